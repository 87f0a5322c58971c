// What a world says that it holds is what it has asked for.
#include "table.hpp"

#include <carom/dynamics/world_memory.hpp>

#include <gtest/gtest.h>
#include <support/allocations.hpp>

#include <functional>
#include <string>

namespace carom {
namespace {

using namespace test;

constexpr double kNarrowphase = 250'000;  // [bytes], its own: for a thousand pairs at a time

constexpr Box kCrate{{0.4f, 0.5f, 0.3f}};

TEST(WorldMemory, IsWhatWasAskedFor) {
    struct Case {
        const char* name;
        WorldDef def;
        std::function<void(Table&, int i)> change;  // a body that has come
    };
    const Case cases[] = {
        {"a heap", {}, [](Table&, int) {}},
        {"that sleeps", {.sleep = {.enabled = true, .time = 0.1}}, [](Table&, int) {}},
        {"with all reports", {.report_residual = true, .record_paths = true}, [](Table&, int) {}},
        {"solved directly", {.contact_method = ContactMethod::Direct}, [](Table&, int) {}},
        {"with joints",
         {},
         [](Table& table, int i) {
             if (i % 4 != 0)
                 table.world.create_joint(
                     SpringDef{.body_a = table.world.bodies()[table.world.body_count() - 2], .body_b = table.world.bodies().back()});
         }},
    };
    for (const Case& c : cases) {
        const long before = bytes_held();
        Table table(c.def);
        for (int i = 0; i < 400; ++i) {
            table.add(
                {.position = {1.1 * (i % 10), 0.6 + 1.2 * (i / 100), 1.1 * (i / 10 % 10)}, .name = std::string(i % 2 == 0 ? 60 : 3, 'n')},
                kCrate);
            c.change(table, i);
        }
        for (const int steps : {0, 1, 20, 100}) {
            table.run(steps);
            const auto held = static_cast<double>(bytes_held() - before), said = static_cast<double>(table.world.memory().total());
            EXPECT_LT(said, held) << c.name << ", " << steps;
            EXPECT_GT(said, 0.96 * held - (steps > 0 ? kNarrowphase : 0.0)) << c.name << ", " << steps << ": " << said << " of " << held;
        }
    }
}

TEST(WorldMemory, IsOfTheirParts) {
    Table table;
    const WorldMemory none = table.world.memory();
    EXPECT_EQ(none.contacts + none.scratch + none.joints, 0u);
    for (int i = 0; i < 200; ++i) table.add({.position = {2.0 * i, 0.5, 0}}, kCrate);
    const WorldMemory built = table.world.memory();
    EXPECT_GT(built.bodies, none.bodies + 200 * 300);
    EXPECT_GT(built.shapes, none.shapes + 200 * 300);
    EXPECT_EQ(built.contacts + built.scratch, 0u);
    table.run(3);
    const WorldMemory stepped = table.world.memory();
    EXPECT_EQ(stepped.shapes - built.shapes, (stepped.shapes - built.shapes) % (200 * 8)) << "but for lists of slots";
    EXPECT_GT(stepped.contacts, 200 * (sizeof(Manifold) + 100));
    EXPECT_GT(stepped.solver, 200u * 100u);
    EXPECT_GT(stepped.broadphase, 200u * 50u);
    EXPECT_GT(stepped.scratch, 200u * 160u);
    EXPECT_EQ(stepped.total(), stepped.bodies + stepped.shapes + stepped.joints + stepped.broadphase + stepped.contacts + stepped.solver +
                                   stepped.scratch + stepped.other);
}

// Definitions are kept once for all that are alike and come one after the other, and a pose in the body where there is one.
TEST(WorldMemory, ShapesThatAreAlikeShareTheirDefinition) {
    const auto held_by_shapes = [](int kinds, double aside) {
        Table table;
        for (int i = 0; i < 200; ++i) {
            const ShapeDef def{.friction = 0.1f * static_cast<float>(1 + i % kinds), .local = {.position = {0.0, aside, 0.0}}};
            const BodyId body = table.add({.position = {2.0 * i, 0.5, 0}}, kCrate, def);
            const ShapeId shape = table.world.shapes(body).front();
            EXPECT_EQ(table.world.shape_def(shape), def);
            EXPECT_NEAR(table.world.shape_pose(shape).position.y, 0.5 + aside, 1e-12);
        }
        for (int i = 0; i < 200; ++i) {
            const ShapeId shape = table.world.shapes(table.world.bodies()[static_cast<std::size_t>(1 + i)]).front();
            EXPECT_EQ(table.world.shape_def(shape).friction, 0.1f * static_cast<float>(1 + i % kinds)) << "whatever came later";
        }
        return table.world.memory().shapes;
    };
    const std::size_t alike = held_by_shapes(1, 0.0);
    EXPECT_GE(held_by_shapes(2, 0.0), alike + 199 * sizeof(ShapeDef));
    // The principal frame goes aside with the only shape.
    EXPECT_EQ(held_by_shapes(1, 0.25), alike);
}

TEST(WorldMemory, AShapeBesideItsBodysMiddleHasAPoseOfItsOwn) {
    const auto held_by_shapes = [](double aside) {
        Table table;
        for (int i = 0; i < 200; ++i) {
            const BodyId body = table.add({.position = {4.0 * i, 0.5, 0}}, kCrate, {.friction = 0.25f});  // no two that follow each other are alike
            table.world.add_shape(body, kCrate, {.friction = 0.5f, .local = {.position = {aside, 0.0, 0.0}}});
        }
        return table.world.memory().shapes;
    };
    EXPECT_EQ(held_by_shapes(0.5), held_by_shapes(0.0) + 2 * 200 * sizeof(Pose)) << "both of two";
}

}  // namespace
}  // namespace carom
