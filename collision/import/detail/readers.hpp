// The reader of each format: takes a file's contents and fills a builder.
#pragma once

#include <carom/collision/import/detail/mesh_builder.hpp>

#include <string>
#include <string_view>

namespace carom {

[[nodiscard]] Status read_obj(std::string_view contents, MeshBuilder& builder);
[[nodiscard]] Status read_off(std::string_view contents, MeshBuilder& builder);
[[nodiscard]] Status read_ply(std::string_view contents, MeshBuilder& builder);
[[nodiscard]] Status read_stl(std::string_view contents, MeshBuilder& builder);

/// @param path  where files that it names are looked for; empty: nowhere, such a file is refused.
[[nodiscard]] Status read_gltf(std::string_view contents, const std::string& path, MeshBuilder& builder);

}  // namespace carom
