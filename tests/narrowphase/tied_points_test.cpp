// Points that span as much as others: rounding decides neither which are kept nor in which order.
#include "oracle.hpp"

#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace carom {
namespace {

using namespace test;

// How B stands on A, whose upper face is y = 0.5. Every one has ties among its points.
struct Standing {
    const char* name;
    vec3 half_a, half_b;
    Pose pose;  ///< of B in A's frame
};

std::vector<Standing> standings() {
    const vec3 cube{0.5f, 0.5f, 0.5f}, plank{1.5f, 0.5f, 1.5f}, bar{1.2f, 0.5f, 0.3f}, small{0.2f, 0.5f, 0.2f};
    const auto on = [](double x, double z, double yaw) { return Pose{{x, 0.995, z}, about({0, 1, 0}, yaw)}; };
    const double eighth = 0.25 * kPi;
    const Pose tilted{{0, 0.995, 0}, about({1, 0, 0}, 0.004) * about({0, 1, 0}, eighth)};
    return {{"equal faces", cube, cube, on(0, 0, 0)},
            {"a quarter turned", cube, cube, on(0, 0, 2.0 * eighth)},
            {"a cube on a plank", plank, cube, on(0, 0, 0)},
            {"a cube beside the middle of a plank", plank, cube, on(0.3, -0.2, 0.0)},
            {"a plank on a cube", cube, plank, on(0, 0, 0)},
            {"a corner on a corner", cube, cube, on(0.4, 0.4, 0)},
            {"half over the edge", cube, cube, on(0.5, 0, 0)},
            {"bars across each other", bar, bar, on(0, 0, 2.0 * eighth)},
            {"an octagon", cube, cube, on(0, 0, eighth)},
            {"a tilted octagon", cube, cube, tilted},
            {"a diamond in a square", plank, cube, on(0, 0, eighth)},
            {"a small cube on a face", cube, small, on(-0.1, 0.1, eighth)}};
}

using Names = std::vector<std::uint64_t>;

Names names_of(const std::vector<Manifold>& manifolds) {
    Names names;
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) names.push_back(p.feature);
    }
    return names;
}

// As far as rounding to floats moves it.
Pose trembling(Pose pose, Random& r) {
    pose.position += r.range(0.0, 2e-7) * random_direction(r);
    pose.orientation = about(random_direction(r), r.range(0.0, 2e-7)) * pose.orientation;
    return pose;
}

Pose seen_from(const Pose& frame, const Pose& pose) {
    return {frame.position + frame.orientation * pose.position, frame.orientation * pose.orientation};
}

Shape hull_like(const vec3& half) { return hull_of(corners_of(Box{half})); }

TEST(TiedPoints, OfTwoBoxesOrHullsRoundingDecidesNone) {
    Random r(61);
    for (const Standing& s : standings()) {
        for (const bool hulls : {false, true}) {
            const Shape a = hulls ? hull_like(s.half_a) : Box{s.half_a}, b = hulls ? hull_like(s.half_b) : Box{s.half_b};
            const Names names = names_of(collide_all(a, {}, b, s.pose, 0.02f));
            ASSERT_EQ(names.size(), 4u) << s.name;
            int same = 0;
            for (int i = 0; i < 200; ++i) {
                const Pose world{random_direction(r) * 3.0, random_rotation(r)};
                const std::vector<Manifold> m = collide_all(a, trembling(world, r), b, trembling(seen_from(world, s.pose), r), 0.02f);
                same += names_of(m) == names ? 1 : 0;
            }
            EXPECT_EQ(same, 200) << s.name << (hulls ? ", hulls" : "");
        }
    }
}

// In a batch, at every width.
TEST(TiedPoints, OfManyBoxesRoundingDecidesNone) {
    Random r(62);
    std::vector<Shape> boxes;
    for (const Standing& s : standings()) boxes.push_back(Box{s.half_a}), boxes.push_back(Box{s.half_b});
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    const std::size_t kinds = standings().size();
    std::vector<Names> expected;
    for (std::size_t k = 0; k < kinds; ++k) {
        expected.push_back(names_of(collide_all(boxes[2 * k], {}, boxes[2 * k + 1], standings()[k].pose, 0.02f)));
    }
    for (std::uint32_t i = 0; i < 600; ++i) {
        const std::size_t k = i % kinds;
        const Pose world{random_direction(r) * 3.0, random_rotation(r)};
        shapes.push_back(&boxes[2 * k]), shapes.push_back(&boxes[2 * k + 1]);
        poses.push_back(trembling(world, r)), poses.push_back(trembling(seen_from(world, standings()[k].pose), r));
        pairs.push_back({2 * i, 2 * i + 1, 0.02f});
    }
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        SerialExecutor executor;
        CollideScratch scratch;
        std::vector<Manifold> manifolds;
        collide({shapes, poses}, pairs, executor, scratch, manifolds);
        set_simd_width(0);
        ASSERT_EQ(manifolds.size(), pairs.size()) << width;
        for (const Manifold& m : manifolds)
            EXPECT_EQ(names_of({m}), expected[m.pair % kinds]) << width << " " << standings()[m.pair % kinds].name;
    }
}

// Alone and in a batch.
TEST(TiedPoints, OfABoxOrHullOnAPlaneRoundingDecidesNone) {
    Random r(63);
    const Shape plane = Plane{{0.0f, 1.0f, 0.0f}, 0.495f};
    const vec3 half{0.5f, 0.5f, 0.5f};
    const Shape box = Box{half}, hull = hull_like(half);
    for (const Shape* shape : {&box, &hull}) {
        const Names names = names_of(collide_all(*shape, {{0, 0.99, 0}, kIdentityRotation}, plane, {}, 0.02f));
        ASSERT_EQ(names.size(), 4u);
        std::vector<const Shape*> shapes{&plane};
        std::vector<Pose> poses{{}};
        std::vector<NumberedPair> pairs;
        for (std::uint32_t i = 1; i <= 400; ++i) {
            shapes.push_back(shape);
            const dvec3 at{r.range(-3.0, 3.0), 0.99, r.range(-3.0, 3.0)};
            poses.push_back(trembling({at, about({0, 1, 0}, r.range(0.0, 6.0))}, r));
            pairs.push_back({i, 0, 0.02f});
            EXPECT_EQ(names_of(collide_all(*shape, poses[i], plane, {}, 0.02f)), names);
        }
        SerialExecutor executor;
        CollideScratch scratch;
        std::vector<Manifold> manifolds;
        collide({shapes, poses}, pairs, executor, scratch, manifolds);
        ASSERT_EQ(manifolds.size(), pairs.size());
        for (const Manifold& m : manifolds) EXPECT_EQ(names_of({m}), names);
    }
}

}  // namespace
}  // namespace carom
