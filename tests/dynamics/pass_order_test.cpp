// The order of the passes: what Gauss-Seidel in one order leaves cancels over a step.
#include "table.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cstdio>
#include <span>
#include <vector>

namespace carom {
namespace {

using test::kDt;
using test::Table;

double mean_speed(const World& world, const std::vector<BodyId>& bodies) {
    double sum = 0.0;
    for (const BodyId body : bodies) sum += glm::length(world.linear_velocity(body));
    return sum / static_cast<double>(bodies.size());
}

// With all passes in one order the wall sways at 1 to 3 mm/s.
TEST(PassOrder, AWallOfFortyRowsComesToRest) {
    for (const int substeps : {5, 7, 8}) {
        Table table({.substeps = substeps, .contact_method = ContactMethod::Soft});
        std::vector<BodyId> boxes;
        for (int row = 0; row < 40; ++row) {
            for (int i = 0; i < 40 - row; ++i) {
                boxes.push_back(table.add({.position = {1.02 * (i + 0.5 * row), 0.5 + row, 0.0}}, Box{vec3{0.5f}}, {.friction = 0.6f}));
            }
        }
        table.run(300);
        const double speed = mean_speed(table.world, boxes);
        std::printf("%d substeps: %g m/s\n", substeps, speed);
        EXPECT_LT(speed, 8e-4);
    }
}

// Its two colours have a bundle each, which are taken together. In one order it sways twice as fast.
TEST(PassOrder, SoDoesAColumnOfThirty) {
    Table table({.contact_method = ContactMethod::Soft});
    std::vector<BodyId> boxes;
    for (int i = 0; i < 30; ++i) boxes.push_back(table.add({.position = {0.0, 0.5 + i, 0.0}}, Box{vec3{0.5f}}));
    table.run(1800);
    const double speed = mean_speed(table.world, boxes);
    std::printf("%g m/s\n", speed);
    EXPECT_LT(speed, 3e-5);
}

// Who lies on the plate shares it with all others, so most contacts find no colour. They come last in passes that go forward, and first in those that go backward.
TEST(PassOrder, WhatFindsNoColourIsSolvedInBothPasses) {
    Table table({.contact_method = ContactMethod::Soft});
    const BodyId plate = table.add({.position = {0.0, 0.1, 0.0}}, Box{{4.0f, 0.1f, 4.0f}}, {.density = 200.0f});
    std::vector<BodyId> bodies{plate};
    for (int i = 0; i < 144; ++i) {
        bodies.push_back(
            table.add({.position = {0.5 * (i % 12 - 5.5), 0.35, 0.5 * (i / 12 - 5.5)}}, Box{vec3{0.15f}}, {.density = 2000.0f}));
    }
    std::size_t overflow = 0;
    for (int i = 0; i < 200; ++i) overflow = std::max<std::size_t>(overflow, table.world.step(kDt).overflow);
    EXPECT_GT(overflow, 50u);
    EXPECT_LT(mean_speed(table.world, bodies), 1e-3);
    for (const BodyId body : std::span(bodies).subspan(1)) EXPECT_NEAR(table.world.pose(body).position.y, 0.35, 2e-3);
}

}  // namespace
}  // namespace carom
