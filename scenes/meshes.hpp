// Named meshes for queries: what studies, benchmarks and `carom cast` cast rays against.
//
//   Result<MeshData> data = scenes::make_mesh("bumpy");
//   Result<TriangleMeshPtr> mesh = TriangleMesh::build(data->vertices, data->triangles);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/result.hpp>

#include <span>
#include <string>

namespace carom::scenes {

/// One entry of the catalogue of meshes.
struct MeshInfo {
    std::string name;
    std::string summary;
};

/// @return every named mesh, in the order that lists show them.
[[nodiscard]] std::span<const MeshInfo> mesh_catalogue();

/// @return the mesh of that name, welded; the same bits each time. UnknownName, with the names there are, for any other.
[[nodiscard]] Result<MeshData> make_mesh(const std::string& name);

/// A closed surface around the origin: each of the six faces of a cube as a grid of n x n quads, each quad two triangles, pushed out
/// along its direction from the origin. The grid's lines are at equal angles, so that triangles are of similar size; vertices on
/// the cube's edges are shared. 12 n² triangles, counter-clockwise seen from outside.
///
/// @param n       1..2048.
/// @param radius  of the surface in the direction of a unit vector [m], > 0 and finite.
/// Misuse (n out of range: InvalidArgument; a radius that is not finite: NotFinite) is reported, and the mesh returned is empty.
/// Accuracy: computed in double and rounded to float; the same bits everywhere.
[[nodiscard]] MeshData cube_sphere(int n, FunctionRef<double(const dvec3& direction)> radius);

/// cube_sphere with radius 1 + 0.12 sin(9x+1) sin(8y+2) sin(7z+0.5) + 0.03 sin(31x) sin(29y) sin(33z): a ball of bumps of two
/// sizes, hollow enough that rays cross it up to a dozen times.
[[nodiscard]] MeshData bumpy_sphere(int n);

}  // namespace carom::scenes
