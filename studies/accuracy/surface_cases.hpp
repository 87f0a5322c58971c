// Pairs of closed meshes of which the least overlap is known: the surfaces of convex solids, by all separating axes of the solids.
//
//   const ManifoldCasesPtr hulls = solid_cases(Solids::Hulls, 100, {0.0, 0.01}, 31);
//   const ManifoldCasesPtr meshes = as_surfaces(*hulls, {.quads = 4});
#pragma once

#include <carom/studies/accuracy/manifold_cases.hpp>

namespace carom::accuracy {

enum class Solids { Boxes, Hulls };

/// Of the least extent of the smaller one.
struct DepthRange {
    double least = 0.0, most = 0.01;
};

/// Pairs, turned evenly, that overlap by an even share of the range. The oracle is the least overlap along all normals of
/// faces and products of edges, in long double: that of their surfaces too.
[[nodiscard]] ManifoldCasesPtr solid_cases(Solids solids, std::size_t count, const DepthRange& range, std::uint64_t seed);

/// Boxes: bars of 2 m that are 2 to 10 cm thick, through plates of 0.4 to 1 m that are 2 to 10 cm thick; as above. The middle line of each bar
/// passes through its plate.
[[nodiscard]] ManifoldCasesPtr pierced_cases(std::size_t count, std::uint64_t seed);

struct SurfaceSettings {
    bool first = true;  ///< the first of each pair as well as the second
    int quads = 1;      ///< along each edge of a box; hulls have the triangles of their faces
    bool seeded = false;  ///< with a tiny tetrahedron in its middle, so that it is not taken for the convex solid that it bounds otherwise
};

/// The same pairs as closed meshes: depths and sizes stay those of the solids.
[[nodiscard]] ManifoldCasesPtr as_surfaces(const ManifoldCases& solids, const SurfaceSettings& settings);

}  // namespace carom::accuracy
