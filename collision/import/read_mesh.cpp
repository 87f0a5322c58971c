#include <carom/collision/import/read_mesh.hpp>

#include <carom/collision/import/detail/read_file.hpp>
#include <carom/collision/import/detail/readers.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace carom {
namespace {

constexpr std::array<std::pair<std::string_view, MeshFormat>, 6> kEndings{{{".obj", MeshFormat::Obj},
                                                                           {".off", MeshFormat::Off},
                                                                           {".ply", MeshFormat::Ply},
                                                                           {".stl", MeshFormat::Stl},
                                                                           {".gltf", MeshFormat::Gltf},
                                                                           {".glb", MeshFormat::Gltf}}};

bool same_letters(char a, char b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
    return lower(a) == lower(b);
}

// @param path  of the file, where the contents may name others beside it; empty: nowhere.
Result<MeshData> parse(std::string_view contents, MeshFormat format, const std::string& where, const std::string& path) {
    MeshBuilder builder(where);
    const Status status = [&]() -> Status {
        switch (format) {
            case MeshFormat::Obj:
                return read_obj(contents, builder);
            case MeshFormat::Off:
                return read_off(contents, builder);
            case MeshFormat::Ply:
                return read_ply(contents, builder);
            case MeshFormat::Stl:
                return read_stl(contents, builder);
            case MeshFormat::Gltf:
                return read_gltf(contents, path, builder);
        }
        return builder.unsupported("is of no known format");
    }();
    if (!status) return status.error();
    return builder.finish();
}

}  // namespace

std::optional<MeshFormat> mesh_format(std::string_view path) {
    for (const auto& [ending, format] : kEndings) {
        if (path.size() < ending.size()) continue;
        if (std::ranges::equal(path.substr(path.size() - ending.size()), ending, same_letters)) return format;
    }
    return std::nullopt;
}

Result<MeshData> read_mesh(const std::string& path) {
    const std::optional<MeshFormat> format = mesh_format(path);
    if (!format) return Error{ErrorCode::WrongType, "is no mesh file: those end in .obj, .off, .ply, .stl, .gltf or .glb", path};
    const Result<std::string> contents = read_file(path);
    return contents ? parse(*contents, *format, path, path) : contents.error();
}

Result<MeshData> parse_mesh(std::string_view contents, MeshFormat format, const std::string& where) {
    return parse(contents, format, where, {});
}

}  // namespace carom
