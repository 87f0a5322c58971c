// Triangles along the path of a ball: none that it comes near is left out, few others, and their corners are the mesh's.
#include <carom/collision/bvh_sweep.hpp>
#include <carom/collision/closest_points.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <vector>

namespace carom {
namespace {

struct Soup {
    std::vector<vec3> vertices;
    std::vector<StaticBvh::Triangle> triangles;
    std::optional<StaticBvh> bvh;

    Soup(Random& random, std::uint32_t count, const dvec3& centre, double size, double side) {
        const auto any = [&](double most) { return most * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
        for (std::uint32_t i = 0; i < count; ++i) {
            const dvec3 p = centre + any(size);
            for (int k = 0; k < 3; ++k) vertices.push_back(vec3(p + any(side)));
            triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        }
        bvh = *StaticBvh::build(vertices, triangles);
    }
    [[nodiscard]] geo::Triangle<double> operator[](std::uint32_t i) const {
        return {dvec3(vertices[3 * i]), dvec3(vertices[3 * i + 1]), dvec3(vertices[3 * i + 2])};
    }
    [[nodiscard]] double distance(std::uint32_t i, const geo::Segment<double>& path) const {
        return std::sqrt(geo::closest_points(path, (*this)[i]).distance_sq);
    }
};

TEST(BvhBall, NoTriangleThatThePathComesNearIsLeftOut) {
    Random random(0xba11);
    for (const double scale : {1.0, 1e-5, 1e5, 1e8, 1e-12}) {
        for (const double away : {0.0, 1.0, 100.0, 1e4}) {
            const auto any = [&](double size) { return size * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
            const dvec3 centre = scale * away * dvec3{1, -1, 1};
            const Soup soup(random, 300, centre, scale, 0.1 * scale);
            std::size_t seen = 0, needed = 0;
            for (int n = 0; n < 150; ++n) {
                dvec3 direction = any(2.0 * scale);
                if (n % 5 == 0) direction[n % 3] = 0.0;
                if (n % 20 == 0) direction = dvec3{0.0};
                const geo::Ray<double> ray{.origin = centre + any(1.5 * scale), .direction = direction, .t_max = 1.0};
                const geo::Segment<double> path{ray.origin, ray.origin + direction};
                double radius = n % 7 == 0 ? 0.0 : random.range(0.0, 0.1 * scale);
                if (n % 2 == 0)
                    radius = soup.distance(static_cast<std::uint32_t>(random.range(0, 300)), path) * (1.0 + 1e-12);  // just touches
                set_simd_width(available_simd_widths()[static_cast<std::size_t>(n) % available_simd_widths().size()]);
                std::set<std::uint32_t> visited;
                triangles_along(*soup.bvh, ray, radius, [&](std::uint32_t i, const vec3*) {
                    EXPECT_TRUE(visited.insert(i).second);
                    return 1.0;
                });
                for (std::uint32_t i = 0; i < 300; ++i) {
                    const bool met = soup.distance(i, path) <= radius;
                    ASSERT_TRUE(!met || visited.contains(i)) << scale << " " << away << " " << n;
                    needed += met ? 1 : 0;
                }
                seen += visited.size();
            }
            set_simd_width(0);
            EXPECT_GT(needed, 1000u);
            EXPECT_LT(seen, needed + needed / (away > 1e3 ? 10 : 25))
                << scale << " " << away;  // and few others; floats far away are coarse
        }
    }
}

// Zeros have signs, which vertices that stand on one place share in a leaf; meshes that are scaled have no corners at hand.
TEST(BvhBall, CornersAreTheMeshsOrNone) {
    Random random(0xc02e);
    std::size_t with = 0, without = 0;
    for (const double scale : {1.0, 1e-12, 1e8}) {
        Soup soup(random, 200, dvec3{0.0}, scale, 0.3 * scale);
        for (std::size_t i = 0; i < soup.vertices.size(); i += 7) soup.vertices[i] = vec3{0.0f, -0.0f, float(0.01 * double(i) * scale)};
        const Result<StaticBvh> bvh = StaticBvh::build(soup.vertices, soup.triangles);
        ASSERT_TRUE(bvh);
        triangles_along(*bvh, {.origin = dvec3{-3.0 * scale}, .direction = dvec3{6.0 * scale}, .t_max = 1.0}, 5.0 * scale,
                        [&](std::uint32_t i, const vec3* corners) {
                            ++(corners != nullptr ? with : without);
                            for (std::uint32_t k = 0; k < 3 && corners != nullptr; ++k) {
                                for (int axis = 0; axis < 3; ++axis) {
                                    EXPECT_EQ(std::bit_cast<std::uint32_t>(corners[k][axis]),
                                              std::bit_cast<std::uint32_t>(soup.vertices[3 * i + k][axis]));
                                }
                            }
                            return 1.0;
                        });
    }
    EXPECT_GT(with, 50u);
    EXPECT_EQ(with + without, 600u);
    EXPECT_GT(without, 450u);
}

// Where floats cannot hold the path, everything is visited.
TEST(BvhBall, NothingIsTooFarOrTooLarge) {
    Random random(0xfa2);
    const Soup soup(random, 50, dvec3{0.0}, 1.0, 0.1);
    for (const double far : {1e24, 1e30, 1e60}) {
        std::size_t count = 0, boxes = 0;
        const geo::Ray<double> ray{.origin = dvec3{far, 0, 0}, .direction = {-2.0 * far, 0, 0}, .t_max = 1.0};
        triangles_along(*soup.bvh, ray, 0.5 * far, [&](std::uint32_t, const vec3*) { return ++count, 1.0; });
        triangles_along(*soup.bvh, ray, dvec3{0.5 * far}, [&](std::uint32_t) { return ++boxes, 1.0; });
        EXPECT_EQ(count, 50u) << far;
        EXPECT_EQ(boxes, 50u) << far;
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto never = [](std::uint32_t, const vec3*) -> double {
        ADD_FAILURE();
        return 0.0;
    };
    triangles_along(*soup.bvh, {.origin = dvec3{nan}, .direction = {1, 0, 0}, .t_max = 1.0}, 0.1, never);
    triangles_along(*soup.bvh, {.origin = dvec3{0.0}, .direction = {1, nan, 0}, .t_max = 1.0}, 0.1, never);
    triangles_along(*soup.bvh, {.origin = dvec3{0.0}, .direction = {1, 0, 0}, .t_max = nan}, 0.1, never);
    triangles_along(*soup.bvh, {.origin = dvec3{0.0}, .direction = {1, 0, 0}, .t_max = 1.0}, -0.1, never);
    triangles_along(*soup.bvh, {.origin = dvec3{0.0}, .direction = {1, 0, 0}, .t_max = 1.0}, nan, never);
}

// A ball that comes down on a floor is shown hardly more than the triangle under it; boxes alone would show it some twelve.
TEST(BvhBall, TheNearestComeFirst) {
    std::vector<vec3> vertices;
    std::vector<StaticBvh::Triangle> triangles;
    for (std::uint32_t i = 0; i < 400; ++i) {  // 20 x 10 quads
        const float x = static_cast<float>(i / 2 % 20), z = static_cast<float>(i / 40), up = i % 2 == 0 ? 0.0f : 1.0f;
        vertices.insert(vertices.end(), {vec3{x + up, 0.5f, z + up}, vec3{x + 1 - up, 0.5f, z + up}, vec3{x + up, 0.5f, z + 1 - up}});
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto bvh = StaticBvh::build(vertices, triangles);
    Random random(0xf10);
    std::size_t count = 0;
    for (int n = 0; n < 200; ++n) {
        const dvec3 from{random.range(2, 18), 5.0, random.range(2, 8)}, direction{0.3, -8, 0.2};
        const double radius = 0.9;
        double first = 1.0;
        triangles_along(*bvh, {.origin = from, .direction = direction, .t_max = 1.0}, radius, [&](std::uint32_t i, const vec3*) {
            ++count;
            const geo::Triangle<double> face{dvec3(vertices[3 * i]), dvec3(vertices[3 * i + 1]), dvec3(vertices[3 * i + 2])};
            double apart = 0.0, down = 4.5 / 8.0;  // where the centre is in the floor
            for (int k = 0; k < 50; ++k) {
                const double t = 0.5 * (apart + down);
                const dvec3 at = from + t * direction;
                (geo::closest_points(geo::Segment<double>{at, at}, face).distance_sq <= radius * radius ? down : apart) = t;
            }
            return first = std::min(first, down);
        });
        EXPECT_NEAR(first, (4.5 - radius) / 8.0, 1e-9);
    }
    EXPECT_LT(count, 500u);
    EXPECT_GE(count, 200u);
}

}  // namespace
}  // namespace carom
