// Triangle meshes with a bounding-volume hierarchy: built once, immutable, shared.
//
//   Result<TriangleMeshPtr> terrain = TriangleMesh::build(vertices, triangles);
//   (*terrain)->overlap(box, [&](std::uint32_t triangle) { ...; return true; });
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace carom {

struct TriangleMeshSettings {
    /// Back faces, those seen clockwise, do not collide: a convex shape, a part of a compound or another mesh meets the mesh only while its
    /// centre is in front of it. What comes from behind passes; once its centre has come through, the front leads the rest of it out.
    bool one_sided = false;
};

/// A surface of triangles, counter-clockwise seen from outside. Both sides collide, unless it is one-sided; rays hit both sides always.
class TriangleMesh {
public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// @param vertices   (n,) [m], finite.
    /// @param triangles  (m,) indices below n, m >= 1. Triangles of zero area are kept and counted (see degenerate_count).
    /// @return the mesh; Empty, NotFinite or InvalidArgument (an index out of range, by triangle; more than 2^28 triangles).
    [[nodiscard]] static Result<TriangleMeshPtr> build(std::span<const vec3> vertices, std::span<const Triangle> triangles,
                                                       const TriangleMeshSettings& settings = {});
    /// The same; `executor` builds the hierarchy of a large mesh in parallel, with the same result.
    [[nodiscard]] static Result<TriangleMeshPtr> build(std::span<const vec3> vertices, std::span<const Triangle> triangles,
                                                       Executor& executor, const TriangleMeshSettings& settings = {});
    ~TriangleMesh();

    [[nodiscard]] std::span<const vec3> vertices() const noexcept { return vertices_; }
    [[nodiscard]] std::span<const Triangle> triangles() const noexcept { return triangles_; }
    /// @return the corners of triangle `index` < triangles().size().
    [[nodiscard]] std::array<vec3, 3> corners(std::uint32_t index) const noexcept;

    /// @return true if every edge is shared by exactly two triangles that run along it in opposite directions (vertices
    /// compared by exact position), so that the mesh bounds a volume.
    [[nodiscard]] bool is_closed() const noexcept { return closed_; }
    /// @return true if no edge is run along twice in one direction: neighbours are wound alike, and at most two meet in an edge.
    [[nodiscard]] bool is_oriented() const noexcept { return oriented_; }
    /// @return the solid that the mesh bounds where that is convex: closed, and each triangle faces out of the hull of the vertices and has its
    /// corners in a face of that, to 2e-6 of the largest extent. Null otherwise, and where it has over 1,024 faces or 16,384 triangles, of
    /// which it is not found out. Contacts with such a mesh are those of the solid (narrowphase/collide.hpp).
    [[nodiscard]] const ConvexHullPtr& solid() const noexcept { return solid_; }
    /// @return whether back faces do not collide. Such a mesh fits static and kinematic bodies only.
    [[nodiscard]] bool is_one_sided() const noexcept { return one_sided_; }
    /// @return how many triangles have zero area.
    [[nodiscard]] std::size_t degenerate_count() const noexcept { return degenerate_count_; }
    /// @return the box of the vertices.
    [[nodiscard]] const Aabb& local_bounds() const noexcept { return bounds_; }
    /// @return the hierarchy, in the mesh's frame: rays in float go there (mesh_rays.hpp).
    [[nodiscard]] const StaticBvh& bvh() const noexcept { return bvh_; }

    /// Calls `visit` for every triangle whose box overlaps `box` (closed test, mesh frame) until it returns false. The order is
    /// fixed by the mesh alone. Cost: O(log m + hits), no allocation, thread-safe.
    void overlap(const Aabb& box, FunctionRef<bool(std::uint32_t triangle)> visit) const;

    /// Visits the boxes of the hierarchy's nodes and leaves with their depth (root 0), parents first, for drawing.
    void visit_nodes(FunctionRef<void(const Aabb& box, int depth)> visit) const;

private:
    explicit TriangleMesh(StaticBvh&& bvh) noexcept : bvh_(std::move(bvh)) {}
    std::vector<vec3> vertices_;
    std::vector<Triangle> triangles_;
    StaticBvh bvh_;
    Aabb bounds_;
    ConvexHullPtr solid_;
    std::size_t degenerate_count_ = 0;
    bool closed_ = false;
    bool oriented_ = true;
    bool one_sided_ = false;
};

}  // namespace carom
