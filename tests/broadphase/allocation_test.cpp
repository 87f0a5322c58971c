// Once warm, an update asks the system for no memory.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>

#include <gtest/gtest.h>
#include <support/count_allocations.hpp>

namespace carom {
namespace {

TEST(Allocation, StopsOnceWarm) {
    SerialExecutor executor;
    for (const BroadphaseMethod method : {BroadphaseMethod::BruteForce, BroadphaseMethod::SweepAndPrune}) {
        const auto broadphase = make_broadphase(method);
        auto boxes = test::random_boxes(test::Distribution::Stacked, 1000, 3);
        const std::vector<ProxyFilter> filters(boxes.size());
        Random random(4);
        const auto jiggle = [&] {
            for (FloatAabb& box : boxes) {
                const vec3 by(static_cast<float>(random.range(-1e-3, 1e-3)));
                box.lower += by;
                box.upper += by;
            }
        };
        for (int frame = 0; frame < 10; ++frame) {
            jiggle();
            broadphase->update(boxes, filters, executor);
        }
        const long before = test::allocations();
        std::size_t pairs = 0;
        for (int frame = 0; frame < 20; ++frame) {
            jiggle();
            pairs += broadphase->update(boxes, filters, executor).size();
        }
        EXPECT_EQ(test::allocations(), before) << to_string(method);
        EXPECT_GT(pairs, 0u);
    }
}

}  // namespace
}  // namespace carom
