// What the direct escalation is for, in whole worlds: stiff stacks stand, with the forces of statics; others are not touched by it.
#include <carom/dynamics/world.hpp>

#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>

#include <gtest/gtest.h>

#include <dynamics/table.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using test::kDt;
using test::Table;

/// A column of unit boxes of these masses [kg], the lowest first.
struct Column {
    Table table;
    std::vector<BodyId> boxes;

    explicit Column(const std::vector<double>& masses, const WorldDef& def = {}) : table(def) {
        for (std::size_t i = 0; i < masses.size(); ++i) {
            boxes.push_back(table.add({.position = {0, 0.5 + static_cast<double>(i), 0}}, Box{vec3{0.5f}}, {.density = masses[i]}));
        }
    }
    [[nodiscard]] double height(std::size_t i) const { return table.world.pose(boxes[i]).position.y; }
    /// By how much the distance of a box to the one below is less than 1 m.
    [[nodiscard]] double squash(std::size_t i) const { return 1.0 - (height(i) - (i > 0 ? height(i - 1) : -0.5)); }
    [[nodiscard]] double worst_squash() const {
        double worst = 0.0;
        for (std::size_t i = 0; i < boxes.size(); ++i) worst = std::max(worst, squash(i));
        return worst;
    }
    [[nodiscard]] double top_speed() const {
        double most = 0.0;
        for (const BodyId b : boxes) most = std::max(most, glm::length(table.world.linear_velocity(b)));
        return most;
    }
    /// The force on the underside of box i [N].
    [[nodiscard]] double force_under(std::size_t i) const {
        double sum = 0.0;
        for (std::size_t c = 0; c < table.world.contact_count(); ++c) {
            const ContactView view = table.world.contact(c);
            const BodyId below = i > 0 ? boxes[i - 1] : table.ground;
            if (!((view.body_a == boxes[i] && view.body_b == below) || (view.body_b == boxes[i] && view.body_a == below))) continue;
            for (const float impulse : view.normal_impulse) sum += static_cast<double>(impulse);
        }
        return sum / (kDt / table.world.settings().substeps);
    }
};

TEST(Direct, AHeavyBoxDoesNotSquashALightOne) {
    for (const double ratio : {1e2, 1e3, 1e4, 1e6}) {
        Column column({1.0, ratio});
        double worst = 0.0;
        for (int i = 0; i < 600; ++i) {
            const StepReport report = column.table.world.step(kDt);
            EXPECT_EQ(report.direct.solved, 1u) << ratio << " step " << i;
            worst = std::max(worst, column.worst_squash());
        }
        EXPECT_LT(worst, 1e-3) << ratio;
        EXPECT_NEAR(column.force_under(1), 9.81 * ratio, 1e-3 * 9.81 * ratio) << ratio;
        EXPECT_NEAR(column.force_under(0), 9.81 * (1.0 + ratio), 1e-3 * 9.81 * ratio) << ratio;
        EXPECT_LT(column.top_speed(), 1e-4) << ratio;
    }
}

TEST(Direct, AColumnOfThirtySinksByLessThanAMillimetreInThirtySeconds) {
    Column column(std::vector<double>(30, 1000.0));
    column.table.run(1800);
    EXPECT_LT(29.5 - column.height(29), 1e-3);
    EXPECT_LT(std::abs(column.table.world.pose(column.boxes[29]).position.x), 1e-3);
    EXPECT_LT(column.top_speed(), 1e-4);
    for (std::size_t i = 0; i < 30; ++i) {
        const double weight = 9.81 * 1000.0 * static_cast<double>(30 - i);
        EXPECT_NEAR(column.force_under(i), weight, 1e-3 * weight) << i;
    }
}

TEST(Direct, AStackOfAlternatingMassesStands) {
    Column column({0.1, 10.0, 0.1, 10.0, 0.1});
    column.table.run(3600);
    EXPECT_LT(column.worst_squash(), 1e-3);
    EXPECT_LT(column.top_speed(), 1e-4);
}

TEST(Direct, WhatIsNotStiffIsSolvedSoftlyToTheSameBit) {
    const auto run = [](ContactMethod method) {
        Column column(std::vector<double>(6, 500.0), {.contact_method = method});
        std::size_t stiff = 0;
        for (int i = 0; i < 120; ++i) stiff += column.table.world.step(kDt).direct.stiff;
        return std::pair{stiff, column.table.world.state_hash()};
    };
    EXPECT_EQ(run(ContactMethod::Automatic), run(ContactMethod::Soft));
    EXPECT_EQ(run(ContactMethod::Automatic).first, 0u);
    EXPECT_NE(run(ContactMethod::Direct).second, run(ContactMethod::Soft).second);
    EXPECT_EQ(run(ContactMethod::Direct).first, 120u);
}

TEST(Direct, SameBitsAtEveryWidthAndTwice) {
    const auto run = [] {
        Column column({1.0, 50.0, 2.0, 4000.0});
        column.table.world.set_linear_velocity(column.boxes[3], {0.4, 0.0, 0.2});
        for (int i = 0; i < 4; ++i) column.table.add({.position = {3.0 + 2.0 * i, 0.5, 0}}, Box{vec3{0.5f}}, {.density = 1.0});
        for (int i = 0; i < 4; ++i) column.table.add({.position = {3.0 + 2.0 * i, 1.5, 0}}, Box{vec3{0.5f}}, {.density = 100.0});
        std::size_t solved = 0;
        for (int i = 0; i < 90; ++i) solved += column.table.world.step(kDt).direct.solved;
        EXPECT_GT(solved, 300u);
        return column.table.world.state_hash();
    };
    const std::uint64_t best = run();
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        EXPECT_EQ(run(), best) << "width " << width;
    }
    set_simd_width(0);
}

TEST(Direct, IslandsThatCostTooMuchStaySoftAndAreCounted) {
    Column column(std::vector<double>(30, 1000.0), {.direct_budget = 10});
    StepReport report;
    for (int i = 0; i < 30; ++i) report = column.table.world.step(kDt);
    EXPECT_EQ(report.direct.stiff, 1u);
    EXPECT_EQ(report.direct.too_large, 1u);
    EXPECT_EQ(report.direct.solved, 0u);
}

/// Boxes side by side on two, row upon row.
struct Pyramid {
    static constexpr int kBase = 14;
    Table table;
    std::vector<std::vector<BodyId>> rows;

    explicit Pyramid(const WorldDef& def) : table(def) {
        for (int row = 0; row < kBase; ++row) {
            rows.emplace_back();
            for (int i = 0; i < kBase - row; ++i) rows.back().push_back(table.add({.position = {1.1 * i + 0.55 * row, 0.5 + row, 0}}, Box{vec3{0.5f}}));
        }
    }
    /// Sums over so many steps.
    DirectCounts run(int steps) {
        DirectCounts sum;
        for (int i = 0; i < steps; ++i) {
            const DirectCounts counts = table.world.step(kDt).direct;
            sum.ordered += counts.ordered;
            sum.too_large += counts.too_large;
            sum.solved += counts.solved;
        }
        return sum;
    }
};

// To find the order of elimination takes as long as the steps in between: what was too dear stays so while it is as large.
TEST(Direct, AnIslandThatCostsTooMuchIsNotOrderedAgainUntilItShrinks) {
    Pyramid pyramid({.contact_method = ContactMethod::Direct, .direct_budget = 1600});
    const DirectCounts first = pyramid.run(300);
    EXPECT_EQ(first.ordered, 1u);
    EXPECT_EQ(first.too_large, 300u);
    EXPECT_EQ(first.solved, 0u);
    for (std::size_t row = 7; row < pyramid.rows.size(); ++row) {
        for (const BodyId box : pyramid.rows[row]) pyramid.table.world.destroy_body(box);
    }
    const DirectCounts then = pyramid.run(300);
    EXPECT_EQ(then.ordered, 1u) << "whose contacts stay as they are";
    EXPECT_GT(then.solved, 0u);
    EXPECT_EQ(then.solved + then.too_large, 300u) << "it waits for the next look";
}

TEST(Direct, AHeavyBoxThatFallsOnALightOneGainsNoEnergy) {
    Column column({1.0});
    const BodyId heavy = column.table.add({.position = {0.1, 3.0, 0}}, Box{vec3{0.5f}}, {.density = 1000.0});
    const double start = column.table.world.energy().total();
    for (int i = 0; i < 300; ++i) {
        column.table.world.step(kDt);
        EXPECT_LT(column.table.world.energy().total() - start, 1e-3 * 9.81 * 1001.0) << i;
    }
    EXPECT_GT(column.table.world.pose(heavy).position.y, 0.49);
}

TEST(Direct, BadSettingsAreRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double sag : {0.0, 1e-7, 0.02, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        EXPECT_FALSE(validate(WorldDef{.direct_sag = sag}).ok()) << sag;
        EXPECT_THROW(World({.direct_sag = sag}), MisuseError) << sag;
    }
    EXPECT_FALSE(validate(WorldDef{.direct_budget = (std::size_t{1} << 32) + 1}).ok());
    EXPECT_FALSE(validate(WorldDef{.contact_method = static_cast<ContactMethod>(4)}).ok());
    EXPECT_TRUE(validate(WorldDef{.contact_method = ContactMethod::Direct, .direct_sag = 0.01, .direct_budget = 0}).ok());
    EXPECT_STREQ(to_string(ContactMethod::Direct), "direct");
}

}  // namespace
}  // namespace carom
