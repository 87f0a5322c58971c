// Many pairs of boxes for the tests of batches, with what is asked of every batch.
//
//   BoxCrowd crowd(2500);
//   collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, out);
#pragma once

#include "oracle.hpp"

#include <carom/narrowphase/detail/kernel.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace carom::test {

inline constexpr double kSizeOfCrowd = 1.0;  // no half extent is longer, but of boxes that float does not take as they are

/// Pairs of boxes far from the origin, of which every seventh is of sizes that float does not take as they are.
struct BoxCrowd {
    std::vector<Shape> shapes;
    std::vector<const Shape*> placed;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    std::vector<std::uint32_t> chosen;

    explicit BoxCrowd(std::size_t count) {
        Random r(31);
        for (std::size_t i = 0; i < count; ++i) {
            const dvec3 here = random_direction(r) * std::pow(10.0, r.range(-3.0, 5.0));
            for (int side = 0; side < 2; ++side) {
                vec3 half{0.0f};
                for (int k = 0; k < 3; ++k) half[k] = static_cast<float>(r.range(0.2, kSizeOfCrowd));
                if (i % 7 == 3 && side == 0) half *= 100.0f;
                shapes.emplace_back(Box{half});
                poses.push_back({here + random_direction(r) * r.range(0.0, 1.7), random_rotation(r)});
            }
            pairs.push_back({static_cast<std::uint32_t>(2 * i + i % 2), static_cast<std::uint32_t>(2 * i + 1 - i % 2),
                             static_cast<float>(r.range(0.0, 0.1)), i % 3 == 0 ? 0.01f : 0.0f});
            chosen.push_back(static_cast<std::uint32_t>(i));
        }
        for (const Shape& shape : shapes) placed.push_back(&shape);
    }
    BoxCrowd(const BoxCrowd&) = delete;
    BoxCrowd& operator=(const BoxCrowd&) = delete;

    [[nodiscard]] detail::BatchInput input() const { return {{placed, poses}, pairs}; }
    /// Number `number` of the seven of a pose.
    [[nodiscard]] double& number_of(std::size_t pose, std::size_t number) { return reinterpret_cast<double*>(&poses[pose])[number]; }
    /// The manifolds of the first `count` pairs, one pair at a time.
    [[nodiscard]] std::vector<Manifold> singles(std::size_t count) const {
        std::vector<Manifold> found;
        for (std::uint32_t i = 0; i < count; ++i) collide(input().pair(i), i, found);
        return found;
    }
};

}  // namespace carom::test
