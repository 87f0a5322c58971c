// Contacts that are kept while all sorts of things happen.
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/explain.hpp>

#include "odd_executors.hpp"
#include "table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

namespace carom {
namespace {

using namespace test;

bool has_contact(const World& world, BodyId a, BodyId b) {
    for (std::size_t c = 0; c < world.contact_count(); ++c) {
        const BodyId one = world.body_of(world.contact(c).shape_a), other = world.body_of(world.contact(c).shape_b);
        if ((one == a && other == b) || (one == b && other == a)) return true;
    }
    return false;
}

/// Boxes and balls that bounce, joints that come and go, sleepers, and whatever else somebody may do, by a seed.
class Churn {
public:
    explicit Churn(Executor* executor, std::uint64_t seed)
        : table(
              {.executor = executor, .plan = executor == nullptr ? PlanMode::Automatic : PlanMode::Everything, .sleep = {.enabled = true}}),
          random_(seed) {
        for (int i = 0; i < 40; ++i) add({2.0 * (i % 8), 0.5 + 1.1 * (i / 32), 2.0 * ((i / 8) % 4)}, i % 5);
        table.run(60);
    }

    StepReport step() {
        if (random_.range(0.0, 1.0) < 0.15) act(static_cast<int>(random_.range(0.0, 10.0)));
        return table.world.step(kDt);
    }

    Table table;

private:
    void add(const dvec3& at, int kind) {
        const ShapeDef def{.restitution = kind == 1 ? 0.7f : 0.0f};
        const BodyDef body{.position = at, .can_sleep = kind != 0};
        if (kind == 1 || kind == 2)
            table.add(body, Sphere{0.4f}, def);
        else
            table.add(body, Box{{0.5f, 0.4f, 0.5f}}, def);
    }
    BodyId any() {
        const std::span<const BodyId> bodies = table.world.bodies();
        return bodies[1 + static_cast<std::size_t>(random_.range(0.0, static_cast<double>(bodies.size() - 1)))];
    }
    BodyId nearest(BodyId to) {
        const auto bodies = table.world.bodies().subspan(1);
        return *std::ranges::min_element(bodies, {}, [&](BodyId body) {
            return body == to ? 1e9 : glm::length(table.world.center_of_mass(body) - table.world.center_of_mass(to));
        });
    }
    void act(int what) {
        World& w = table.world;
        const BodyId a = any();
        const dvec3 here = w.center_of_mass(a), up{0, 2.5, 0};
        switch (what) {
            case 0:
                w.apply_impulse(a, w.mass_properties(a).mass * dvec3{random_.range(-2.0, 2.0), 3, 0}, here);
                break;
            case 1:
                if (w.bodies().size() > 25) w.destroy_body(a);
                break;
            case 2:
                add({random_.range(0.0, 14.0), 4.0, random_.range(0.0, 6.0)}, static_cast<int>(random_.range(0.0, 5.0)));
                break;
            case 3:
                w.set_pose(a, {here + up, kIdentityRotation});
                break;
            case 4: {
                const BodyId b = nearest(a);
                const dvec3 middle = 0.5 * (here + w.center_of_mass(b));
                const auto local = [&](BodyId body) { return glm::conjugate(w.pose(body).orientation) * (middle - w.pose(body).position); };
                w.create_joint(BallJointDef{.body_a = a,
                                            .body_b = b,
                                            .anchor_a = local(a),
                                            .anchor_b = local(b),
                                            .collide_connected = random_.range(0.0, 1.0) < 0.3});
            } break;
            case 5:
                if (!w.joints().empty()) w.destroy_joint(w.joints()[0]);
                break;
            case 6:
                w.wake(a);
                break;
            case 7:
                static_cast<void>(w.put_to_sleep(a));
                break;
            case 8:
                w.add_shape(a, Box{{0.1f, 0.1f, 0.1f}}, {.restitution = 0.5f, .local = {{0, 0.5, 0}, kIdentityRotation}});
                break;
            default:
                w.set_gravity_scale(a, random_.range(-0.2, 1.0));
                break;
        }
    }
    Random random_;
};

// explain() measures each pair where it is, and holds what the step has of it against that.
TEST(KeptChurn, WhateverHappensContactsAreThoseOfThePoses) {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        Churn churn(nullptr, seed);
        std::size_t kept = 0, asleep = 0, impacts = 0, joints = 0;
        for (int i = 0; i < 400; ++i) {
            const StepReport report = churn.step();
            kept += 2 * report.reused > report.pairs ? 1 : 0, asleep += report.asleep > 0 ? 1 : 0, impacts += report.impacts;
            joints += report.joints.in_contact;
            const World& w = churn.table.world;
            for (std::size_t c = 0; c < w.contact_count(); ++c) {
                const ContactView view = w.contact(c);
                ASSERT_TRUE(w.is_alive(view.shape_a) && w.is_alive(view.shape_b)) << i;
                for (const JointId joint : w.joints()) {
                    const BallJointDef& def = std::get<BallJointDef>(w.joint_def(joint));
                    ASSERT_TRUE(def.collide_connected || !has_contact(w, def.body_a, def.body_b)) << i;
                }
            }
            if (i % 10 != 9) continue;
            for (std::size_t a = 0; a < w.bodies().size(); ++a) {
                for (std::size_t b = a + 1; b < w.bodies().size(); ++b) {
                    const ContactExplanation why = w.explain(w.bodies()[a], w.bodies()[b]);
                    ASSERT_TRUE(why.disagreements.empty()) << why.disagreements.front() << " seed " << seed << ", step " << i;
                }
            }
        }
        EXPECT_GT(kept, 60u) << seed;
        EXPECT_GT(asleep, 60u) << seed;
        EXPECT_GT(impacts, 10u) << seed;
        EXPECT_GT(joints, 20u) << seed;
    }
}

TEST(KeptChurn, AllOfItHasTheSameBitsOnAllThreadsAndWidths) {
    const auto hashes = [](Executor* executor, int width) {
        set_simd_width(width);
        Churn churn(executor, 7);
        std::vector<std::uint64_t> out;
        for (int i = 0; i < 250; ++i) {
            churn.step();
            out.push_back(churn.table.world.state_hash());
        }
        set_simd_width(0);
        return out;
    };
    OddExecutor one(1, [](std::size_t count, const Executor::Body& body) { body(0, count); });
    const std::vector<std::uint64_t> expected = hashes(&one, 0);
    for (const int width : available_simd_widths()) EXPECT_EQ(hashes(&one, width), expected) << width;
    for (const int threads : {2, 3}) {
        OddExecutor executor(threads, [](std::size_t count, const Executor::Body& body) { in_threads(count, body, false); });
        EXPECT_EQ(hashes(&executor, 0), expected) << threads << " threads";
    }
}

// Two boxes lose a wall on one side as another comes to them on the other: contacts end and begin in one step. So many boxes lie there that all lanes of the colour are
// taken: the new ones get those that the old ones had.
TEST(KeptChurn, ALaneThatIsFreedAndTakenAgainHasTheNewContact) {
    Table table({.contact_method = ContactMethod::Soft});
    std::vector<BodyId> boxes, walls;
    const auto at = [](int i) { return dvec3{4.0 * (i % 20), 0.5, 4.0 * (i / 20)}; };
    for (int i = 0; i < 398; ++i) boxes.push_back(table.add({.position = at(i)}, Box{{0.5f, 0.5f, 0.5f}}));
    for (int i = 0; i < 18; ++i) {
        const dvec3 beside = at(i % 16) + dvec3{i < 16 ? 0.6 : -0.62, 0.1, 0};
        walls.push_back(table.add({.type = BodyType::Kinematic, .position = beside}, Box{{0.1f, 0.5f, 0.4f}}));
        if (i >= 16) table.add({.position = beside + dvec3{0, 0.55, 0}}, Box{{0.05f, 0.05f, 0.05f}});  // so that the solver has the wall already
    }
    const auto move = [&](std::size_t first, double speed) {
        for (const std::size_t i : {first, first + 1}) table.world.set_linear_velocity(walls[i], {speed, 0, 0});
    };
    table.run(100);
    ASSERT_EQ(table.world.contact_count(), 398u + 16u + 2u);
    move(0, 0.02 / kDt);
    table.run(1);
    move(0, 0.0), move(16, 0.04 / kDt);
    const StepReport report = table.world.step(kDt);
    EXPECT_GT(report.reused, 380u);
    EXPECT_EQ(report.manifolds, 398u + 16u + 2u);
    for (const std::size_t i : {0u, 1u}) EXPECT_GT(table.world.linear_velocity(boxes[i]).x, 1.0) << i;
}

// Everything that touched goes in one step: no contact is left, and none is counted.
TEST(KeptChurn, NoContactIsLeftOfNothing) {
    Table table;
    for (int i = 0; i < 2; ++i) table.add({.type = BodyType::Static, .position = {20.0 + 5.0 * i, 0, 0}}, Box{});
    const BodyId ball = table.add({.position = {0, 0.5, 0}}, Sphere{0.5f});
    table.run(60);
    ASSERT_EQ(table.world.contact_count(), 1u);
    table.world.set_linear_velocity(ball, {0, 5, 0});
    for (int i = 0; i < 5; ++i) {
        const StepReport report = table.world.step(kDt);
        EXPECT_EQ(report.manifolds, report.contacts) << i;
        EXPECT_EQ(table.world.contact_count(), report.manifolds) << i;
        for (std::size_t k = 0; k < table.world.contact_count(); ++k) EXPECT_EQ(table.world.contact(k).manifold.count, 1u);
    }
    EXPECT_EQ(table.world.contact_count(), 0u);
}

}  // namespace
}  // namespace carom
