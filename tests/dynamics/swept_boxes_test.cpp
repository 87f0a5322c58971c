// The bounds of moving boxes, many at once, against those of one at a time: the same bits.
#include <carom/collision/aabb.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/detail/swept_boxes.hpp>

#include <support/random_pose.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace carom::dynamics {
namespace {

constexpr double kDt = 1.0 / 60.0;

struct Case {
    BodyState state;
    Pose local;
    Box box{};
    double reach = 0.0, pull = 0.0;
    Pose pose;
    FloatAabb bounds;
    double motion = -1.0;
};

dvec3 vector_of(Random& r, double least, double most) {
    const auto number = [&] { return (r.unit() < 0.5 ? -1.0 : 1.0) * std::exp2(r.range(std::log2(least), std::log2(most))); };
    return {number(), number(), number()};
}

std::vector<Case> some_cases(Random& r, std::size_t count) {
    std::vector<Case> cases(count);
    for (std::size_t i = 0; i < count; ++i) {
        Case& c = cases[i];
        const double far = i % 5 == 0 ? 1e29 : 100.0;
        c.state.pose = {vector_of(r, 1e-6, far), test::random_rotation(r)};
        if (i % 3 != 0) c.state.velocity = vector_of(r, 1e-3, i % 5 == 0 ? 1e14 : 100.0);
        if (i % 4 != 0) c.state.spin = vector_of(r, 1e-3, 1e3);
        if (i % 2 != 0) c.local = {vector_of(r, 1e-3, 10.0), test::random_rotation(r)};
        c.box.half_extents = glm::abs(vec3(vector_of(r, 1e-4, 1e3)));
        c.reach = r.range(0.0, 10.0);
        c.pull = i % 7 == 0 ? 0.0 : 9.81 * kDt * kDt;
        if (i == 9) c.state.pose.position = c.local.position = dvec3{0.0};  // bounds about nothing
    }
    return cases;
}

void sweep_one(Case& c, const dvec3& origin) {
    c.pose = c.state.pose * c.local;
    const Aabb box = bounds(c.box, c.pose);
    const dvec3 path = c.state.velocity * kDt;
    const double play = c.pull + c.reach * std::min(glm::length(c.state.spin) * kDt, 2.0);
    c.bounds = round_outward(inflate({box.lower + glm::min(path, dvec3{0.0}), box.upper + glm::max(path, dvec3{0.0})}, play), origin);
    c.motion = glm::length(c.state.velocity) * kDt + play;
}

TEST(SweptBoxes, HaveTheBitsOfOneAtATime) {
    Random r(71);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        for (const std::size_t count : {0u, 1u, 15u, 16u, 17u, 500u}) {
            dvec3 origin = count % 2 == 0 ? dvec3{0.0} : vector_of(r, 1e-3, 1e6);
            if (count == 17) origin = {0x1p80, -0x1p80, 0x1p80};  // so far that differences are floats but for what rounding hides
            std::vector<Case> expected = some_cases(r, count);
            for (Case& c : expected) c.local = count == 1 ? Pose{} : c.local;
            std::vector<Case> cases = expected;
            std::vector<SweptBox> boxes;
            for (Case& c : cases) boxes.push_back({&c.state, &c.local, c.box.half_extents, c.reach, c.pull, false, &c.pose, &c.bounds, &c.motion});
            sweep_boxes(boxes, kDt, origin);
            for (std::size_t i = 0; i < count; ++i) {
                sweep_one(expected[i], origin);
                ASSERT_EQ(std::memcmp(&cases[i].pose, &expected[i].pose, sizeof(Pose)), 0) << i << " of " << count << ", width " << width;
                ASSERT_EQ(cases[i].bounds, expected[i].bounds) << i << " of " << count << ", width " << width;
                ASSERT_EQ(cases[i].motion, expected[i].motion) << i << " of " << count << ", width " << width;
            }
        }
    }
    set_simd_width(0);
}

}  // namespace
}  // namespace carom::dynamics
