// Ground as triangle meshes: a grid over a height function, and fractal terrain.
//
//   MeshData bowl = height_grid(128, 128, 0.5, [](double x, double z) { return 0.01 * (x * x + z * z); });
//   MeshData hills = diamond_square({.level = 6, .spacing = 0.5, .height = 2.0, .seed = 7, .rim = true});
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/function_ref.hpp>

namespace carom {

/// A grid of nx x nz quads of side `spacing` centred on the origin, y up. Vertex (i, j), at index j (nx + 1) + i, lies at
/// x = (i - nx/2) spacing, z = (j - nz/2) spacing, y = height(x, z). Each quad is the two triangles (i,j)-(i,j+1)-(i+1,j+1) and
/// (i,j)-(i+1,j+1)-(i+1,j), whose normals point up.
///
/// @param nx, nz   quads along x and z, 1..4096.
/// @param spacing  > 0, finite [m].
/// @param height   finite for every point [m]; called once a vertex, x fastest.
/// Misuse (a size or spacing out of range: InvalidArgument; a height or spacing that is not finite: NotFinite) is reported, and
/// the mesh returned is empty. Accuracy: positions are computed in double and rounded to float.
[[nodiscard]] MeshData height_grid(int nx, int nz, double spacing, FunctionRef<double(double x, double z)> height);

struct TerrainSettings {
    int level = 6;           ///< 2^level quads along each side, 1..12
    double spacing = 0.5;    ///< side of a quad [m], > 0
    double roughness = 0.5;  ///< factor of the displacements from one level to the next, 0..1; 2^-H for the Hurst exponent H
    double height = 1.0;     ///< of the corners, and of the first level's displacements before roughness [m], >= 0
    std::uint64_t seed = 1;
    bool rim = false;        ///< the outer eighth of each side rises as a parabola, to a tenth of the side, 58 degrees steep
};

/// Fractal terrain by the diamond-square algorithm (Fournier, Fussell, Carpenter 1982, Computer rendering of stochastic models,
/// sec. 4): corners uniform in [-height, height]; at level k = 1, 2, ... the centre of each square, then the middle of each
/// edge, is the mean of its neighbours (four, or three at the border) plus uniform noise of at most height * roughness^k.
/// Mesh and vertex order as height_grid.
///
/// Heights without the rim are at most height (1 + 2 sum over k of roughness^k) in size.
/// Misuse (a setting out of range: InvalidArgument, not finite: NotFinite) is reported, and the mesh returned is empty.
/// The same settings give the same bits everywhere. Cost: O(4^level).
[[nodiscard]] MeshData diamond_square(const TerrainSettings& settings);

/// @return by how much the rim raises the point (x, z) of a terrain of these settings [m]; 0 without a rim.
[[nodiscard]] double rim_height(const TerrainSettings& settings, double x, double z) noexcept;

}  // namespace carom
