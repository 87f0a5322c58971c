// What the walk of the wide hierarchy takes from a prepared ray, against exact rationals: the lemmas of detail/wide_ray.hpp.
#include <carom/collision/detail/wide_ray.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <support/exact.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

using exact::Rational;

WideBvh box_alone(const vec3& lower, const vec3& upper) {
    WideBvh tree;
    tree.lower = lower;
    tree.upper = upper;
    tree.update_far_reach();
    return tree;
}

vec3 random_vec3(Random& random, double size) {
    return {static_cast<float>(random.range(-size, size)), static_cast<float>(random.range(-size, size)),
            static_cast<float>(random.range(-size, size))};
}

// Images and depths are off by 21 u D together; so a point of the ray that is that far outside of a box must still be met in it.
TEST(WideRay, SlabsAreWiderThanImagesAndDepthsAreOff) {
    Random random(731);
    const Rational u = exact::number(0x1p-24);
    double least = 1e9;
    int checked = 0;
    for (int i = 0; i < 3000; ++i) {
        const double far = i % 3 == 0 ? 0.0 : std::ldexp(1.0, i % 14);  // from the world's origin, where the pad is smallest, to far from it
        const vec3 at = random_vec3(random, far);
        const WideBvh tree = box_alone(at - vec3{1.0f, 0.5f, 2.0f}, at + vec3{1.0f, 2.0f, 0.25f});
        geo::Ray<float> ray{.origin = i % 5 == 0 ? vec3{0.0f} : at + random_vec3(random, 4.0), .direction = random_vec3(random, 1.0)};
        if (i % 4 == 0) ray.direction[i % 3] *= 0x1p-30f;
        WideRay r{};
        if (!prepare(tree, ray, r) || r.moved != 0.0) continue;
        // The direction in the ray's own units: the same but for a power of two.
        const vec3 d = ray.direction * static_cast<float>(r.unit);
        Rational reach = 0;
        for (int k = 0; k < 3; ++k) {
            for (const float b : {tree.lower[k], tree.upper[k]}) reach = std::max(reach, exact::magnitude(exact::number(b) - exact::number(ray.origin[k])));
        }
        for (int k = 0; k < 3; ++k) {
            for (const float share : {0.0f, 0.3f, 1.0f}) {
                const float b = tree.lower[k] + share * (tree.upper[k] - tree.lower[k]);
                const Rational along = exact::number(d[k]), from = exact::number(b) - exact::number(ray.origin[k]);
                const Rational sign = along > 0 ? 1 : -1;
                for (const bool fused : {true, false}) {
                    const float near = fused ? std::fma(b, r.inverse[k], r.near[k]) : b * r.inverse[k] + r.near[k];
                    const float far_t = fused ? std::fma(b, r.inverse[k], r.far[k]) : b * r.inverse[k] + r.far[k];
                    // In units of u D: by how much more than images and depths need the slabs are apart.
                    const Rational before = (from / along - exact::number(near)) * along * sign / (u * reach);
                    const Rational after = (exact::number(far_t) - from / along) * along * sign / (u * reach);
                    least = std::min({least, static_cast<double>(before), static_cast<double>(after)});
                    ++checked;
                }
            }
        }
    }
    EXPECT_GT(checked, 10000);
    EXPECT_GE(least, 21.0) << "in u D";
    EXPECT_LE(least, 28.0) << "and no more than the pad can be";
}

// A ray that exactly meets the one corner of the box that is on the ball round it, as far off as doubles can be exact about it.
TEST(WideRay, NoRayThatHitsIsGivenUpForBeingFarAway) {
    Random random(732);
    const WideBvh tree = box_alone(vec3{0.0f}, vec3{1.0f});
    for (int i = 0; i < 4000; ++i) {
        const auto whole = [&] { return std::trunc(random.range(-1e6, 1e6)); };
        const dvec3 d{whole(), whole(), 0.0};
        // Across the diagonal, so that the corner is where the line is nearest to the ball's centre.
        const dvec3 direction{d.x, d.y, -d.x - d.y};
        const double away = std::ldexp(1.0, i % 60);
        WideRay r{};
        ASSERT_TRUE(prepare(tree, geo::Ray<double>{-away * direction, direction, 0.0, 2.0 * away}, r)) << i;
        ASSERT_TRUE(prepare(tree, geo::Ray<double>{away * direction, direction, -2.0 * away, 0.0}, r)) << i;
    }
}

}  // namespace
}  // namespace carom
