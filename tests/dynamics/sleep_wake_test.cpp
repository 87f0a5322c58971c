// What wakes an island: each reason by itself, and that a woken body is hit like any other.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/explain.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr WorldDef kSleeps{.sleep = {.enabled = true}};

/// Two columns of two boxes on a table of each kind: a plane, a static box, and a kinematic box that stands still. All asleep.
struct Columns {
    World world{kSleeps};
    BodyId plane, slab, lift;
    BodyId on_plane[2], on_slab[2], on_lift[2];

    Columns() {
        plane = world.create_body({.type = BodyType::Static});
        world.add_shape(plane, Plane{{0, 1, 0}, 0});
        slab = world.create_body({.type = BodyType::Static, .position = {10, 0.5, 0}});
        world.add_shape(slab, Box{{2, 0.5f, 2}});
        lift = world.create_body({.type = BodyType::Kinematic, .position = {20, 0.5, 0}});
        world.add_shape(lift, Box{{2, 0.5f, 2}});
        for (int i = 0; i < 2; ++i) {
            on_plane[i] = box({0, 0.5 + i, 0});
            on_slab[i] = box({10, 1.5 + i, 0});
            on_lift[i] = box({20, 1.5 + i, 0});
        }
        for (int i = 0; i < 120; ++i) world.step(kDt);
    }
    BodyId box(const dvec3& at) {
        const BodyId body = world.create_body({.position = at});
        world.add_shape(body, Box{vec3{0.5f}});
        return body;
    }
    [[nodiscard]] std::string awake() const {
        std::string names;
        if (world.is_awake(on_plane[0]) || world.is_awake(on_plane[1])) names += "plane ";
        if (world.is_awake(on_slab[0]) || world.is_awake(on_slab[1])) names += "slab ";
        if (world.is_awake(on_lift[0]) || world.is_awake(on_lift[1])) names += "lift ";
        return names;
    }
};

/// @return who is awake after `act` and a step.
std::string woken_by(const std::function<void(Columns&)>& act) {
    Columns c;
    EXPECT_EQ(c.awake(), "");
    act(c);
    const StepReport report = c.world.step(kDt);
    EXPECT_EQ(report.asleep + report.woken, 6u);
    return c.awake();
}

TEST(Wake, ByEveryCallThatChangesTheBody) {
    using Act = std::function<void(World&, BodyId)>;
    const std::vector<std::pair<const char*, Act>> acts{
        {"wake", [](World& w, BodyId b) { w.wake(b); }},
        {"force", [](World& w, BodyId b) { w.apply_force(b, {1, 0, 0}, w.center_of_mass(b)); }},
        {"torque", [](World& w, BodyId b) { w.apply_torque(b, {0, 1, 0}); }},
        {"impulse", [](World& w, BodyId b) { w.apply_impulse(b, {1, 0, 0}, w.center_of_mass(b)); }},
        {"velocity", [](World& w, BodyId b) { w.set_linear_velocity(b, {0, 0, 1}); }},
        {"spin", [](World& w, BodyId b) { w.set_angular_velocity(b, {0, 1, 0}); }},
        {"pose", [](World& w, BodyId b) { w.set_pose(b, {w.pose(b).position + dvec3{0, 0, 0.1}, w.pose(b).orientation}); }},
        {"mass", [](World& w, BodyId b) { w.set_mass_properties(b, {5.0, dvec3{0.0}, dmat3{1.0}}); }},
        {"gravity scale", [](World& w, BodyId b) { w.set_gravity_scale(b, -1.0); }},
        {"damping", [](World& w, BodyId b) { w.set_damping(b, 1.0, 0.0); }},
        {"locked axes", [](World& w, BodyId b) { w.set_locked_axes(b, LockedAxes::MoveX); }},
        {"shape", [](World& w, BodyId b) { w.add_shape(b, Sphere{0.1f}); }},
        {"destroy", [](World& w, BodyId b) { w.destroy_body(b); }},
    };
    for (const auto& [name, act] : acts) {
        for (const int which : {0, 1}) {
            Columns c;
            ASSERT_EQ(c.awake(), "");
            act(c.world, c.on_slab[which]);
            const StepReport report = c.world.step(kDt);
            EXPECT_EQ(report.woken, 2u) << name;
            EXPECT_EQ(report.asleep, 4u) << name;
            EXPECT_TRUE(c.world.is_awake(c.on_slab[1 - which])) << name;
        }
    }
}

TEST(Wake, ByWhatLiesUnder) {
    EXPECT_EQ(woken_by([](Columns& c) { c.world.destroy_body(c.plane); }), "plane ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.destroy_body(c.slab); }), "slab ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.destroy_body(c.lift); }), "lift ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.slab, {{10, 0.4, 0}, kIdentityRotation}); }), "slab ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.lift, {{20, 0.4, 0}, kIdentityRotation}); }), "lift ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.plane, {{0, -0.1, 0}, kIdentityRotation}); }), "plane ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_linear_velocity(c.lift, {0, -1e-3, 0}); }), "lift ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_angular_velocity(c.lift, {0, 1e-3, 0}); }), "lift ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.wake(c.slab); }), "slab ");
    // What goes into quarantine supports nobody.
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_linear_velocity(c.lift, {0, 1e300, 0}); }), "lift ");
}

TEST(Wake, ByWhatIsPutThere) {
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.slab, {{0, 2.4, 0}, kIdentityRotation}); }), "plane slab ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.lift, {{0, 2.4, 0}, kIdentityRotation}); }), "plane lift ");
    EXPECT_EQ(woken_by([](Columns& c) { c.world.set_pose(c.plane, {{0, 2.4, 0}, kIdentityRotation}); }), "plane slab lift ");
    EXPECT_EQ(woken_by([](Columns& c) {
                  c.world.add_shape(c.world.create_body({.type = BodyType::Static, .position = {20.3, 2.0, 0.3}}), Sphere{0.5f});
              }),
              "lift ");
    EXPECT_EQ(woken_by([](Columns& c) {
                  c.world.add_shape(c.world.create_body({.type = BodyType::Static, .position = {0, 0, 8}}), Sphere{0.5f});
              }),
              "") << "what is far away wakes nobody";
    // A plane that comes nearer.
    Columns c;
    const BodyId wall = c.world.create_body({.type = BodyType::Kinematic, .position = {-3, 0, 0}, .linear_velocity = {1, 0, 0}});
    c.world.add_shape(wall, Plane{{1, 0, 0}, 0});
    int steps = 0;
    for (; steps < 300 && c.awake().empty(); ++steps) c.world.step(kDt);
    EXPECT_NEAR(steps * kDt, 2.5, 0.5) << "it is 2.5 m away from the box, by whose bounding sphere it goes";
    EXPECT_EQ(c.awake(), "plane ");
}

TEST(Wake, ByWhatComes) {
    for (const BodyType type : {BodyType::Dynamic, BodyType::Kinematic}) {
        Columns c;
        const BodyId ball = c.world.create_body({.type = type, .position = {-4, 0.6, 0}, .linear_velocity = {2, 0, 0}});
        c.world.add_shape(ball, Sphere{0.5f}, {.friction = 0.0f});
        std::size_t woken = 0;
        int steps = 0;
        for (; steps < 200 && woken == 0; ++steps) woken = c.world.step(kDt).woken;
        EXPECT_EQ(woken, 2u);
        EXPECT_NEAR(steps * kDt, 1.5, 0.1) << "when it is there, not before";
        EXPECT_EQ(c.awake(), "plane ");
    }
}

// Momentum goes over in the step of the hit, as it would without sleep: both balls, one asleep, against the same without.
TEST(Wake, IsHitAsIfItHadNeverSlept) {
    for (const float restitution : {0.0f, 1.0f}) {
        Table sleeps(kSleeps, 0.0f), wakes({}, 0.0f);
        BodyId target, ball;
        for (Table* table : {&sleeps, &wakes}) {
            target = table->add({.position = {0, 0.5, 0}}, Sphere{0.5f}, {.friction = 0.0f, .restitution = restitution});
            table->run(120);
            ball = table->add({.position = {-2, 0.5, 0}, .linear_velocity = {3, 0, 0}}, Sphere{0.5f}, {.friction = 0.0f, .restitution = restitution});
        }
        ASSERT_FALSE(sleeps.world.is_awake(target));
        for (int i = 0; i < 60; ++i) {
            sleeps.world.step(kDt);
            wakes.world.step(kDt);
            for (const BodyId body : {target, ball}) {
                EXPECT_NEAR(sleeps.world.linear_velocity(body).x, wakes.world.linear_velocity(body).x, 1e-5) << i;
                EXPECT_NEAR(sleeps.world.pose(body).position.x, wakes.world.pose(body).position.x, 1e-5) << i;
            }
        }
        EXPECT_TRUE(sleeps.world.is_awake(target));
        EXPECT_NEAR(sleeps.world.momentum().linear.x, wakes.world.momentum().linear.x, 1e-3);
    }
}

TEST(Wake, FallsWhenItsSupportIsGone) {
    Columns c;
    c.world.destroy_body(c.slab);
    for (int i = 0; i < 60; ++i) c.world.step(kDt);
    EXPECT_LT(c.world.pose(c.on_slab[0]).position.y, 0.6);
    EXPECT_LT(c.world.pose(c.on_slab[1]).position.y, 1.6);
}

// Rows of columns that fall asleep and are knocked about again, by every kind of wake.
World shaken(Executor* executor, BroadphaseMethod method, PlanMode plan, std::vector<std::uint64_t>& hashes) {
    World world({.executor = executor, .broadphase = method, .plan = plan, .sleep = {.enabled = true, .time = 0.2, .motion = 1e-3}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
    const BodyId slab = world.create_body({.type = BodyType::Static, .position = {0, 0.2, 0}});
    world.add_shape(slab, Box{{3, 0.2f, 3}});
    const BodyId sweeper = world.create_body({.type = BodyType::Kinematic, .position = {-9, 0.3, 0}});
    world.add_shape(sweeper, Box{{0.3f, 0.3f, 4}});
    Random random(12);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 48; ++i) {
        bodies.push_back(world.create_body({.position = {1.5 * (i % 6) - 4.0, 0.9 + 0.9 * (i / 24), 1.5 * ((i / 6) % 4) - 2.0}}));
        const ShapeDef matter{.restitution = i % 5 == 0 ? 0.3f : 0.0f};
        switch (i % 3) {
            case 0: world.add_shape(bodies.back(), Box{vec3{0.4f}}, matter); break;
            case 1: world.add_shape(bodies.back(), Cylinder{0.4f, 0.4f}, matter); break;
            default: world.add_shape(bodies.back(), Capsule{0.3f, 0.2f}, matter); break;
        }
    }
    std::size_t fell = 0, woke = 0;
    for (int i = 0; i < 500; ++i) {
        if (i == 150) world.set_linear_velocity(sweeper, {1.5, 0, 0});
        if (i == 260) world.set_linear_velocity(sweeper, dvec3{0.0});
        if (i == 300) world.set_pose(slab, {{0, 0.1, 0}, kIdentityRotation});
        if (i == 380) world.destroy_body(bodies[7]);
        if (i == 400) world.destroy_body(slab);
        if (i % 40 == 39) world.apply_impulse(bodies[static_cast<std::size_t>(random.range(8.0, 48.0))], {0, 200, 30}, dvec3{0.0});
        const StepReport report = world.step(i % 90 == 89 ? 0.5 * kDt : kDt);
        fell += report.fell_asleep;
        woke += report.woken;
        hashes.push_back(world.state_hash());
    }
    EXPECT_GT(fell, 100u);
    EXPECT_GT(woke, 60u);
    return world;
}

/// Two threads that take turns from the far end.
class BackwardsExecutor final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 2; }
    void parallel_for(std::size_t count, std::size_t grain, Body body) override {
        for (std::size_t pieces = (count + grain - 1) / grain; pieces-- > 0;) body(pieces * grain, std::min(count, (pieces + 1) * grain));
    }
};

TEST(Wake, SameBitsInEveryOrderWithEveryBroadphasePlanAndWidth) {
    std::vector<std::uint64_t> usual;
    shaken(nullptr, BroadphaseMethod::Automatic, PlanMode::Automatic, usual);
    BackwardsExecutor backwards;
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        std::vector<std::uint64_t> other;
        shaken(&backwards, method, PlanMode::Everything, other);
        EXPECT_EQ(usual, other) << to_string(method);
    }
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        std::vector<std::uint64_t> other;
        shaken(nullptr, BroadphaseMethod::Automatic, PlanMode::Automatic, other);
        EXPECT_EQ(usual, other) << width;
    }
    set_simd_width(0);
}

TEST(Wake, TheHashTellsWhoSleepsAndHowLongOthersHaveBeenStill) {
    const auto hash = [](const std::function<void(World&, BodyId)>& act) {
        Table table(kSleeps);
        const BodyId body = table.add({.position = {0, 0.5, 0}}, Box{vec3{0.5f}});
        table.run(20);
        act(table.world, body);
        return table.world.state_hash();
    };
    EXPECT_EQ(hash([](World&, BodyId) {}), hash([](World&, BodyId) {}));
    EXPECT_NE(hash([](World&, BodyId) {}), hash([](World& w, BodyId b) { w.wake(b); }));
}

TEST(Wake, ExplainSaysWhoTouchesWhomAsleep) {
    Columns c;
    const auto expect = [&](BodyId a, BodyId b, Rung rung, const char* part) {
        const ContactExplanation why = c.world.explain(a, b);
        EXPECT_EQ(why.rung, rung) << why.sentence;
        EXPECT_NE(why.sentence.find(part), std::string::npos) << why.sentence;
        EXPECT_TRUE(why.disagreements.empty()) << why.disagreements.front();
    };
    const BodyId ball = c.world.create_body({.position = {0, 40, 0}, .can_sleep = false});
    c.world.add_shape(ball, Sphere{0.5f});
    for (int round = 0; round < 2; ++round) {  // in a step with contacts, and after one that looked for none
        expect(c.on_slab[0], c.on_slab[1], Rung::Asleep, "they touch as they did when they fell asleep, with 4 points");
        expect(c.slab, c.on_slab[0], Rung::Asleep, "they touch as they did");
        expect(c.on_lift[0], c.lift, Rung::Asleep, "they touch as they did");
        expect(c.on_lift[0], c.on_plane[0], Rung::Asleep, "they did not when it fell asleep");
        c.world.step(kDt);
    }
    expect(ball, c.on_plane[1], Rung::Bounds, "apart along y");
    c.world.wake(c.on_slab[0]);
    expect(c.on_slab[0], c.on_slab[1], Rung::OutOfStep, "did not know");
    c.world.step(kDt);
    expect(c.on_slab[0], c.on_slab[1], Rung::Touch, "they overlap");
    expect(c.on_slab[0], c.slab, Rung::Touch, "they overlap");
}

TEST(Wake, ThePlanSaysWhatSleepsAndWhatThatLeavesOut) {
    Columns c;
    bool said = false;
    for (const PlanEntry& entry : c.world.plan(kDt).entries) {
        if (entry.stage == Stage::Sleep) said = entry.run && entry.reason.find("6 of 6") != std::string::npos;
        if (entry.stage == Stage::Solve) {
            EXPECT_FALSE(entry.run);
            EXPECT_NE(entry.reason.find("sleeps"), std::string::npos) << entry.reason;
        }
    }
    EXPECT_TRUE(said);
}

}  // namespace
}  // namespace carom
