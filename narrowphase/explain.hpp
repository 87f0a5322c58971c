// Why two placed shapes touch, or why not: everything that bears on it, as data, from bounds on their distance to the points of contact.
//
//   PairExplanation why = explain({.a = &crate, .b = &floor, .pose_a = pose_a, .pose_b = pose_b, .margin = 0.01f});
//   if (why.verdict == PairVerdict::Apart) print(why.axis->gap, to_string(why.axis->source));
//
// For people and pictures: it measures anew, in double and by plain searches, and says whether collide() agrees.
#pragma once

#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carom {

/// Whether two shapes share points, as far as rounding lets one say.
enum class PairVerdict : unsigned char {
    Apart,      ///< an axis with a gap beyond rounding proves it
    Touching,   ///< they overlap by more than rounding
    Undecided,  ///< nearer to touching than rounding can tell apart
};

/// What a shape turns towards the other one, along an axis.
enum class SupportKind : unsigned char {
    Corner,
    Edge,
    Face,
    Round,  ///< of a sphere, capsule, cylinder or cone: it has no number
};

/// Corners are counted as the hull's vertices (a box: bit k of the number set where axis k is positive), faces as the hull's, edges as pairs
/// of half edges; of a triangle the corners 0..2, edges 0..2 (0: from corner 0 to 1), faces 0 and 1 for front and back; of a mesh whose
/// contacts are those of the convex solid that it bounds (TriangleMesh::solid), as of that hull.
struct SupportFeature {
    SupportKind kind = SupportKind::Round;
    std::uint32_t index = 0;
};

/// Where an axis comes from.
enum class AxisSource : unsigned char {
    FaceOfA,  ///< square to a face of A, or to A where that is a plane
    FaceOfB,
    Edges,    ///< square to an edge of each
    Points,   ///< along the line between the closest or deepest points
    Contact,  ///< the normal that collide() reports of its deepest contact: no better axis is known here
};

/// The axis along which the two are farthest apart or, where they overlap, overlap least.
struct SeparatingAxis {
    AxisSource source = AxisSource::Points;
    vec3 normal{0.0f};        ///< unit, world axes, from A to B
    double gap = 0.0;         ///< between the two along the axis [m]; negative: overlap
    double rounding = 0.0;    ///< what rounding may have done to `gap` [m]
    PairVerdict verdict = PairVerdict::Undecided;  ///< of this axis alone: Touching where they overlap along it, which others may undo
    SupportFeature of_a, of_b;                     ///< what supports the two planes across the axis
    dvec3 on_a{0.0}, on_b{0.0};                    ///< points of A and B in those planes, from A's origin along world axes [m]
};

/// What GJK knows of the distance of the two cores less their radii: `lower` from a support plane, `upper` from two points.
struct DistanceBounds {
    double lower = 0.0;  ///< the distance is at least this [m], 0 where they overlap
    double upper = 0.0;  ///< and at most this [m]
    dvec3 on_a{0.0}, on_b{0.0};  ///< the two points, from A's origin along world axes [m]; without meaning where the cores overlap
    bool cores_overlap = false;
    bool converged = true;       ///< false: stopped at its cap; the bounds hold
    std::vector<dvec3> simplex_a, simplex_b;  ///< corners of the last simplex, 1..4 of each core; frame as above [m]
};

/// What a manifold of two flat faces was cut from, from A's origin along world axes [m].
struct FacePatch {
    std::vector<dvec3> face_a, face_b;  ///< corners of the two faces that look at each other
    std::vector<dvec3> common;          ///< of what they share, seen along the normal, midway between them
};

struct PairExplanation {
    PairVerdict verdict = PairVerdict::Undecided;
    double margin = 0.0;       ///< [m]
    std::uint32_t part_a = 0;  ///< the parts (of compounds) and the triangle (of a mesh) that come nearest or overlap most
    std::uint32_t part_b = 0;
    std::uint32_t triangle = 0;    ///< of two meshes, A's
    std::uint32_t triangle_b = 0;  ///< of two meshes, B's
    std::optional<DistanceBounds> distance;
    std::optional<SeparatingAxis> axis;  ///< of two meshes that are apart and do not both bound convex solids: that of the two triangles
    /// A one-sided mesh has its back towards the other's centre: collide() then says nothing, however near or deep they are.
    bool back_face = false;
    CollideStatus status = CollideStatus::Ok;
    std::vector<Manifold> manifolds;         ///< as collide() gives them
    std::optional<FacePatch> patch;          ///< of the deepest manifold, where two faces make it
    /// Empty, or in what collide() differs from the above by more than it may: a fault of the engine's.
    std::string disagreement;
};

/// Explains a pair, at the same frame as its manifolds: world axes about A's origin.
///
/// Distances by GJK, axes by the faces and edges of both for boxes, hulls and triangles; along every axis the gap is measured at the
/// farthest points of both shapes, so that a gap is a proof whatever the search for the axis did. Rounding: 64 ulp of the
/// sizes and the distance of the origins.
/// Two shapes overlap more along any other axis than the one given: to 1e-6 of their size for boxes, hulls, spheres and capsules, and
/// as well as collide() has it for cylinders, cones and meshes. Of a mesh, the nearest triangle is looked at; of a one-sided one, the nearest
/// that faces the shape's centre. Of two meshes that bound convex solids these are compared. Of other meshes the bounds of the distance are
/// those of closest_pair(), which prove that they are apart; the axis, its features and the simplex are then those of the two triangles that are
/// nearest. Where such meshes meet, or one is inside of the other, the axis is that of the deepest contact.
/// Misuse as in collide(): reported; then an empty explanation. Cost: that of collide(), and for each pair of parts or triangles whose
/// boxes come near some µs; a mesh costs O(triangles) against a convex shape, two meshes as closest_pair(). Thread-safe. Allocates.
[[nodiscard]] PairExplanation explain(const ShapePair& pair);

/// @return "apart", "touching", "undecided".
[[nodiscard]] const char* to_string(PairVerdict verdict) noexcept;
/// @return "corner", "edge", "face", "round".
[[nodiscard]] const char* to_string(SupportKind kind) noexcept;
/// @return "face of A", "face of B", "edges", "points", "contact".
[[nodiscard]] const char* to_string(AxisSource source) noexcept;

}  // namespace carom
