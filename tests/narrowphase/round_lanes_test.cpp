// Kernels of round shapes for many pairs at once against those for one pair: the same bits.
#include "oracle.hpp"

#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/collide.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <map>

namespace carom {
namespace {

using namespace test;

Shape shape_of(Random& r, int kind) {
    const auto size = [&] { return static_cast<float>(r.range(0.1, 1.0)); };
    switch (kind) {
        case 0: return Sphere{size()};
        case 1: return Capsule{.radius = size(), .half_segment = r.range(0.0, 1.0) < 0.2 ? 0.0f : size()};
        case 2: return Box{r.range(0.0, 1.0) < 0.5 ? vec3(size()) : vec3(size(), size(), size())};
        default: return Plane{vec3(random_direction(r)), static_cast<float>(r.range(-1.0, 1.0))};
    }
}

// Turns and places where closed forms have to choose: none at all, along an axis, in the middle of one another.
Pose pose_of(Random& r) {
    Pose pose{random_direction(r) * r.range(0.0, 1.5), random_rotation(r)};
    const double chance = r.range(0.0, 1.0);
    if (chance < 0.3) pose.orientation = kIdentityRotation;
    if (chance < 0.2 || chance > 0.9) pose.position = {0.0, chance < 0.1 ? 0.0 : r.range(-0.6, 0.6), 0.0};
    return pose;
}

struct Crowd {
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    std::vector<const Shape*> placed;
    std::vector<NumberedPair> pairs;

    explicit Crowd(std::uint64_t seed) {
        Random r(seed);
        for (int i = 0; i < 4000; ++i) {
            const int first = static_cast<int>(r.range(0.0, 4.0)), second = static_cast<int>(r.range(0.0, first == 3 ? 3.0 : 4.0));
            const dvec3 origin = i % 5 == 0 ? dvec3{1e6, -3e5, 2e6} : dvec3{0.0};
            const auto number = static_cast<std::uint32_t>(shapes.size());
            for (const int kind : {first, second}) {
                shapes.push_back(shape_of(r, kind));
                poses.push_back(pose_of(r));
                poses.back().position += origin;
            }
            if (i % 8 == 0) poses[number + 1].position = poses[number].position;
            pairs.push_back({number, number + 1, i % 3 == 0 ? 0.0f : 0.1f});
        }
        poses[0].position = {1e308, 0.0, 0.0};  // the difference overflows
        poses[1].position = {-1e308, 0.0, 0.0};
        for (const Shape& shape : shapes) placed.push_back(&shape);
    }
};

TEST(RoundLanes, HaveTheBitsOfOnePairAtATime) {
    const Crowd crowd(41);
    std::vector<Manifold> expected;
    std::map<std::pair<ShapeType, ShapeType>, int> touching;
    for (std::uint32_t i = 0; i < crowd.pairs.size(); ++i) {
        const NumberedPair& p = crowd.pairs[i];
        const std::size_t before = expected.size();
        const ShapePair pair{crowd.placed[p.a], crowd.placed[p.b], crowd.poses[p.a], crowd.poses[p.b], p.margin};
        ASSERT_EQ(collide(pair, i, expected), CollideStatus::Ok);
        if (expected.size() > before) ++touching[{type_of(*pair.a), type_of(*pair.b)}];
    }
    EXPECT_EQ(touching.size(), 15u);  // every two of the four kinds, either way round, but two planes
    for (const auto& [types, count] : touching) EXPECT_GT(count, 60) << to_string(types.first) << " and " << to_string(types.second);

    SerialExecutor executor;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        CollideScratch scratch;
        std::vector<Manifold> found;
        collide({crowd.placed, crowd.poses}, crowd.pairs, executor, scratch, found);
        ASSERT_EQ(found.size(), expected.size()) << "width " << width;
        for (std::size_t m = 0; m < found.size(); ++m) {
            const Manifold &a = found[m], &b = expected[m];
            ASSERT_EQ(a.pair, b.pair) << "width " << width;
            ASSERT_EQ(a.count, b.count) << "pair " << a.pair << ", width " << width;
            ASSERT_EQ(std::memcmp(&a.normal, &b.normal, sizeof(a.normal)), 0) << "pair " << a.pair << ", width " << width;
            ASSERT_EQ(std::memcmp(a.points.data(), b.points.data(), sizeof(a.points)), 0) << "pair " << a.pair << ", width " << width;
        }
    }
    set_simd_width(0);
}

}  // namespace
}  // namespace carom
