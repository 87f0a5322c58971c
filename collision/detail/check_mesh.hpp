// What every builder over triangles demands of them.
//
//   if (Status status = check_mesh(vertices, triangles, "TriangleMesh::build"); !status) return status.error();
#pragma once

#include <carom/core/result.hpp>
#include <carom/core/types.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom {

/// @return Empty without triangles, NotFinite naming the vertex, InvalidArgument naming the triangle whose index is out of range, or
/// too many triangles. @param where  the caller, for the error.
[[nodiscard]] Status check_mesh(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles,
                                const char* where);

}  // namespace carom
