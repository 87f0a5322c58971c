// The closest points of two meshes: one hierarchy against the other, both at any pose.
//
//   if (auto gap = closest_pair(a, b, inverse(pose_a) * pose_b, 0.5)) { gap->on_a; gap->on_b; gap->distance; gap->triangles; }
//
// Method: both trees are descended together as in mesh_pairs.hpp, nearest boxes first, leaving out what is farther apart than the nearest
// pair of triangles so far; what remains is measured in double.
#pragma once

#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/pose.hpp>

#include <limits>
#include <optional>

namespace carom {

/// A point of each mesh, in the frame of the first.
struct ClosestOfMeshes {
    dvec3 on_a{0.0};
    dvec3 on_b{0.0};
    double distance = 0.0;   ///< [m]; 0 where the surfaces meet, to rounding
    double lower = 0.0;      ///< no two points of the meshes are nearer to each other than this [m], as rounding goes
    TrianglePair triangles;  ///< that hold the points: the first, ascending, of several at this distance; of meshes that meet, some pair
};

/// @param b_in_a   the second mesh in the frame of the first; not finite: nothing.
/// @param radius   only what is at most this far apart counts [m]; may be infinite; negative or NaN: nothing.
/// @return nothing where the meshes are farther apart than `radius`.
/// Accuracy: 48 eps of the largest coordinate of the two where they lie, eps = 2^-52, of which `lower` takes account. Surfaces count, not
/// what they enclose.
/// Cost: some 10 us for two balls of 69,312 triangles that are near each other; where large stretches are equally near, O(triangles there).
/// Allocates only while a buffer of the calling thread grows. Thread-safe.
[[nodiscard]] std::optional<ClosestOfMeshes> closest_pair(const StaticBvh& a, const StaticBvh& b, const Pose& b_in_a,
                                                          double radius = std::numeric_limits<double>::infinity());

}  // namespace carom
