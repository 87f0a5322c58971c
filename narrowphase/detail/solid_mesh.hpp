// When a mesh is met as the convex solid that it bounds.
//
//   if (const ConvexHull* solid = solid_to(mesh, centre, reach)) ...
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <glm/geometric.hpp>

#include <algorithm>

namespace carom::detail {

[[nodiscard]] inline bool is_in(const ConvexHull& solid, const dvec3& p) noexcept {
    if (!overlaps(solid.local_bounds(), Aabb{p, p})) return false;
    return std::ranges::all_of(solid.faces(), [&](const ConvexHull::Face& face) { return glm::dot(face.normal, p) <= face.offset; });
}

/// What is wedged between two walls of a room is in both by as much as a solver leaves: its width may be this many times the room's.
inline constexpr double kWedged = 1.02;

/// A mesh has two sides, and what has its centre behind the surface is pushed further in: so a closed one can be a room. But nothing can be
/// pushed into what it has no room in.
/// @param reach  of the shape that is held against the solid: the largest dot product of a vector of the solid's frame with a point of it.
/// @return whether through each face that the shape reaches, the solid is wider than the shape along the face's normal, or no narrower
/// than what is wedged in it.
template <class Reach>
[[nodiscard]] bool has_room(const ConvexHull& solid, const Reach& reach) {
    return std::ranges::all_of(solid.faces(), [&](const ConvexHull::Face& face) {
        const double highest = reach(face.normal);
        if (highest <= face.offset) return true;
        const double bottom = glm::dot(face.normal, dvec3(solid.vertices()[solid.support(-face.normal)]));
        return highest + reach(-face.normal) < kWedged * (face.offset - bottom);
    });
}

/// @param centre  of a convex shape, in the mesh's frame.
/// @param reach   as in has_room().
/// @return the solid whose contacts with the shape are those of the mesh; null where they are those of its triangles: of a mesh that bounds no
/// convex solid, to what is inside of it and has room there, and to what has its centre behind a one-sided one.
template <class Reach>
[[nodiscard]] const ConvexHull* solid_to(const TriangleMesh& mesh, const dvec3& centre, const Reach& reach) {
    const ConvexHull* const solid = mesh.solid().get();
    if (solid == nullptr || !is_in(*solid, centre)) return solid;
    return mesh.is_one_sided() || has_room(*solid, reach) ? nullptr : solid;
}

}  // namespace carom::detail
