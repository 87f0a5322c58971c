// Sleep: what may, what never may, and what it leaves as it was.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr WorldDef kSleeps{.sleep = {.enabled = true}};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Boxes of different sizes in columns that lean on nothing, and some balls and capsules between them.
void fill(Table& table) {
    Random random(411);
    for (int i = 0; i < 60; ++i) {
        const auto half = static_cast<float>(random.range(0.2, 0.3));
        const dvec3 at{1.1 * (i % 5) + random.range(-0.02, 0.02), 0.4 + 0.65 * (i / 20), 1.1 * ((i / 5) % 4) + random.range(-0.02, 0.02)};
        const ShapeDef matter{.density = random.range(300.0, 2000.0), .friction = 0.8f};
        if (i % 7 == 6) {
            table.add({.position = at + dvec3{20.0, 0.0, 0.0}, .angular_damping = 2.0}, Sphere{half}, matter);
        } else {
            table.add({.position = at}, Box{{half, 0.3f, half}}, matter);
        }
    }
}

double farthest(const World& a, const World& b) {
    double most = 0.0;
    for (const BodyId body : a.bodies()) most = std::max(most, glm::length(a.pose(body).position - b.pose(body).position));
    return most;
}

TEST(Sleep, IsOffUnlessAskedFor) {
    Table table;
    table.add({.position = {0, 0.5, 0}}, Box{});
    for (int i = 0; i < 120; ++i) EXPECT_EQ(table.world.step(kDt).asleep, 0u);
    EXPECT_TRUE(table.world.is_awake(table.ground));
    EXPECT_THROW(table.world.put_to_sleep(table.world.bodies()[1]), MisuseError);
}

// The oracle is the same world without sleep. Contacts are found anew in both: where they are kept, all are looked at when somebody falls asleep, which changes where a
// body that rocks comes to lie by up to a millimetre.
TEST(Sleep, PilesStayWhereTheyWouldBeWithout) {
    Table sleeps({.contact_reuse = 0.0, .sleep = {.enabled = true}}), wakes({.contact_reuse = 0.0});
    fill(sleeps), fill(wakes);
    StepReport report;
    for (int i = 0; i < 1200; ++i) {
        report = sleeps.world.step(kDt);
        wakes.world.step(kDt);
    }
    EXPECT_EQ(report.asleep, sleeps.world.body_count() - 1);
    EXPECT_EQ(report.pairs + report.manifolds + report.boxes_given, 0u) << "nothing is left to do";
    // Without sleep piles go on creeping, by less than what counts as still: 1e-3 of 0.4 m in 0.5 s. Most of them stop by themselves.
    EXPECT_LT(farthest(sleeps.world, wakes.world), 1e-4);
}

TEST(Sleep, ChangesNoBitWhileAsleep) {
    Table table(kSleeps);
    fill(table);
    for (int i = 0; i < 600; ++i) table.world.step(kDt);
    std::vector<Pose> poses;
    for (const BodyId body : table.world.bodies()) poses.push_back(table.world.pose(body));
    const std::uint64_t hash = table.world.state_hash();
    const std::size_t contacts = table.world.contact_count();
    for (const double dt : {kDt, 1.0, 1e-3}) table.world.step(dt);
    EXPECT_EQ(table.world.state_hash(), hash);
    EXPECT_EQ(table.world.contact_count(), contacts);
    for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(table.world.pose(table.world.bodies()[i]), poses[i]);
}

TEST(Sleep, KeepsContactsAndImpulses) {
    Table table(kSleeps);
    const BodyId lower = table.add({.position = {0, 0.5, 0}}, Box{vec3{0.5f}}), upper = table.add({.position = {0, 1.5, 0}}, Box{vec3{0.5f}});
    table.run(120);
    ASSERT_FALSE(table.world.is_awake(lower));
    // Whatever the lengths of the steps that pass, they are forces.
    for (int i = 0; i < 9; ++i) table.world.step(i % 2 == 0 ? kDt : 0.1 * kDt);
    ASSERT_EQ(table.world.contact_count(), 2u);
    double under_lower = 0.0, under_upper = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
        const ContactView view = table.world.contact(i);
        for (const float impulse : view.normal_impulse) (view.body_a == upper || view.body_b == upper ? under_upper : under_lower) += static_cast<double>(impulse);
    }
    const double weight = 1000.0 * 9.81 * kDt / table.world.settings().substeps;
    EXPECT_NEAR(under_upper, weight, 0.01 * weight);
    EXPECT_NEAR(under_lower, 2.0 * weight, 0.02 * weight);
}

// The stored impulses carry the pile: the first step after waking is as quiet as the last before.
TEST(Sleep, WakingDoesNotMakePilesJump) {
    Table table(kSleeps);
    fill(table);
    for (int i = 0; i < 10; ++i) {  // a column that is solved directly, and one that would buckle if it were not
        table.add({.position = {-5, 0.5 + i, 0}}, Box{vec3{0.5f}}, {.density = i == 9 ? 1e5 : 1000.0});
    }
    table.run(600);
    for (int round = 0; round < 3; ++round) {
        ASSERT_EQ(table.world.step(kDt).asleep, table.world.body_count() - 1);
        for (const BodyId body : table.world.bodies()) table.world.wake(body);
        double speed = 0.0;
        for (int i = 0; i < 10; ++i) {
            EXPECT_EQ(table.world.step(kDt).asleep, 0u);
            for (const BodyId body : table.world.bodies()) speed = std::max(speed, glm::length(table.world.linear_velocity(body)));
        }
        EXPECT_LT(speed, 0.01 * 9.81 * kDt);  // without its impulses a body falls by g dt in the first step
        table.run(300);
    }
}

TEST(Sleep, NeverTakesThrowsAtTheirApex) {
    Random random(97);
    for (int throw_number = 0; throw_number < 1000; ++throw_number) {
        World world({.sleep = {.enabled = true, .time = random.range(0.01, 2.0), .motion = random.range(1e-6, 0.1)}});
        world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
        const double size = std::exp2(random.range(-6.0, 9.0)), speed = random.range(0.0, 6.0);
        const BodyId body = world.create_body({.position = {0, 2.0 * size + 1.0, 0}, .linear_velocity = {0, speed, 0}, .can_sleep = true});
        world.add_shape(body, Box{vec3{static_cast<float>(size)}});
        // Two that fly together touch and are held by nothing.
        const BodyId rider = world.create_body({.position = {0, 4.0 * size + 1.0, 0}, .linear_velocity = {0, speed, 0}});
        world.add_shape(rider, Box{vec3{static_cast<float>(size)}});
        const double dt = random.range(4e-3, 0.02), flight = speed / 9.81 + std::sqrt(speed * speed / (9.81 * 9.81) + 2.0 / 9.81 * 0.9);
        for (double t = 0.0; t + dt < flight; t += dt) {
            world.step(dt);
            ASSERT_TRUE(world.is_awake(body) && world.is_awake(rider)) << throw_number << " at " << t;
            ASSERT_FALSE(world.put_to_sleep(body)) << throw_number << " at " << t;
        }
        ASSERT_GT(flight, 0.4);
    }
}

// A pencil on its tip: the tilt grows from what it is at the start, however small.
TEST(Sleep, NeverTakesWhatTips) {
    for (const double tilt : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
        Table sleeps(kSleeps), wakes;
        BodyId body;
        for (Table* table : {&sleeps, &wakes}) {
            body = table->add({.position = {0.1 * std::sin(tilt), 0.1 * std::cos(tilt), 0}, .orientation = rotation_from_vector({0, 0, -tilt})}, Capsule{0.0035f, 0.0965f});
        }
        for (int i = 0; i < 600; ++i) {
            sleeps.world.step(kDt);
            wakes.world.step(kDt);
        }
        EXPECT_LT(wakes.world.pose(body).position.y, 0.01) << "it lies";
        EXPECT_LT(sleeps.world.pose(body).position.y, 0.01) << tilt;
        EXPECT_FALSE(sleeps.world.is_awake(body)) << "and sleeps at last";
    }
}

TEST(Sleep, NeverTakesSlowSlides) {
    const double angle = 0.3;
    for (const double speed : {3e-3, 1e-2, 0.1}) {  // damped by 3 1/s, a body without friction comes to g sin(angle) / 3, g by the scale that makes it so
        World world({.sleep = {.enabled = true}});
        world.add_shape(world.create_body({.type = BodyType::Static, .orientation = rotation_from_vector({0, 0, -angle})}), Plane{{0, 1, 0}, 0}, {.friction = 0.0f});
        const dquat turn = rotation_from_vector({0, 0, -angle});
        const BodyId body = world.create_body({.position = rotate(turn, dvec3{0, 0.5, 0}), .orientation = turn,
                                               .gravity_scale = 3.0 * speed / (9.81 * std::sin(angle)), .linear_damping = 3.0});
        world.add_shape(body, Box{vec3{0.5f}});
        for (int i = 0; i < 1200; ++i) {
            world.step(kDt);
            ASSERT_TRUE(world.is_awake(body)) << speed << " m/s, step " << i;
        }
        EXPECT_NEAR(glm::length(world.linear_velocity(body)), speed, 0.02 * speed);
    }
}

// Slides from rest, without friction: one so slight that only its growth tells it from rest, and one of a body so large that in its own size it hardly moves.
TEST(Sleep, NeverTakesSlidesThatBegin) {
    struct Case {
        double angle, half, motion;
    };
    for (const Case& c : {Case{2e-4, 0.5, 1e-3}, Case{0.1, 5000.0, 0.1}}) {
        World world({.sleep = {.enabled = true, .motion = c.motion}});
        const dquat turn = rotation_from_vector({0, 0, -c.angle});
        world.add_shape(world.create_body({.type = BodyType::Static, .orientation = turn}), Plane{{0, 1, 0}, 0}, {.friction = 0.0f});
        const BodyId body = world.create_body({.position = rotate(turn, dvec3{0, c.half, 0}), .orientation = turn});
        world.add_shape(body, Box{vec3{static_cast<float>(c.half)}}, {.friction = 0.0f});
        for (int i = 0; i < 300; ++i) {
            world.step(kDt);
            ASSERT_TRUE(world.is_awake(body)) << c.half << " m, step " << i;
        }
        EXPECT_NEAR(glm::length(world.linear_velocity(body)), 9.81 * std::sin(c.angle) * 5.0, 0.05 * 9.81 * std::sin(c.angle) * 5.0);
    }
}

TEST(Sleep, NeverTakesWhatRides) {
    World world({.sleep = {.enabled = true}});
    const BodyId platform = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {1e-6, 0, 0}});
    world.add_shape(platform, Box{{5, 0.5f, 5}});
    const BodyId rider = world.create_body({.position = {0, 1, 0}});
    world.add_shape(rider, Box{vec3{0.5f}});
    for (int i = 0; i < 300; ++i) {
        world.step(kDt);
        ASSERT_TRUE(world.is_awake(rider)) << i;
        ASSERT_FALSE(world.put_to_sleep(rider));
    }
    world.set_linear_velocity(platform, dvec3{0.0});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_FALSE(world.is_awake(rider));
}

TEST(Sleep, WithoutGravityTakesOnlyWhatDoesNotMove) {
    World world({.gravity = dvec3{0.0}, .sleep = {.enabled = true}});
    const auto add = [&](const BodyDef& def) {
        const BodyId body = world.create_body(def);
        world.add_shape(body, Box{vec3{0.5f}});
        return body;
    };
    const BodyId still = add({}), drifts = add({.position = {5, 0, 0}, .linear_velocity = {1e-9, 0, 0}}), turns = add({.position = {10, 0, 0}, .angular_velocity = {0, 1e-9, 0}});
    const BodyId damped = add({.position = {15, 0, 0}, .linear_velocity = {0.1, 0, 0}, .linear_damping = 2.0});
    const BodyId pulled = add({.position = {20, 0, 0}});
    for (int i = 0; i < 1200; ++i) {
        world.apply_force(pulled, {1e-9, 0, 0}, world.center_of_mass(pulled));
        world.step(kDt);
    }
    EXPECT_FALSE(world.is_awake(still));
    EXPECT_TRUE(world.is_awake(drifts));
    EXPECT_TRUE(world.is_awake(turns));
    EXPECT_TRUE(world.is_awake(pulled));
    EXPECT_FALSE(world.is_awake(damped));
    EXPECT_NEAR(world.pose(damped).position.x, 15.0 + 0.1 / 2.0, 0.5 * 1e-3) << "all but the least of its way is behind it";
}

TEST(Sleep, ATiredIslandStaysAwakeForOneThatIsNot) {
    Table table(kSleeps);
    const BodyId lower = table.add({.position = {0, 0.5, 0}}, Box{vec3{0.5f}});
    const BodyId upper = table.add({.position = {0, 1.5, 0}, .can_sleep = false}, Box{vec3{0.5f}});
    const BodyId apart = table.add({.position = {3, 0.5, 0}}, Box{vec3{0.5f}});
    table.run(300);
    EXPECT_TRUE(table.world.is_awake(lower) && table.world.is_awake(upper));
    EXPECT_FALSE(table.world.is_awake(apart));
    EXPECT_FALSE(table.world.put_to_sleep(lower));
}

// Sizes and times in proportion (Froude): who is asleep when is the same, to the bit.
TEST(Sleep, DoesNotDependOnScale) {
    for (const double scale : {1.0 / 256.0, 1.0 / 16.0, 16.0, 256.0}) {
        Table one(kSleeps);
        const double root = std::sqrt(scale);
        Table other({.sleep = {.enabled = true, .time = 0.5 * root}});
        const BodyId a = one.add({.position = {0, 0.7, 0}, .orientation = rotation_from_vector({0.1, 0.2, 0.1})}, Box{{0.5f, 0.4f, 0.3f}});
        const BodyId b = other.add({.position = {0, 0.7 * scale, 0}, .orientation = rotation_from_vector({0.1, 0.2, 0.1})}, Box{vec3{0.5f, 0.4f, 0.3f} * static_cast<float>(scale)});
        int asleep = 0;
        for (int i = 0; i < 400; ++i) {
            one.world.step(kDt);
            other.world.step(kDt * root);
            ASSERT_EQ(one.world.is_awake(a), other.world.is_awake(b)) << scale << ", step " << i;
            asleep += one.world.is_awake(a) ? 0 : 1;
        }
        EXPECT_GT(asleep, 100);
    }
}

TEST(Sleep, PutsToSleepAtOnceWhatIsAtRest) {
    Table table({.sleep = {.enabled = true, .time = 10.0}});
    const BodyId lower = table.add({.position = {0, 0.5, 0}}, Box{vec3{0.5f}}), upper = table.add({.position = {0, 1.5, 0}}, Box{vec3{0.5f}});
    EXPECT_FALSE(table.world.put_to_sleep(lower)) << "no step has shown that it rests";
    table.run(120);
    EXPECT_TRUE(table.world.is_awake(lower));
    EXPECT_TRUE(table.world.put_to_sleep(upper));
    EXPECT_FALSE(table.world.is_awake(lower)) << "the whole island";
    EXPECT_TRUE(table.world.put_to_sleep(upper)) << "it does already";
    EXPECT_EQ(table.world.linear_velocity(lower), dvec3{0.0});
    const StepReport report = table.world.step(kDt);
    EXPECT_EQ(report.fell_asleep, 2u);
    EXPECT_EQ(report.asleep, 2u);
}

TEST(Sleep, RefusesBadInput) {
    for (const double bad : {-1.0, 0.0, 1e9, kNaN}) {
        EXPECT_THROW(World({.sleep = {.time = bad}}), MisuseError);
        EXPECT_THROW(World({.sleep = {.motion = bad}}), MisuseError);
    }
    Table table(kSleeps);
    const BodyId dead = table.add({}, Sphere{});
    table.world.destroy_body(dead);
    EXPECT_THROW((void)table.world.is_awake(dead), MisuseError);
    EXPECT_THROW(table.world.wake(dead), MisuseError);
    EXPECT_THROW(table.world.put_to_sleep(dead), MisuseError);
    EXPECT_THROW(table.world.put_to_sleep(table.ground), MisuseError);
    EXPECT_THROW(table.world.create_body({.type = BodyType::Static, .can_sleep = false}), MisuseError);
    EXPECT_EQ(table.world.body_count(), 1u);
}

}  // namespace
}  // namespace carom
