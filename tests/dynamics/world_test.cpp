// The world's promises: bad input changes nothing, dt = 0 changes no bit, what goes wrong is quarantined.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Expects `call` to be refused with `code`, and the world to be the same to the bit afterwards.
void expect_refused(World& world, ErrorCode code, const std::function<void()>& call) {
    const std::uint64_t hash = world.state_hash();
    const std::size_t bodies = world.body_count();
    try {
        call();
        ADD_FAILURE() << "accepted";
    } catch (const MisuseError& e) {
        EXPECT_EQ(e.error().code, code) << e.what();
    }
    EXPECT_EQ(world.state_hash(), hash);
    EXPECT_EQ(world.body_count(), bodies);
}

TEST(World, RefusesBadBodies) {
    World world;
    expect_refused(world, ErrorCode::NotFinite, [&] { world.create_body({.position = {kNaN, 0, 0}}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.create_body({.orientation = {kNaN, 0, 0, 0}}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.create_body({.orientation = {0, 0, 0, 0}}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.create_body({.linear_velocity = {0, kNaN, 0}}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.create_body({.angular_velocity = {0, 0, INFINITY}}); });
}

TEST(World, RefusesBadShapes) {
    World world;
    const BodyId body = world.create_body();
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{0.0f}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Box{{1, -1, 1}}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.add_shape(body, Capsule{NAN, 1.0f}); });
    expect_refused(world, ErrorCode::WrongType, [&] { world.add_shape(body, Plane{}); });
    expect_refused(world, ErrorCode::Empty, [&] { world.add_shape(body, ConvexHullPtr{}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{}, {.density = -1.0}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{}, {.density = kNaN}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{}, {.friction = -0.1f}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{}, {.restitution = 1.5f}); });
    expect_refused(world, ErrorCode::DeadId, [&] { world.add_shape(BodyId{}, Sphere{}); });
    EXPECT_TRUE(world.shapes(body).empty());
    // Masses and moments that the solver's floats cannot hold.
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{1e-3f}, {.density = 1e-320}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{2.0f}, {.density = 1e300}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.set_mass_properties(body, {1.0, {}, dmat3{1e-40}}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.set_mass_properties(body, {1.0, {1e300, 0, 0}, dmat3{1}}); });
    const BodyId fixed = world.create_body({.type = BodyType::Static});
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(fixed, Sphere{3e38f}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.add_shape(fixed, Sphere{}, {.local = {{1e39, 0, 0}}}); });
    ASSERT_TRUE(world.add_shape(body, Sphere{1.0f}));
    expect_refused(world, ErrorCode::InvalidArgument,
                   [&] { world.add_shape(body, Sphere{1.0f}, {.local = {{1e100, 0, 0}}}); });
    EXPECT_EQ(world.shapes(body).size(), 1u) << "nothing of the refused shape stays";
    EXPECT_TRUE(world.add_shape(body, Sphere{1.0f})) << "and the body takes others";
}

TEST(World, RefusesBadSettings) {
    EXPECT_THROW(World({.gravity = {0, kNaN, 0}}), MisuseError);
    EXPECT_THROW(World({.substeps = 0}), MisuseError);
    EXPECT_THROW(World({.contact_rate = -1.0}), MisuseError);
    EXPECT_THROW(World({.contact_rate = 0.3}), MisuseError);
    EXPECT_THROW(World({.contact_reuse = -1e-9}), MisuseError);
    EXPECT_THROW(World({.contact_reuse = 0.11}), MisuseError);
    EXPECT_THROW(World({.contact_reuse = std::numeric_limits<double>::quiet_NaN()}), MisuseError);
    EXPECT_THROW(World({.max_push = kNaN}), MisuseError);
    EXPECT_THROW(World({.broadphase = static_cast<BroadphaseMethod>(7)}), MisuseError);
    EXPECT_THROW(World({.pair_limit = 0}), MisuseError);
    EXPECT_THROW(World({.pair_limit = (std::size_t{1} << 31) + 1}), MisuseError);
    EXPECT_THROW(World({.plan = static_cast<PlanMode>(7)}), MisuseError);
    World world;
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.create_body({.type = static_cast<BodyType>(9)}); });
}

// Three crates in one place are three pairs.
TEST(World, SaysWhereItLeftPairsOut) {
    for (const std::size_t limit : {2u, 3u}) {
        World world({.pair_limit = limit});
        for (int i = 0; i < 3; ++i) world.add_shape(world.create_body({.position = {0.01 * i, 0, 0}}), Box{});
        const StepReport report = world.step(kDt);
        EXPECT_EQ(report.pairs_limited, limit == 2);
        EXPECT_EQ(report.pairs, limit);
    }
}

TEST(World, RefusesBadSteps) {
    Table table;
    table.add({.position = {0, 2, 0}}, Sphere{});
    expect_refused(table.world, ErrorCode::NotFinite, [&] { table.world.step(kNaN); });
    expect_refused(table.world, ErrorCode::NotFinite, [&] { table.world.step(INFINITY); });
    expect_refused(table.world, ErrorCode::InvalidArgument, [&] { table.world.step(-kDt); });
    expect_refused(table.world, ErrorCode::InvalidArgument, [&] { table.world.step(1e20); });
    expect_refused(table.world, ErrorCode::InvalidArgument, [&] { static_cast<void>(table.world.plan(1e20)); });
}

TEST(World, RefusesDeadIdsEverywhere) {
    Table table;
    World& world = table.world;
    const BodyId dead = table.add({}, Sphere{});
    const ShapeId dead_shape = world.shapes(dead)[0];
    world.destroy_body(dead);
    EXPECT_FALSE(world.is_alive(dead));
    EXPECT_FALSE(world.is_alive(dead_shape));
    expect_refused(world, ErrorCode::DeadId, [&] { world.destroy_body(dead); });
    expect_refused(world, ErrorCode::DeadId, [&] { (void)world.pose(dead); });
    expect_refused(world, ErrorCode::DeadId, [&] { (void)world.linear_velocity(dead); });
    expect_refused(world, ErrorCode::DeadId, [&] { (void)world.shape(dead_shape); });
    expect_refused(world, ErrorCode::DeadId, [&] { world.set_pose(dead, {}); });
    expect_refused(world, ErrorCode::DeadId, [&] { world.set_linear_velocity(dead, {}); });
    expect_refused(world, ErrorCode::DeadId, [&] { world.apply_impulse(dead, {}, {}); });
    expect_refused(world, ErrorCode::DeadId, [&] { world.set_mass_properties(dead, {}); });
    const BodyId next = world.create_body();
    EXPECT_EQ(next.slot, dead.slot);
    EXPECT_NE(next, dead) << "a reused slot is another body";
}

TEST(World, RefusesBadStates) {
    Table table;
    World& world = table.world;
    const BodyId body = table.add({.position = {0, 2, 0}}, Sphere{});
    expect_refused(world, ErrorCode::NotFinite, [&] { world.set_pose(body, {{kNaN, 0, 0}}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.set_pose(body, {{}, {2, 0, 0, 0}}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.set_linear_velocity(body, {kNaN, 0, 0}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.set_angular_velocity(body, {kNaN, 0, 0}); });
    expect_refused(world, ErrorCode::WrongType, [&] { world.set_linear_velocity(table.ground, {1, 0, 0}); });
    expect_refused(world, ErrorCode::NotFinite, [&] { world.apply_impulse(body, {kNaN, 0, 0}, {}); });
    expect_refused(world, ErrorCode::WrongType, [&] { world.apply_impulse(table.ground, {}, {}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.set_mass_properties(body, {-1.0, {}, dmat3{1.0}}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { (void)world.cast_ray({.direction = {0, 0, 0}}); });
    expect_refused(world, ErrorCode::InvalidArgument, [&] { (void)world.contact(99); });
}

TEST(World, ReturnsNullWhereTheHandlerReturns) {
    World world;
    const ErrorHandler before = set_error_handler([](const Error&) {});
    EXPECT_FALSE(world.create_body({.position = {kNaN, 0, 0}}));
    EXPECT_FALSE(world.add_shape(BodyId{}, Sphere{}));
    EXPECT_EQ(world.step(kNaN).step, 0u);
    set_error_handler(before);
}

TEST(World, ZeroStepChangesNoBit) {
    Table table;
    table.add({.position = {0, 0.4, 0}, .angular_velocity = {1, 2, 3}}, Box{});
    table.run(3);
    const std::uint64_t hash = table.world.state_hash();
    EXPECT_EQ(table.world.step(0.0).step, 0u);
    EXPECT_EQ(table.world.state_hash(), hash);
}

// The body that went wrong lies in the middle of a heap: it alone is taken out.
TEST(World, UnusableBodiesAreQuarantinedAndNamedAndHarmNobody) {
    const std::function<void(World&, BodyId)> harms[] = {
        [](World& w, BodyId b) { w.set_linear_velocity(b, {1e308, 0, 0}); },
        [](World& w, BodyId b) { w.set_linear_velocity(b, {1e37, 0, 0}); },
        [](World& w, BodyId b) { w.set_angular_velocity(b, {0, 1e9, 0}); },
        [](World& w, BodyId b) { w.apply_impulse(b, {1e30, 0, 0}, w.center_of_mass(b)); },
        [](World& w, BodyId b) { w.set_pose(b, {{1e39, 0, 0}}); },
    };
    for (const auto& harm : harms) {
        Table table;
        std::vector<BodyId> heap;
        for (int i = 0; i < 27; ++i) {
            heap.push_back(table.add({.position = {0.95 * (i % 3), 0.5 + (i / 9), 0.95 * ((i / 3) % 3)}}, Box{{0.5f, 0.5f, 0.5f}}));
        }
        table.run(3);
        const BodyId bad = heap[13];
        harm(table.world, bad);
        const StepReport report = table.world.step(kDt);
        ASSERT_EQ(report.quarantined.size(), 1u);
        EXPECT_EQ(report.quarantined[0], bad);
        EXPECT_TRUE(table.world.is_quarantined(bad));
        EXPECT_LT(glm::length(table.world.pose(bad).position), 10.0) << "back where it was";
        EXPECT_EQ(table.world.linear_velocity(bad), dvec3{0.0});
        for (int i = 0; i < 30; ++i) EXPECT_TRUE(table.world.step(kDt).quarantined.empty());
        for (const BodyId body : heap) {
            EXPECT_TRUE(is_finite(table.world.pose(body)));
            EXPECT_LT(glm::length(table.world.linear_velocity(body)), 10.0);
        }
        table.world.release(bad);
        EXPECT_FALSE(table.world.is_quarantined(bad));
        table.world.set_pose(bad, {{0, 20, 0}});
        table.world.step(kDt);
        EXPECT_LT(table.world.linear_velocity(bad).y, 0.0) << "falls again";
    }
}

TEST(World, QuarantineIsTheSameWhateverThePlan) {
    for (const PlanMode mode : {PlanMode::Automatic, PlanMode::Everything}) {
        World world({.plan = mode});
        const BodyId body = world.create_body({.position = {1e39, 0, 0}});
        world.add_shape(body, Sphere{});
        world.add_shape(body, Sphere{}, {.local = {{2, 0, 0}}});
        EXPECT_EQ(world.step(kDt).quarantined, std::vector<BodyId>{body}) << "once, however many shapes it has";
    }
}

TEST(World, RefusesAnImpulseThatLeavesNoFiniteVelocity) {
    World world;
    const BodyId body = world.create_body();
    world.add_shape(body, Sphere{1e-3f});
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.apply_impulse(body, {1e306, 0, 0}, {0, 0, 0}); });
}

TEST(World, RayFindsTheNearestBody) {
    Table table;
    const BodyId low = table.add({.position = {0, 1, 0}}, Sphere{0.5f});
    const BodyId high = table.add({.position = {0, 3, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    const auto hit = table.world.cast_ray({.origin = {0, 9, 0}, .direction = {0, -2, 0}, .max_distance = 20});
    ASSERT_TRUE(hit.has_value());
    EXPECT_EQ(hit->body, high);
    EXPECT_NEAR(hit->hit.distance, 5.5, 1e-12);
    table.world.destroy_body(high);
    EXPECT_EQ(table.world.cast_ray({.origin = {0, 9, 0}, .direction = {0, -2, 0}, .max_distance = 20})->body, low);
    EXPECT_EQ(table.world.cast_ray({.origin = {4, 9, 0}, .direction = {0, -1, 0}, .max_distance = 20})->body, table.ground);
    EXPECT_FALSE(table.world.cast_ray({.origin = {4, 9, 0}, .direction = {0, -1, 0}, .max_distance = 8.9}).has_value());
}

TEST(World, ShapesShiftTheCentreOfMassAndNotTheBody) {
    World world({.gravity = {0, 0, 0}});
    const BodyId body = world.create_body({.position = {1, 2, 3}, .angular_velocity = {0, 0, 1}});
    world.add_shape(body, Sphere{0.5f});
    world.add_shape(body, Sphere{0.5f}, {.local = {{2, 0, 0}}});
    EXPECT_LT(glm::length(world.pose(body).position - dvec3(1, 2, 3)), 1e-15);
    EXPECT_LT(glm::length(world.center_of_mass(body) - dvec3(2, 2, 3)), 1e-15);
    EXPECT_LT(glm::length(world.linear_velocity(body) - dvec3(0, 1, 0)), 1e-15) << "its origin was at rest";
}

TEST(World, FiltersAndMasksKeepShapesApart) {
    Table table;
    const BodyId ghost = table.add({.position = {0, 1, 0}}, Sphere{0.5f}, {.layer = 2, .mask = 2});
    table.run(60);
    EXPECT_LT(table.world.pose(ghost).position.y, 0.0) << "falls through: the plane is of layer 1";
}

TEST(Step, CountsPointsWhosePushOutIsLimited) {
    for (const double depth : {0.001, 0.4}) {
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static}), Box{{5.0f, 0.5f, 5.0f}});
        world.add_shape(world.create_body({.position = {0, 1.0 - depth, 0}}), Box{});
        const StepReport report = world.step(kDt);
        EXPECT_EQ(report.contacts, 4u);
        EXPECT_EQ(report.deep, depth > 0.1 ? 4u : 0u) << depth;
    }
}

TEST(Step, ShapesOfOneBodyDoNotMeet) {
    World world;
    const BodyId body = world.create_body();
    for (const double x : {0.0, 0.3, 0.6}) world.add_shape(body, Box{}, {.local = {{x, 0, 0}, kIdentityRotation}});
    world.add_shape(world.create_body({.type = BodyType::Static, .position = {0, -50, 0}}), Box{});
    const StepReport report = world.step(kDt);
    EXPECT_EQ(report.pairs, 0u);
    EXPECT_EQ(world.contact_count(), 0u);
}

// A soft contact sags by load / (m_eff w^2) (docs/step.md), at twice the frequency where one side cannot give way. Of two equal boxes on the
// ground the upper contact has half the load and half the effective mass of the lower one, and so would sag as much at one frequency.
TEST(Step, AContactWithTheGroundIsFourTimesAsStiff) {
    World world({.gravity = {0, -9.81, 0}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Box{{5.0f, 0.5f, 5.0f}});
    const BodyId lower = world.create_body({.position = {0, 1, 0}}), upper = world.create_body({.position = {0, 2, 0}});
    world.add_shape(lower, Box{});
    world.add_shape(upper, Box{});
    for (int k = 0; k < 300; ++k) world.step(kDt);
    const double under = 1.0 - world.pose(lower).position.y;
    const double between = 1.0 - (world.pose(upper).position.y - world.pose(lower).position.y);
    EXPECT_GT(under, 1e-6);
    EXPECT_NEAR(between / under, 4.0, 0.2);
}

// The ground's own origin may be as far from the contact as it likes, and the ground may be first or second of the pair.
TEST(Step, AStaticBodysOriginMayBeFarFromItsShape) {
    for (const bool ground_first : {true, false}) {
        World world;
        BodyId crate;
        const auto add_ground = [&] {
            const BodyId ground = world.create_body({.type = BodyType::Static, .position = {0, -1e9, 0}});
            world.add_shape(ground, Box{{5.0f, 0.5f, 5.0f}}, {.local = {{0, 1e9, 0}, kIdentityRotation}});
        };
        if (ground_first) add_ground();
        crate = world.create_body({.position = {0, 1.0, 0}, .linear_velocity = {1, 0, 0}});
        world.add_shape(crate, Box{});
        if (!ground_first) add_ground();
        for (int k = 0; k < 120; ++k) world.step(kDt);
        EXPECT_NEAR(world.pose(crate).position.y, 1.0, 1e-3) << ground_first;
        EXPECT_NEAR(world.pose(crate).position.x, 1.0 / (2.0 * 0.6 * 9.81), 0.02) << "slides v^2 / (2 mu g)";
        EXPECT_LT(glm::length(world.linear_velocity(crate)), 1e-3);
    }
}

}  // namespace
}  // namespace carom
