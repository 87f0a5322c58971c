// The oracle of free bodies against elliptic functions and closed forms; the fit of orders; and the orders that the study finds.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/integrator_baselines.hpp>
#include <carom/studies/accuracy/integrator_cases.hpp>
#include <carom/studies/accuracy/integrator_digest.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace carom::accuracy {
namespace {

using oracle::FreeBody;
using oracle::free_motion;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Landau, Lifshitz, Mechanics, section 37: I1 < I2 < I3 and L² > 2 E I2, from a moment at which the middle component is zero.
TEST(FreeMotion, SpinsByJacobisFunctions) {
    const dvec3 moments{2.0, 3.0, 4.0};
    const double w1 = 2.0, w3 = 3.5, i1 = moments.x, i2 = moments.y, i3 = moments.z;
    const double twice_energy = i1 * w1 * w1 + i3 * w3 * w3, l_sq = i1 * i1 * w1 * w1 + i3 * i3 * w3 * w3;
    ASSERT_GT(l_sq, twice_energy * i2);
    const double rate = std::sqrt((i3 - i2) * (l_sq - twice_energy * i1) / (i1 * i2 * i3));
    const double m = (i2 - i1) * (twice_energy * i3 - l_sq) / ((i3 - i2) * (l_sq - twice_energy * i1));
    const double b = std::sqrt((twice_energy * i3 - l_sq) / (i2 * (i3 - i2)));
    const std::array times{0.3, 1.0, 10.0, 100.0};
    const auto states = free_motion({.moments = moments, .start = {.spin = {w1, 0.0, w3}}}, times);
    for (std::size_t i = 0; i < times.size(); ++i) {
        double cn = 0.0, dn = 0.0;
        const double sn = boost::math::jacobi_elliptic(std::sqrt(m), rate * times[i], &cn, &dn);
        const dvec3 spin = rotate_inverse(states[i].orientation, states[i].spin);
        EXPECT_LT(glm::length(spin - dvec3{w1 * cn, b * sn, w3 * dn}), 1e-13 * (1.0 + times[i])) << times[i];
        const dvec3 momentum = rotate(states[i].orientation, moments * spin);
        EXPECT_LT(glm::length(momentum - dvec3{i1 * w1, 0.0, i3 * w3}), 1e-14 * std::sqrt(l_sq)) << "L stays in the world";
    }
}

// Two exact rotations: about L at |L| / I1, and about the axis of symmetry at (1 - I3 / I1) w3.
TEST(FreeMotion, TurnsASymmetricTopByTwoRotations) {
    const dvec3 moments{2.0, 2.0, 5.0}, spin{1.5, 0.0, 4.0}, momentum = moments * spin;
    const std::array times{10.0};
    const auto states = free_motion({.moments = moments, .start = {.spin = spin}}, times);
    const auto turn = [](const dvec3& axis, double angle) {
        const dvec3 v = axis * std::sin(0.5 * angle);
        return dquat{std::cos(0.5 * angle), v.x, v.y, v.z};
    };
    const dquat expected = turn(glm::normalize(momentum), 10.0 * glm::length(momentum) / 2.0) * turn({0.0, 0.0, 1.0}, 10.0 * (1.0 - 5.0 / 2.0) * 4.0);
    EXPECT_NEAR(std::abs(glm::dot(states[0].orientation, expected)), 1.0, 1e-15);
    EXPECT_LT(glm::length(rotate(states[0].orientation, moments * rotate_inverse(states[0].orientation, states[0].spin)) - momentum), 1e-13);
}

TEST(FreeMotion, FallsAlongAParabolaAndRefusesMisuse) {
    const std::array times{0.0, 2.0};
    const auto states = free_motion({.start = {.position = {1, 2, 3}, .velocity = {4, 0, 0}}, .acceleration = {0, -10, 0}}, times);
    ASSERT_EQ(states.size(), 2u);
    EXPECT_EQ(states[0].position, dvec3(1, 2, 3));
    EXPECT_EQ(states[1].position, dvec3(9, -18, 3));
    EXPECT_EQ(states[1].velocity, dvec3(4, -20, 0));
    EXPECT_THROW(static_cast<void>(free_motion({.moments = {1, 0, 1}}, times)), MisuseError);
    EXPECT_THROW(static_cast<void>(free_motion({.start = {.spin = {kNan, 0, 0}}}, times)), MisuseError);
    EXPECT_THROW(static_cast<void>(free_motion({}, std::array{2.0, 1.0})), MisuseError);
    EXPECT_THROW(static_cast<void>(free_motion({}, std::array{-1.0})), MisuseError);
    EXPECT_THROW(static_cast<void>(free_motion({}, std::array{kNan})), MisuseError);
}

StudyResult power_law(const std::string& name, double order, double largest) {
    StudyResult result{name, "", "", "", "", "", {}, {}, {}, {}};
    for (double dt = 0.125; dt > 0.01; dt *= 0.5) {
        result.points.push_back({"carom", {{"scheme", std::string("s")}, {"dt", dt}}, 1.0, 0.0, largest * std::pow(dt / 0.125, order), 0});
    }
    return result;
}

TEST(Slopes, AreThePowersOfPowerLaws) {
    StudyResult result = power_law("law", 2.0, 1e-2);
    for (const double dt : {0.1, 0.2, 0.4}) result.points.push_back({"peer", {{"dt", dt}}, 1.0, 0.0, dt * 0.5, 0});
    result.points.push_back({"peer", {{"dt", 8.0}}, 1.0, 0.0, 0.9, 0});                // too large to be of the law
    result.points.push_back({"peer", {{"dt", 0.8}}, 1.0, 0.0, std::nullopt, 1});       // failed
    result.points.push_back({"few", {{"dt", 0.1}}, 1.0, 0.0, 0.1, 0});
    result.points.push_back({"other", {{"knob", 0.1}}, 1.0, 0.0, 0.1, 0});
    const std::vector<Series> series = slopes(result, "dt");
    ASSERT_EQ(series.size(), 2u);
    EXPECT_EQ(to_string(series[0].settings), "scheme=s");
    EXPECT_NEAR(series[0].slope.value(), 2.0, 1e-12);
    EXPECT_EQ(series[0].largest, 1e-2);
    EXPECT_EQ(series[1].who, "peer");
    EXPECT_EQ(series[1].points, 4u);
    EXPECT_NEAR(series[1].slope.value(), 1.0, 1e-12);
    EXPECT_EQ(slopes(power_law("law", 0.0, 1e-13), "dt")[0].slope, std::nullopt) << "rounding has no order";
    StudyResult floor = power_law("law", 4.0, 1e-6);  // 1e-6, 6e-8, 4e-9, 2e-10
    for (const double dt : {0.002, 0.001}) floor.points.push_back({"carom", floor.points[0].settings, 1.0, 0.0, 3e-10, 0}), floor.points.back().settings[1].second = dt;
    EXPECT_NEAR(slopes(floor, "dt")[0].slope.value(), 4.0, 1e-12) << "where rounding takes over is left out";
    for (Point& p : floor.points) *p.error *= 1e3;
    EXPECT_LT(slopes(floor, "dt")[0].slope.value(), 3.0) << "but a stop that is no rounding counts";
}

TEST(OrderRows, PassFromTwoOn) {
    const auto verdict = [](const StudyResult& result) { return order_rows(std::span(&result, 1)).at(0).verdict; };
    EXPECT_EQ(verdict(power_law("integrator", 2.0, 1e-2)), OrderVerdict::Passed);
    EXPECT_EQ(verdict(power_law("integrator", 4.0, 1e-2)), OrderVerdict::Passed);
    EXPECT_EQ(verdict(power_law("integrator", 1.9, 1e-2)), OrderVerdict::Failed);
    EXPECT_EQ(verdict(power_law("integrator", 1.0, 1e-2)), OrderVerdict::Failed);
    EXPECT_EQ(verdict(power_law("integrator", 0.0, 1e-12)), OrderVerdict::Exact);
    const auto asked = [](const std::string& name, double largest) {
        StudyResult result = power_law(name, 0.0, largest);
        for (Point& p : result.points) p.settings.insert(p.settings.begin(), {"tolerance", 1e-6});
        return result;
    };
    EXPECT_EQ(verdict(asked("integrator_energy", 9e-7)), OrderVerdict::Passed);
    EXPECT_EQ(verdict(asked("integrator_energy", 2e-6)), OrderVerdict::Failed);
    EXPECT_EQ(verdict(asked("integrator", 2e-6)), OrderVerdict::NotAsked);
    StudyResult peer = power_law("integrator", 1.0, 1e-2);
    for (Point& p : peer.points) p.who = "peer";
    EXPECT_EQ(verdict(peer), OrderVerdict::NotAsked);
}

TEST(FreeCases, MeasureWhatWasSpoiled) {
    const FreeCasesPtr cases = free_cases(FreeKind::Falling, 2, 1.0);
    Track run{0.0, cases->truth};
    for (const FreeMeasure m : {FreeMeasure::Orientation, FreeMeasure::Energy, FreeMeasure::Momentum, FreeMeasure::Position}) {
        EXPECT_EQ(error_of(*cases, run, m), 0.0);
    }
    oracle::FreeBodyState& state = run.states[1].back();
    const double way = glm::length(state.position - cases->bodies.moving[1].pose.position);
    state.position.x += 1e-3 * way;
    state.orientation = state.orientation * dquat{std::cos(5e-5), std::sin(5e-5), 0.0, 0.0};
    state.spin *= 1.0 + 1e-6;
    EXPECT_NEAR(error_of(*cases, run, FreeMeasure::Position).value(), 1e-3, 1e-12);
    EXPECT_NEAR(error_of(*cases, run, FreeMeasure::Orientation).value(), 1e-4, 1e-12);
    EXPECT_GT(error_of(*cases, run, FreeMeasure::Energy).value(), 1e-7);
    EXPECT_GT(error_of(*cases, run, FreeMeasure::Momentum).value(), 1e-7);
    state.spin.x = kNan;
    EXPECT_EQ(error_of(*cases, run, FreeMeasure::Position), std::nullopt);
}

TEST(FreeCases, TheTextbooksIntegratorIsOfFirstOrderAndTheRotationAloneIsTheWorldsOwn) {
    const FreeCasesPtr cases = free_cases(FreeKind::Falling, 2, 1.0);
    const auto error = [&](Engine& engine, double dt) { return error_of(*cases, follow(engine, cases->bodies, cases->times, dt), FreeMeasure::Position).value(); };
    // It falls g t h / 2 too far, of g t² / 2 and what the throw adds.
    EXPECT_NEAR(error(*make_semi_implicit_euler(cases->bodies), 1.0 / 64) / error(*make_semi_implicit_euler(cases->bodies), 1.0 / 128), 2.0, 1e-6);
    const Track world = follow(*make_carom(cases->make({})), cases->bodies, cases->times, 1.0 / 64);
    const Track alone = follow(*make_rotation(cases->bodies, {.tolerance = 1e-6}), cases->bodies, cases->times, 1.0 / 64);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(world.states[i].back().spin, alone.states[i].back().spin);
}

// Every method of Carom shows its order or is exact, whatever the class of inertia; the box that spins keeps within its limits.
TEST(IntegratorStudy, HasOrderTwoOrBetter) {
    std::vector<StudyResult> results;
    for (const Study& study : integrator_studies({.quick = true})) results.push_back(measure(study, {.repeats = 1}));
    std::size_t passed = 0, exact = 0;
    for (const OrderRow& row : order_rows(results)) {
        const std::string name = row.study + " " + row.series.who + " " + to_string(row.series.settings);
        EXPECT_NE(row.verdict, OrderVerdict::Failed) << name;
        passed += row.verdict == OrderVerdict::Passed;
        exact += row.verdict == OrderVerdict::Exact;
        if (row.series.who == "euler" && row.study == "integrator") {
            EXPECT_NEAR(row.series.slope.value_or(0.0), 1.0, 0.2) << name;
        }
        if (row.study == "integrator" && to_string(row.series.settings) == "call=rotate_free scheme=fourth_order") {
            EXPECT_NEAR(row.series.slope.value_or(0.0), 4.0, 0.3);
        }
    }
    EXPECT_GE(passed, 7u) << "world, Strang and fourth order in attitude and energy, and the tolerances";
    EXPECT_GE(exact, 14u) << "L always; symmetric and isotropic bodies, and the fall";
    std::size_t spins = 0;
    for (const StudyResult& result : results) {
        if (!result.name.starts_with("integrator_single_body_spin")) continue;
        ++spins;
        EXPECT_LT(result.points.at(0).error.value_or(1.0), result.name.ends_with("_energy") ? kMostSpinEnergy : kMostSpinMomentum) << result.name;
    }
    EXPECT_EQ(spins, 2u);
    EXPECT_NE(integrator_digest(results).table.find("integrator_single_body_spin_energy     carom"), std::string::npos);
}

}  // namespace
}  // namespace carom::accuracy
