// Contacts are kept with the same bits where bodies and contacts lie in parts, one for each thread.
#include "odd_executors.hpp"
#include "table.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace carom {
namespace {

using namespace test;

// With so many points, bodies and contacts lie in parts, one for each thread, and share bundles with others. What is driven over the boxes makes contacts come and go.
TEST(KeptContacts, HaveTheSameBitsInParts) {
    const auto hashes = [](Executor* executor) {
        Table table({.executor = executor, .plan = PlanMode::Everything, .contact_method = ContactMethod::Soft});
        for (int i = 0; i < 400; ++i) table.add({.position = {2.0 * (i % 20), 0.5, 2.0 * (i / 20)}}, Box{{0.5f, 0.5f, 0.5f}});
        std::vector<BodyId> carts;
        for (int j = 0; j < 20; ++j) {
            carts.push_back(table.add({.type = BodyType::Kinematic, .position = {-2.0 + 0.1 * j, 1.2005, 2.0 * j}}, Box{{0.6f, 0.2f, 0.4f}}, {.friction = 0.3f}));
        }
        std::vector<std::uint64_t> out;
        for (int i = 0; i < 440; ++i) {
            for (int j = 0; j < 20; ++j) {
                const double x = table.world.pose(carts[static_cast<std::size_t>(j)]).position.x, speed = 6.0 + 0.2 * j;
                if (i == 0 || x < -2.0 || x > 40.0) table.world.set_linear_velocity(carts[static_cast<std::size_t>(j)], {x > 40.0 ? -speed : speed, 0, 0});
            }
            table.run(1);
            out.push_back(table.world.state_hash());
        }
        return out;
    };
    const std::vector<std::uint64_t> expected = hashes(nullptr);
    for (const int threads : {2, 8}) {
        OddExecutor executor(threads, [](std::size_t count, const Executor::Body& body) {
            for (std::size_t i = count; i-- > 0;) body(i, i + 1);
        });
        EXPECT_EQ(hashes(&executor), expected) << threads;
    }
}

// What turns fast gets its inertia anew within the step, in a bundle with contacts that are kept.
TEST(KeptContacts, HaveTheSameBitsInPartsBesideWhatTurnsFast) {
    const auto hash = [](Executor* executor) {
        Table table({.executor = executor, .plan = PlanMode::Everything, .contact_method = ContactMethod::Soft});
        for (int i = 0; i < 500; ++i) table.add({.position = {2.0 * (i % 25), 0.3, 2.0 * (i / 25)}}, Box{{0.5f, 0.3f, 0.4f}});
        std::vector<BodyId> discs;
        for (int i = 0; i < 40; ++i) discs.push_back(table.add({.position = {-2.0, 0.05, 1.0 * i}}, Cylinder{0.2f, 0.05f}, {.friction = 0.1f}));
        for (int i = 0; i < 140; ++i) {
            for (std::size_t k = 0; i >= 60 && i % 20 == 0 && k < discs.size(); ++k) {
                table.world.set_angular_velocity(discs[k], {50.0 - 2.0 * static_cast<double>(k), 40.0, -30.0 + static_cast<double>(k)});
                table.world.set_linear_velocity(discs[k], {0, 1, 0});
            }
            table.run(1);
        }
        return table.world.state_hash();
    };
    const std::uint64_t expected = hash(nullptr);
    for (const int threads : {2, 8}) {
        OddExecutor executor(threads, [](std::size_t count, const Executor::Body& body) {
            for (std::size_t i = count; i-- > 0;) body(i, i + 1);
        });
        EXPECT_EQ(hash(&executor), expected) << threads;
    }
}

}  // namespace
}  // namespace carom
