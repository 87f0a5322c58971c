// The mesh and the rays with which ray casting is measured.
//
//   MeshData mesh = scenes::bumpy(76);                                     // 69,312 triangles
//   std::vector<geo::Ray<float>> rays = scenes::bumpy_camera_rays();
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/collision/primitives.hpp>

#include <cstddef>
#include <vector>

namespace carom::scenes {

/// The sizes that figures are quoted for.
inline constexpr int kBumpy70k = 76;
inline constexpr int kBumpy1m = 289;

/// A bumpy ball about the origin of radius 0.85..1.15: a cube-sphere, each of six faces n x n quads of two triangles, its points
/// (1, tan((2i/n-1) pi/4), tan((2j/n-1) pi/4)) and the like, normalised, times
/// 1 + .12 sin(9x+1) sin(8y+2) sin(7z+.5) + .03 sin(31x) sin(29y) sin(33z). Faces share positions along their seams, but not
/// vertices; welded by position the surface is closed, and it faces outward.
/// @param n  >= 1; 12 n^2 triangles.
[[nodiscard]] MeshData bumpy(int n);

/// 707 x 707 rays from (0, 0, 4) through a picture of the ball: directions ((x+.5)/707-.5, .5-(y+.5)/707, -1.4), normalised; row by
/// row from the top.
[[nodiscard]] std::vector<geo::Ray<float>> bumpy_camera_rays();

/// Rays from one random point of the sphere of radius 2 about the origin to another one, seed 4242; directions of unit length,
/// without an end. A random point is a point of the cube [-1, 1]^3, redrawn while its length is over 1 or under 0.1, then scaled.
[[nodiscard]] std::vector<geo::Ray<float>> bumpy_chords(std::size_t count = 500'000);

}  // namespace carom::scenes
