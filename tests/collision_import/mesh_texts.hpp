// One tetrahedron in every format.
#pragma once

#include <carom/collision/import/read_mesh.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <string>

namespace carom::test {

/// Bytes of numbers in either order.
template <class T>
std::string raw(T value, bool big_endian = false) {
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : std::string(bytes.begin(), bytes.end());
}

inline constexpr std::array<std::array<float, 3>, 4> kCorners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0.1f}}};
inline constexpr std::array<std::array<std::uint32_t, 3>, 4> kFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

inline const std::string kOff = "OFF\n# a tetrahedron\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n\n0 0 0.1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
inline const std::string kObj =
    "# a tetrahedron\r\nmtllib none.mtl\no t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e-1\nvn 0 0 1\nf 1//1 3//1 2//1\nf 1/ 2 4\nf -3 -2 -1\nf 1 "
    "4 3\n";
inline const std::string kPlyHeader =
    " 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
inline const std::string kPly =
    "ply\nformat ascii" + kPlyHeader + "0 0 0 9\n1 0 0 9\n0 1 0 9\n0 0 0.1 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

inline std::string binary_ply(bool big) {
    std::string out = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian" + kPlyHeader;
    for (const auto& corner : kCorners) {
        for (const float x : corner) out += raw(x, big);
        out += '\7';
    }
    for (const auto& face : kFaces) {
        out += '\3';
        for (const std::uint32_t i : face) out += raw(i, big);
    }
    return out;
}

inline std::string text_stl() {
    std::string out = "solid a tetrahedron\n";
    for (const auto& face : kFaces) {
        out += "  facet normal 0 0 0\n    outer loop\n";
        for (const std::uint32_t i : face) {
            out += "      vertex";
            for (const float x : kCorners[i]) out += " " + std::to_string(x);
            out += "\n";
        }
        out += "    endloop\n  endfacet\n";
    }
    return out + "endsolid a tetrahedron\n";
}

inline std::string binary_stl() {
    std::string out(80, 's');
    out.replace(0, 5, "solid");  // as some programs write
    out += raw(std::uint32_t{4});
    for (const auto& face : kFaces) {
        out += std::string(12, '\0');
        for (const std::uint32_t i : face) {
            for (const float x : kCorners[i]) out += raw(x);
        }
        out += std::string(2, '\0');
    }
    return out;
}

/// 48 bytes of positions and 12 of indices.
inline std::string gltf_buffer() {
    std::string out;
    for (const auto& corner : kCorners) {
        for (const float x : corner) out += raw(x);
    }
    for (const auto& face : kFaces) {
        for (const std::uint32_t i : face) out += static_cast<char>(i);
    }
    return out;
}

inline std::string gltf_json(const std::string& buffer, const std::string& node = R"({"mesh":0})", const std::string& primitive = "") {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + node +
           R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1)" + primitive + R"(}]}],"buffers":[)" + buffer +
           R"(],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"accessors":[)"
           R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}]})";
}

inline std::string glb(std::string json, std::string buffer = gltf_buffer()) {
    while (json.size() % 4 != 0) json += ' ';
    while (buffer.size() % 4 != 0) buffer += '\0';
    const auto size = static_cast<std::uint32_t>(28 + json.size() + buffer.size());
    return "glTF" + raw(std::uint32_t{2}) + raw(size) + raw(static_cast<std::uint32_t>(json.size())) + "JSON" + json +
           raw(static_cast<std::uint32_t>(buffer.size())) + std::string("BIN\0", 4) + buffer;
}

inline std::string glb() { return glb(gltf_json(R"({"byteLength":60})")); }

inline std::string base64(const std::string& bytes) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63u] : '=';
    }
    return out;
}

inline std::string gltf() {
    return gltf_json(R"({"byteLength":60,"uri":"data:application/octet-stream;base64,)" + base64(gltf_buffer()) + "\"}");
}

/// A whole file of one format.
struct MeshText {
    const char* name;
    MeshFormat format;
    std::string text;
    std::size_t optional_end;  ///< how many characters before the end may be missing unnoticed
};

inline std::array<MeshText, 9> mesh_texts() {
    return {{{"obj", MeshFormat::Obj, kObj, kObj.size()},
             {"off", MeshFormat::Off, kOff, 0},
             {"ply", MeshFormat::Ply, kPly, 0},
             {"ply little", MeshFormat::Ply, binary_ply(false), 0},
             {"ply big", MeshFormat::Ply, binary_ply(true), 0},
             {"stl", MeshFormat::Stl, text_stl(), std::string(" a tetrahedron").size()},
             {"stl binary", MeshFormat::Stl, binary_stl(), 0},
             {"gltf", MeshFormat::Gltf, gltf(), 0},
             {"glb", MeshFormat::Gltf, glb(), 0}}};
}

}  // namespace carom::test
