// Euler angles, axis and angle, and matrices: each rotates as the quaternion does, both ways, at the gimbal lock and for tiny turns.
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>
#include <carom/core/rotations.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

constexpr EulerOrder kOrders[] = {EulerOrder::XYZ, EulerOrder::XZY, EulerOrder::YXZ, EulerOrder::YZX, EulerOrder::ZXY, EulerOrder::ZYX};
// A dozen roundings of 2^-53.
constexpr double kTolerance = 2e-15;

dquat random_rotation(Random& random) {
    dquat q{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
    return q / std::sqrt(glm::dot(q, q));
}

// Of the same rotation, q and -q, the nearer.
double distance(const dquat& a, const dquat& b) {
    const dquat minus = a - b, plus = a + b;
    return std::sqrt(std::min(glm::dot(minus, minus), glm::dot(plus, plus)));
}

dmat3 turn(int axis, double angle) {
    const SinCos t = sin_cos(angle);
    dmat3 m{1.0};
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    m[u][u] = t.cos, m[u][v] = t.sin, m[v][u] = -t.sin, m[v][v] = t.cos;
    return m;
}

TEST(Euler, TheOrderIsTheOneInTheName) {
    const int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    Random random(0xe01);
    for (int n = 0; n < 6; ++n) {
        for (int i = 0; i < 200; ++i) {
            const EulerAngles e{random.range(-7, 7), random.range(-7, 7), random.range(-7, 7)};
            const dmat3 want = turn(axes[n][0], e.first) * turn(axes[n][1], e.second) * turn(axes[n][2], e.third);
            const dmat3 got = rotation_matrix(rotation_from_euler(e, kOrders[n]));
            for (int k = 0; k < 9; ++k) EXPECT_NEAR(got[k / 3][k % 3], want[k / 3][k % 3], kTolerance);
        }
    }
}

TEST(Euler, AnglesGiveTheRotationBackNextToTheGimbalLockToo) {
    Random random(0xe02);
    for (const EulerOrder order : kOrders) {
        for (int i = 0; i < 2000; ++i) {
            EulerAngles e{random.range(-kPi, kPi), random.range(-kPi / 2, kPi / 2), random.range(-kPi, kPi)};
            if (i % 2 == 0) e.second = std::copysign(kPi / 2 - std::ldexp(random.unit(), -static_cast<int>(random.range(0, 60))), e.second);
            if (i % 20 == 0) e.second = std::copysign(kPi / 2, e.second);
            const dquat q = rotation_from_euler(e, order);
            const EulerAngles back = euler_angles(q, order);
            ASSERT_LE(distance(rotation_from_euler(back, order), q), kTolerance) << i;
            ASSERT_LE(std::fabs(back.first), kPi);
            ASSERT_LE(std::fabs(back.second), kPi / 2);
            ASSERT_LE(std::fabs(back.third), kPi);
            if (std::fabs(e.second) < 1.5) {  // away from the lock, the angles themselves
                ASSERT_NEAR(back.first, e.first, 1e-13);
                ASSERT_NEAR(back.second, e.second, 1e-13);
                ASSERT_NEAR(back.third, e.third, 1e-13);
            }
        }
    }
}

TEST(Euler, AtTheLockTheFirstAngleIsZero) {
    for (const EulerOrder order : kOrders) {
        for (const double side : {-1.0, 1.0}) {
            const dquat q = rotation_from_euler({0.7, side * kPi / 2, 0.4}, order);
            const EulerAngles e = euler_angles(q, order);
            EXPECT_EQ(e.first, 0.0);
            EXPECT_NEAR(e.second, side * kPi / 2, 1e-15);
            EXPECT_LE(distance(rotation_from_euler(e, order), q), kTolerance);
        }
    }
    const EulerAngles none = euler_angles(kIdentityRotation, EulerOrder::ZYX);
    EXPECT_EQ(none.first, 0.0);
    EXPECT_EQ(none.second, 0.0);
    EXPECT_EQ(none.third, 0.0);
}

TEST(AxisAngleForm, GoesBothWays) {
    Random random(0xaa1);
    for (int i = 0; i < 2000; ++i) {
        dquat q = random_rotation(random);
        if (i % 3 == 0)
            q = rotation_from_vector(dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)} * std::ldexp(1.0, -i / 2));
        const AxisAngle turned = axis_angle(q);
        EXPECT_NEAR(glm::dot(turned.axis, turned.axis), 1.0, 1e-15);
        EXPECT_GE(turned.angle, 0.0);
        EXPECT_LE(turned.angle, kPi);
        EXPECT_LE(distance(rotation_about(turned.axis, turned.angle), q), kTolerance);
        EXPECT_LE(distance(rotation_from_vector(rotation_vector(q)), q), kTolerance);
        const AxisAngle negated = axis_angle(-q);
        EXPECT_EQ(negated.angle, turned.angle);
        EXPECT_EQ(negated.axis, turned.axis);
    }
}

TEST(AxisAngleForm, KeepsTheRelativeAccuracyOfTinyTurns) {
    for (int exponent = -1000; exponent < 0; exponent += 7) {
        const dvec3 v{std::ldexp(0.3, exponent), std::ldexp(-0.4, exponent), std::ldexp(0.5, exponent)};
        const dvec3 back = rotation_vector(rotation_from_vector(v));
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(back[k] / v[k], 1.0, 2e-15) << exponent;
    }
    EXPECT_EQ(axis_angle(kIdentityRotation).angle, 0.0);
    EXPECT_EQ(axis_angle(kIdentityRotation).axis, (dvec3{1, 0, 0}));
    EXPECT_EQ(rotation_vector(dquat{-1, 0, 0, 0}), dvec3{0.0});
    EXPECT_EQ(axis_angle(dquat{0, 0, 1, 0}).angle, kPi);
}

TEST(Matrix, RotatesAsTheQuaternionAndGivesItBack) {
    Random random(0x3a7);
    for (int i = 0; i < 4000; ++i) {
        dquat q = random_rotation(random);
        if (i % 4 == 1) q = rotation_about({0, 0, 1}, kPi / 2 * (i % 16));                                          // exact entries
        if (i % 4 == 2) q = rotation_about(rotate(q, dvec3{1, 0, 0}), kPi - std::ldexp(random.unit(), -(i % 50)));  // w near 0
        const dmat3 m = rotation_matrix(q);
        const dvec3 v{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};
        const dvec3 a = m * v, b = rotate(q, v);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], kTolerance);
        const dquat back = rotation_from_matrix(m);
        EXPECT_LE(distance(back, q), kTolerance);
        EXPECT_GE(back.w, 0.0);
    }
}

TEST(Rotations, OfWhatIsNotFiniteAreNotFinite) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const dquat bad{nan, 0, 0, 1};
    EXPECT_FALSE(is_finite(euler_angles(bad, EulerOrder::XYZ).third));
    EXPECT_FALSE(is_finite(axis_angle(bad).angle));
    EXPECT_FALSE(is_finite(rotation_from_euler({0.0, nan, 0.0}, EulerOrder::YZX)));
    EXPECT_FALSE(is_finite(rotation_from_matrix(dmat3{nan})));
}

}  // namespace
}  // namespace carom
