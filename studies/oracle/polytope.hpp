// Boxes and hulls as polytopes in double, and how deep two of them overlap: the slow and plain answer that the engine's
// is held against.
//
//   Polytope a = *make_polytope(shape_a, pose_a), b = *make_polytope(shape_b, pose_b);
//   double depth = overlap_depth(a, b);
#pragma once

#include <carom/collision/shapes.hpp>
#include <carom/core/pose.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace carom::oracle {

/// A convex polyhedron, turned to world axes; coordinates count from `position`, so that distance from the world's
/// origin costs no accuracy.
struct Polytope {
    struct Face {
        dvec3 normal{0.0};                   ///< outward, unit
        double offset = 0.0;                 ///< largest dot(normal, vertex) [m]
        std::uint32_t first = 0, count = 0;  ///< its corners, counter-clockwise, in `loops`
    };
    struct Edge {
        std::uint32_t a = 0, b = 0;         ///< vertices
        std::uint32_t left = 0, right = 0;  ///< the two faces that share it
    };
    dvec3 position{0.0};
    std::vector<dvec3> vertices;
    std::vector<Face> faces;
    std::vector<Edge> edges;
    std::vector<std::uint32_t> loops;
};

/// @return the polytope of a box or a hull at `pose`; of a cylinder or cone the prism or pyramid inside it with kTurnedSides sides, which
/// lacks at most 0.5 % of the radius; nothing for other shapes.
[[nodiscard]] std::optional<Polytope> make_polytope(const Shape& shape, const Pose& pose);

/// @return the least overlap over the separating axes, which is the shortest translation that parts the two [m]; 0 if
/// they are apart or only touch. Axes: the faces of both, and those crosses of edges that are faces of the Minkowski
/// difference (Gregorius, The Separating Axis Test between Convex Polyhedra, GDC 2013); the supports are always taken
/// over all vertices. Accuracy: a few ulp of the sizes; where a hull merged faces that are not quite coplanar, never
/// too small and too large by that angle at most. Cost: O(F V + E²), with four products for most pairs of edges.
[[nodiscard]] double overlap_depth(const Polytope& a, const Polytope& b);

inline constexpr int kTurnedSides = 32;

/// The same for two boxes, by the 15 axes. @param pose_a, pose_b  of the boxes in one frame.
[[nodiscard]] double overlap_depth(const Box& a, const Pose& pose_a, const Box& b, const Pose& pose_b);

/// All points within `radius` of a segment: a sphere where the ends coincide. World coordinates [m].
struct Round {
    dvec3 a{0.0}, b{0.0};
    double radius = 0.0;
};

/// @return the sphere or capsule at `pose`; nothing for other shapes.
[[nodiscard]] std::optional<Round> make_round(const Shape& shape, const Pose& pose);

/// @return the depth of overlap [m], 0 if apart: the sum of radii less the distance of the segments.
[[nodiscard]] double overlap_depth(const Round& a, const Round& b);

/// @return the depth of overlap [m], 0 if apart: the radius less the distance of segment and polytope or, where these
/// meet, plus the shortest translation that parts them.
[[nodiscard]] double overlap_depth(const Round& a, const Polytope& b);

/// @return the least distance between the segments a0 a1 and b0 b1; either may be a point.
[[nodiscard]] double segment_distance(const dvec3& a0, const dvec3& a1, const dvec3& b0, const dvec3& b1);

/// @return the point of the triangle nearest to `p`. Source: Ericson, Real-Time Collision Detection (2005), sec. 5.1.5.
[[nodiscard]] dvec3 closest_on_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c);

}  // namespace carom::oracle
