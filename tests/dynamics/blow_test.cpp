// The law of a blow that both kinds of impacts go by.
#include <carom/dynamics/detail/blow.hpp>
#include <carom/dynamics/detail/meeting.hpp>

#include <gtest/gtest.h>

namespace carom::dynamics {
namespace {

/// A ball of 2 kg with the moment 0.5 kg m².
BlowBody ball(const dvec3& velocity, const dvec3& spin = dvec3{0.0}) { return {velocity, spin, dvec3{0.5}, dmat3{2.0}}; }
const BlowBody kGround{};

TEST(Blow, NoImpulsePulls) {
    EXPECT_EQ(stopping_impulse(0.0, 2.0, -3.0), 6.0) << "what approaches is stopped";
    EXPECT_EQ(stopping_impulse(6.0, 2.0, 1.0), 4.0) << "what was given too much is taken back";
    EXPECT_EQ(stopping_impulse(6.0, 2.0, 9.0), 0.0) << "but not more than was given";
    EXPECT_EQ(stopping_impulse(0.0, 2.0, 1.0), 0.0);
}

TEST(Blow, MassIsFeltWhereItGivesWay) {
    const BlowBody a = ball({0, 0, 0});
    const dvec3 x{1, 0, 0}, arm{0, 0.5, 0};
    EXPECT_DOUBLE_EQ(felt_mass({a, dvec3{0.0}}, {kGround, dvec3{0.0}}, x), 2.0);
    EXPECT_DOUBLE_EQ(felt_mass({a, dvec3{0.0}}, {a, dvec3{0.0}}, x), 1.0);
    EXPECT_DOUBLE_EQ(felt_mass({a, arm}, {kGround, arm}, x), 1.0) << "1 / (1/2 + 0.5² / 0.5)";
    EXPECT_EQ(felt_mass({kGround, arm}, {kGround, arm}, x), 0.0);
}

TEST(Blow, PushesAreEqualAndOpposite) {
    BlowBody a = ball({1, 0, 0}), b = ball({-1, 0, 0});
    push({a, {0, 0.5, 0}}, {b, {0, -0.5, 0}}, {4, 0, 0});
    EXPECT_EQ(a.velocity, (dvec3{-1, 0, 0}));
    EXPECT_EQ(b.velocity, (dvec3{1, 0, 0}));
    EXPECT_EQ(a.spin, (dvec3{0, 0, 4})) << "-2 (r x J) about z";
    EXPECT_EQ(b.spin, (dvec3{0, 0, 4}));
}

TEST(Blow, FrictionStopsTheSlidingAtMostAndStaysInItsCone) {
    const dvec3 up{0, 1, 0}, centre{0.0};
    const auto slides = [&](double most) {
        BlowBody ground = kGround, b = ball({3, 0, 0});
        rub({ground, centre}, {b, centre}, up, b.velocity, most, 0.0);
        return b.velocity.x;
    };
    EXPECT_DOUBLE_EQ(slides(100.0), 0.0) << "no farther than to a stop";
    EXPECT_DOUBLE_EQ(slides(2.0), 2.0) << "2 N s on 2 kg";
    BlowBody ground = kGround, slow = ball({1e-9, 0, 0});
    rub({ground, centre}, {slow, centre}, up, slow.velocity, 1.0, 1e-8);
    EXPECT_EQ(slow.velocity.x, 1e-9) << "what is still does not slide";
}

// A bar that falls on one end of it while the other rises: the end that rises is not held down.
TEST(Blow, AMeetingHoldsNothingBack) {
    Meeting meeting;
    meeting.b.velocity = {0, -1, 0}, meeting.b.spin = {0, 0, 4};
    meeting.b.inverse_mass = dvec3{0.5}, meeting.b.inverse_inertia = dmat3{2.0};
    meeting.points = {{.at = {-0.5, 0, 0}, .normal = {0, 1, 0}}, {.at = {0.5, 0, 0}, .normal = {0, 1, 0}}};
    EXPECT_EQ(meeting.resolve(), 1);
    EXPECT_NEAR(meeting.points[0].impulse, 3.0, 1e-12) << "approaches at 3 m/s, and weighs 1 kg there";
    EXPECT_EQ(meeting.points[1].impulse, 0.0);
    EXPECT_GT(meeting.b.velocity.y + 0.5 * meeting.b.spin.z, 0.0) << "the other end goes on rising";
}

}  // namespace
}  // namespace carom::dynamics
