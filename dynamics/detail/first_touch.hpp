// When two shapes of any types first touch along two motions.
//
//   MovingShape ball{.shape = &shape, .motion = motion};
//   Impact impact = first_touch(ball, 0, {.shape = &wall, .motion = {.start = pose}}, {.separation = bend}, cores);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <deque>
#include <memory>

namespace carom::dynamics {

/// How much of a shape is asked for: 0 is the shape, and each further level is what is left of it when it is thinned from all sides by a larger share of its
/// thickness, down to next to nothing. What is inside of a shape passes through nothing that the shape itself has not come as deep into.
inline constexpr int kLevels = 8;
inline constexpr int kMiddle = kLevels;  ///< deeper than what is watched: where that comes, something has been passed through
inline constexpr double kRestOfLevel[kLevels + 1]{1.0, 0.98, 0.95, 0.9, 0.8, 0.6, 0.3, 0.02, 0.01};  ///< of the thickness

/// Hulls that are made for the levels of hulls and meshes, kept between calls.
class Cores {
public:
    /// @return the hull of a mesh, or a null pointer for a flat one; and that of a hull, thinned to a level.
    [[nodiscard]] const Shape* hull_of(const TriangleMeshPtr& mesh);
    [[nodiscard]] const Shape* core_of(const ConvexHullPtr& hull, int level);

    /// Lets go of what nobody else holds.
    void forget_unused();

private:
    struct Hull {
        std::shared_ptr<const void> of;
        int level = 0;
        Shape shape;
        bool exists = false;
    };
    template <class Make>
    const Shape* find(const std::shared_ptr<const void>& of, int level, const Make& make);
    std::deque<Hull> hulls_;
};

struct MovingShape {
    const Shape* shape = nullptr;
    RigidMotion motion{};
};

/// The first contact of A, thinned to a level, and B, all of it: of compounds that of the first of their parts. At most one of the two is a plane.
/// Where A is a mesh and meets a plane, a mesh or anything at a deeper level, its hull stands for it, which is never later; a flat mesh then meets nothing.
/// Promises and costs are those of time_of_impact(); `point` is on B, or on A where A is a mesh.
[[nodiscard]] Impact first_touch(const MovingShape& a, int level, const MovingShape& b, const TimeOfImpactSettings& settings, Cores& cores);

}  // namespace carom::dynamics
