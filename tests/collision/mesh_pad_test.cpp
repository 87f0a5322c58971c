// Boxes are padded by enough: rays and triangles for which the rounding of images, of depths and of slabs adds up, so that a hierarchy
// with a pad too small loses hits that the triangle test alone finds.
//
// The pad is k (D + |o|) / 2^24 with k = 28 (detail/wide_ray.hpp), which is proved to do. With smaller ones these tests were seen to fail:
// specks up to k = 1, faces up to 2, cards up to 3. A pad of 1 passes every other test of leaks.
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include "mesh_rays_cases.hpp"
#include "ray_definition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using test::FloatRay;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// How often the hierarchy misses, or finds a later hit, where the triangle test alone does not.
struct Lost {
    int hits = 0, lost = 0;

    void count(const MeshData& mesh, const StaticBvh& bvh, const FloatRay& ray) {
        const MeshHit expected = test::by_definition(mesh, ray);
        if (!expected) return;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            const MeshHit hit = closest_hit(bvh, ray);
            lost += hit.triangle == expected.triangle && hit.t == expected.t ? 0 : 1;
        }
        set_simd_width(0);
        ++hits;
    }
};

StaticBvh build(const MeshData& mesh) { return StaticBvh::build(mesh.vertices, mesh.triangles).value(); }

float steps(float x, int count) {
    for (; count > 0; --count) x = std::nextafter(x, kInfinity);
    for (; count < 0; ++count) x = std::nextafter(x, -kInfinity);
    return x;
}

/// Triangles of a few ulps at the corners of a cube: each has a box far thinner than the error of its images. Coordinates lie just above
/// a power of two, where an ulp is most of them.
MeshData specks(Random& random, int count) {
    MeshData mesh;
    for (int i = 0; i < count; ++i) {
        vec3 middle{0.0f};
        for (int axis = 0; axis < 3; ++axis)
            middle[axis] = static_cast<float>(random.range(1.0, 1.03) * (random.unit() < 0.5 ? -1.0 : 1.0));
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (int k = 0; k < 3; ++k) {
            vec3 p = middle;
            for (int axis = 0; axis < 3; ++axis) p[axis] = steps(p[axis], static_cast<int>(random.unit() * 5.0) - 2);
            mesh.vertices.push_back(p);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

/// Images move by up to 6 of 2^-24 D. Origins near zero, whose bits are lost against the mesh's, make the pad small beside that.
TEST(MeshPad, SpecksAreFoundWhereverTheirImageIs) {
    Random random(1701);
    Lost result;
    for (int round = 0; round < 60; ++round) {
        const MeshData mesh = specks(random, 200);
        const StaticBvh bvh = build(mesh);
        for (int i = 0; i < 400; ++i) {
            const dvec3 corner(mesh.vertices[static_cast<std::size_t>(random.unit() * static_cast<double>(mesh.vertices.size()))]);
            const vec3 origin(test::random_point(random, 1e-3));
            // Just below 2, so that the inverse lies just above a power of two.
            result.count(mesh, bvh, {origin, vec3(random.range(1.8, 1.9) * (corner - dvec3(origin)))});
        }
    }
    EXPECT_GT(result.hits, 500);
    EXPECT_EQ(result.lost, 0) << "of " << result.hits;
}

/// Cards at one depth, in leaves of their own: the least computed t is that of any of them, and a box entered later than the best t so
/// far must not be left out.
TEST(MeshPad, OfCardsAtOneDepthTheLeastIsFound) {
    Random random(1702);
    Lost result;
    for (int round = 0; round < 60; ++round) {
        MeshData mesh;
        const float depth = static_cast<float>(random.range(1.0, 1.03));  // an ulp is most of it just above a power of two
        for (int i = 0; i < 100; ++i) {
            const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
            const dvec3 middle = test::random_point(random, 0.1);
            for (int k = 0; k < 3; ++k) {
                const dvec3 p = middle + test::random_point(random, round % 2 == 0 ? 0.5 : 0.9);
                mesh.vertices.push_back({static_cast<float>(p.x), static_cast<float>(p.y),
                                         steps(depth, round % 3 == 0 ? 0 : static_cast<int>(random.unit() * 3.0))});
            }
            mesh.triangles.push_back({first, first + 1, first + 2});
        }
        const StaticBvh bvh = build(mesh);
        for (int i = 0; i < 200; ++i) {
            const vec3 origin = vec3(test::random_point(random, i % 2 == 0 ? 1e-3 : 1e-6));
            const dvec3 target{random.range(-0.3, 0.3), random.range(-0.3, 0.3), static_cast<double>(depth)};
            result.count(mesh, bvh, {origin, test::in_unit_binade(vec3(target - dvec3(origin)))});
        }
    }
    EXPECT_GT(result.hits, 5000);
    EXPECT_EQ(result.lost, 0) << "of " << result.hits;
}

/// Rays along an axis, or nearly, in the plane of the faces of boxes: the slab of that axis is nothing but rounding.
TEST(MeshPad, RaysInTheFacesOfBoxesFindWhatLiesThere) {
    Random random(1703);
    Lost result;
    for (int round = 0; round < 40; ++round) {
        // A grid of squares across z whose corners are no round numbers, at a distance that costs them digits.
        MeshData mesh;
        const dvec3 place = round % 2 == 0 ? test::random_point(random, 1.0) : test::random_point(random, 1000.0);
        constexpr int kCells = 12;
        for (int i = 0; i <= kCells; ++i) {
            for (int k = 0; k <= kCells; ++k) {
                mesh.vertices.push_back(vec3(place + dvec3{0.37 * i, 0.41 * k, random.range(-0.1, 0.1)}));
                mesh.vertices.back().x = vec3(place + dvec3{0.37 * i, 0, 0}).x;
                mesh.vertices.back().y = vec3(place + dvec3{0, 0.41 * k, 0}).y;
            }
        }
        const auto at = [](int i, int k) { return static_cast<std::uint32_t>(i * (kCells + 1) + k); };
        for (int i = 0; i < kCells; ++i) {
            for (int k = 0; k < kCells; ++k) {
                mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
                mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
            }
        }
        const StaticBvh bvh = build(mesh);
        for (int i = 0; i < 300; ++i) {
            const vec3& corner = mesh.vertices[static_cast<std::size_t>(random.unit() * static_cast<double>(mesh.vertices.size()))];
            vec3 direction{0.0f, -0.0f, i % 2 == 0 ? 1.0f : -1.0f};
            if (i % 3 == 1) direction.x = static_cast<float>(random.range(-1.0, 1.0) * (i % 2 == 0 ? 1e-20 : 1e-30));
            if (i % 3 == 2) direction.y = std::numeric_limits<float>::denorm_min();
            const float away = static_cast<float>(random.range(0.5, 8.0));
            const vec3 origin{corner.x, corner.y, corner.z - direction.z * away};
            result.count(mesh, bvh, {origin, direction});
        }
    }
    EXPECT_GT(result.hits, 5000);
    EXPECT_EQ(result.lost, 0) << "of " << result.hits;
}

}  // namespace
}  // namespace carom
