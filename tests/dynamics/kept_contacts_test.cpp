// Contacts of bodies that hardly move stay as they are from step to step, but for what their motion changes.
#include <carom/collision/convex_hull.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/explain.hpp>

#include "odd_executors.hpp"
#include "table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace carom {
namespace {

using namespace test;

ConvexHullPtr wedge() {
    return ConvexHull::build(std::vector<vec3>{{-0.4f, -0.3f, -0.4f}, {0.4f, -0.3f, -0.4f}, {-0.4f, -0.3f, 0.4f}, {0.4f, -0.3f, 0.4f}, {-0.3f, 0.3f, 0.0f}, {0.3f, 0.3f, 0.0f}}).value();
}

/// Four layers of boxes, wedges and balls, some askew, in a pit.
Table heap(const WorldDef& def) {
    Table table(def);
    for (const double side : {-1.0, 1.0}) {
        table.add({.type = BodyType::Static, .position = {3.4 * side, 1, 0}}, Box{{0.5f, 3.0f, 4.0f}});
        table.add({.type = BodyType::Static, .position = {0, 1, 3.4 * side}}, Box{{4.0f, 3.0f, 0.5f}});
    }
    const ConvexHullPtr hull = wedge();
    for (int i = 0; i < 144; ++i) {
        const dvec3 at{0.95 * (i % 6) - 2.4 + 0.01 * (i % 7), 0.6 + 0.95 * (i / 36), 0.95 * ((i / 6) % 6) - 2.4 + 0.01 * (i % 5)};
        const BodyDef body{.position = at, .angular_velocity = {0.3 * (i % 3), 0.2, 0.1 * (i % 4)}};
        if (i % 4 == 3) {
            table.add(body, Sphere{0.4f});
        } else if (i % 4 == 1) {
            table.add(body, hull);
        } else {
            table.add(body, Box{{0.4f, 0.3f + 0.05f * static_cast<float>(i % 3), 0.4f}});
        }
    }
    return table;
}

TEST(KeptContacts, AHeapRestsAsItDoesWithoutThem) {
    Table kept = heap({}), anew = heap({.contact_reuse = 0.0});
    kept.run(400), anew.run(400);
    const StepReport a = kept.world.step(kDt), b = anew.world.step(kDt);
    EXPECT_GT(static_cast<double>(a.reused), 0.6 * static_cast<double>(a.pairs));
    EXPECT_LT(a.boxes_given, 60u) << "what rests keeps its box";
    EXPECT_EQ(b.reused, 0u);
    EXPECT_LT(a.max_penetration, 2.0 * b.max_penetration);
    EXPECT_LT(a.mean_penetration, 1.25 * b.mean_penetration);
    const auto median_speed = [](const World& world) {
        std::vector<double> speeds;
        for (const BodyId body : world.bodies()) speeds.push_back(glm::length(world.linear_velocity(body)));
        std::ranges::nth_element(speeds, speeds.begin() + 75);
        return speeds[75];
    };
    EXPECT_LT(median_speed(kept.world), 2.0 * median_speed(anew.world) + 1e-4);
}

// explain() measures each pair where it is and holds what the step has of it against that.
TEST(KeptContacts, AreWhatThePosesGiveWithinTheSlack) {
    Table table = heap({});
    for (int round = 0; round < 8; ++round) {
        table.run(37);
        const std::vector<BodyId> bodies(table.world.bodies().begin(), table.world.bodies().end());
        std::size_t touching = 0;
        for (const BodyId a : bodies) {
            for (const BodyId b : bodies) {
                if (!(a < b)) continue;
                const ContactExplanation why = table.world.explain(a, b);
                EXPECT_TRUE(why.disagreements.empty()) << why.disagreements.front();
                touching += why.rung == Rung::Touch ? 1 : 0;
            }
        }
        EXPECT_GT(touching, 80u);
    }
}

// What rests is not given to the broadphase again; it must not have left the box that it has there.
TEST(KeptContacts, EveryShapeIsInItsBox) {
    Table table = heap({});
    const World& world = table.world;
    std::size_t kept = 0;
    for (int i = 0; i < 300; ++i) {
        std::vector<std::pair<std::uint32_t, Aabb>> were;
        for (const BodyId body : world.bodies()) {
            for (const ShapeId id : world.shapes(body)) {
                if (is_bounded(world.shape(id))) were.emplace_back(id.slot, bounds(world.shape(id), world.pose(body)));
            }
        }
        table.run(1);
        const dvec3 origin = world.broadphase_origin();
        for (const auto& [slot, was] : were) {
            const FloatAabb box = world.broadphase().box(slot);
            for (int k = 0; k < 3; ++k) {
                ASSERT_LE(origin[k] + static_cast<double>(box.lower[k]), was.lower[k]) << i;
                ASSERT_GE(origin[k] + static_cast<double>(box.upper[k]), was.upper[k]) << i;
            }
        }
        kept += world.broadphase().result().begun.empty() ? 1 : 0;
    }
    EXPECT_GT(kept, 50u);
}

TEST(KeptContacts, AreListedInTheOrderOfTheirShapesAndAreNeverEmpty) {
    Table table = heap({});
    std::size_t points = 0;
    for (int i = 0; i < 300; ++i) {
        table.run(1);
        std::pair<std::uint32_t, std::uint32_t> last{0, 0};
        for (std::size_t c = 0; c < table.world.contact_count(); ++c) {
            const ContactView view = table.world.contact(c);
            ASSERT_GT(view.manifold.count, 0u);
            points += view.manifold.count;
            const auto plane_last = [&](ShapeId id) { return id == table.ground_shape ? id.slot | 0x80000000u : id.slot; };
            const std::pair<std::uint32_t, std::uint32_t> now{view.shape_a.slot, plane_last(view.shape_b)};
            ASSERT_LT(last, now);
            last = now;
        }
    }
    EXPECT_GT(points, 60000u);
}

TEST(KeptContacts, HaveTheSameBitsOnAllThreadsAndWidths) {
    const auto hashes = [](Executor* executor, int width) {
        set_simd_width(width);
        Table table = heap({.executor = executor});
        const BodyId stick = table.add({.type = BodyType::Kinematic, .position = {-1.2, 9, 0.1}, .linear_velocity = {0, -1.4, 0}}, Box{{0.2f, 4.0f, 0.2f}});
        std::vector<std::uint64_t> out;
        for (int i = 0; i < 420; ++i) {
            if (i == 160) table.world.set_linear_velocity(stick, {0.1, 0, 0.02});  // stirs a corner of the heap
            table.run(1);
            out.push_back(table.world.state_hash());
        }
        set_simd_width(0);
        return out;
    };
    const std::vector<std::uint64_t> expected = hashes(nullptr, 0);
    for (const int width : available_simd_widths()) EXPECT_EQ(hashes(nullptr, width), expected) << width;
    for (const int threads : {2, 3}) {
        OddExecutor executor(threads, [](std::size_t count, const Executor::Body& body) { in_threads(count, body, false); });
        EXPECT_EQ(hashes(&executor, 0), expected) << threads << " threads";
    }
}

// What is never put in order would grow without end: contacts that come and go leave their numbers unused, until all are found anew.
TEST(KeptContacts, AreFoundAnewWhenTooManyAreOutOfUse) {
    World world({.contact_method = ContactMethod::Soft});
    const auto add = [&](const BodyDef& body, const vec3& half) {
        const BodyId id = world.create_body(body);
        world.add_shape(id, Box{half});
        return id;
    };
    add({.type = BodyType::Static, .position = {19, -1, 9}}, {60.0f, 1.0f, 60.0f});
    std::vector<BodyId> lids;
    for (int i = 0; i < 200; ++i) {
        const dvec3 at{2.0 * (i % 20), 0.5, 2.0 * (i / 20)};
        add({.position = at}, {0.5f, 0.5f, 0.5f});
        if (i % 5 == 0) lids.push_back(add({.type = BodyType::Kinematic, .position = at + dvec3{0, 0.703, 0}}, {0.4f, 0.2f, 0.4f}));
    }
    int anew = 0, kept = 0;
    for (int i = 0; i < 400; ++i) {
        for (const BodyId lid : lids) world.set_linear_velocity(lid, {0, i / 10 % 2 == 0 ? 0.3 : -0.3, 0});  // up by 5 cm, and down again to 3 mm over the box
        const StepReport report = world.step(kDt);
        if (i >= 60) ++(report.reused > 0 ? kept : anew);  // of two boxes, none is carried along where all are found anew
    }
    EXPECT_GE(anew, 3);
    EXPECT_LT(10 * anew, kept);
}

// A ball that is one of several shapes of a body looks the same however the body turns, but what its contact pushes against does not.
TEST(KeptContacts, ABallWithArmsIsLookedAtAsItTurns) {
    for (const bool has_arms : {false, true}) {
        Table table({.contact_method = ContactMethod::Soft});
        for (int i = 0; i < 20; ++i) table.add({.position = {3.0 * i, 0.5, 9.0}}, Box{{0.5f, 0.5f, 0.5f}});
        const BodyId top = table.add({.position = {0, 0.5, 0}}, Sphere{0.5f});
        for (const double side : {-1.0, 1.0}) {
            if (has_arms) table.world.add_shape(top, Box{{0.2f, 0.1f, 0.1f}}, {.local = {{0.9 * side, 0, 0}, kIdentityRotation}});
        }
        table.run(60);
        table.world.set_angular_velocity(top, {0, 1.0, 0});
        std::size_t looked = 0;
        for (int i = 0; i < 32; ++i) {
            const StepReport report = table.world.step(kDt);
            looked += report.pairs - report.reused;
        }
        EXPECT_EQ(looked >= 32u, has_arms) << looked << "; a third of a pair a step is due anyway";
    }
}

// A body at rest that is pushed hard is no slow one: contacts are predicted for what it may do in a step, and not farther than its size allows.
TEST(KeptContacts, APushSendsNothingAgainstWhatItPasses) {
    for (const double speed : {20.0, 200.0}) {
        World world({.gravity = {0, 0, 0}, .continuous = {.enabled = false}});
        const BodyId block = world.create_body({.type = BodyType::Static, .position = {-0.5, -0.5, 0}});
        world.add_shape(block, Box{{0.5f, 0.5f, 0.5f}});
        const BodyId ball = world.create_body({.position = {0.2, 0.2, 0}});
        world.add_shape(ball, Sphere{0.1f});
        for (int i = 0; i < 3; ++i) world.step(kDt);
        const double mass = world.mass_properties(ball).mass;
        world.apply_force(ball, {-speed * mass / kDt, 0, 0}, world.center_of_mass(ball));
        for (int i = 0; i < 3; ++i) world.step(kDt);
        EXPECT_LT(glm::length(world.linear_velocity(ball) - dvec3{-speed, 0, 0}), 1e-9 * speed);
    }
}

// Gravity moves them by more than their size in a step, whether they have room or not.
TEST(KeptContacts, GrainsHaveNoMoreContactsThanWithoutThem) {
    const auto most_of = [](double reuse) {
        Table table({.contact_reuse = reuse, .contact_method = ContactMethod::Soft});
        constexpr float kSize = 1e-3f;
        for (int i = 0; i < 64; ++i) {
            table.add({.position = 1.1 * static_cast<double>(kSize) * dvec3{i % 4, 0.5 + i / 16, (i / 4) % 4}}, Box{vec3{0.5f * kSize}});
        }
        std::size_t most = 0;
        for (int i = 0; i < 30; ++i) most = std::max(most, table.world.step(kDt).manifolds);
        return static_cast<double>(most);
    };
    EXPECT_LE(most_of(1e-2), 1.1 * most_of(0.0));
}

// Boxes in a row close in on each other: contacts come one by one, and each finds a lane in which neither of its bodies is.
TEST(KeptContacts, NewOnesComeWhileTheOthersAreKept) {
    const auto run = [](int width) {
        set_simd_width(width);
        Table table({.contact_method = ContactMethod::Soft}, 0.0f);
        double x = 0.0;
        for (int i = 0; i < 80; ++i) {
            x += 1.0065 + 2e-4 * (i * 7 % 13);
            table.add({.position = {x, 0.5, 0}, .linear_velocity = {2e-4 * (40 - i), 0, 0}}, Box{{0.5f, 0.5f, 0.5f}}, {.friction = 0.0f});
        }
        std::size_t most = 0, reused = 0, pairs = 0;
        for (int i = 0; i < 450; ++i) {
            const StepReport report = table.world.step(kDt);
            most = std::max(most, report.manifolds);
            reused += i > 20 ? report.reused : 0, pairs += i > 20 ? report.pairs : 0;
        }
        set_simd_width(0);
        EXPECT_GT(most, 110u);
        EXPECT_GT(2 * reused, pairs);
        return table.world.state_hash();
    };
    const std::uint64_t expected = run(0);
    for (const int width : available_simd_widths()) EXPECT_EQ(run(width), expected) << width;
}

/// A box on a plank on the ground, a ball beside them; all at rest, and known to be.
struct Rest {
    Table table;
    BodyId plank, box, ball;

    explicit Rest(double reuse) : table({.contact_reuse = reuse, .contact_method = ContactMethod::Soft}) {
        plank = table.add({.type = BodyType::Kinematic, .position = {0, 0.5, 0}}, Box{{1.5f, 0.5f, 1.5f}});
        box = table.add({.position = {0, 1.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
        ball = table.add({.position = {3, 0.5, 0}}, Sphere{0.5f});
        table.run(120);
    }
};

struct Event {
    const char* name;
    std::function<void(Rest& rest)> happens;
    double moves = 0.0;  ///< at least, of the box [m]
    int steps = 60;
};

TEST(KeptContacts, WhateverHappensIsSeenAtOnce) {
    const Event events[] = {
        {"nothing", [](Rest&) {}, 0.0},
        {"the plank goes", [](Rest& r) { r.table.world.destroy_body(r.plank); }, 0.9},
        {"the plank is put elsewhere", [](Rest& r) { r.table.world.set_pose(r.plank, {{0, -3, 0}, kIdentityRotation}); }, 0.9},
        {"the plank is put a little lower", [](Rest& r) { r.table.world.set_pose(r.plank, {{0, 0.4999, 0}, kIdentityRotation}); }, 0.9e-4, 3},
        {"the plank moves", [](Rest& r) { r.table.world.set_linear_velocity(r.plank, {0.5, 0, 0}); }, 0.4},
        {"the plank creeps", [](Rest& r) { r.table.world.set_linear_velocity(r.plank, {1e-3, 0, 0}); }, 0.9e-3},
        {"the box is hit", [](Rest& r) { r.table.world.apply_impulse(r.box, {900, 0, 0}, r.table.world.center_of_mass(r.box)); }, 0.04},
        {"the box is light", [](Rest& r) { r.table.world.set_gravity_scale(r.box, -0.1); }, 0.3},
        {"the box is locked", [](Rest& r) {
             r.table.world.set_locked_axes(r.box, LockedAxes::MoveY);
             r.table.world.destroy_body(r.plank);
         }, 0.0},
        {"another lands", [](Rest& r) { r.table.add({.position = {0.3, 3.0, 0.1}}, Box{{0.4f, 0.4f, 0.4f}}); }, 0.0},
        {"a bullet comes", [](Rest& r) { r.table.add({.position = {-5, 1.5, 0}, .linear_velocity = {400, 0, 0}}, Sphere{0.1f}, {.density = 8000.0}); }, 0.5},
        {"a joint comes", [](Rest& r) { r.table.world.create_joint(BallJointDef{.body_a = r.box, .anchor_a = {0, 0.5, 0}, .anchor_b = {0, 2, 0}}); }, 0.0},
        {"a wing comes", [](Rest& r) { r.table.world.add_shape(r.box, Box{{0.2f, 0.2f, 0.2f}}, {.density = 9000.0, .local = {{2.0, 0, 0}, kIdentityRotation}}); }, 0.2},
        {"a body without shapes comes", [](Rest& r) { r.table.world.create_body({.type = BodyType::Kinematic}); }, 0.0},
        {"the step is shorter", [](Rest& r) { for (int i = 0; i < 30; ++i) r.table.world.step(kDt / 2); }, 0.0},
    };
    for (const Event& event : events) {
        Rest kept(WorldDef{}.contact_reuse), anew(0.0);
        EXPECT_GT(kept.table.world.step(kDt).reused, 0u);
        EXPECT_EQ(anew.table.world.step(kDt).reused, 0u);
        const dvec3 before = anew.table.world.center_of_mass(anew.box);
        for (Rest* rest : {&kept, &anew}) {
            event.happens(*rest);
            rest->table.run(event.steps);
        }
        const dvec3 a = kept.table.world.center_of_mass(kept.box), b = anew.table.world.center_of_mass(anew.box);
        EXPECT_LT(glm::length(a - b), 2e-5 + 0.01 * glm::length(b - before)) << event.name;
        EXPECT_GE(glm::length(b - before), event.moves) << event.name;
    }
}

// Who has lost his last contact flies as exactly as ever, though nothing is found anew of the others.
TEST(KeptContacts, WhatIsThrownUpFliesOnItsOwn) {
    Table table({.contact_method = ContactMethod::Soft});
    for (int i = 0; i < 30; ++i) table.add({.position = {2.0 * i, 0.5, 0}}, Box{{0.5f, 0.5f, 0.5f}});
    const BodyId ball = table.add({.position = {-5, 0.5, 0}}, Sphere{0.5f});
    table.run(120);
    table.world.set_linear_velocity(ball, {0, 4, 0});
    table.run(4);
    const dvec3 at = table.world.center_of_mass(ball), velocity = table.world.linear_velocity(ball);
    for (int i = 1; i <= 30; ++i) {
        EXPECT_GT(table.world.step(kDt).reused, 25u);
        const double t = i * kDt;
        EXPECT_NEAR(table.world.center_of_mass(ball).y, at.y + velocity.y * t - 0.5 * 9.81 * t * t, 1e-13);
    }
}

// The blow moves the box by nothing to speak of, but not as the contact solver had it.
TEST(KeptContacts, WhatWasStruckIsLookedAt) {
    Table table({.contact_method = ContactMethod::Soft});
    for (int i = 0; i < 20; ++i) table.add({.position = {0, 2.0, 3.0 * i}}, Box{{0.5f, 2.0f, 0.5f}}, {.density = 1e6});
    table.run(120);
    for (int i = 0; i < 3; ++i) table.add({.position = {-3.0, 3.5, 3.0 * i}, .linear_velocity = {300, 0, 0}}, Sphere{0.05f}, {.density = 10.0});
    std::size_t looked = 0, struck = 0;
    for (int i = 0; i < 3; ++i) {
        const StepReport report = table.world.step(kDt);
        if (struck > 0) looked = std::max(looked, report.pairs - report.reused);
        struck = report.continuous.impacts;
    }
    EXPECT_GE(looked, 6u) << "each ball and its box, the box and the ground";
}

// A box creeps over the edge of a table, at a thirtieth of a millimetre a step: it tips where its middle has no more under it.
TEST(KeptContacts, WhatCreepsOverAnEdgeTips) {
    const auto steps_to_tip = [](double reuse) {
        Table table({.contact_reuse = reuse, .contact_method = ContactMethod::Soft}, 0.0f);
        table.add({.type = BodyType::Static, .position = {-2, 2, 0}}, Box{{2.0f, 0.5f, 1.0f}}, {.friction = 0.0f});
        const BodyId box = table.add({.position = {-0.004, 3.0, 0}, .linear_velocity = {0.002, 0, 0}}, Box{{0.5f, 0.5f, 0.5f}}, {.friction = 0.0f});
        int steps = 0;
        while (table.world.center_of_mass(box).y > 2.95 && steps < 2000) table.run(1), ++steps;
        return steps;
    };
    const int kept = steps_to_tip(WorldDef{}.contact_reuse), anew = steps_to_tip(0.0);
    EXPECT_LT(anew, 500);
    EXPECT_NEAR(kept, anew, 15) << "half a millimetre";
}

}  // namespace
}  // namespace carom
