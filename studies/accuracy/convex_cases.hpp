// The cases of the studies of convex pairs: boxes and hulls under conditions, with their exact separations.
//
//   for (ConvexCases& cases : convex_cases(ConvexKind::Boxes, quick)) { cases.pairs, cases.separation; }
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>
#include <carom/narrowphase/collide.hpp>

#include <string>
#include <vector>

namespace carom::accuracy {

enum class ConvexKind { Boxes, Hulls };

/// Pairs under one condition. Pair i is of the places 2 i and 2 i + 1.
struct ConvexCases {
    std::string condition;  ///< "random", "near", "touching", "deep", "thin", "far" or "tiny"
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    std::vector<const Shape*> placed;
    std::vector<NumberedPair> pairs;
    std::vector<double> separation;  ///< exact to 1e-17 of the size: the distance, or the least depth, negative [m]
    std::vector<double> size;        ///< of the pair, the larger extent [m]

    [[nodiscard]] PlacedShapes places() const { return {placed, poses}; }
};

/// @return the conditions, always the same cases; by brute force over all separating axes and features in long double.
/// random: half extents or radii 0.2..1, centres 0.5..2.4 apart. near: the gap or depth is 1e-12..1e-3 of the size. touching: 0, as far as
/// doubles hold the place. deep: centres up to 0.2 apart. thin: one extent 1e-3 of the others. far: 1e4..1e7 m from the world's origin.
/// tiny: all lengths times 1e-6. thin, far and tiny are near contact every other time.
/// @param quick  a tenth of the cases.
[[nodiscard]] std::vector<ConvexCases> convex_cases(ConvexKind kind, bool quick);

}  // namespace carom::accuracy
