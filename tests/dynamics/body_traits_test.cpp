// Gravity scale, damping, locked axes, forces and how surfaces combine.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/part_surface.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

using namespace test;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

BodyId add_box(World& world, const BodyDef& def) {
    const BodyId id = world.create_body(def);
    world.add_shape(id, Box{{0.5f, 0.3f, 0.4f}});
    return id;
}

TEST(BodyTraits, GravityScaleIsExactInFreeFall) {
    for (const double scale : {0.0, -0.5, 3.0}) {
        World world;
        const BodyId body = add_box(world, {.gravity_scale = scale});
        for (int i = 0; i < 600; ++i) world.step(kDt);
        EXPECT_NEAR(world.pose(body).position.y, -0.5 * 9.81 * scale * 100.0, 1e-12 * 1500.0);
        EXPECT_EQ(world.gravity_scale(body), scale);
    }
}

TEST(BodyTraits, DampedFallFollowsItsClosedForm) {
    World world;
    const double c = 0.7, t = 5.0;
    const BodyId body = add_box(world, {.linear_velocity = {3, 0, 0}, .linear_damping = c});
    for (int i = 0; i < 300; ++i) world.step(kDt);
    const double left = std::exp(-c * t), first = (1.0 - left) / c;
    EXPECT_NEAR(world.linear_velocity(body).x, 3.0 * left, 1e-12);
    EXPECT_NEAR(world.pose(body).position.x, 3.0 * first, 1e-12 * 10.0);
    EXPECT_NEAR(world.linear_velocity(body).y, -9.81 * first, 1e-11);
    EXPECT_NEAR(world.pose(body).position.y, -9.81 * (t - first) / c, 1e-10);
}

// Damping makes no step too large: a rate of 1e6 1/s stops a body.
TEST(BodyTraits, DampingIsStableAtAnyRate) {
    World world({.gravity = {0, 0, 0}});
    const BodyId body = add_box(world, {.linear_velocity = {3, 0, 0}, .angular_velocity = {1, 2, 3}, .linear_damping = 1e6, .angular_damping = 1e6});
    world.step(kDt);
    EXPECT_LT(glm::length(world.linear_velocity(body)), 1e-300);
    EXPECT_LT(glm::length(world.angular_velocity(body)), 1e-300);
    EXPECT_NEAR(world.pose(body).position.x, 3e-6, 1e-15);
}

TEST(BodyTraits, AngularDampingTakesMomentumDownAndKeepsItsDirection) {
    World world({.gravity = {0, 0, 0}});
    add_box(world, {.angular_velocity = {1, 5, 2}, .angular_damping = 0.5});
    const dvec3 before = world.momentum().angular;
    for (int i = 0; i < 120; ++i) world.step(kDt);
    EXPECT_LT(glm::length(world.momentum().angular - std::exp(-1.0) * before), 1e-12 * glm::length(before));
}

TEST(BodyTraits, DecayIsTheExponential) {
    for (const double x : {0.0, 1e-12, 1e-3, 0.3, 0.5, 0.500001, 1.0, 7.0, 50.0, 600.0, 1e5}) {
        const dynamics::Decay d = dynamics::decay(x);
        EXPECT_NEAR(d.left, std::exp(-x), 1e-14 * std::exp(-x) * std::max(1.0, x)) << x;
        const double first = x == 0.0 ? 1.0 : -std::expm1(-x) / x;
        EXPECT_NEAR(d.first, first, 1e-15) << x;
        if (x >= 0.3) {
            EXPECT_NEAR(d.second, (1.0 - first) / x, 4e-15) << x;
        }
    }
}

// In contact too: terminal speed under friction-free sliding with damping is that of v' = g sin - c v.
TEST(BodyTraits, DampingActsOnWhatIsInContact) {
    const double c = 2.0, along = 3.0;
    World world({.gravity = {along, -9.0, 0.0}});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, 0}, {.friction = 0.0f});
    const BodyId box = add_box(world, {.position = {0, 0.3, 0}, .linear_damping = c});
    for (int i = 0; i < 300; ++i) world.step(kDt);
    EXPECT_NEAR(world.linear_velocity(box).x, along / c, 0.01);  // a kick a substep: off by half a substep's worth
    EXPECT_NEAR(world.pose(box).position.y, 0.3, 1e-3);
}

TEST(BodyTraits, LockedAxesHoldInFlightAndInContact) {
    Table table;
    const BodyId flat = table.add({.position = {0, 1.0, 0}, .linear_velocity = {2, 0, 5}, .angular_velocity = {3, 4, 5}, .locked = LockedAxes::Plane2D},
                                  Box{{0.5f, 0.3f, 0.4f}});
    const BodyId other = table.add({.position = {0.3, 2.0, 0.2}}, Box{{0.5f, 0.3f, 0.4f}});
    EXPECT_EQ(table.world.linear_velocity(flat), (dvec3{2, 0, 0}));
    EXPECT_EQ(table.world.angular_velocity(flat), (dvec3{0, 0, 5}));
    for (int i = 0; i < 180; ++i) {
        table.world.step(kDt);
        EXPECT_EQ(table.world.pose(flat).position.z, 0.0) << i;
        const dvec3 z = rotate(table.world.pose(flat).orientation, dvec3{0, 0, 1});
        EXPECT_NEAR(z.z, 1.0, 1e-12) << i;
    }
    EXPECT_LT(glm::length(table.world.linear_velocity(flat)), 1e-3);
    EXPECT_GT(table.world.pose(other).position.y, 0.3);
    table.world.set_linear_velocity(flat, {1, 1, 1});
    EXPECT_EQ(table.world.linear_velocity(flat), (dvec3{1, 1, 0}));
    table.world.apply_impulse(flat, {0, 0, 1e6}, table.world.center_of_mass(flat));
    EXPECT_EQ(table.world.linear_velocity(flat).z, 0.0);
}

// One locked axis: the angular momentum about the others is kept.
TEST(BodyTraits, LockedTurnKeepsMomentumAboutFreeAxes) {
    World world({.gravity = {0, 0, 0}});
    const BodyId body = add_box(world, {.angular_velocity = {1, 2, 0}, .locked = LockedAxes::TurnZ});
    const dvec3 before = world.momentum().angular;
    for (int i = 0; i < 600; ++i) world.step(kDt);
    EXPECT_EQ(world.angular_velocity(body).z, 0.0);
    EXPECT_NEAR(world.momentum().angular.x, before.x, 1e-10 * glm::length(before));
    EXPECT_NEAR(world.momentum().angular.y, before.y, 1e-10 * glm::length(before));
}

TEST(BodyTraits, ForceActsEvenlyOverOneStep) {
    World world({.gravity = {0, 0, 0}});
    const BodyId body = add_box(world, {});
    const double mass = world.mass_properties(body).mass;
    world.apply_force(body, {mass, 0, 0}, world.center_of_mass(body));
    world.apply_force(body, {mass, 0, 0}, world.center_of_mass(body));
    world.step(0.0);  // takes nothing
    world.step(0.5);
    EXPECT_NEAR(world.linear_velocity(body).x, 1.0, 1e-15);
    EXPECT_NEAR(world.pose(body).position.x, 0.25, 1e-15);
    world.step(0.5);
    EXPECT_NEAR(world.linear_velocity(body).x, 1.0, 1e-15) << "of one step only";
    world.set_linear_velocity(body, dvec3{0.0});
    const dvec3 before = world.momentum().angular;
    world.apply_torque(body, {0, 3, 0});
    world.apply_force(body, {0, 0, 2}, world.center_of_mass(body) + dvec3{1, 0, 0});
    world.step(0.01);
    EXPECT_LT(glm::length(world.momentum().angular - before - dvec3{0, 0.03 - 0.02, 0} - glm::cross(world.center_of_mass(body), dvec3{0, 0, 0.02})), 1e-6);
}

// A push below the friction limit moves nothing, one above it accelerates by the rest.
TEST(BodyTraits, ForceWorksAgainstFriction) {
    for (const double share : {0.9, 1.5}) {
        Table table({}, 0.5f);
        const BodyId box = table.add({.position = {0, 0.25, 0}}, Box{{0.5f, 0.25f, 0.5f}}, {.friction = 0.5f});
        table.run(30);
        const double weight = 9.81 * table.world.mass_properties(box).mass, start = table.world.pose(box).position.x;
        for (int i = 0; i < 60; ++i) {
            table.world.apply_force(box, {share * 0.5 * weight, 0, 0}, table.world.center_of_mass(box) - dvec3{0, 0.25, 0});
            table.world.step(kDt);
        }
        const double speed = table.world.linear_velocity(box).x;
        if (share < 1.0) {
            EXPECT_LT(table.world.pose(box).position.x - start, 1e-4);
        } else {
            EXPECT_NEAR(speed, 0.5 * 0.5 * 9.81, 0.02 * 2.45);
        }
    }
}

// The same bits whether bodies have traits that ask for nothing or none at all.
TEST(BodyTraits, AskingForNothingChangesNoBit) {
    const auto hash = [](bool traits) {
        Table table;
        const BodyId box = table.add({.position = {0, 1, 0}, .angular_velocity = {1, 2, 3}}, Box{{0.5f, 0.3f, 0.4f}});
        if (traits) table.world.set_gravity_scale(box, 1.0);
        table.run(120);
        return table.world.state_hash();
    };
    EXPECT_EQ(hash(true), hash(false));
}

TEST(BodyTraits, SurfacesCombineByTheRuleOfOne) {
    using dynamics::combine;
    using enum CombineRule;
    const std::optional<CombineRule> none;
    EXPECT_FLOAT_EQ(combine(0.25f, 1.0f, none, none, GeometricMean), 0.5f);
    EXPECT_FLOAT_EQ(combine(0.25f, 1.0f, none, none, Maximum), 1.0f);
    EXPECT_FLOAT_EQ(combine(0.25f, 1.0f, Minimum, none, Maximum), 0.25f) << "one that names a rule is followed";
    EXPECT_FLOAT_EQ(combine(0.25f, 1.0f, none, Average, Maximum), 0.625f);
    EXPECT_FLOAT_EQ(combine(0.25f, 0.5f, Product, Minimum, Maximum), 0.125f) << "the later of two";
    EXPECT_FLOAT_EQ(combine(0.25f, 0.5f, Average, Maximum, GeometricMean), 0.5f);
}

TEST(BodyTraits, ACompoundsPartTakesTheRuleOfItsShape) {
    Table table({}, 1.0f);
    const BodyId sled = table.add({.position = {0, 0.25, 0}, .linear_velocity = {2, 0, 0}}, Box{{0.5f, 0.25f, 0.5f}},
                                  {.friction = 0.0f, .friction_rule = CombineRule::Minimum});
    const BodyId brake = table.add({.position = {0, 0.25, 3}, .linear_velocity = {2, 0, 0}}, Box{{0.5f, 0.25f, 0.5f}},
                                   {.friction = 0.0f, .friction_rule = CombineRule::Maximum});
    table.run(60);
    EXPECT_NEAR(table.world.linear_velocity(sled).x, 2.0, 1e-4);
    EXPECT_LT(table.world.linear_velocity(brake).x, 1e-3);
}

template <class Call>
void expect_refused(World& world, ErrorCode code, const Call& call) {
    const std::uint64_t before = world.state_hash();
    ErrorCode reported = ErrorCode::Io;
    try {
        call();
    } catch (const MisuseError& error) {
        reported = error.error().code;
    }
    EXPECT_EQ(reported, code);
    EXPECT_EQ(world.state_hash(), before);
}

TEST(BodyTraits, BadInputIsRefused) {
    World world;
    const BodyId body = add_box(world, {}), fixed = world.create_body({.type = BodyType::Static});
    const auto refuse = [&](ErrorCode code, const auto& call) { expect_refused(world, code, call); };
    for (const double bad : {kNan, 2e6, -2e6}) {
        refuse(ErrorCode::InvalidArgument, [&] { world.set_gravity_scale(body, bad); });
        refuse(ErrorCode::InvalidArgument, [&] { world.create_body({.gravity_scale = bad}); });
    }
    for (const double bad : {kNan, -1e-9, 2e9}) {
        refuse(ErrorCode::InvalidArgument, [&] { world.set_damping(body, bad, 0.0); });
        refuse(ErrorCode::InvalidArgument, [&] { world.set_damping(body, 0.0, bad); });
        refuse(ErrorCode::InvalidArgument, [&] { world.create_body({.linear_damping = bad}); });
        refuse(ErrorCode::InvalidArgument, [&] { world.create_body({.angular_damping = bad}); });
    }
    refuse(ErrorCode::InvalidArgument, [&] { world.set_locked_axes(body, 64); });
    refuse(ErrorCode::InvalidArgument, [&] { world.create_body({.locked = 64}); });
    refuse(ErrorCode::InvalidArgument, [&] { world.create_body({.type = BodyType::Static, .linear_damping = 1.0}); });
    refuse(ErrorCode::WrongType, [&] { world.set_damping(fixed, 1.0, 1.0); });
    refuse(ErrorCode::WrongType, [&] { world.apply_force(fixed, dvec3{0.0}, dvec3{0.0}); });
    refuse(ErrorCode::DeadId, [&] { world.apply_torque({}, dvec3{0.0}); });
    refuse(ErrorCode::NotFinite, [&] { world.apply_force(body, {kNan, 0, 0}, dvec3{0.0}); });
    refuse(ErrorCode::NotFinite, [&] { world.apply_force(body, dvec3{0.0}, {0, kNan, 0}); });
    refuse(ErrorCode::NotFinite, [&] { world.apply_torque(body, {kNan, 0, 0}); });
    refuse(ErrorCode::InvalidArgument, [&] { world.apply_force(body, {1e300, 0, 0}, dvec3{0.0}); });
    refuse(ErrorCode::InvalidArgument, [&] { world.add_shape(body, Sphere{}, {.friction_rule = static_cast<CombineRule>(9)}); });
    EXPECT_EQ(world.shapes(body).size(), 1u);
    EXPECT_EQ(world.body_count(), 2u);
    for (const double bad : {kNan, 0.0, 2.0}) EXPECT_FALSE(validate(WorldDef{.spin_tolerance = bad}).ok());
}

}  // namespace
}  // namespace carom
