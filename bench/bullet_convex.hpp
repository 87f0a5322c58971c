// Balls, boxes and hulls as Bullet knows them: its convex casts, one pair at a time.
//
//   BulletConvex a(Sphere{}), b(hull);
//   BulletImpact hit = a.time_of_impact(b, BulletMotion(motion_a), BulletMotion(motion_b));
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <memory>
#include <string>

namespace carom::bench {

/// The two ends of a motion as Bullet takes them, made beforehand so that making them costs Bullet nothing.
class BulletMotion {
public:
    /// @param motion  about the shape's origin, by less than pi / 4: Bullet follows no more.
    explicit BulletMotion(const RigidMotion& motion);
    ~BulletMotion();
    BulletMotion(BulletMotion&&) noexcept;

private:
    friend class BulletConvex;
    struct Data;
    std::unique_ptr<Data> data_;
};

struct BulletImpact {
    bool met = false;
    double t = 1.0;
};

class BulletConvex {
public:
    /// @param shape  a sphere, a box or a hull; without a margin, which would round corners, so that all engines see one shape.
    explicit BulletConvex(const Shape& shape);
    ~BulletConvex();
    BulletConvex(BulletConvex&&) noexcept;

    /// btSubsimplexConvexCast, which World::convexSweepTest of Bullet uses: orientations at the start are kept.
    [[nodiscard]] BulletImpact cast(const BulletConvex& other, const BulletMotion& here, const BulletMotion& there) const;
    /// btContinuousConvexCollision, which follows the turning.
    [[nodiscard]] BulletImpact time_of_impact(const BulletConvex& other, const BulletMotion& here, const BulletMotion& there) const;

    [[nodiscard]] static std::string version();

private:
    struct Geometry;
    std::unique_ptr<Geometry> geometry_;
};

}  // namespace carom::bench
