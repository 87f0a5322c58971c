// Casts through a world against the search over all its shapes, one by one.
#include "table.hpp"

#include <carom/core/check.hpp>
#include <carom/dynamics/world_cast.hpp>

#include <support/cast_cases.hpp>

#include <broadphase/executors.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSkin = 1e-5;

/// Bodies of every shape, some of several, some that have moved since they were last looked at.
World crowd(Executor* executor = nullptr) {
    World world({.gravity = {0, -9.81, 0}, .executor = executor});
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{{0, 1, 0}, -6.0f});
    Random random(0xc0de);
    std::vector<BodyId> bodies;
    for (int i = 0; i < 120; ++i) {
        const auto type = i % 4 == 0 ? BodyType::Static : i % 4 == 1 ? BodyType::Kinematic : BodyType::Dynamic;
        const BodyId body = world.create_body({.type = type,
                                               .position = {random.range(-6, 6), random.range(-5, 6), random.range(-6, 6)},
                                               .orientation = random_rotation(random),
                                               .linear_velocity = type == BodyType::Static ? dvec3{0.0} : 2.0 * random_direction(random)});
        bodies.push_back(body);
        for (int k = 0; k <= i % 3; ++k) {
            Shape shape = any_shape(random, i % 9 == 6 ? 5 : i);
            world.add_shape(body, std::move(shape), {.local = {0.5 * random_direction(random), random_rotation(random)}});
        }
    }
    for (int i = 0; i < 4; ++i) world.step(kDt);
    for (std::size_t i = 0; i < bodies.size(); i += 7) world.set_pose(bodies[i], {4.0 * random_direction(random), random_rotation(random)});
    for (std::size_t i = 3; i < bodies.size(); i += 17) world.destroy_body(bodies[i]);
    world.add_shape(world.create_body({.position = {1, 7, 1}}), Sphere{0.7f});  // not seen by any step
    return world;
}

std::vector<ShapeCast> casts_through(std::uint64_t seed, int count) {
    Random random(seed);
    std::vector<ShapeCast> casts;
    for (int i = 0; i < count; ++i) {
        ShapeCast cast{.shape = any_convex(random, i), .motion = any_motion(random, i % 10 == 0 ? 3.0 : 9.0, i % 3 == 0 ? 3.0 : 0.0)};
        cast.settings.most_checks = 2000;
        if (i % 4 == 0) cast.settings.separation = 0.1;
        if (i % 6 == 5) cast.motion.translation *= 0.2;
        casts.push_back(std::move(cast));
    }
    return casts;
}

/// The first contact with each shape, in order of creation.
std::vector<WorldImpact> all_by_search(const World& world, const ShapeCast& cast, double skin) {
    std::vector<WorldImpact> met;
    TimeOfImpactSettings settings = cast.settings;
    settings.separation += skin;
    for (const BodyId body : world.bodies()) {
        for (const ShapeId shape : world.shapes(body)) {
            const Impact impact = first_by_search(cast.shape, cast.motion, world.shape(shape), world.shape_pose(shape), settings);
            if (may_touch(impact.status)) met.push_back({body, shape, {impact, 0, 0}});
        }
    }
    return met;
}

double first_time(const std::vector<WorldImpact>& met) {
    double t = 2.0;
    for (const WorldImpact& w : met) t = std::min(t, w.impact.t);
    return t;
}

void expect_same(const std::optional<WorldImpact>& a, const std::optional<WorldImpact>& b, std::size_t i) {
    ASSERT_EQ(a.has_value(), b.has_value()) << i;
    if (!a) return;
    EXPECT_EQ(a->body, b->body) << i;
    EXPECT_EQ(a->shape, b->shape) << i;
    EXPECT_EQ(a->impact.status, b->impact.status) << i;
    EXPECT_EQ(a->impact.t, b->impact.t) << i;
    EXPECT_EQ(a->impact.point, b->impact.point) << i;
    EXPECT_EQ(a->impact.normal, b->impact.normal) << i;
    EXPECT_EQ(a->impact.triangle, b->impact.triangle) << i;
    EXPECT_EQ(a->impact.part, b->impact.part) << i;
}

TEST(WorldCast, MeetsWhatTheSearchOverAllShapesMeets) {
    const World world = crowd();
    const std::vector<ShapeCast> casts = casts_through(0xca57, 240);
    int met = 0, missed = 0;
    for (std::size_t i = 0; i < casts.size(); ++i) {
        const std::optional<WorldImpact> hit = world.cast_shape(casts[i]);
        const double latest = first_time(all_by_search(world, casts[i], 0.0));
        const double soonest = first_time(all_by_search(world, casts[i], kSkin));
        ++(hit ? met : missed);
        ASSERT_TRUE(hit || latest > 1.0) << i;
        ASSERT_TRUE(!hit || hit->impact.t <= latest + 1e-3) << i;
        ASSERT_TRUE(!hit || hit->impact.t >= soonest) << i;
        if (!hit) continue;
        ASSERT_TRUE(world.is_alive(hit->body));
        const Impact alone = first_by_search(casts[i].shape, casts[i].motion, world.shape(hit->shape), world.shape_pose(hit->shape),
                                             {.separation = casts[i].settings.separation + kSkin, .most_checks = 2000});
        EXPECT_LE(alone.t, hit->impact.t) << i << ": another shape was named";
        EXPECT_EQ(world.body_of(hit->shape), hit->body);
    }
    EXPECT_GT(met, 60);
    EXPECT_GT(missed, 20);
}

TEST(WorldCast, AllThatIsMetComesInOrderAndTheFirstIsTheFirst) {
    const World world = crowd();
    std::size_t most = 0;
    for (const ShapeCast& cast : casts_through(0xca58, 120)) {
        const std::vector<WorldImpact> all = world.cast_shape_all(cast);
        most = std::max(most, all.size());
        for (std::size_t k = 1; k < all.size(); ++k) ASSERT_LE(all[k - 1].impact.t, all[k].impact.t);
        const std::optional<WorldImpact> first = world.cast_shape(cast);
        ASSERT_EQ(first.has_value(), !all.empty());
        if (first) expect_same(first, all.front(), 0);
        const std::size_t at_least = all_by_search(world, cast, 0.0).size(), at_most = all_by_search(world, cast, kSkin).size();
        ASSERT_GE(all.size(), at_least);
        ASSERT_LE(all.size(), at_most);
    }
    EXPECT_GT(most, 5u);
}

TEST(WorldCast, BatchesOfAnySizeOnAnyThreadsGiveTheAnswersOfSingleCasts) {
    ScatteringExecutor threads;
    const World serial = crowd(), parallel = crowd(&threads);
    for (const int count : {0, 1, 20, 300}) {
        const std::vector<ShapeCast> casts = casts_through(0xca59, count);
        std::vector<std::optional<WorldImpact>> a(casts.size()), b(casts.size());
        serial.cast_shapes(casts, a);
        parallel.cast_shapes(casts, b);
        for (std::size_t i = 0; i < casts.size(); ++i) {
            expect_same(a[i], serial.cast_shape(casts[i]), i);
            expect_same(a[i], b[i], i);
            if (HasFailure()) return;
        }
    }
}

/// The hierarchy holds floats about an origin of its own, so nothing is lost there either.
TEST(WorldCast, FarFromTheOriginNothingIsMissed) {
    for (const double far : {1e3, 1e6, 1e9}) {
        World world;
        Random random(0xfa4);
        const dvec3 at = far * random_direction(random);
        for (int i = 0; i < 60; ++i) {
            const BodyId body = world.create_body({.position = at + 5.0 * random_direction(random), .orientation = random_rotation(random)});
            world.add_shape(body, any_convex(random, i));
        }
        std::vector<ShapeCast> casts = casts_through(0xca5b, 100);
        for (ShapeCast& cast : casts) cast.motion.start.position += at;
        std::vector<std::optional<WorldImpact>> batch(casts.size());
        world.cast_shapes(casts, batch);
        for (std::size_t i = 0; i < casts.size(); ++i) {
            expect_same(batch[i], world.cast_shape(casts[i]), i);
            ASSERT_TRUE(batch[i] || first_time(all_by_search(world, casts[i], 0.0)) > 1.0) << far << " " << i;
        }
    }
}

TEST(WorldCast, FiltersChoose) {
    Table table;
    const BodyId ghost = table.add({.position = {0, 4, 0}}, Sphere{0.5f}, {.layer = 2, .mask = 4});
    const BodyId crate = table.add({.position = {0, 2, 0}}, Box{});
    ShapeCast cast{.shape = Capsule{0.2f, 0.3f}, .motion = {.start = {{0, 9, 0}, kIdentityRotation}, .translation = {0, -20, 0}}};
    const auto first = [&] { return table.world.cast_shape(cast)->body; };
    EXPECT_EQ(first(), ghost) << "by default all are met";
    cast.filter.layer = 1;
    EXPECT_EQ(first(), crate) << "the ghost meets layer 4 alone";
    cast.filter.layer = 4;
    EXPECT_EQ(first(), ghost);
    cast.filter.mask = 1;
    EXPECT_EQ(first(), crate) << "the ghost is of layer 2";
    cast.filter = {.ignored = ghost};
    EXPECT_EQ(first(), crate);
    cast.filter = {.wanted = [](void* context, BodyId body, ShapeId) { return *static_cast<BodyId*>(context) == body; }, .context = &table.ground};
    EXPECT_EQ(first(), table.ground);
    EXPECT_EQ(table.world.cast_shape_all(cast).size(), 1u);
    std::array<std::optional<WorldImpact>, 1> out;
    table.world.cast_shapes({&cast, 1}, out);
    EXPECT_EQ(out[0]->body, table.ground);
}

TEST(WorldCast, KnownAnswers) {
    Table table;
    const BodyId low = table.add({.position = {0, 1, 0}}, Sphere{0.5f});
    const BodyId high = table.add({.position = {0, 3, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    ShapeCast cast{.shape = Sphere{0.25f}, .motion = {.start = {{0, 9, 0}, kIdentityRotation}, .translation = {0, -20, 0}}};
    const std::optional<WorldImpact> hit = table.world.cast_shape(cast);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->body, high);
    EXPECT_NEAR(hit->impact.t, 5.25 / 20.0, 1e-12);
    EXPECT_LE(hit->impact.t, 5.25 / 20.0);
    EXPECT_NEAR(hit->impact.point.y, 3.5, 1e-12);
    EXPECT_NEAR(hit->impact.normal.y, -1.0, 1e-12);
    table.world.destroy_body(high);
    EXPECT_EQ(table.world.cast_shape(cast)->body, low);
    cast.motion.start.position.x = 4.0;
    EXPECT_EQ(table.world.cast_shape(cast)->body, table.ground);
    cast.settings.until = 0.4;
    EXPECT_FALSE(table.world.cast_shape(cast)) << "later than is asked for";
    cast.motion.translation.y = -8.5;
    cast.settings.until = 1.0;
    EXPECT_FALSE(table.world.cast_shape(cast));
    // At the start, at rest, and the first of two at one time.
    cast.motion = {.start = {{0, 1, 0.5}, kIdentityRotation}};
    EXPECT_EQ(table.world.cast_shape(cast)->impact.status, ImpactStatus::Overlapping);
    EXPECT_EQ(table.world.cast_shape(cast)->impact.t, 0.0);
    const BodyId left = table.add({.position = {-1, 20, 0}}, Sphere{0.5f});
    table.add({.position = {1, 20, 0}}, Sphere{0.5f});
    cast.shape = Sphere{0.8f};
    cast.motion = {.start = {{0, 25, 0}, kIdentityRotation}, .translation = {0, -10, 0}};
    EXPECT_EQ(table.world.cast_shape(cast)->body, left);
}

TEST(WorldCast, WhatTurnsMeetsWhatItSweepsOver) {
    World world;
    const BodyId post = world.create_body({.type = BodyType::Static, .position = {0, 0.9, 0}});
    world.add_shape(post, Sphere{0.05f});
    ShapeCast swing{.shape = Box{{1.0f, 0.01f, 0.01f}}};
    EXPECT_FALSE(world.cast_shape(swing));
    swing.motion.rotation = {0, 0, 1.0};
    EXPECT_FALSE(world.cast_shape(swing));
    swing.motion.rotation = {0, 0, 7.0};
    const std::optional<WorldImpact> hit = world.cast_shape(swing);
    ASSERT_TRUE(hit && hit->impact.status == ImpactStatus::Touching);
    EXPECT_NEAR(hit->impact.t * 7.0, std::acos(0.06 / 0.9), 1e-6);
    swing.settings.most_checks = 1;
    EXPECT_EQ(world.cast_shape(swing)->impact.status, ImpactStatus::Clamped) << "nothing is known after it";
    EXPECT_LT(world.cast_shape(swing)->impact.t, hit->impact.t);
}

TEST(WorldCast, QuarantinedBodiesAreNotMet) {
    Table table;
    const BodyId bad = table.add({.position = {0, 1, 0}}, Sphere{0.5f});
    const ShapeCast cast{.shape = Sphere{0.25f}, .motion = {.start = {{0, 9, 0}, kIdentityRotation}, .translation = {0, -20, 0}}};
    EXPECT_EQ(table.world.cast_shape(cast)->body, bad);
    table.world.set_linear_velocity(bad, {1e37, 0, 0});
    table.world.step(kDt);
    ASSERT_TRUE(table.world.is_quarantined(bad));
    EXPECT_EQ(table.world.cast_shape(cast)->body, table.ground);
}

TEST(WorldCast, BadInputIsRefused) {
    World world = crowd();
    const Shape mesh = box_mesh(vec3{0.5f}, 1);
    const auto refused = [&](const ShapeCast& cast, ErrorCode code) {
        std::array<std::optional<WorldImpact>, 1> out{WorldImpact{}};
        EXPECT_EQ(validate(cast).error().code, code);
        const std::function<void()> calls[] = {[&] { (void)world.cast_shape(cast); }, [&] { (void)world.cast_shape_all(cast); },
                                               [&] { world.cast_shapes({&cast, 1}, out); }};
        for (const auto& call : calls) {
            try {
                call();
                ADD_FAILURE() << "accepted";
            } catch (const MisuseError& e) {
                EXPECT_EQ(e.error().code, code) << e.what();
            }
        }
        EXPECT_TRUE(out[0].has_value()) << "nothing was written";
    };
    refused({.shape = Sphere{0.0f}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{NAN}}, ErrorCode::NotFinite);
    refused({.shape = Plane{}}, ErrorCode::WrongType);
    refused({.shape = mesh}, ErrorCode::WrongType);
    refused({.shape = CompoundPtr{}}, ErrorCode::WrongType);
    refused({.shape = ConvexHullPtr{}}, ErrorCode::Empty);
    refused({.shape = Sphere{}, .motion = {.start = {{kNaN, 0, 0}, kIdentityRotation}}}, ErrorCode::NotFinite);
    refused({.shape = Sphere{}, .motion = {.translation = {0, INFINITY, 0}}}, ErrorCode::NotFinite);
    refused({.shape = Sphere{}, .motion = {.rotation = {0, kNaN, 0}}}, ErrorCode::NotFinite);
    refused({.shape = Sphere{}, .motion = {.pivot = {0, kNaN, 0}}}, ErrorCode::NotFinite);
    refused({.shape = Sphere{}, .motion = {.start = {dvec3{0.0}, {2, 0, 0, 0}}}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .motion = {.start = {{1e31, 0, 0}, kIdentityRotation}}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .motion = {.translation = {1e31, 0, 0}}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .motion = {.rotation = {1e10, 0, 0}}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .settings = {.separation = -1.0}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .settings = {.tolerance = kNaN}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .settings = {.most_checks = 0}}, ErrorCode::InvalidArgument);
    refused({.shape = Sphere{}, .settings = {.until = 2.0}}, ErrorCode::InvalidArgument);
    std::vector<std::optional<WorldImpact>> two(2);
    const ShapeCast one{.shape = Sphere{}};
    EXPECT_THROW(world.cast_shapes({&one, 1}, two), MisuseError);
    // Where the handler returns, so do they.
    const ErrorHandler before = set_error_handler([](const Error&) {});
    EXPECT_FALSE(world.cast_shape({.shape = Plane{}}));
    EXPECT_TRUE(world.cast_shape_all({.shape = Plane{}}).empty());
    set_error_handler(before);
}

/// Lengths at the ends of what is taken.
TEST(WorldCast, TheLargestAndTheSmallestAreAnswered) {
    World world;
    world.add_shape(world.create_body({.type = BodyType::Static}), Box{});
    const ShapeCast far{.shape = Sphere{0.5f}, .motion = {.start = {{1e30, 0, 0}, kIdentityRotation}, .translation = {-1e30, 0, 0}}};
    EXPECT_TRUE(world.cast_shape(far));
    const ShapeCast near{.shape = Sphere{1e-30f}, .motion = {.start = {{0.5 + 1e-9, 0, 0}, kIdentityRotation}, .translation = {-1e-8, 0, 0}}};
    ASSERT_TRUE(world.cast_shape(near));
    EXPECT_NEAR(world.cast_shape(near)->impact.t, 0.1, 1e-5);
    const ShapeCast speck{.shape = Sphere{1e-30f}, .motion = {.start = {{9, 0, 0}, kIdentityRotation}, .translation = {-1e-200, 0, 0}}};
    EXPECT_FALSE(world.cast_shape(speck));
}

}  // namespace
}  // namespace carom
