// Meshes that the tests of this room share.
//
//   MeshData ball = sphere_mesh(12, 8, 1.0);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <cstdint>

namespace carom::test {

/// Uniform in the cube of half edge `half`.
inline dvec3 random_point(Random& random, double half) {
    const double x = random.range(-half, half);
    const double y = random.range(-half, half);
    return {x, y, random.range(-half, half)};
}

/// A closed ball with poles on y, outward.
inline MeshData sphere_mesh(int slices, int rings, double radius) {
    MeshData data;
    data.vertices.push_back({0.0f, static_cast<float>(-radius), 0.0f});
    for (int r = 1; r < rings; ++r) {
        const SinCos up = sin_cos(kPi * (static_cast<double>(r) / rings - 0.5));
        for (int s = 0; s < slices; ++s) {
            const SinCos round = sin_cos(2.0 * kPi * s / slices);
            data.vertices.push_back(vec3(radius * dvec3{up.cos * round.cos, up.sin, -up.cos * round.sin}));
        }
    }
    data.vertices.push_back({0.0f, static_cast<float>(radius), 0.0f});
    const auto at = [&](int r, int s) { return static_cast<std::uint32_t>(1 + (r - 1) * slices + s % slices); };
    const auto top = static_cast<std::uint32_t>(data.vertices.size() - 1);
    for (int s = 0; s < slices; ++s) {
        data.triangles.push_back({0, at(1, s + 1), at(1, s)});
        for (int r = 1; r + 1 < rings; ++r) {
            data.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
            data.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
        }
        data.triangles.push_back({top, at(rings - 1, s), at(rings - 1, s + 1)});
    }
    return data;
}

/// A field of `n` x `n` quads of edge `cell` in x and z with gentle hills in y, centred on the origin.
inline MeshData terrain(int n, double cell) {
    MeshData data;
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n; ++k) {
            const dvec2 p = cell * (dvec2{i, k} - 0.5 * n);
            data.vertices.push_back(vec3(dvec3{p.x, sin_cos(0.3 * p.x).sin + sin_cos(0.2 * p.y).cos, p.y}));
        }
    }
    const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * (n + 1) + k); };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            data.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
            data.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
        }
    }
    return data;
}

/// The same surface with three vertices of its own for each triangle.
inline MeshData unweld(const MeshData& data) {
    MeshData soup;
    for (const auto& t : data.triangles) {
        const auto first = static_cast<std::uint32_t>(soup.vertices.size());
        for (const std::uint32_t v : t) {
            soup.vertices.push_back(data.vertices[v]);
        }
        soup.triangles.push_back({first, first + 1, first + 2});
    }
    return soup;
}

}  // namespace carom::test
