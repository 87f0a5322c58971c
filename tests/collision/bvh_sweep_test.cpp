// Triangles along the path of a box: none that the box's path meets is left out.
#include <carom/collision/bvh_sweep.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <set>
#include <vector>

namespace carom {
namespace {

/// Whether the box about origin + t direction meets the box of the triangle for a t in [0, 1]: slabs in long double, strictly.
bool meets(const std::vector<vec3>& v, std::uint32_t i, const geo::Ray<double>& ray, const dvec3& half) {
    long double from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
        long double low = v[3 * i][k], high = low;
        for (std::uint32_t c = 1; c < 3; ++c) {
            low = std::min<long double>(low, v[3 * i + c][k]);
            high = std::max<long double>(high, v[3 * i + c][k]);
        }
        low -= half[k], high += half[k];
        const long double o = ray.origin[k], d = ray.direction[k];
        if (d == 0) {
            if (o < low || o > high) return false;
            continue;
        }
        const long double a = (low - o) / d, b = (high - o) / d;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    return from <= to;
}

TEST(BvhSweep, NoTriangleOnThePathIsLeftOut) {
    Random random(0x5feeb);
    for (const double scale : {1.0, 1e-5, 1e5, 1e8}) {
        for (const double away : {0.0, 1.0, 1000.0}) {
            std::vector<vec3> vertices;
            std::vector<StaticBvh::Triangle> triangles;
            const auto any = [&](double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
            const dvec3 centre = scale * away * dvec3{1, -1, 1};
            for (std::uint32_t i = 0; i < 400; ++i) {
                const dvec3 p = centre + any(scale);
                for (int k = 0; k < 3; ++k) vertices.push_back(vec3(p + any(0.1 * scale)));
                triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
            }
            const auto bvh = StaticBvh::build(vertices, triangles);
            ASSERT_TRUE(bvh);
            std::size_t seen = 0, needed = 0;
            for (int n = 0; n < 60; ++n) {
                dvec3 direction = any(2.0 * scale);
                if (n % 5 == 0) direction[n % 3] = 0.0;
                if (n % 20 == 0) direction = dvec3{0.0};
                const geo::Ray<double> ray{.origin = centre + any(1.5 * scale), .direction = direction, .t_max = 1.0};
                const dvec3 half = glm::abs(any(0.1 * scale));
                std::set<std::uint32_t> visited;
                triangles_along(*bvh, ray, half, [&](std::uint32_t i) {
                    EXPECT_TRUE(visited.insert(i).second);
                    return 1.0;
                });
                for (std::uint32_t i = 0; i < 400; ++i) {
                    const bool met = meets(vertices, i, ray, half);
                    ASSERT_TRUE(!met || visited.contains(i)) << scale << " " << away << " " << n;
                    needed += met ? 1 : 0;
                }
                seen += visited.size();
            }
            EXPECT_GT(needed, 30u);
            EXPECT_LT(seen, needed + needed / 2 + 100) << scale << " " << away;  // and few others
        }
    }
}

TEST(BvhSweep, NothingBeyondTheReturnedTimeIsWanted) {
    std::vector<vec3> vertices;
    std::vector<StaticBvh::Triangle> triangles;
    for (std::uint32_t i = 0; i < 1000; ++i) {  // a row of walls
        const float x = static_cast<float>(i);
        vertices.insert(vertices.end(), {vec3{x, -1, -1}, vec3{x, 1, -1}, vec3{x, 0, 1}});
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto bvh = StaticBvh::build(vertices, triangles);
    std::size_t count = 0;
    triangles_along(*bvh, {.origin = {-1, 0, 0}, .direction = {2000, 0, 0}, .t_max = 1.0}, dvec3{0.1}, [&](std::uint32_t i) {
        ++count;
        return (i + 1.0) / 2000.0;
    });
    EXPECT_GE(count, 1u);
    EXPECT_LT(count, 40u);
    // Bad input visits nothing.
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto never = [](std::uint32_t) -> double { ADD_FAILURE(); return 0.0; };
    triangles_along(*bvh, {.origin = dvec3{nan}, .direction = {1, 0, 0}, .t_max = 1.0}, dvec3{0.1}, never);
    triangles_along(*bvh, {.origin = dvec3{0.0}, .direction = {1, nan, 0}, .t_max = 1.0}, dvec3{0.1}, never);
    triangles_along(*bvh, {.origin = dvec3{0.0}, .direction = {1, 0, 0}, .t_max = nan}, dvec3{0.1}, never);
    triangles_along(*bvh, {.origin = dvec3{0.0}, .direction = {1, 0, 0}, .t_max = 1.0}, dvec3{-0.1}, never);
}

}  // namespace
}  // namespace carom
