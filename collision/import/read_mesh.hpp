// Triangles from mesh files: OBJ, OFF, PLY, STL and glTF.
//
//   Result<MeshData> data = read_mesh("bunny.off");
//   if (!data) { print(data.error().where + ": " + data.error().message); }
//   Result<TriangleMeshPtr> mesh = TriangleMesh::build(data->vertices, data->triangles);
//
// A file is data that nobody vouches for: a damaged, truncated or lying one is an Error that names the place, memory stays within a
// small multiple of the file's size whatever its header claims, and nothing is repaired in silence.
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/result.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace carom {

enum class MeshFormat : unsigned char {
    Obj,   ///< Wavefront: v and f; curves and surfaces are left out
    Off,   ///< Geomview, text, with or without normals and colours (OFF, COFF, NOFF, STOFF and combinations)
    Ply,   ///< Stanford: text, little-endian or big-endian; elements other than vertex and face are skipped
    Stl,   ///< stereolithography, text or binary
    Gltf,  ///< glTF 2.0, .gltf or .glb
};

/// The largest file that is read: 4 GiB.
inline constexpr std::uint64_t kMostMeshFileBytes = std::uint64_t{1} << 32;

/// @return the format that a path's ending stands for, in upper or lower case; none for others.
[[nodiscard]] std::optional<MeshFormat> mesh_format(std::string_view path);

/// Reads a mesh file; the format is that of the path's ending.
///
/// Positions are rounded to float, in the file's unit (glTF says metre; the others do not say). Faces with more corners become
/// triangles: convex ones as a fan, others by clipping ears in the plane of their normal (Meisters 1975); a face that crosses itself or
/// has no normal becomes a fan all the same. Points, lines and loose vertices carry no surface: the first two are left out, the last
/// stay. Normals, colours, textures and groups are not read. glTF: every mesh of the default scene (the first where none is named), placed by
/// its node, at rest; a node that mirrors turns its triangles round.
/// @return vertices and triangles in the order of the file, not welded (STL has three vertices a triangle; StaticBvh and TriangleMesh
/// weld by themselves, weld() does it at once). Io: missing, not a regular file, cannot be read. WrongType: an ending of no format, or a
/// kind of file that is not read (binary OFF, four-dimensional OFF, triangle strips in PLY; glTF 1, sparse accessors, compressed or
/// quantised meshes). Parse: not of its format, truncated, an index out of range, with the line where there are lines; an OBJ file
/// that ends too early between two lines looks whole. NotFinite: a position that no float holds. Empty: no triangle. InvalidArgument:
/// more than kMostMeshFileBytes, or more than 2^28 triangles. `where` is the path.
/// Cost: O(size), for glTF O(size + triangles of all instances); a concave face of n <= 1024 corners O(n^3) at worst, larger ones are
/// refused (Parse). Thread-safe.
[[nodiscard]] Result<MeshData> read_mesh(const std::string& path);

/// The same for the contents of a file. glTF that names other files is refused (WrongType).
/// @param where  what errors name.
[[nodiscard]] Result<MeshData> parse_mesh(std::string_view contents, MeshFormat format, const std::string& where);

}  // namespace carom
