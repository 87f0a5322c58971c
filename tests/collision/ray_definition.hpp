// What a ray in float is to hit, without any hierarchy.
//
//   MeshHit expected = test::by_definition(mesh, ray);
#pragma once

#include "mesh_rays_cases.hpp"

#include <carom/collision/mesh_rays.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace carom::test {

/// What closest_hit is to give, by the method's definition and no tree: scalar, with exact signs in double.
///
/// Images are float, so products of two coordinates are exact in double and a difference of two has an exact sign there; triangles
/// too small for products in float, and those edge-on, are computed in double altogether. Rays here
/// are near, and their largest component is in [1, 2), so that nothing is moved or scaled first.
inline MeshHit by_definition(const MeshData& mesh, const FloatRay& ray) {
    int z = 0;
    for (int k = 1; k < 3; ++k) z = std::abs(ray.direction[k]) > std::abs(ray.direction[z]) ? k : z;
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    const float depth = 1.0f / ray.direction[z];
    const vec3 shear{ray.direction[x] * depth, ray.direction[y] * depth, 0.0f};
    MeshHit best;
    float best_t = ray.t_max;
    for (std::uint32_t number = 0; number < mesh.triangles.size(); ++number) {
        vec3 image[3];
        for (int c = 0; c < 3; ++c) {
            const vec3 p = mesh.vertices[mesh.triangles[number][static_cast<std::size_t>(c)]] - ray.origin;
            image[c] = {std::fma(-shear.x, p[z], p[x]), std::fma(-shear.y, p[z], p[y]), p[z]};
        }
        float edge[3];
        double exact[3];
        for (int c = 0; c < 3; ++c) {
            const dvec3 p(image[(c + 2) % 3]);
            const dvec3 q(image[(c + 1) % 3]);
            exact[c] = p.x * q.y - p.y * q.x;  // products of floats are exact in double
            const float rest = static_cast<float>(static_cast<double>(image[(c + 2) % 3].y * image[(c + 1) % 3].x) - p.y * q.x);
            edge[c] = std::fma(image[(c + 2) % 3].x, image[(c + 1) % 3].y, -(image[(c + 2) % 3].y * image[(c + 1) % 3].x)) + rest;
            // Exact, but for differences below the smallest denormal, which become zero.
            EXPECT_EQ(exact[c] > 0.0, edge[c] > 0.0f || (edge[c] == 0.0f && exact[c] > 0.0 && exact[c] < 0x1p-148)) << exact[c];
            EXPECT_EQ(exact[c] < 0.0, edge[c] < 0.0f || (edge[c] == 0.0f && exact[c] < 0.0 && exact[c] > -0x1p-148)) << exact[c];
        }
        if ((edge[0] < 0 || edge[1] < 0 || edge[2] < 0) && (edge[0] > 0 || edge[1] > 0 || edge[2] > 0)) continue;
        const float sum = (edge[0] + edge[1]) + edge[2];
        float t = ((edge[0] * image[0].z + edge[1] * image[1].z) + edge[2] * image[2].z) / sum * depth;
        float v = edge[1] / sum, w = edge[2] / sum;
        if (std::abs(sum) < 0x1p-80f) {  // so small, or edge-on: in double
            if ((exact[0] < 0 || exact[1] < 0 || exact[2] < 0) && (exact[0] > 0 || exact[1] > 0 || exact[2] > 0)) continue;
            const double all = exact[0] + exact[1] + exact[2];
            if (all == 0.0) continue;
            double z_at = 0.0;
            for (int c = 0; c < 3; ++c) z_at += exact[c] / all * static_cast<double>(image[c].z);
            t = static_cast<float>(z_at * static_cast<double>(depth));
            v = static_cast<float>(exact[1] / all), w = static_cast<float>(exact[2] / all);
        }
        if (!(t >= ray.t_min) || !(t <= ray.t_max) || !(t < best_t || !best)) continue;
        best_t = t;
        best = {t + 0.0f, number, v, w};
    }
    return best;
}

}  // namespace carom::test
