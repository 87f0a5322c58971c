// The world's promises: bad input changes nothing, dt = 0 changes no bit, known problems come out as they should.
#include <carom/dynamics/world.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace carom {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDt = 1.0 / 60.0;

struct Table {
    World world;
    BodyId ground;
    ShapeId ground_shape;

    explicit Table(const WorldDef& def = {}, float friction = 0.6f) : world(def) {
        ground = world.create_body({.type = BodyType::Static, .name = "ground"});
        ground_shape = world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = friction});
    }
    BodyId add(const BodyDef& body, Shape shape, const ShapeDef& def = {}) {
        const BodyId id = world.create_body(body);
        world.add_shape(id, std::move(shape), def);
        return id;
    }
    void run(int steps) {
        for (int i = 0; i < steps; ++i) world.step(kDt);
    }
};

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
    EXPECT_THROW(World({.max_push = kNaN}), MisuseError);
    EXPECT_THROW(World({.broadphase = static_cast<BroadphaseMethod>(7)}), MisuseError);
    EXPECT_THROW(World({.plan = static_cast<PlanMode>(7)}), MisuseError);
    World world;
    expect_refused(world, ErrorCode::InvalidArgument, [&] { world.create_body({.type = static_cast<BodyType>(9)}); });
}

TEST(World, RefusesBadSteps) {
    Table table;
    table.add({.position = {0, 2, 0}}, Sphere{});
    expect_refused(table.world, ErrorCode::NotFinite, [&] { table.world.step(kNaN); });
    expect_refused(table.world, ErrorCode::NotFinite, [&] { table.world.step(INFINITY); });
    expect_refused(table.world, ErrorCode::InvalidArgument, [&] { table.world.step(-kDt); });
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

TEST(World, BoxComesToRestOnThePlane) {
    Table table;
    const BodyId box = table.add({.position = {0, 1.0, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    table.run(180);
    EXPECT_NEAR(table.world.pose(box).position.y, 0.5, 1e-3);
    EXPECT_LT(glm::length(table.world.linear_velocity(box)), 1e-5);
    ASSERT_EQ(table.world.contact_count(), 1u);
    const ContactView contact = table.world.contact(0);
    EXPECT_EQ(contact.manifold->count, 4u);
    double force = 0.0;
    for (int k = 0; k < 4; ++k) force += static_cast<double>(contact.normal_impulse[static_cast<std::size_t>(k)]);
    // impulses are of one substep
    EXPECT_NEAR(force * 60.0 * table.world.settings().substeps, 1000.0 * 9.81, 10.0);
}

// Coulomb: v0²/(2 mu g), along the axes and between them; a friction pyramid would stop too early at 45 degrees.
TEST(World, SlidingBoxStopsWhereCoulombSays) {
    for (const double degrees : {0.0, 30.0, 45.0, 90.0}) {
        Table table({}, 0.5f);
        const SinCos heading = sin_cos(degrees * kPi / 180.0);
        const double speed = 3.0;
        const dvec3 direction{heading.cos, 0.0, heading.sin};
        const BodyId box = table.add({.position = {0, 0.25, 0}, .linear_velocity = speed * direction},
                                     Box{{0.5f, 0.25f, 0.5f}}, {.friction = 0.5f});
        table.run(120);
        const double expected = speed * speed / (2.0 * 0.5 * 9.81);
        const dvec3 path = table.world.pose(box).position;
        EXPECT_NEAR(glm::dot(path, direction), expected, 0.02 * expected) << degrees;
        EXPECT_LT(glm::length(glm::cross(path, direction) * dvec3{0, 1, 0}), 0.01 * expected) << degrees;
    }
}

TEST(World, BlockOnInclineSticksBelowTheFrictionAngleAndSlidesAbove) {
    const double mu = 0.5;  // critical angle 26.57 degrees
    for (const double degrees : {25.0, 28.0}) {
        const SinCos a = sin_cos(degrees * kPi / 180.0);
        World world({.gravity = {9.81 * a.sin, -9.81 * a.cos, 0.0}});
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = 0.5f});
        const BodyId box = world.create_body({.position = {0, 0.25, 0}});
        world.add_shape(box, Box{{0.5f, 0.25f, 0.5f}}, {.friction = 0.5f});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        const double path = world.pose(box).position.x;
        if (a.sin < mu * a.cos) {
            EXPECT_LT(path, 0.01) << "sticks";
        } else {
            const double expected = 0.5 * 9.81 * (a.sin - mu * a.cos) * 4.0;
            EXPECT_NEAR(path, expected, 0.1 * expected) << "slides";
        }
    }
}

TEST(World, SphereSlipsThenRolls) {
    Table table({}, 0.3f);
    const BodyId ball = table.add({.position = {0, 0.5, 0}, .linear_velocity = {4, 0, 0}}, Sphere{0.5f}, {.friction = 0.3f});
    table.run(180);
    EXPECT_NEAR(table.world.linear_velocity(ball).x, 4.0 * 5.0 / 7.0, 0.01);
    EXPECT_NEAR(table.world.angular_velocity(ball).z, -4.0 * 5.0 / 7.0 / 0.5, 0.02);
}

TEST(World, BouncingBallKeepsTheRestitutionOfItsImpact) {
    Table table;
    const BodyId ball = table.add({.position = {0, 2.5, 0}}, Sphere{0.5f}, {.restitution = 0.5f});
    double apex = 0.0;
    bool fell = false;
    for (int i = 0; i < 120; ++i) {
        table.world.step(kDt);
        const bool rising = table.world.linear_velocity(ball).y > 0.0;
        fell |= rising;
        if (fell && !rising) break;
        apex = fell ? table.world.pose(ball).position.y - 0.5 : 0.0;
    }
    EXPECT_NEAR(apex, 2.0 * 0.25, 0.06);  // impact is placed to within a step
}

TEST(World, MomentumOfACollisionIsConserved) {
    World world({.gravity = {0, 0, 0}, .report_balance = true});
    const BodyId a = world.create_body({.position = {-2, 0, 0}, .linear_velocity = {3, 0, 0}});
    world.add_shape(a, Box{{0.5f, 0.5f, 0.5f}});
    const BodyId b = world.create_body({.position = {2, 0.3, 0.2}, .linear_velocity = {-1, 0, 0}});
    world.add_shape(b, Sphere{0.7f});
    const Momentum before = world.momentum();
    bool met = false;
    for (int i = 0; i < 120; ++i) met |= world.step(kDt).touching > 0;
    EXPECT_TRUE(met);
    const Momentum after = world.momentum();
    EXPECT_LT(glm::length(after.linear - before.linear), 1e-6 * 3000.0);
    // Within a step both bodies keep their lever arms, so friction acts at points as far apart as they moved: at most
    // |v| dt times the friction impulse, mu m v.
    EXPECT_LT(glm::length(after.angular - before.angular), 4.0 * kDt * 0.6 * 1000.0 * 4.0);
}

TEST(World, KinematicPlatformCarriesWhatStandsOnIt) {
    World world;
    const BodyId platform = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {1, 0, 0}});
    world.add_shape(platform, Box{{2, 0.25f, 2}});
    const BodyId box = world.create_body({.position = {0, 0.75, 0}});
    world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}});
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_NEAR(world.pose(platform).position.x, 2.0, 1e-12);
    EXPECT_NEAR(world.linear_velocity(box).x, 1.0, 1e-3);
    EXPECT_GT(world.pose(box).position.x, 1.8);
}

TEST(World, StackFarFromTheOriginSettlesTheSame) {
    const auto settle = [](double offset) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static, .position = {offset, -0.5, offset}});
        world.add_shape(ground, Box{{10, 0.5f, 10}});
        std::vector<BodyId> boxes;
        for (int i = 0; i < 5; ++i) {
            boxes.push_back(world.create_body({.position = {offset, 0.5 + i, offset}}));
            world.add_shape(boxes.back(), Box{{0.5f, 0.5f, 0.5f}});
        }
        for (int i = 0; i < 120; ++i) world.step(kDt);
        return world.pose(boxes.back()).position - dvec3{offset, 0.0, offset};
    };
    EXPECT_LT(glm::length(settle(1e6) - settle(0.0)), 1e-4);
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

TEST(World, KinematicPlaneLiftsWhatLiesOnIt) {
    World world;
    const BodyId floor = world.create_body({.type = BodyType::Kinematic, .linear_velocity = {0, 10, 0}});
    world.add_shape(floor, Plane{{0, 1, 0}, 0});
    const BodyId ball = world.create_body({.position = {0, 0.6, 0}});
    world.add_shape(ball, Sphere{0.5f});
    double deepest = 0.0;
    for (int i = 0; i < 60; ++i) {
        world.step(kDt);
        deepest = std::min(deepest, world.pose(ball).position.y - world.pose(floor).position.y - 0.5);
    }
    EXPECT_GT(deepest, -5e-3);
}

// The static body's own origin may be as far away as the world is wide.
TEST(World, ContactKeepsItsDigitsFarFromTheStaticBodysOrigin) {
    for (const double d : {0.0, 1e5, 1e7}) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Box{{10, 0.5f, 10}}, {.local = {{d, -0.5, 0}}});
        const BodyId box = world.create_body({.position = {d, 0.5, 0}});
        world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}});
        for (int i = 0; i < 120; ++i) world.step(kDt);
        EXPECT_NEAR(world.pose(box).position.y, 0.5, 1e-4) << d;
        EXPECT_LT(glm::length(world.linear_velocity(box)), 1e-5) << d;
    }
}

// Lengths times s, times times sqrt(s): the same path at every size and density, friction included.
TEST(World, SlidingScalesWithSizeAndDensity) {
    const auto slide = [](double s, double density) {
        World world;
        const BodyId ground = world.create_body({.type = BodyType::Static});
        world.add_shape(ground, Plane{{0, 1, 0}, 0}, {.friction = 0.5f});
        const auto f = static_cast<float>(s);
        const BodyId box = world.create_body({.position = {0, 0.5 * s, 0}, .linear_velocity = {5.0 * std::sqrt(s), 0, 0}});
        world.add_shape(box, Box{{f, 0.5f * f, f}}, {.density = density, .friction = 0.5f});
        for (int i = 0; i < 120; ++i) world.step(kDt * std::sqrt(s));
        return world.pose(box).position.x / s;
    };
    const double expected = slide(1.0, 1000.0);
    EXPECT_NEAR(expected, 2.548, 0.02);
    for (const double s : {1e-4, 1e-2, 1e2, 1e5}) EXPECT_NEAR(slide(s, 1000.0), expected, 1e-3 * expected) << s;
    for (const double density : {1e-20, 1e-10, 1e10, 1e20}) EXPECT_NEAR(slide(1.0, density), expected, 1e-3 * expected) << density;
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

}  // namespace
}  // namespace carom
