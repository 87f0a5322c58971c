// The static hierarchy of a set of triangles, for rays and other queries: built once, immutable.
//
//   Result<StaticBvh> bvh = StaticBvh::build(vertices, triangles);
//   if (MeshHit hit = closest_hit(*bvh, ray)) ...                         // mesh_rays.hpp
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/result.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace carom {

struct WideBvh;  // <carom/collision/detail/wide_bvh.hpp>

/// A 16-wide tree of boxes whose leaves hold up to 16 triangles with their vertices, so that queries need nothing else.
///
/// Vertices are welded by exact position, so soup costs what an indexed mesh does; some 42 bytes a triangle for a smooth surface.
class StaticBvh {
public:
    using Triangle = std::array<std::uint32_t, 3>;
    static constexpr std::size_t kMaxTriangles = std::size_t{1} << 28;

    /// @param vertices   (n,), finite; any unit.
    /// @param triangles  (m,) indices below n, 1 <= m <= kMaxTriangles; degenerate ones are kept.
    /// @param executor   builds large trees in parallel; the tree is the same on every thread count and SIMD width.
    /// @return the tree; Empty, NotFinite or InvalidArgument (an index out of range, by triangle).
    /// Cost: O(m log m), some 0.5 us a triangle on one thread.
    /// Source: binned surface-area heuristic (Wald 2007), folded into wide nodes by a dynamic programme (Ylitie, Karras, Laine,
    /// HPG 2017, section 3.2).
    [[nodiscard]] static Result<StaticBvh> build(std::span<const vec3> vertices, std::span<const Triangle> triangles,
                                                 Executor& executor);
    [[nodiscard]] static Result<StaticBvh> build(std::span<const vec3> vertices, std::span<const Triangle> triangles);

    /// Moves the vertices and keeps the shape of the tree: for meshes that deform. Much faster than a build, and slower to query the
    /// further the mesh is from what was built: see degradation().
    /// @param vertices, triangles  as of build(), with the same triangles.
    /// @return InvalidArgument where the triangles are not as many, an index is out of range; NotFinite; WrongType where only a build
    /// helps: the mesh grew or shrank out of the range of its scale, or vertices at one position moved apart. Of a mesh whose vertices
    /// all had positions of their own in build(), they never do; of any other, soup say, vertices that are at one position must stay
    /// together from then on, wherever they are. The tree is then what it was. Triangles that are not those of build() give a tree of
    /// no use, which nothing notices.
    /// Cost: O(m), some 20 ns a triangle; 60 where vertices have to stay together.
    [[nodiscard]] Status refit(std::span<const vec3> vertices, std::span<const Triangle> triangles);
    /// @return how many more leaves lie over a place of the mesh than when it was built, on average: 1 at first. Near the mesh queries
    /// take from the square root of that to about that many times as long; from some 1.5 on a build pays for itself within a few
    /// hundred rays a triangle. Triangles that moved far away do not hide what became of the rest.
    [[nodiscard]] double degradation() const noexcept;

    /// @return the tree as bytes, for load() on any machine: little-endian, with a version and a checksum (XXH3).
    [[nodiscard]] std::vector<std::byte> save() const;
    /// @return the tree that save() wrote, to the bit. Parse for anything else: a wrong length, version or checksum, and where the
    /// checksum was made to fit, anything that is not the tree of a mesh; no byte is trusted, and no memory is taken that the length
    /// of `bytes` does not warrant.
    /// Cost: O(bytes), some 50 ns a triangle.
    [[nodiscard]] static Result<StaticBvh> load(std::span<const std::byte> bytes);

    StaticBvh(StaticBvh&&) noexcept;
    StaticBvh& operator=(StaticBvh&&) noexcept;
    ~StaticBvh();

    [[nodiscard]] std::size_t triangle_count() const noexcept;
    /// @return the memory of the tree.
    [[nodiscard]] std::size_t bytes() const noexcept;
    /// @return what a random line through the root's box is expected to cost: for each node and leaf the area of its box over the
    /// root's, nodes below the root counted twice. Lower is faster.
    [[nodiscard]] double sah_cost() const noexcept;
    /// @return the box of the triangles; for queries geo::Aabb<double>{box.lower, box.upper}.
    [[nodiscard]] Aabb bounds() const noexcept;
    /// For queries in this library.
    [[nodiscard]] const WideBvh& wide() const noexcept { return *wide_; }

private:
    friend class TriangleMesh;
    explicit StaticBvh(WideBvh&& wide);
    std::unique_ptr<WideBvh> wide_;
};

}  // namespace carom
