// Moving sets of boxes for tests of the broadphase methods: each hard in its own way.
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/random.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace carom::test {

enum class Distribution { Uniform, Clustered, Planar, Stacked, Line, Coincident, Touching, Mixed, Points };
inline constexpr Distribution kDistributions[] = {Distribution::Uniform,  Distribution::Clustered, Distribution::Planar,
                                                  Distribution::Stacked,  Distribution::Line,      Distribution::Coincident,
                                                  Distribution::Touching, Distribution::Mixed,     Distribution::Points};

inline FloatAabb box_about(const dvec3& centre, const dvec3& half) { return {vec3(centre - half), vec3(centre + half)}; }

inline FloatAabb random_box(Distribution kind, Random& random, std::size_t i) {
    const auto x = [&](double size) { return random.range(-size, size); };
    const dvec3 half{random.range(0.1, 0.6), random.range(0.1, 0.6), random.range(0.1, 0.6)};
    switch (kind) {
        case Distribution::Uniform:
            return box_about({x(8), x(6), x(4)}, half);
        case Distribution::Clustered: {
            const double c = static_cast<double>(i % 3) * 100.0;
            return box_about({c + x(1.5), x(1.5) - c, x(1.5)}, half);
        }
        case Distribution::Planar:
            return box_about({x(10), 0.0, x(10)}, half);
        case Distribution::Stacked: {
            const auto k = static_cast<double>(i % 40);
            return box_about({0.3 * x(1), k + 0.01 * x(1), static_cast<double>(i / 40) * 1.1}, {0.51, 0.51, 0.51});
        }
        case Distribution::Line:
            return box_about({0.0, x(60), 0.0}, half);
        case Distribution::Coincident:
            return box_about({1.0, 2.0, 3.0}, {0.5, 0.5, 0.5});
        case Distribution::Touching: {  // faces, edges and corners meet exactly
            const auto k = static_cast<float>(i % 7), m = static_cast<float>((i / 7) % 7), l = static_cast<float>(i / 49);
            return {{k, m, l}, {k + 1.0f, m + 1.0f, l + 1.0f}};
        }
        case Distribution::Mixed: {  // sizes over five decades, one of them very large
            const double size = i == 5 ? 500.0 : 0.01 * (1 << (i % 10)) * random.unit();
            return box_about({x(10), x(10), x(10)}, {size, size * random.unit(), size});
        }
        case Distribution::Points: {  // no volume, many equal coordinates, zeros of both signs
            const double p = static_cast<double>(static_cast<int>(x(3)));
            const double q = static_cast<double>(static_cast<int>(x(3)));
            return box_about({p, q, random.unit() < 0.5 ? -0.0 : 0.0}, dvec3{0.0});
        }
    }
    return {};
}

inline std::vector<FloatAabb> random_boxes(Distribution kind, std::size_t n, std::uint64_t seed) {
    Random random(seed);
    std::vector<FloatAabb> boxes(n);
    for (std::size_t i = 0; i < n; ++i) boxes[i] = random_box(kind, random, i);
    return boxes;
}

/// Moves most boxes a little and some far.
inline void move(std::vector<FloatAabb>& boxes, Random& random) {
    for (FloatAabb& box : boxes) {
        const double step = random.unit() < 0.02 ? 5.0 : 0.05;
        if (random.unit() < 0.3) continue;
        const vec3 by(dvec3{random.range(-step, step), random.range(-step, step), random.range(-step, step)});
        box.lower += by;
        box.upper += by;
    }
}

inline std::vector<ProxyFilter> random_filters(std::size_t n, std::uint64_t seed) {
    Random random(seed);
    std::vector<ProxyFilter> filters(n);
    for (ProxyFilter& filter : filters) {
        filter.layer = std::uint64_t{1} << static_cast<unsigned>(random.range(0, 4));
        filter.mask = static_cast<std::uint64_t>(random.range(0, 16));
        filter.movable = random.unit() < 0.7;
    }
    return filters;
}

/// The oracle: every pair looked at by itself, from the documented rules.
inline std::vector<ProxyPair> all_pairs(const std::vector<FloatAabb>& boxes, const std::vector<ProxyFilter>& filters) {
    std::vector<ProxyPair> pairs;
    for (std::uint32_t a = 0; a < boxes.size(); ++a) {
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
            bool meets = filters[a].movable || filters[b].movable;
            meets = meets && (filters[a].layer & filters[b].mask) != 0 && (filters[b].layer & filters[a].mask) != 0;
            for (int k = 0; k < 3; ++k) {
                meets = meets && boxes[a].lower[k] <= boxes[b].upper[k] && boxes[b].lower[k] <= boxes[a].upper[k];
            }
            if (meets) pairs.push_back({a, b});
        }
    }
    return pairs;
}

}  // namespace carom::test
