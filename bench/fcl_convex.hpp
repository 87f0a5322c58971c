// Balls, boxes and hulls as FCL knows them, one pair at a time (GJK and EPA of libccd, conservative advancement).
//
//   FclConvex a(Box{}), b(hull);
//   bool meet = a.overlaps(b, FclPlace(pose_a), FclPlace(pose_b));
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <memory>
#include <optional>

namespace carom::bench {

/// A pose as FCL takes it, made beforehand so that making it costs FCL nothing.
class FclPlace {
public:
    explicit FclPlace(const Pose& pose);
    ~FclPlace();
    FclPlace(FclPlace&&) noexcept;

private:
    friend class FclConvex;
    struct Data;
    std::unique_ptr<Data> data_;
};

/// A motion as FCL takes it, made beforehand likewise. FCL moves it while it searches.
class FclMotion {
public:
    /// @param motion  about the shape's origin, by less than pi. What does not turn is a TranslationMotion, what does an InterpMotion.
    explicit FclMotion(const RigidMotion& motion);
    ~FclMotion();
    FclMotion(FclMotion&&) noexcept;

private:
    friend class FclConvex;
    struct Data;
    std::unique_ptr<Data> data_;
};

/// What FCL says of two motions.
struct FclImpact {
    bool met = false;
    double t = 1.0;
    bool threw = false;
};

class FclConvex {
public:
    /// @param shape  a sphere, a box or a hull.
    explicit FclConvex(const Shape& shape);
    ~FclConvex();
    FclConvex(FclConvex&&) noexcept;

    [[nodiscard]] bool overlaps(const FclConvex& other, const FclPlace& here, const FclPlace& there) const;
    /// @return the depth [m], 0 where FCL finds the two apart; nothing where it throws.
    [[nodiscard]] std::optional<double> depth(const FclConvex& other, const FclPlace& here, const FclPlace& there) const;
    /// @return the distance [m] with nearest points asked for, below 0 where they overlap; nothing where it throws.
    [[nodiscard]] std::optional<double> distance(const FclConvex& other, const FclPlace& here, const FclPlace& there) const;
    /// Conservative advancement, with FCL's defaults: GJK of libccd. Of what turns, GJK of FCL's own, since libccd would end the program.
    [[nodiscard]] FclImpact time_of_impact(const FclConvex& other, const FclMotion& here, const FclMotion& there) const;

private:
    struct Geometry;
    std::unique_ptr<Geometry> geometry_;
};

}  // namespace carom::bench
