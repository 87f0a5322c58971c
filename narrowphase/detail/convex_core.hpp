// A convex shape as distance and overlap queries see it: a core of points, or a truncated cone, and a radius round it.
//
//   const CorePair pair = core_pair(shape_a, pose_a, shape_b, pose_b);
//   CoreSupport s = pair.a.support(direction);
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/detail/truncated_cone.hpp>

#include <cstdint>
#include <span>
#include <type_traits>

namespace carom::detail {

/// A point of a core, and its number; points of curved cores have none.
struct CoreSupport {
    dvec3 point{0.0};
    std::uint32_t index = 0;
};

static_assert(std::is_trivially_copyable_v<TruncatedCone>);  // a core that has none is copied with what is in its place

/// A core in its pair's frame: world axes about A's origin, lengths in the pair's unit.
struct ConvexCore {
    enum class Kind : unsigned char { Box, Points, Turned };

    ConvexCore() noexcept {}  // leaves out the solid, which few have

    Kind kind = Kind::Box;
    std::span<const vec3> points;          ///< of a hull, in its own frame [m]
    std::span<const PointBundle> bundles;  ///< the same
    dvec3 half{0.0};                       ///< of a box, along its axes [m]; a capsule's core has y alone, a sphere's is a point
    dmat3 axes{1.0};                       ///< of the shape, each of the length of a metre
    dvec3 centre{0.0};
    union {
        TruncatedCone solid;  ///< of a cylinder or cone alone
    };
    double radius = 0.0;  ///< what lies round the core
    double reach = 0.0;   ///< of the core from `centre`, at least

    [[nodiscard]] bool curved() const noexcept { return kind == Kind::Turned; }
    [[nodiscard]] std::uint32_t count() const noexcept;  ///< of numbered points
    [[nodiscard]] dvec3 place(std::uint32_t index) const noexcept;
    /// @return a point farthest along `direction`, which is neither zero nor infinite; the lowest number of equals.
    [[nodiscard]] CoreSupport support(const dvec3& direction) const noexcept;
    /// @return what that point has along it: the support function, without the point.
    [[nodiscard]] double height(const dvec3& direction) const noexcept;
};

/// A support point of each, of `a` along a direction and of `b` against it.
void supports(const ConvexCore& a, const ConvexCore& b, const dvec3& direction, CoreSupport& of_a, CoreSupport& of_b) noexcept;

/// @return the radius about a shape's core [m]: of spheres and capsules; for the rest 0.
[[nodiscard]] double core_radius(const Shape& shape) noexcept;

/// Two cores in one frame. Lengths are scaled by a power of two so that the larger of sizes and distance is near 1: squares and cubes of
/// lengths of any size can be formed then.
struct CorePair {
    ConvexCore a, b;
    double unit = 1.0;      ///< [m]
    double rounding = 0.0;  ///< what rounding may do to the difference of a support point of each, and to its length
};

/// @param a, b  spheres, boxes, capsules, hulls, cylinders or cones with finite poses.
/// Method: a point is c + R v with R the rotation of the quaternion as it stands, exact where that is of unit length.
/// Rounding: entries of R err by at most 5 u (u = 2^-53), a placed point by 5 u |v|_1 + 3 u |v|, less than 21 u of its reach,
/// the difference of the origins by u of its length. Searching for the farthest point along a rounded direction may miss the farthest by
/// 10 u of the reach, and products of the result with a unit vector err by 5 u. All of it for both shapes is below 64 u (|t| + reach_a
/// + reach_b); `rounding` is twice that.
[[nodiscard]] CorePair core_pair(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b) noexcept;

/// The core of one shape about `centre`, a metre being `scale` long.
[[nodiscard]] ConvexCore core_of(const Shape& shape, const dquat& orientation, const dvec3& centre, double scale) noexcept;

}  // namespace carom::detail
