// Once warm, an update asks the system for no memory.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>

#include <gtest/gtest.h>
#include <support/count_allocations.hpp>

namespace carom {
namespace {

TEST(Allocation, StopsOnceWarm) {
    SerialExecutor executor;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        for (const std::size_t share : {1u, 20u}) {  // one in so many moves
            Broadphase broadphase({.method = method});
            auto boxes = test::random_boxes(test::Distribution::Stacked, 1000, 3);
            const std::vector<ProxyFilter> filters(boxes.size());
            std::vector<std::uint32_t> moved(boxes.size());
            for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = static_cast<std::uint32_t>(i);
            broadphase.update({boxes, filters, moved, {}}, executor);
            std::erase_if(moved, [&](std::uint32_t i) { return i % share != 0; });
            int frames = 0;
            const auto jiggle = [&] {  // there and back
                const vec3 by(frames++ % 2 == 0 ? 0.02f : -0.02f);
                for (const std::uint32_t i : moved) {
                    boxes[i].lower += by;
                    boxes[i].upper += by;
                }
                return broadphase.update({boxes, filters, moved, {}}, executor).pairs.size();
            };
            for (int frame = 0; frame < 40; ++frame) jiggle();
            const long before = test::allocations();
            std::size_t pairs = 0;
            for (int frame = 0; frame < 20; ++frame) pairs += jiggle();
            EXPECT_EQ(test::allocations(), before) << to_string(method) << ", one in " << share;
            EXPECT_GT(pairs, 0u);
        }
    }
}

}  // namespace
}  // namespace carom
