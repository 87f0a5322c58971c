// A convex core on a screw, as searches for a time of impact see it: where it is at t, and how fast its support along a normal may change.
//
//   MovingCore a = moving_core(shape, motion, scale), b = moving_core(corners, motion, scale);
//   Impact found = find_impact({a, b, between, along, unit}, settings, nullptr);
#pragma once

#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <array>
#include <span>

namespace carom::detail {

/// A triangle as a core of points.
struct TrianglePoints {
    std::array<vec3, 3> corner;
    PointBundle bundle;
};
[[nodiscard]] TrianglePoints triangle_points(const std::array<vec3, 3>& corners) noexcept;

/// Lengths in a unit of which a metre is `scale`.
struct MovingCore {
    const Shape* shape = nullptr;              ///< or null, for
    const TrianglePoints* triangle = nullptr;  ///< this, or
    const ConvexCore* ready = nullptr;         ///< this: about its centre, in the pair's unit; it does not turn
    dquat start{kIdentityRotation};
    dvec3 rotation{0.0};    ///< zero of a core that is one point at its pivot
    dvec3 pivot{0.0};       ///< in the shape's frame
    dvec3 foot{0.0};        ///< of a plane: a point of it, in its frame
    dvec3 plane_normal{0.0};  ///< of a plane, as it stands at the start: world axes; else zero
    double scale = 1.0;
    double reach = 0.0;     ///< of the core's points from the pivot, at least; a plane's foot has 0
    double radius = 0.0;    ///< of the ball about the core, which turning does not change

    [[nodiscard]] bool is_box() const noexcept;
    [[nodiscard]] bool is_plane() const noexcept { return plane_normal != dvec3{0.0}; }
    /// @return a plane's normal at t, world axes.
    [[nodiscard]] dvec3 normal_at(double t) const noexcept;
    /// @param at  of the pivot at t. @return in the pair's unit; a box with its half extents in it and axes of unit length.
    [[nodiscard]] ConvexCore core(double t, const dvec3& at) const noexcept;
};

/// A and B, and how B's pivot moves seen from A's: between + t along.
struct MovingPair {
    MovingCore a, b;
    dvec3 between{0.0};
    dvec3 along{0.0};
    double unit = 1.0;  ///< [m]

    /// What rounding may do to a gap.
    [[nodiscard]] double rounding() const noexcept;
};

/// @param until  contacts later than this need not be found.
/// @return the answer with `point` relative to A's pivot at t, in metres.
[[nodiscard]] Impact find_impact(const MovingPair& pair, const TimeOfImpactSettings& settings, double until, DistanceCache* cache) noexcept;

}  // namespace carom::detail
