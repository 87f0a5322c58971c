// Pairs of shapes with contact, what is true of each, and how wrong manifolds are by it.
//
//   auto cases = box_cases(2000, Depth::Any, 91);
//   double error = depth_error(*cases, manifolds);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/studies/oracle/polytope.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace carom::accuracy {

/// Each pair (2 k, 2 k + 1) of the shapes overlaps.
struct ManifoldCases {
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    std::vector<double> depth;    ///< the least overlap over the separating axes, by the oracle [m]
    std::vector<double> area;     ///< of the region of contact, where cases have one [m²]
    std::vector<double> size;     ///< the larger extent of the two [m]
    std::vector<const Shape*> pointers;
    std::vector<NumberedPair> pairs;

    [[nodiscard]] PlacedShapes placed() const { return {pointers, poses}; }
    [[nodiscard]] std::size_t count() const { return pairs.size(); }
    [[nodiscard]] ShapePair pair(std::size_t k) const {
        return {pointers[2 * k], pointers[2 * k + 1], poses[2 * k], poses[2 * k + 1], pairs[k].margin};
    }
    void add(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b);
    /// Once all are added.
    void number(float margin);
};
using ManifoldCasesPtr = std::shared_ptr<const ManifoldCases>;

enum class Depth { Any, Wedged };

/// Boxes or hulls of 32 points, turned evenly, that overlap: by any depth, or by 10 to 100 % of the smaller one's least extent.
[[nodiscard]] ManifoldCasesPtr box_cases(std::size_t count, Depth depth, std::uint64_t seed);
[[nodiscard]] ManifoldCasesPtr hull_cases(std::size_t count, std::uint64_t seed);
/// The same boxes as hulls of eight points, which other kernels take.
[[nodiscard]] ManifoldCasesPtr as_hulls(const ManifoldCases& boxes);

/// Boxes that rest on each other face to face, each turned and moved in the plane; the area is that of the cut of the two rectangles.
[[nodiscard]] ManifoldCasesPtr resting_cases(std::size_t count, std::uint64_t seed);

/// Boxes, hulls, spheres and capsules, or cylinders and cones, in flat ground, tilted; the depth is that of the deepest point.
/// @param triangles  0: the ground is a half-space; otherwise a mesh of so many, an even square.
[[nodiscard]] ManifoldCasesPtr ground_cases(std::size_t count, int triangles, bool turned, std::uint64_t seed);

/// The same pairs with B moved by `share` of the size in an even direction and turned by as much [rad].
[[nodiscard]] ManifoldCasesPtr moved(const ManifoldCases& cases, double share, std::uint64_t seed);

// Each takes the manifolds of all pairs, in order.

/// The largest difference between the deepest point and the true depth, of the size; a contact that is missing counts 1.
[[nodiscard]] double depth_error(const ManifoldCases& cases, std::span<const Manifold> manifolds);
/// The mean of the same over all pairs.
[[nodiscard]] double mean_depth_error(const ManifoldCases& cases, std::span<const Manifold> manifolds);
/// The largest excess of the overlap along the reported normal over the least, of the size: what a wrong normal costs.
[[nodiscard]] double normal_error(const ManifoldCases& cases, std::span<const Manifold> manifolds);
/// The mean share of the area that the hull of the first `points` points does not span; of one or two points 1.
[[nodiscard]] double area_error(const ManifoldCases& cases, std::span<const Manifold> manifolds, std::size_t points);
/// The share of points after a motion whose name no point of the pair had before.
[[nodiscard]] double new_names(std::span<const Manifold> before, std::span<const Manifold> after);

}  // namespace carom::accuracy
