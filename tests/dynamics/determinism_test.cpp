// The same bits on every number of threads, at every SIMD width, with the automatic plan and with everything on; and no
// allocation once warm.
#include "shuffled_executor.hpp"

#include <carom/collision/compound.hpp>
#include <carom/dynamics/world.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>
#include <support/count_allocations.hpp>

#include <limits>
#include <vector>

namespace carom {
namespace {

using test::ShuffledExecutor;

World make_pile(const WorldDef& def) {
    World world(def);
    const BodyId ground = world.create_body({.type = BodyType::Static, .position = {0, -0.5, 0}});
    world.add_shape(ground, Box{{20, 0.5f, 20}});
    Random random(99);
    for (int i = 0; i < 120; ++i) {
        const dvec3 at{random.range(-2, 2), 0.5 + 0.25 * i, random.range(-2, 2)};
        const BodyId body = world.create_body({.position = at,
                                               .orientation = rotation_from_vector({random.unit(), random.unit(), 0.0}),
                                               .angular_velocity = {random.unit(), 0.0, random.unit()}});
        const auto size = static_cast<float>(random.range(0.25, 0.5));
        const ShapeDef material{.restitution = i % 7 == 0 ? 0.4f : 0.0f};
        switch (i % 6) {
            case 0: world.add_shape(body, Sphere{size}, material); break;
            case 1: world.add_shape(body, Box{{size, 0.4f, 0.3f}}, material); break;
            case 2: world.add_shape(body, Cylinder{size, 0.3f}, material); break;
            case 3: world.add_shape(body, Cone{size, 0.4f}, material); break;
            case 4:
                world.add_shape(body, *Compound::build({{Sphere{0.2f}, {{0, 0.3, 0}}, {.restitution = 0.5f}}, {Box{{size, 0.1f, 0.2f}}}}), material);
                break;
            default: world.add_shape(body, Capsule{0.25f, size}, material); break;
        }
    }
    for (const double x : {8.0, 10.0, 12.0}) {  // islands for the direct solve
        world.add_shape(world.create_body({.position = {x, 0.5, 0}}), Box{vec3{0.5f}}, {.density = 1.0});
        world.add_shape(world.create_body({.position = {x + 0.1, 1.5, 0}}), Box{vec3{0.5f}}, {.density = 300.0 * x});
    }
    return world;
}

std::uint64_t hash_after(World world, int steps) {
    for (int i = 0; i < steps; ++i) world.step(1.0 / 60.0);
    return world.state_hash();
}

TEST(Determinism, SameBitsTwice) { EXPECT_EQ(hash_after(make_pile({}), 120), hash_after(make_pile({}), 120)); }

TEST(Determinism, SameBitsOnEveryNumberOfThreads) {
    const std::uint64_t serial = hash_after(make_pile({}), 60);
    for (const int threads : {1, 2, 3, 8}) {
        ShuffledExecutor executor(threads);
        for (const PlanMode plan : {PlanMode::Automatic, PlanMode::Everything}) {  // the latter shares however little there is
            EXPECT_EQ(hash_after(make_pile({.executor = &executor, .plan = plan}), 60), serial) << threads << " threads";
        }
    }
}

// Enough contacts in each colour that threads share the passes of the solver; and what is done between them by one: rolling, damping, locks.
World make_blocks(const WorldDef& def) {
    World world(def);
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
    Random random(7);
    for (int i = 0; i < 400; ++i) {
        for (int level = 0; level < 3; ++level) {
            const BodyId body = world.create_body({.position = {1.5 * (i % 20) + random.range(-0.1, 0.1), 0.5 + level, 1.5 * (i / 20) + random.range(-0.1, 0.1)},
                                                   .linear_velocity = {random.range(-1.0, 1.0), 0, random.range(-1.0, 1.0)},
                                                   .linear_damping = i % 5 == 0 ? 0.3 : 0.0,
                                                   .locked = i % 7 == 0 ? LockedAxes::TurnY : LockedAxes::None});
            world.add_shape(body, Box{vec3{0.5f}}, {.rolling_resistance = i % 11 == 0 ? 0.01f : 0.0f});
        }
    }
    return world;
}

TEST(Determinism, SameBitsWhereThreadsShareThePassesOfTheSolver) {
    World alone = make_blocks({.contact_method = ContactMethod::Soft});
    StepReport report;
    for (int i = 0; i < 25; ++i) report = alone.step(1.0 / 60.0);
    EXPECT_GT(report.contacts, 4000u);
    for (const int threads : {2, 3, 5}) {
        ShuffledExecutor executor(threads);
        EXPECT_EQ(hash_after(make_blocks({.executor = &executor, .contact_method = ContactMethod::Soft}), 25), alone.state_hash()) << threads << " threads";
    }
}

// More of everything than any stage does on one thread: candidates, with planes too, contacts that are carried along, bodies that are followed, that stray
// and that bounce, and one that is thrown out.
World make_crowd(const WorldDef& def) {
    World world(def);
    const BodyId ground = world.create_body({.type = BodyType::Static});
    world.add_shape(ground, Plane{{0, 1, 0}, 0});
    world.add_shape(ground, Plane{{-1, 0, 0}, -40});
    Random random(21);
    for (int i = 0; i < 2600; ++i) {
        const int level = i / 900, at = i % 900;
        const double fast = i % 40 == 0 ? 60.0 : 1.5;
        const BodyId body = world.create_body({.position = {1.3 * (at % 30) + 0.2 * level, 0.6 + 1.02 * level, 1.3 * (at / 30) + 0.1 * level},
                                               .linear_velocity = {random.range(-fast, fast), random.range(-fast, 0.0), random.range(-fast, fast)},
                                               .angular_velocity = {random.range(-3.0, 3.0), 0, 0}});
        const ShapeDef matter{.restitution = i % 300 == 0 ? 0.5f : 0.0f};
        switch (i % 3) {
            case 0: world.add_shape(body, Box{{0.5f, 0.45f, 0.4f}}, matter); break;
            case 1: world.add_shape(body, Sphere{0.5f}, matter); break;
            default: world.add_shape(body, Cylinder{0.45f, 0.4f}, matter); break;
        }
    }
    return world;
}

TEST(Determinism, SameBitsWhereEveryStageIsShared) {
    const auto run = [](Executor* executor, StepReport& last) {
        World world = make_crowd({.executor = executor, .contact_reuse = 0.1});
        std::vector<std::uint64_t> hashes;
        for (int i = 0; i < 14; ++i) {
            last = world.step(1.0 / 60.0);
            hashes.push_back(world.state_hash());
        }
        return hashes;
    };
    StepReport report;
    const std::vector<std::uint64_t> serial = run(nullptr, report);
    EXPECT_GT(report.contacts, 6000u);
    EXPECT_GT(report.reused, 1000u);
    EXPECT_GT(report.continuous.followed, 5u);
    for (const int threads : {1, 2, 3, 8}) {
        ShuffledExecutor executor(threads);
        StepReport other;
        EXPECT_EQ(run(&executor, other), serial) << threads << " threads";
        EXPECT_EQ(other.contacts, report.contacts);
        EXPECT_EQ(other.mean_penetration, report.mean_penetration);
        EXPECT_EQ(other.deep, report.deep);
    }
}

/// Counts its loops, which it runs on the calling thread.
class CountingExecutor final : public Executor {
public:
    [[nodiscard]] int thread_count() const noexcept override { return 2; }
    void parallel_for(std::size_t count, std::size_t, Body body) override {
        ++loops;
        body(0, count);
    }
    int loops = 0;
};

TEST(Threads, ComeTogetherOnceAStepAndNotForLittle) {
    const auto loops_of_first = [](int bodies, PlanMode plan) {
        CountingExecutor executor;
        World world({.executor = &executor, .plan = plan});
        world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
        for (int i = 0; i < bodies; ++i) world.add_shape(world.create_body({.position = {2.0 * (i % 30), 1.0, 2.0 * (i / 30)}}), Sphere{0.5f});
        world.step(1.0 / 60.0);
        return executor.loops;
    };
    EXPECT_EQ(loops_of_first(100, PlanMode::Automatic), 0);
    EXPECT_EQ(loops_of_first(100, PlanMode::Everything), 1);
    EXPECT_EQ(loops_of_first(600, PlanMode::Automatic), 1);
}

TEST(Determinism, SameBitsAtEverySimdWidth) {
    const std::uint64_t best = hash_after(make_pile({}), 120);
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        EXPECT_EQ(hash_after(make_pile({}), 120), best) << "width " << width;
    }
    set_simd_width(0);
}

TEST(Determinism, SameBitsWithEveryBroadphase) {
    EXPECT_EQ(hash_after(make_pile({.broadphase = BroadphaseMethod::BruteForce}), 60),
              hash_after(make_pile({.broadphase = BroadphaseMethod::SweepAndPrune}), 60));
}

TEST(Plan, LeavingOutChangesNoBit) {
    for (const int bodies : {1, 40}) {
        const auto run = [&](PlanMode mode) {
            World world({.plan = mode});
            Random random(3);
            for (int i = 0; i < bodies; ++i) {
                const BodyId b = world.create_body({.position = {random.range(-1, 1), 0.6 * i, random.range(-1, 1)},
                                                    .angular_velocity = {1.0, 0.5 * i, 0.2}});
                world.add_shape(b, Box{{0.5f, 0.3f, 0.4f}});
            }
            std::vector<std::uint64_t> hashes;
            for (int i = 0; i < 60; ++i) {
                world.step(1.0 / 60.0);
                hashes.push_back(world.state_hash());
            }
            return hashes;
        };
        EXPECT_EQ(run(PlanMode::Automatic), run(PlanMode::Everything)) << bodies << " bodies";
    }
}

TEST(Plan, SaysWhatIsSkippedAndWhy) {
    World world;
    const BodyId body = world.create_body();
    world.add_shape(body, Sphere{});
    for (const PlanEntry& e : world.plan().entries) {
        const bool needed = e.stage == Stage::Positions || e.stage == Stage::Quarantine;
        EXPECT_EQ(e.run, needed) << to_string(e.stage);
        EXPECT_FALSE(e.reason.empty());
    }
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{}, {.restitution = 0.5f});
    for (const PlanEntry& e : world.plan().entries) EXPECT_EQ(e.run, e.stage != Stage::Joints && e.stage != Stage::Sleep) << to_string(e.stage);
    world.create_joint(BallJointDef{.body_a = body});
    for (const PlanEntry& e : world.plan().entries) EXPECT_EQ(e.run, e.stage != Stage::Sleep) << to_string(e.stage);
}

TEST(Plan, NamesTheBroadphaseThatTheFirstStepWillChoose) {
    for (const int bodies : {20, 600, 3000}) {
        for (const double gap : {1.1, 20.0}) {
            World world;
            for (int i = 0; i < bodies; ++i) {
                const BodyId body = world.create_body({.position = {gap * (i % 20), gap * (i / 400), gap * (i / 20 % 20)},
                                                       .linear_velocity = {i % 3 == 0 ? 90.0 : 0.0, 0, 0}});
                world.add_shape(body, Box{{0.5f, i % 50 == 0 ? 8.0f : 0.5f, 0.5f}});
            }
            const std::uint64_t hash = world.state_hash();
            const Plan before = world.plan(1.0 / 60.0);
            EXPECT_EQ(world.state_hash(), hash);
            world.step(1.0 / 60.0);
            const Plan after = world.plan(1.0 / 60.0);
            EXPECT_EQ(before.broadphase.method, after.broadphase.method) << bodies;
            EXPECT_EQ(before.broadphase.reason, after.broadphase.reason) << bodies;
            EXPECT_EQ(before.broadphase.method == BroadphaseMethod::BruteForce, bodies == 20);
        }
    }
}

TEST(Plan, SaysWhyThereIsNoBroadphaseOrWhoAskedForIt) {
    World empty;
    EXPECT_EQ(empty.plan().broadphase.method, BroadphaseMethod::Automatic);
    EXPECT_NE(empty.plan().broadphase.reason.find("not used"), std::string::npos);

    World asked({.broadphase = BroadphaseMethod::DynamicTree});
    asked.add_shape(asked.create_body(), Sphere{});
    asked.add_shape(asked.create_body(), Sphere{});
    EXPECT_EQ(asked.plan().broadphase.method, BroadphaseMethod::DynamicTree);
    EXPECT_EQ(asked.plan().broadphase.reason, "asked for");
    EXPECT_THROW((void)asked.plan(-1.0), MisuseError);
    EXPECT_THROW((void)asked.plan(std::numeric_limits<double>::quiet_NaN()), MisuseError);

    // What the first step would quarantine has no box to choose by.
    World wild;
    wild.add_shape(wild.create_body({.linear_velocity = {1e300, 0, 0}}), Sphere{});
    wild.add_shape(wild.create_body({.linear_velocity = {1e300, 0, 0}}), Sphere{});
    EXPECT_NE(wild.plan(1.0).broadphase.reason.find("no shape has a box"), std::string::npos);
}

TEST(Step, AllocatesNothingOnceWarm) {
    World world;
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
    for (int i = 0; i < 60; ++i) {  // columns that rock and settle, with contacts that come and go
        const BodyId body = world.create_body(
            {.position = {1.2 * (i % 5), 0.5 + 1.05 * (i / 25), 1.2 * ((i / 5) % 5)}, .angular_velocity = {0.1, 0, 0.1}});
        world.add_shape(body, Box{{0.5f, 0.5f, 0.5f}});
    }
    for (int i = 0; i < 200; ++i) world.step(1.0 / 60.0);
    const long before = test::allocations();
    std::size_t contacts = 0;
    for (int i = 0; i < 60; ++i) contacts += world.step(1.0 / 60.0).contacts;
    EXPECT_EQ(test::allocations() - before, 0);
    EXPECT_GT(contacts, 60u * 200u) << "the steps had work to do";
}

TEST(Step, AllocatesNothingForSleepOnceWarm) {
    World world({.sleep = {.enabled = true}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 20; ++i) {
        bodies.push_back(world.create_body({.position = {1.5 * (i % 10), 0.5 + i / 10, 0}}));
        world.add_shape(bodies.back(), Box{vec3{0.5f}});
    }
    std::size_t woken = 0;
    const auto round = [&] {
        for (std::size_t i = 0; i < bodies.size(); i += 3) world.wake(bodies[i]);
        StepReport report;
        for (int i = 0; i < 60; ++i) {
            report = world.step(1.0 / 60.0);
            woken += report.woken;
        }
        EXPECT_EQ(report.asleep, bodies.size());
    };
    for (int i = 0; i < 120; ++i) world.step(1.0 / 60.0);
    round(), round();
    const long before = test::allocations();
    round();
    EXPECT_EQ(test::allocations() - before, 0);
    EXPECT_GT(woken, 20u);
}

}  // namespace
}  // namespace carom
