// Which shapes a one-sided mesh takes no notice of.
//
//   if (mesh.is_one_sided() && is_behind(mesh, centre_of(shape))) return;
#pragma once

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <cstdint>

namespace carom::detail {

/// @return the point that tells on which side of a mesh a convex shape is, in the shape's frame: the kernels' centre.
[[nodiscard]] inline dvec3 centre_of(const Shape& shape) noexcept {
    const ConvexHullPtr* const hull = std::get_if<ConvexHullPtr>(&shape);
    return hull != nullptr ? (*hull)->centre() : dvec3{0.0};
}

/// @param centre  in the mesh's frame.
/// @return whether it is behind the surface where that is nearest to it. Beside an open edge nothing is behind.
[[nodiscard]] bool is_behind(const TriangleMesh& mesh, const dvec3& centre);

/// @return whether it is behind the plane of the triangle; not where it is in the plane.
[[nodiscard]] bool is_behind(const TriangleMesh& mesh, std::uint32_t triangle, const dvec3& centre) noexcept;

/// Contacts that a moving shape makes with a mesh on its way.
///
/// Where the mesh is one-sided, those with triangles count of which the centre was in front both at the start and at the contact. What
/// crosses the plane of a triangle from behind goes away from it, though its rest, coming after, may touch that triangle only then; it
/// must not be held by what it passes.
class OneSidedPath {
public:
    /// @param from  the shape's centre at the start, in the mesh's frame then. The mesh must outlive this.
    OneSidedPath(const TriangleMesh& mesh, const dvec3& from) noexcept : mesh_(mesh), from_(from), one_sided_(mesh.is_one_sided()) {}

    /// @return whether no contact with the triangle counts, whenever it is.
    [[nodiscard]] bool passes(std::uint32_t triangle) const noexcept { return one_sided_ && is_behind(mesh_, triangle, from_); }
    /// @param centre_then  gives the centre at the contact, in the mesh's frame then.
    template <class CentreThen>
    [[nodiscard]] bool is_back(std::uint32_t triangle, const CentreThen& centre_then) const {
        if (!one_sided_) return false;
        const dvec3 centre = centre_then();
        return is_behind(mesh_, triangle, centre) || is_behind(mesh_, centre);
    }

private:
    const TriangleMesh& mesh_;
    dvec3 from_;
    bool one_sided_;
};

}  // namespace carom::detail
