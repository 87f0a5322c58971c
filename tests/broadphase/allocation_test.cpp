// Once warm, an update asks the system for no memory.
#include "broadphase/distributions.hpp"

#include <carom/broadphase/broadphase.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> g_allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
    ++g_allocations;
    if (void* memory = std::malloc(size)) return memory;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

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
        const long before = g_allocations.load();
        std::size_t pairs = 0;
        for (int frame = 0; frame < 20; ++frame) {
            jiggle();
            pairs += broadphase->update(boxes, filters, executor).size();
        }
        EXPECT_EQ(g_allocations.load(), before) << to_string(method);
        EXPECT_GT(pairs, 0u);
    }
}

}  // namespace
}  // namespace carom
