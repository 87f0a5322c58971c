// The triangles of two meshes that are near each other, each placed once.
//
//   faces.place(first, second, pairs, reach);
//   for (const TrianglePair& pair : faces.pairs) use(faces.first[pair.a], faces.second[pair.b]);
#pragma once

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
    dvec3 lower{0.0}, upper{0.0};
    dvec3 normal{0.0};                        ///< unit; zero where there is none
    TriangleMesh::Triangle vertices{};
    std::array<std::uint32_t, 3> edges{};     ///< names, from each corner to the next
};

/// Name of the edge between two vertices, below 2^31.
[[nodiscard]] std::uint32_t edge_name(std::uint32_t a, std::uint32_t b) noexcept;

class PlacedFaces {
public:
    std::vector<PlacedFace> first, second;
    std::vector<TrianglePair> pairs;  ///< by numbers in `first` and `second`

    /// Places the triangles of `near` whose boxes are within `reach` [m] of each other.
    void place(const MeshSide& a, const MeshSide& b, std::span<const TrianglePair> near, double reach);

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
