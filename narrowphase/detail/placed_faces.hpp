// The triangles of two meshes that are near each other, each placed once.
//
//   faces.place(first, second, near, meeting, reach);
//   for (const FacePair& pair : faces.pairs) use(faces.first[pair.a], faces.second[pair.b]);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/narrowphase/detail/mesh_side.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// A triangle in the frame of the pair, counter-clockwise seen from the side that pushes.
struct PlacedFace {
    Corners corners{dvec3{0.0}, dvec3{0.0}, dvec3{0.0}};
    Aabb box;
    std::array<Aabb, 3> edge_boxes;           ///< of the edges from each corner to the next
    dvec3 normal{0.0};                        ///< unit; zero where there is none
    TriangleMesh::Triangle vertices{};
    std::array<std::uint32_t, 3> names{};     ///< of the vertices
    std::array<std::uint32_t, 3> edges{};     ///< names of the edges
};

/// Whether two boxes come within `reach` of each other along every axis.
[[nodiscard]] inline bool within(const Aabb& a, const Aabb& b, double reach) noexcept {
    return a.lower.x <= b.upper.x + reach && b.lower.x <= a.upper.x + reach && a.lower.y <= b.upper.y + reach &&
           b.lower.y <= a.upper.y + reach && a.lower.z <= b.upper.z + reach && b.lower.z <= a.upper.z + reach;
}

/// Name of the vertex at a position in its mesh's frame, below 2^31: one for all vertices there, as meshes often have one for each side
/// of an edge. Two positions share a name by accident once in 2^31.
[[nodiscard]] std::uint32_t vertex_name(const vec3& position) noexcept;

/// Two faces, by their numbers among those that are placed.
struct FacePair {
    std::uint32_t a = 0, b = 0;
    bool meet = false;
};

class PlacedFaces {
public:
    std::vector<PlacedFace> first, second;
    std::vector<FacePair> pairs;

    /// Places the triangles of `near` whose boxes are within `reach` [m] of each other. `meeting` are those of them that meet; both ascend.
    void place(const MeshSide& a, const MeshSide& b, std::span<const TrianglePair> near, std::span<const TrianglePair> meeting, double reach);

private:
    /// Which triangles of a mesh are placed already.
    struct Placed {
        std::vector<std::uint32_t> rounds, numbers;  // by triangle
    };
    std::uint32_t number_of(Placed& placed, std::vector<PlacedFace>& faces, const MeshSide& side, std::uint32_t triangle);

    Placed first_placed_, second_placed_;
    std::uint32_t round_ = 0;
};

}  // namespace carom::detail
