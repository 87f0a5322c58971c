// Contacts are kept beside joints, bouncing bodies and sleepers.
#include "table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

namespace carom {
namespace {

using namespace test;

/// Thirty boxes at rest, in pairs one on the other, away from all that happens.
void add_rest(Table& table) {
    for (int i = 0; i < 30; ++i) table.add({.position = {2.0 * (i % 15), i < 15 ? 0.5 : 1.5, -6.0}}, Box{{0.5f, 0.5f, 0.5f}});
}

struct Kept {
    std::size_t pairs = 0, reused = 0;
    StepReport last;
};

Kept run(Table& table, int steps) {
    Kept kept;
    for (int i = 0; i < steps; ++i) {
        kept.last = table.world.step(kDt);
        kept.pairs += kept.last.pairs, kept.reused += kept.last.reused;
    }
    return kept;
}

/// The farthest that a body of one is from that of the other [m].
double apart(const World& a, const World& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.bodies().size(); ++i) {
        most = std::max(most, glm::length(a.center_of_mass(a.bodies()[i]) - b.center_of_mass(b.bodies()[i])));
    }
    return most;
}

bool has_contact(const World& world, BodyId a, BodyId b) {
    for (std::size_t c = 0; c < world.contact_count(); ++c) {
        const BodyId one = world.body_of(world.contact(c).shape_a), other = world.body_of(world.contact(c).shape_b);
        if ((one == a && other == b) || (one == b && other == a)) return true;
    }
    return false;
}

// What the last contact has left is nobody's but the joints'.
TEST(KeptBeside, JoinedBodiesThrownUpFlyAsOne) {
    Table table({.contact_method = ContactMethod::Soft});
    add_rest(table);
    const BodyId a = table.add({.position = {0, 0.5, 0}}, Sphere{0.5f}), b = table.add({.position = {1.1, 0.5, 0}}, Sphere{0.5f});
    table.world.create_joint(BallJointDef{.body_a = a, .body_b = b, .anchor_a = {0.55, 0, 0}, .anchor_b = {-0.55, 0, 0}});
    table.run(120);
    for (const BodyId body : {a, b}) table.world.set_linear_velocity(body, {0, 4, 0});
    table.run(4);
    const auto height = [&] { return 0.5 * (table.world.center_of_mass(a).y + table.world.center_of_mass(b).y); };
    const double y = height(), v = 0.5 * (table.world.linear_velocity(a).y + table.world.linear_velocity(b).y);
    for (int i = 1; i <= 30; ++i) {
        EXPECT_GT(table.world.step(kDt).reused, 25u);
        EXPECT_NEAR(height(), y + v * i * kDt - 0.5 * 9.81 * i * kDt * i * kDt, 1e-12);
    }
}

// A hinge of two ball joints on the ground, a rope that lies on it with its end in the air, and a door that swings.
TEST(KeptBeside, JointsHoldAsTheyDoWithoutThem) {
    const auto world = [](double reuse) {
        Table table({.contact_reuse = reuse, .contact_method = ContactMethod::Soft});
        add_rest(table);
        const BodyId a = table.add({.position = {0, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}}),
                     b = table.add({.position = {1.1, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
        for (const double z : {-0.4, 0.4}) {
            table.world.create_joint(BallJointDef{.body_a = a, .body_b = b, .anchor_a = {0.55, 0.4, z}, .anchor_b = {-0.55, 0.4, z}});
        }
        BodyId last;
        for (int i = 0; i < 8; ++i) {
            const BodyId link = table.add({.position = {4.0 + 0.5 * i, 0.1, 0}}, Box{{0.2f, 0.1f, 0.1f}});
            if (last)
                table.world.create_joint(BallJointDef{.body_a = last, .body_b = link, .anchor_a = {0.25, 0, 0}, .anchor_b = {-0.25, 0, 0}});
            last = link;
        }
        table.world.create_joint(BallJointDef{.body_a = last, .anchor_a = {0.2, 0, 0}, .anchor_b = {7.7, 0.5, 0}});
        const BodyId door = table.add({.position = {-5, 3, 0}, .angular_velocity = {0, 1, 0}}, Box{{0.5f, 1.0f, 0.05f}});
        for (const double y : {-0.9, 0.9})
            table.world.create_joint(BallJointDef{.body_a = door, .anchor_a = {-0.5, y, 0}, .anchor_b = {-5.5, 3 + y, 0}});
        return table;
    };
    Table kept = world(WorldDef{}.contact_reuse), anew = world(0.0);
    run(kept, 240), run(anew, 240);
    const Kept a = run(kept, 60), b = run(anew, 60);
    EXPECT_GT(10 * a.reused, 9 * a.pairs) << a.reused << " of " << a.pairs;
    EXPECT_EQ(b.reused, 0u);
    EXPECT_LT(apart(kept.world, anew.world), 2e-4);
    EXPECT_LT(a.last.joints.worst_gap, 1e-9);
    EXPECT_EQ(a.last.joints.in_contact, 2u);
    EXPECT_LT(a.last.max_penetration, 1.5 * b.last.max_penetration);
    constexpr std::size_t kHung = 6;   // the first of the rope's end, which is lifted off: no friction has a say in it
    constexpr std::size_t kDoor = 10;  // the first of its joints; those before are of what lies on the ground
    for (std::size_t j = 0; j < kept.world.joints().size(); ++j) {
        const dvec3 one = kept.world.joint_state(kept.world.joints()[j]).force,
                    other = anew.world.joint_state(anew.world.joints()[j]).force;
        if (j >= kDoor) {
            EXPECT_EQ(one, other) << j << ": nothing touches the door";
        } else if (j >= kHung) {
            EXPECT_LT(glm::length(one - other), 1.0) << j << ": a 150th of a link's weight";
        } else {
            EXPECT_LT(glm::length(one - other), 10.0) << j << ": a tenth of what friction holds of a link, so much of which is anybody's";
        }
    }
}

// A joint that leaves contacts out does so at once, and they are there when it goes.
TEST(KeptBeside, AJointThatPartsLeavesNoContactBehind) {
    Table table({.contact_method = ContactMethod::Soft});
    add_rest(table);
    const BodyId low = table.add({.position = {0, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}}),
                 top = table.add({.position = {0, 1.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    table.run(90);
    const auto touches = [&] { return has_contact(table.world, low, top); };
    ASSERT_TRUE(touches());
    SpringDef spring{.body_a = low, .body_b = top, .rest_length = 0.999, .stiffness = 1e7, .damping = 1e4};
    const JointId joint = table.world.create_joint(spring);
    table.run(1);
    EXPECT_FALSE(touches()) << "created";
    spring.collide_connected = true;
    table.world.set_joint(joint, spring);
    table.run(1);
    EXPECT_TRUE(touches()) << "changed";
    spring.collide_connected = false;
    table.world.set_joint(joint, spring);
    table.run(60);
    EXPECT_FALSE(touches()) << "changed back";
    table.world.destroy_joint(joint);
    table.run(1);
    EXPECT_TRUE(touches()) << "destroyed";
}

TEST(KeptBeside, ABallBouncesForEver) {
    Table table({.contact_method = ContactMethod::Soft});
    add_rest(table);
    const BodyId ball = table.add({.position = {0, 1.5, 0}}, Sphere{0.5f}, {.friction = 0.0f, .restitution = 1.0f});
    run(table, 120);
    std::size_t bounces = 0;
    Kept kept;
    for (int i = 0; i < 3000; ++i) {
        const StepReport report = table.world.step(kDt);
        bounces += report.impacts, kept.pairs += report.pairs, kept.reused += report.reused;
    }
    const double v = table.world.linear_velocity(ball).y;
    EXPECT_GT(bounces, 50u);
    EXPECT_NEAR(table.world.pose(ball).position.y + v * v / (2.0 * 9.81), 1.5, 1e-10);
    EXPECT_GT(20 * kept.reused, 19 * kept.pairs);
}

// All bounce: what rests is kept, and what falls on it bounces as high as it does where nothing is.
TEST(KeptBeside, WhatBouncesAndRestsIsKeptToo) {
    const auto run_one = [](double reuse, Kept& kept) {
        Table table({.contact_reuse = reuse});
        for (int i = 0; i < 30; ++i) table.add({.position = {2.0 * i, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}}, {.restitution = 0.3f});
        const BodyId ball =
            table.add({.position = {10.0, 4.0, 0}}, Sphere{0.3f}, {.density = 100.0, .friction = 0.0f, .restitution = 0.8f});
        std::vector<double> apexes;
        double speed = 0.0;
        for (int i = 0; i < 500; ++i) {
            const StepReport report = table.world.step(kDt);
            if (i >= 60) kept.pairs += report.pairs, kept.reused += report.reused;
            const double now = table.world.linear_velocity(ball).y;
            if (speed > 0.0 && now <= 0.0) apexes.push_back(table.world.pose(ball).position.y);
            speed = now;
        }
        return apexes;
    };
    Kept a, b;
    const std::vector<double> kept = run_one(WorldDef{}.contact_reuse, a), anew = run_one(0.0, b);
    EXPECT_GT(10 * a.reused, 8 * a.pairs);
    ASSERT_GE(anew.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(kept.at(i), anew[i], 0.01 * (anew[i] - 1.3) + 1e-3) << i;
}

// It comes to rest on a box, is thrown up, flies and bounces again; contacts begin and end to fly, and the rest stays.
TEST(KeptBeside, WhatComesToRestAndIsThrownUpAgain) {
    Table table({.contact_method = ContactMethod::Soft});
    add_rest(table);
    const BodyId ball = table.add({.position = {0, 1.5, 0}}, Sphere{0.5f}, {.restitution = 0.5f});
    for (int round = 0; round < 3; ++round) {
        run(table, 200);
        EXPECT_NEAR(table.world.pose(ball).position.y, 0.5, 1e-3) << round;
        EXPECT_LT(glm::length(table.world.linear_velocity(ball)), 1e-3) << round;
        EXPECT_GT(table.world.step(kDt).reused, 25u);
        const double y = table.world.center_of_mass(ball).y, v = 4.0;
        table.world.set_linear_velocity(ball, {0, v, 0});
        for (int i = 1; i <= 34; ++i) {  // from the first step on, though its contact lay in a lane
            run(table, 1);
            EXPECT_NEAR(table.world.center_of_mass(ball).y, y + v * i * kDt - 0.5 * 9.81 * i * kDt * i * kDt, 1e-13) << i;
        }
    }
}

// What bounces is put where its blows left it when the solver is done: what it rests on is not as the solver had it, though it has moved by next to nothing.
TEST(KeptBeside, WhatABounceMovesIsLookedAt) {
    Table table({.contact_method = ContactMethod::Soft});
    for (int i = 0; i < 20; ++i) table.add({.position = {0, 0.5, 3.0 * i}}, Box{{0.5f, 0.5f, 0.5f}}, {.density = 1e6});
    table.run(120);
    for (int i = 0; i < 3; ++i) table.add({.position = {0.2, 2.0, 3.0 * i}}, Sphere{0.1f}, {.restitution = 0.8f});
    bool struck = false;
    for (int i = 0; i < 60 && !struck; ++i) struck = table.world.step(kDt).impacts == 3;
    ASSERT_TRUE(struck);
    const StepReport report = table.world.step(kDt);
    EXPECT_GE(report.pairs - report.reused, 3u) << "each box and the ground: the balls have left";
    EXPECT_GE(report.reused, 17u);
}

Table with_sleepers(double reuse) {
    Table table({.contact_reuse = reuse, .contact_method = ContactMethod::Soft, .sleep = {.enabled = true}});
    for (int i = 0; i < 30; ++i)
        table.add({.position = {2.0 * (i % 15), i < 15 ? 0.5 : 1.5, -6.0}, .can_sleep = false}, Box{{0.5f, 0.5f, 0.5f}});
    for (int i = 0; i < 5; ++i) table.add({.position = {0, 0.5 + i, 0}, .name = "stack"}, Box{{0.5f, 0.5f, 0.5f}});
    for (int i = 0; i < 5; ++i) table.add({.position = {4.0 + 2.0 * i, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    table.run(240);
    return table;
}

// What wakes has its contacts and impulses, whatever wakes it: the stack stands as it stood.
TEST(KeptBeside, SleepersComeBackAsTheyWere) {
    struct Waking {
        const char* name;
        std::function<void(Table& table, BodyId top)> happens;
        double moves;
    };
    const Waking wakings[] = {
        {"it is woken", [](Table& t, BodyId top) { t.world.wake(top); }, 2e-5},
        {"a ball lands on it",
         [](Table& t, BodyId) {
             t.add({.position = {0.1, 5.3, 0}}, Sphere{0.2f}, {.density = 100.0});
         },
         1e-3},
        {"its neighbour is pushed away",
         [](Table& t, BodyId top) {
             t.world.apply_impulse(top, {0, 0, 1e3}, t.world.center_of_mass(top));
         },
         0.05},
    };
    for (const Waking& waking : wakings) {
        Table kept = with_sleepers(WorldDef{}.contact_reuse), anew = with_sleepers(0.0);
        ASSERT_EQ(kept.world.step(kDt).asleep, 10u) << waking.name;
        const Kept before = run(kept, 60);
        EXPECT_GT(10 * before.reused, 9 * before.pairs);
        run(anew, 61);
        std::vector<dvec3> stood;
        const auto highest_of_rest = [&] { return kept.world.center_of_mass(kept.world.bodies()[30]).y; };
        const double rest = highest_of_rest();
        for (std::size_t i = 31; i < 36; ++i) stood.push_back(kept.world.center_of_mass(kept.world.bodies()[i]));
        for (Table* table : {&kept, &anew}) waking.happens(*table, table->world.bodies()[35]);
        double deepest = 0.0;
        std::size_t woken = 0;
        for (int i = 0; i < 20; ++i) {
            const StepReport report = kept.world.step(kDt);
            deepest = std::max(deepest, report.max_penetration), woken += report.woken;
            EXPECT_NEAR(highest_of_rest(), rest, 1e-7) << waking.name << ": the others keep their impulses";
        }
        EXPECT_EQ(woken, 5u) << waking.name;
        EXPECT_LT(deepest, waking.moves < 1e-4 ? 4e-4 : 2e-3) << waking.name;
        run(anew, 20);
        for (std::size_t i = 0; i < 4; ++i) {  // but for the one on top
            EXPECT_LT(glm::length(kept.world.center_of_mass(kept.world.bodies()[31 + i]) - stood[i]), waking.moves)
                << waking.name << ", " << i;
        }
        EXPECT_LT(apart(kept.world, anew.world), 0.05 * waking.moves + 1e-4) << waking.name;
    }
}

TEST(KeptBeside, WhatIsPutToSleepAndWokenInTurnsLeavesNothingBehind) {
    Table table = with_sleepers(WorldDef{}.contact_reuse);
    const std::vector<BodyId> bodies(table.world.bodies().begin(), table.world.bodies().end());
    std::size_t reused = 0;
    for (int round = 0; round < 12; ++round) {
        const BodyId one = bodies[static_cast<std::size_t>(31 + round % 10)];
        table.world.is_awake(one) ? static_cast<void>(table.world.put_to_sleep(one)) : table.world.wake(one);
        for (int i = 0; i < 3; ++i) {
            reused += table.world.step(kDt).reused;
            std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
            for (std::size_t c = 0; c < table.world.contact_count(); ++c) {
                const ContactView view = table.world.contact(c);
                EXPECT_TRUE(seen.insert({view.shape_a.slot, view.shape_b.slot}).second) << "a contact is there twice";
            }
            EXPECT_EQ(seen.size(), 15u + 15u + 5u + 5u);
        }
    }
    EXPECT_GT(reused, 24u * 25u);
    EXPECT_NEAR(table.world.pose(bodies[35]).position.y, 4.5, 1e-3);
}

}  // namespace
}  // namespace carom
