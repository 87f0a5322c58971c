// Triangle meshes with a bounding-volume hierarchy: built once, immutable, shared.
//
//   Result<TriangleMeshPtr> terrain = TriangleMesh::build(vertices, triangles);
//   (*terrain)->overlap(box, [&](std::uint32_t triangle) { ...; return true; });
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace carom {

class Bvh;  // <carom/collision/detail/bvh.hpp>

/// A surface of triangles, counter-clockwise seen from outside. Both sides collide.
class TriangleMesh {
public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// @param vertices   (n,) [m], finite.
    /// @param triangles  (m,) indices below n, m >= 1. Triangles of zero area are kept and counted (see degenerate_count).
    /// @return the mesh; Empty, NotFinite or InvalidArgument (an index out of range, by triangle).
    [[nodiscard]] static Result<TriangleMeshPtr> build(std::span<const vec3> vertices, std::span<const Triangle> triangles);
    ~TriangleMesh();

    [[nodiscard]] std::span<const vec3> vertices() const noexcept { return vertices_; }
    [[nodiscard]] std::span<const Triangle> triangles() const noexcept { return triangles_; }
    /// @return the corners of triangle `index` < triangles().size().
    [[nodiscard]] std::array<vec3, 3> corners(std::uint32_t index) const noexcept;

    /// @return true if every edge is shared by exactly two triangles that run along it in opposite directions (vertices
    /// compared by exact position), so that the mesh bounds a volume.
    [[nodiscard]] bool is_closed() const noexcept { return closed_; }
    /// @return how many triangles have zero area.
    [[nodiscard]] std::size_t degenerate_count() const noexcept { return degenerate_count_; }
    /// @return the box of the vertices.
    [[nodiscard]] const Aabb& local_bounds() const noexcept { return bounds_; }
    [[nodiscard]] const Bvh& bvh() const noexcept { return *bvh_; }

    /// Calls `visit` for every triangle whose box overlaps `box` (closed test, mesh frame) until it returns false. The order is
    /// fixed by the mesh alone. Cost: O(log m + hits), no allocation, thread-safe.
    void overlap(const Aabb& box, FunctionRef<bool(std::uint32_t triangle)> visit) const;

    /// Visits the boxes of the hierarchy's nodes with their depth (root 0), for drawing.
    void visit_nodes(FunctionRef<void(const Aabb& box, int depth)> visit) const;

private:
    TriangleMesh() = default;
    std::vector<vec3> vertices_;
    std::vector<Triangle> triangles_;
    std::unique_ptr<const Bvh> bvh_;
    Aabb bounds_;
    std::size_t degenerate_count_ = 0;
    bool closed_ = false;
};

}  // namespace carom
