// Meshes and rays on which ray casting goes wrong easily.
#pragma once

#include "support_mesh.hpp"

#include <carom/collision/primitives.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace carom::test {

using FloatRay = geo::Ray<float>;

struct RayCase {
    std::string name;
    MeshData mesh;
    std::vector<FloatRay> near_rays{};  ///< origins within a few sizes, largest component of the direction in [1, 2)
    std::vector<FloatRay> far_rays{};   ///< anything else
};

inline MeshData transformed(MeshData data, float scale, const vec3& by) {
    for (vec3& v : data.vertices) v = scale * v + by;
    return data;
}

/// The largest component in [1, 2), the rest exact.
inline vec3 in_unit_binade(const vec3& d) {
    const float largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    int exponent = 0;
    static_cast<void>(std::frexp(largest, &exponent));
    return {std::ldexp(d.x, 1 - exponent), std::ldexp(d.y, 1 - exponent), std::ldexp(d.z, 1 - exponent)};
}

inline const vec3& any_vertex(const MeshData& mesh, Random& random) {
    const auto& t = mesh.triangles[static_cast<std::size_t>(random.unit() * static_cast<double>(mesh.triangles.size()))];
    return mesh.vertices[t[static_cast<std::size_t>(random.unit() * 3.0)]];
}

/// A point on an edge of a random triangle, or its corner.
inline vec3 seam_point(const MeshData& mesh, Random& random) {
    const auto& t = mesh.triangles[static_cast<std::size_t>(random.unit() * static_cast<double>(mesh.triangles.size()))];
    const auto k = static_cast<std::size_t>(random.unit() * 3.0);
    const vec3& a = mesh.vertices[t[k]];
    const vec3& b = mesh.vertices[t[(k + 1) % 3]];
    const double s = random.unit();
    if (s < 0.3) return a;
    if (s < 0.5) return 0.5f * (a + b);
    return vec3(dvec3(a) + (dvec3(b) - dvec3(a)) * random.unit());
}

inline MeshData needles_and_specks(int count) {
    Random random(711);
    MeshData data;
    for (int i = 0; i < count; ++i) {
        const auto first = static_cast<std::uint32_t>(data.vertices.size());
        const dvec3 at = random_point(random, 1.0);
        const dvec3 size = i % 4 == 0 ? dvec3{2.0, 1e-6, 1e-6} : i % 4 == 1 ? dvec3{1e-4} : i % 4 == 2 ? dvec3{1e-7, 0.5, 0.5} : dvec3{0.7};
        for (int k = 0; k < 3; ++k) data.vertices.push_back(vec3(at + size * random_point(random, 1.0)));
        if (i % 10 == 0) data.vertices.back() = data.vertices[first];  // degenerate
        data.triangles.push_back({first, first + 1, first + 2});
    }
    return data;
}

/// A flat grid in the plane z = 0 with integer corners, so that rays meet edges and corners exactly.
inline MeshData flat_grid(int n) {
    MeshData data;
    for (int i = 0; i <= n; ++i) {
        for (int k = 0; k <= n; ++k) data.vertices.push_back({static_cast<float>(i - n / 2), static_cast<float>(k - n / 2), 0.0f});
    }
    const auto at = [&](int i, int k) { return static_cast<std::uint32_t>(i * (n + 1) + k); };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < n; ++k) {
            data.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            data.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    }
    return data;
}

/// Random rays, rays at seams, and rays along axes with zeros of both signs, from points and from vertices of the mesh.
inline void add_rays(RayCase& c, std::uint64_t seed, double size, const dvec3& at, int count) {
    Random random(seed);
    for (int i = 0; i < count; ++i) {
        FloatRay ray;
        ray.origin = i % 7 == 0 ? any_vertex(c.mesh, random) : vec3(at + random_point(random, 2.0 * size));
        switch (i % 5) {
            case 0:
            case 1: ray.direction = seam_point(c.mesh, random) - ray.origin; break;
            case 2: {
                const float zero = i % 2 == 0 ? 0.0f : -0.0f;
                ray.direction = {zero, -zero, zero};
                ray.direction[i % 3] = i % 4 < 2 ? 1.0f : -1.0f;
                const vec3 target = seam_point(c.mesh, random);
                for (int k = 0; k < 3; ++k) ray.origin[k] = k == i % 3 ? ray.origin[k] : target[k];
                break;
            }
            case 3: ray.direction = vec3(random_point(random, 1.0)); ray.direction[i % 3] = i % 2 == 0 ? 1e-30f : -1e-42f; break;
            default: ray.direction = vec3(random_point(random, 1.0)); break;
        }
        if (ray.direction == vec3{0.0f}) continue;
        FloatRay near = ray;
        near.direction = in_unit_binade(ray.direction);
        if (i % 11 == 0) near.t_max = static_cast<float>(size);
        if (i % 13 == 0) near.t_min = static_cast<float>(0.5 * size);
        c.near_rays.push_back(near);
        FloatRay far = ray;
        far.origin = vec3(dvec3(ray.origin) - static_cast<double>(i % 3 == 0 ? 30 : i % 3 == 1 ? 1000 : 1000000) *
                                                  dvec3(near.direction) * size);
        far.direction *= i % 2 == 0 ? 1e-25f : 1e20f;
        c.far_rays.push_back(far);
    }
}

/// Near rays of tiny and huge meshes are far rays to the definition, which neither moves nor scales.
inline std::vector<RayCase> ray_cases() {
    std::vector<RayCase> cases;
    const auto add = [&](std::string name, MeshData mesh, double size, const dvec3& at, bool plain) {
        RayCase c{std::move(name), std::move(mesh)};
        add_rays(c, 700 + cases.size(), size, at, 600);
        if (!plain) {
            c.far_rays.insert(c.far_rays.end(), c.near_rays.begin(), c.near_rays.end());
            c.near_rays.clear();
        }
        cases.push_back(std::move(c));
    };
    const MeshData ball = sphere_mesh(31, 17, 1.0);
    add("ball", ball, 1.0, {}, true);
    add("soup", unweld(ball), 1.0, {}, true);
    add("ball 1,000 away", transformed(ball, 1.0f, {1000, -300, 50}), 1.0, {1000, -300, 50}, true);
    add("terrain", terrain(24, 0.125), 1.5, {}, true);
    add("flat grid", flat_grid(16), 8.0, {}, true);
    add("needles and specks", needles_and_specks(500), 1.0, {}, true);
    add("one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}}, {{0, 1, 2}}}, 1.0, {}, true);
    add("tiny ball", transformed(ball, 1e-20f, {}), 1e-20, {}, false);
    add("huge ball", transformed(ball, 1e15f, {}), 1e15, {}, false);
    add("ball of denormals", transformed(ball, 1e-39f, {}), 1e-39, {}, false);
    return cases;
}

}  // namespace carom::test
