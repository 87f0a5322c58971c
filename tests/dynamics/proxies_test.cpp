// Bodies that come, go and change touch their own boxes in the broadphase and no others, and leave the contacts of a world that
// was built in one go.
#include <carom/core/random.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/world.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace carom {
namespace {

constexpr double kDt = 1.0 / 60.0;

/// A grid of static boxes and, well above them, one of dynamic ones that float: `side`² each.
struct Field {
    explicit Field(int side) {
        for (int i = 0; i < side * side; ++i) {
            const dvec3 at{3.0 * (i % side), 0.0, 3.0 * (i / side)};
            fixed.push_back(world.create_body({.type = BodyType::Static, .position = at}));
            world.add_shape(fixed.back(), Box{});
            floating.push_back(world.create_body({.position = at + dvec3{0, 5, 0}}));
            world.add_shape(floating.back(), Box{});
        }
    }
    StepReport step() { return world.step(kDt); }

    World world{{.gravity = dvec3{0.0}, .contact_reuse = 0.0}};  // otherwise what rests keeps its box
    std::vector<BodyId> fixed, floating;
};

BodyId add_box(World& world, BodyType type, const dvec3& at) {
    const BodyId body = world.create_body({.type = type, .position = at});
    world.add_shape(body, Box{});
    return body;
}

TEST(Proxies, WhatComesGoesOrChangesTouchesItsOwnBoxOnly) {
    Field field(16);
    World& world = field.world;
    const std::size_t moving = field.floating.size();
    EXPECT_EQ(field.step().boxes_given, 2 * moving);
    EXPECT_EQ(field.step().boxes_given, moving) << "static boxes are made once";

    const BodyId wall = add_box(world, BodyType::Static, {0, 20, 0});
    EXPECT_EQ(field.step().boxes_given, moving + 1);
    world.set_pose(wall, {{0, 30, 0}, dquat{1, 0, 0, 0}});
    EXPECT_EQ(field.step().boxes_given, moving + 1);
    world.add_shape(wall, Sphere{});
    EXPECT_EQ(field.step().boxes_given, moving + 1) << "the box that was there stays";

    const BodyId crate = add_box(world, BodyType::Dynamic, {0, 25, 0});
    EXPECT_EQ(field.step().boxes_given, moving + 1);
    world.destroy_body(crate);
    StepReport report = field.step();
    EXPECT_EQ(report.boxes_given, moving);
    EXPECT_EQ(report.boxes_removed, 1u);

    world.destroy_body(wall);
    report = field.step();
    EXPECT_EQ(report.boxes_given, moving);
    EXPECT_EQ(report.boxes_removed, 2u);
    EXPECT_EQ(world.broadphase().live_count(), 2 * moving);
    EXPECT_EQ(field.step().boxes_removed, 0u);
}

TEST(Proxies, ASlotThatIsUsedAgainIsTheNewShapes) {
    Field field(4);
    World& world = field.world;
    field.step();
    const ShapeId old = world.shapes(field.fixed[5])[0];
    world.destroy_body(field.fixed[5]);
    const BodyId wall = add_box(world, BodyType::Static, {100, 0, 0});
    ASSERT_EQ(world.shapes(wall)[0].slot, old.slot);
    StepReport report = field.step();
    EXPECT_EQ(report.boxes_given, field.floating.size() + 1);
    EXPECT_EQ(report.boxes_removed, 0u);
    EXPECT_GT(double(world.broadphase().box(old.slot).lower.x) + world.broadphase_origin().x, 99.0);

    // A plane has no box, so the slot's has to go.
    world.destroy_body(wall);
    const BodyId ground = world.create_body({.type = BodyType::Static});
    ASSERT_EQ(world.add_shape(ground, Plane{{0, 1, 0}, -50.0f}).slot, old.slot);
    report = field.step();
    EXPECT_EQ(report.boxes_removed, 1u);
    EXPECT_EQ(world.broadphase().live_count(), 2 * field.floating.size() - 1);
    EXPECT_EQ(report.pairs, 0u);

    // And back: the plane stops nothing any more.
    world.set_pose(ground, {{0, 60, 0}, dquat{1, 0, 0, 0}});
    EXPECT_EQ(field.step().pairs, field.floating.size()) << "all boxes are below the plane's surface now";
    world.destroy_body(ground);
    EXPECT_EQ(field.step().pairs, 0u);
}

TEST(Proxies, AWorldThatIsEmptiedAndFilledAgainStartsAnew) {
    Field field(4);
    World& world = field.world;
    field.step();
    for (const std::vector<BodyId>* bodies : {&field.fixed, &field.floating}) {
        for (const BodyId body : *bodies) world.destroy_body(body);
    }
    world.step(kDt);  // leaves out Bounds and Pairs: nothing could meet
    add_box(world, BodyType::Static, {0, 0, 0});
    add_box(world, BodyType::Dynamic, {0, 0.9, 0});
    const StepReport report = field.step();
    EXPECT_EQ(report.boxes_given, 2u);
    EXPECT_EQ(report.pairs, 1u);
    EXPECT_EQ(world.broadphase().live_count(), 2u);
}

TEST(Proxies, QuarantineTakesOneBoxOutAndReleasePutsItBack) {
    Field field(4);
    World& world = field.world;
    field.step();
    world.set_linear_velocity(field.floating[3], {1e16, 0, 0});
    StepReport report = field.step();
    ASSERT_EQ(report.quarantined.size(), 1u);
    EXPECT_EQ(report.boxes_given, field.floating.size() - 1);
    EXPECT_EQ(report.boxes_removed, 1u);
    world.add_shape(field.floating[3], Sphere{});
    EXPECT_EQ(field.step().boxes_given, field.floating.size() - 1);
    world.release(field.floating[3]);
    report = field.step();
    EXPECT_EQ(report.boxes_given, field.floating.size() + 1) << "it has two shapes now";
    EXPECT_EQ(report.boxes_removed, 0u);
}

// What was never valid has no pose to go back to, and least of all that of the body which had its slot before.
TEST(Proxies, QuarantineHasNoPoseOfTheBodyBefore) {
    World world;
    const BodyId gone = world.create_body({.position = {5, 6, 7}});
    world.step(kDt);
    world.destroy_body(gone);
    const BodyId wild = world.create_body({.position = {1, 2, 3}, .linear_velocity = {1e16, 0, 0}});
    ASSERT_EQ(wild.slot, gone.slot);
    ASSERT_EQ(world.step(kDt).quarantined.size(), 1u);
    EXPECT_EQ(world.pose(wild), Pose{});
}

TEST(Proxies, TheOriginStaysUntilTheSceneHasLeftIt) {
    Field field(8);
    World& world = field.world;
    field.step();
    const dvec3 origin = world.broadphase_origin();
    const BodyId near = add_box(world, BodyType::Dynamic, {40, 5, 40});
    field.step();
    EXPECT_EQ(world.broadphase_origin(), origin);

    for (const BodyId body : world.bodies()) {
        world.set_pose(body, {world.pose(body).position + dvec3{1e7, 0, 0}, dquat{1, 0, 0, 0}});
    }
    EXPECT_EQ(field.step().boxes_given, world.body_count());
    EXPECT_EQ(world.broadphase_origin(), origin) << "nothing came or went";
    world.destroy_body(near);
    EXPECT_EQ(field.step().boxes_given, world.body_count());
    EXPECT_NEAR(world.broadphase_origin().x, 1e7 + 10.5, 1.0);
}

/// A world that bodies and shapes keep coming to and going from.
class Churn {
public:
    Churn(BroadphaseMethod method, std::uint64_t seed) : random_(seed), world({.broadphase = method}) {
        world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
        world.add_shape(world.create_body({.type = BodyType::Static, .position = {0, -0.4, 0}}), Box{{4, 0.5f, 4}});
        for (int i = 0; i < 80; ++i) add_body();
    }
    void change() {
        for (int i = below(3); i > 0; --i) add_body();
        for (int i = below(3); i > 0 && world.body_count() > 40; --i) world.destroy_body(some_body());
        if (below(4) == 0) world.add_shape(some_body(true), some_shape(), {.local = {{0, 0.3, 0}, dquat{1, 0, 0, 0}}});
        if (below(4) == 0) world.set_pose(some_body(), {some_place(), dquat{1, 0, 0, 0}});
        if (below(8) == 0) world.set_mass_properties(some_body(), {2.0, dvec3{0.0, 0.05, 0.0}, dmat3{0.5}});
    }

private:
    int below(int n) { return static_cast<int>(random_.range(0.0, n)); }
    dvec3 some_place() { return {random_.range(-3, 3), random_.range(0.5, 6), random_.range(-3, 3)}; }
    Shape some_shape() {
        const auto size = static_cast<float>(random_.range(0.2, 0.6));
        switch (below(3)) {
            case 0: return Sphere{size};
            case 1: return Box{{size, 0.4f, 0.3f}};
            default: return Capsule{0.25f, size};
        }
    }
    /// One that came after the ground: dynamic ones where `any` is false.
    BodyId some_body(bool any = false) {
        for (;;) {
            const BodyId body = world.bodies()[2 + static_cast<std::size_t>(below(static_cast<int>(world.body_count()) - 2))];
            if (any || world.type(body) == BodyType::Dynamic) return body;
        }
    }
    void add_body() {
        const BodyType type = below(8) == 0 ? BodyType::Static : below(8) == 0 ? BodyType::Kinematic : BodyType::Dynamic;
        const BodyId body = world.create_body({.type = type, .position = some_place()});
        const std::uint64_t layer = below(10) == 0 ? 2 : 1;
        const std::uint64_t mask = below(10) == 0 ? 1 : ~std::uint64_t{0};
        world.add_shape(body, some_shape(), {.layer = layer, .mask = mask});
        if (type == BodyType::Kinematic) world.set_linear_velocity(body, {0.2, 0, 0});
    }
    Random random_;

public:
    World world;
};

/// The same bodies and shapes, none of which ever went, the shapes in the order of their slots in `world`.
World rebuilt(const World& world) {
    World fresh(world.settings());
    std::vector<std::pair<ShapeId, BodyId>> shapes;
    for (const BodyId body : world.bodies()) {
        const BodyId copy = fresh.create_body({.type = world.type(body)});
        for (const ShapeId shape : world.shapes(body)) shapes.push_back({shape, copy});
    }
    std::stable_sort(shapes.begin(), shapes.end(), [](const auto& a, const auto& b) { return a.first.slot < b.first.slot; });
    for (const auto& [shape, body] : shapes) fresh.add_shape(body, world.shape(shape), world.shape_def(shape));
    for (std::size_t i = 0; i < world.body_count(); ++i) {
        const BodyId body = world.bodies()[i], copy = fresh.bodies()[i];
        if (world.type(body) == BodyType::Dynamic) fresh.set_mass_properties(copy, world.mass_properties(body));
        fresh.set_pose(copy, world.pose(body));
        if (world.type(body) == BodyType::Static) continue;
        fresh.set_linear_velocity(copy, world.linear_velocity(body));
        fresh.set_angular_velocity(copy, world.angular_velocity(body));
    }
    return fresh;
}

struct Touch {
    std::size_t body_a, body_b;
    std::uint32_t points;
    float deepest;
};

std::vector<Touch> touches(const World& world) {
    const auto index = [&](BodyId body) {
        return static_cast<std::size_t>(std::find(world.bodies().begin(), world.bodies().end(), body) - world.bodies().begin());
    };
    std::vector<Touch> all;
    for (std::size_t i = 0; i < world.contact_count(); ++i) {
        const ContactView view = world.contact(i);
        float deepest = INFINITY;
        for (const ContactPoint& p : view.manifold.used()) deepest = std::min(deepest, p.separation);
        all.push_back({index(view.body_a), index(view.body_b), view.manifold.count, deepest});
    }
    return all;
}

TEST(Proxies, ContactsAreThoseOfAWorldBuiltInOneGo) {
    for (const BroadphaseMethod method : {BroadphaseMethod::Automatic, BroadphaseMethod::SortedAxes, BroadphaseMethod::DynamicTree}) {
        Churn churn(method, 20);
        std::size_t compared = 0;
        for (int step = 0; step < 200; ++step) {
            churn.change();
            if (step % 3 != 0) {
                churn.world.step(kDt);
                continue;
            }
            World fresh = rebuilt(churn.world);
            const StepReport report = churn.world.step(kDt);
            const StepReport expected = fresh.step(kDt);
            ASSERT_TRUE(report.quarantined.empty());
            EXPECT_EQ(churn.world.broadphase().live_count(), fresh.broadphase().live_count());
            const std::vector<Touch> found = touches(churn.world), wanted = touches(fresh);
            ASSERT_EQ(found.size(), wanted.size()) << to_string(method) << ", step " << step;
            for (std::size_t i = 0; i < found.size(); ++i) {
                EXPECT_EQ(found[i].body_a, wanted[i].body_a);
                EXPECT_EQ(found[i].body_b, wanted[i].body_b);
                EXPECT_EQ(found[i].points, wanted[i].points) << to_string(method) << ", step " << step;
                // Poses are rounded once more on their way into the copy.
                EXPECT_NEAR(found[i].deepest, wanted[i].deepest, 1e-5f);
            }
            compared += found.size();
            EXPECT_LE(report.boxes_given, expected.boxes_given);
        }
        EXPECT_GT(compared, 1500u);
    }
}

TEST(Proxies, ComingAndGoingLeavesTheSameBitsWithEveryBroadphase) {
    const auto run = [](BroadphaseMethod method) {
        Churn churn(method, 21);
        for (int step = 0; step < 150; ++step) {
            churn.change();
            churn.world.step(kDt);
        }
        return churn.world.state_hash();
    };
    const std::uint64_t expected = run(BroadphaseMethod::BruteForce);
    for (const BroadphaseMethod method : kBroadphaseMethods) EXPECT_EQ(run(method), expected) << to_string(method);
}

// A broadphase may refuse an update, or throw: what came and went with it comes and goes with the next.
TEST(Proxies, AreListedAgainUntilTheBroadphaseTookThemOver) {
    dynamics::ProxySet set;
    dynamics::BodyArrays bodies;
    bodies.states.resize(1);
    bodies.masses.resize(1);
    bodies.roles.assign(1, dynamics::Role::Static);
    dynamics::NewProxy proxy;
    proxy.id = {0, 1};
    proxy.shape = Box{};
    SerialExecutor serial;
    const auto update = [&] { dynamics::update_swept_bounds(set, bodies, {.dt = kDt}, {}, serial); };
    dynamics::put_proxy(set, proxy, {});
    for (int k = 0; k < 3; ++k) {
        update();
        EXPECT_EQ(set.moved, std::vector<std::uint32_t>{0}) << k;
    }
    dynamics::note_listed(set);
    update();
    EXPECT_TRUE(set.moved.empty()) << "it is static";
    dynamics::drop_proxy(set, 0);
    for (int k = 0; k < 3; ++k) {
        update();
        EXPECT_EQ(set.removed, std::vector<std::uint32_t>{0}) << k;
    }
    dynamics::note_listed(set);
    update();
    EXPECT_TRUE(set.removed.empty());
}

}  // namespace
}  // namespace carom
