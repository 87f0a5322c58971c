// The oracle of resting forces, the problems that the solver's study asks, and what the methods make of them.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/solver_cases.hpp>
#include <carom/studies/oracle/contact_forces.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace carom::accuracy {
namespace {

constexpr double kDt = 1.0 / 60.0;

World after(const SolverCase& problem, const WorldDef& def, int steps) {
    World world = problem.make(def);
    for (int i = 0; i < steps; ++i) world.step(kDt);
    return world;
}

WorldDef by(ContactMethod method, int passes = 8) { return {.substeps = passes, .contact_method = method, .direct_budget = 2'000'000}; }

TEST(ContactForces, AreThoseOfStaticsWhereTheDirectMethodSolvesAndNotWhereNobodyHas) {
    const SolverCasePtr column = solver_case(SolverKind::Column, true);
    const World solved = after(*column, by(ContactMethod::Direct), 10), one_pass = after(*column, by(ContactMethod::Impulses, 1), 1);
    const oracle::ContactForces good = oracle::contact_forces(solved, kDt), bad = oracle::contact_forces(one_pass, kDt);
    ASSERT_EQ(good.carried.size(), column->carried.size());
    EXPECT_NEAR(column->carried.front(), 20.0 * 9810.0, 1e-6) << "the lowest carries all";
    EXPECT_NEAR(column->carried.back(), 9810.0, 1e-6);
    for (std::size_t i = 0; i < good.carried.size(); ++i) EXPECT_NEAR(good.carried[i] / column->carried[i], 1.0, 1e-3) << i;
    EXPECT_LT(good.unbalanced, 1e-3);
    EXPECT_LT(good.beyond_cone, 1e-6);
    EXPECT_EQ(good.pull, 0.0);
    EXPECT_GT(bad.unbalanced, 0.05);
    // The same forces in a step of another length are not those that carry.
    EXPECT_GT(oracle::contact_forces(solved, 2.0 * kDt).unbalanced, 0.1);
}

TEST(ContactForces, AFreeBodyIsNotCarried) {
    World world;
    world.add_shape(world.create_body(), Box{vec3{0.5f}});
    world.step(kDt);
    const oracle::ContactForces forces = oracle::contact_forces(world, kDt);
    ASSERT_EQ(forces.carried.size(), 1u);
    EXPECT_EQ(forces.carried[0], 0.0);
    EXPECT_EQ(forces.unbalanced, 1.0);
}

TEST(SolverCases, EachCanRestAndTheDirectMethodFindsTheForces) {
    for (const SolverKind kind : solver_kinds()) {
        const SolverCasePtr problem = solver_case(kind, true);
        const World solved = after(*problem, by(ContactMethod::Direct), 60);
        EXPECT_LT(oracle::contact_forces(solved, kDt).unbalanced, 5e-3) << to_string(kind);
        const World before = problem->make({});
        for (std::size_t i = 0; i < before.bodies().size(); ++i) {
            const dvec3 moved = solved.center_of_mass(solved.bodies()[i]) - before.center_of_mass(before.bodies()[i]);
            EXPECT_LT(glm::length(moved), 5e-3) << to_string(kind) << " " << i;
        }
    }
}

TEST(SolverCases, MorePassesAreNearerAndTheHeavyBoxIsBeyondThem) {
    const auto unbalanced = [](SolverKind kind, const WorldDef& def) {
        const SolverCasePtr problem = solver_case(kind, true);
        return oracle::contact_forces(after(*problem, def, 10), kDt).unbalanced;
    };
    EXPECT_LT(unbalanced(SolverKind::Arch, by(ContactMethod::Impulses, 64)), 0.1 * unbalanced(SolverKind::Arch, by(ContactMethod::Impulses, 4)));
    EXPECT_GT(unbalanced(SolverKind::Heavy, by(ContactMethod::Impulses, 64)), 0.1) << "ratio 1e4 takes some 46,000 sweeps";
    EXPECT_LT(unbalanced(SolverKind::Heavy, by(ContactMethod::Direct)), 1e-3);
}

TEST(SolverStudies, HaveNamesOfTheirOwnAndEveryMethod) {
    const std::vector<Study> studies = solver_studies({.quick = true});
    std::set<std::string> names, methods;
    for (const Study& study : studies) EXPECT_TRUE(names.insert(study.name).second) << study.name;
    ASSERT_EQ(studies[0].name, "solver");
    EXPECT_EQ(names.count("solver_heavy_force"), 1u);
    for (const Candidate& c : studies[0].candidates) methods.insert(std::get<std::string>(c.settings[0].second));
    EXPECT_EQ(methods, (std::set<std::string>{"direct", "impulses", "soft"}));
    double sum = 0.0;
    for (const Study& study : studies) {
        if (study.name != "solver" && !study.name.ends_with("_force")) sum += std::min(study.candidates[0].run().error.value(), 1.0);
    }
    EXPECT_NEAR(studies[0].candidates[0].run().error.value(), sum / 5.0, 1e-12);
}

}  // namespace
}  // namespace carom::accuracy
