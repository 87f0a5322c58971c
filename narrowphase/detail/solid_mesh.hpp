// When a mesh is met as the convex solid that it bounds.
//
//   if (const ConvexHull* solid = solid_to(mesh, centre, axes, reach)) ...
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

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

/// What would have room if it were turned reaches through the walls by its corners, at most by this share of how deep its centre is inside: a cube
/// in a room of its own size, turned about one of its axes, by 0.41.
inline constexpr double kCorner = 0.5;

/// @param axes  of the shape's own box, in the solid's frame, unit.
/// @param reach  as in has_room().
/// @return whether its edges, from the shortest to the longest, are no longer than those of the solid's own box, and the shape reaches through no
/// face by more than its corners do where it is turned.
template <class Reach>
[[nodiscard]] bool fits_turned(const ConvexHull& solid, const dvec3& centre, const dmat3& axes, const Reach& reach) {
    std::array<double, 3> own{}, room{};
    for (glm::length_t k = 0; k < 3; ++k) {
        own[static_cast<std::size_t>(k)] = reach(axes[k]) + reach(-axes[k]);
        room[static_cast<std::size_t>(k)] = solid.local_bounds().upper[k] - solid.local_bounds().lower[k];
    }
    for (std::array<double, 3>* edges : {&own, &room}) {  // shortest first
        if ((*edges)[1] < (*edges)[0]) std::swap((*edges)[0], (*edges)[1]);
        if ((*edges)[2] < (*edges)[1]) std::swap((*edges)[1], (*edges)[2]);
        if ((*edges)[1] < (*edges)[0]) std::swap((*edges)[0], (*edges)[1]);
    }
    if (!(own[0] < kWedged * room[0] && own[1] < kWedged * room[1] && own[2] < kWedged * room[2])) return false;
    double inside = std::numeric_limits<double>::infinity(), outside = 0.0;
    for (const ConvexHull::Face& face : solid.faces()) {
        inside = std::min(inside, face.offset - glm::dot(face.normal, centre));
        outside = std::max(outside, reach(face.normal) - face.offset);
    }
    return outside <= kCorner * inside;
}

/// @param centre  of a convex shape, in the mesh's frame.
/// @param axes    as in fits_turned().
/// @param reach   as in has_room().
/// @return the solid whose contacts with the shape are those of the mesh; null where they are those of its triangles: of a mesh that bounds no
/// convex solid, to what is inside of it and has room there or would have if it were turned, and to what has its centre behind a one-sided one.
template <class Reach>
[[nodiscard]] const ConvexHull* solid_to(const TriangleMesh& mesh, const dvec3& centre, const dmat3& axes, const Reach& reach) {
    const ConvexHull* const solid = mesh.solid().get();
    if (solid == nullptr || !is_in(*solid, centre)) return solid;
    return mesh.is_one_sided() || has_room(*solid, reach) || fits_turned(*solid, centre, axes, reach) ? nullptr : solid;
}

}  // namespace carom::detail
