#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

dvec3 random_vector(Random& random, double size) {
    return {random.range(-size, size), random.range(-size, size), random.range(-size, size)};
}
Pose random_pose(Random& random) { return {random_vector(random, 10.0), rotation_from_vector(random_vector(random, 3.0))}; }

void expect_near(const dvec3& a, const dvec3& b, double tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// Coordinates up to 30: a dozen roundings of 2^-53 * 30 each.
constexpr double kTolerance = 5e-14;

TEST(Pose, RotateIsTheRotationMatrix) {
    Random random(0x907e);
    for (int i = 0; i < 1000; ++i) {
        const dquat q = random_pose(random).orientation;
        const dvec3 v = random_vector(random, 10.0);
        // Columns of the matrix of q, Kuipers, Quaternions and Rotation Sequences (1999), sec. 5.14.
        const double w = q.w, x = q.x, y = q.y, z = q.z;
        const dvec3 want{(1 - 2 * (y * y + z * z)) * v.x + 2 * (x * y - w * z) * v.y + 2 * (x * z + w * y) * v.z,
                         2 * (x * y + w * z) * v.x + (1 - 2 * (x * x + z * z)) * v.y + 2 * (y * z - w * x) * v.z,
                         2 * (x * z - w * y) * v.x + 2 * (y * z + w * x) * v.y + (1 - 2 * (x * x + y * y)) * v.z};
        expect_near(rotate(q, v), want, kTolerance);
        expect_near(rotate_inverse(q, rotate(q, v)), v, kTolerance);
    }
}

TEST(Pose, IsAGroup) {
    Random random(0x6e0);
    for (int i = 0; i < 1000; ++i) {
        const Pose a = random_pose(random), b = random_pose(random), c = random_pose(random);
        const dvec3 p = random_vector(random, 10.0);
        expect_near(transform_point(a * b, p), transform_point(a, transform_point(b, p)), kTolerance);
        expect_near(transform_point((a * b) * c, p), transform_point(a * (b * c), p), 2 * kTolerance);
        expect_near(transform_point(inverse(a) * a, p), p, kTolerance);
        expect_near(transform_point(a * inverse(a), p), p, kTolerance);
        expect_near(inverse_transform_point(a, transform_point(a, p)), p, kTolerance);
        expect_near(transform_point(inverse(a), p), inverse_transform_point(a, p), kTolerance);
    }
}

TEST(Pose, VectorsTurnAndDoNotMove) {
    Random random(0x0ec);
    for (int i = 0; i < 200; ++i) {
        const Pose a = random_pose(random), b = random_pose(random);
        const dvec3 p = random_vector(random, 10.0), q = random_vector(random, 10.0);
        expect_near(transform_vector(a, p - q), transform_point(a, p) - transform_point(a, q), kTolerance);
        expect_near(inverse_transform_vector(a, transform_vector(a, p)), p, kTolerance);
        expect_near(change_frame(a, b, p), inverse_transform_point(b, transform_point(a, p)), kTolerance);
        expect_near(change_frame_vector(a, b, p), inverse_transform_vector(b, transform_vector(a, p)), kTolerance);
    }
}

TEST(Pose, AChangeOfFrameLosesNothingFarFromTheOrigin) {
    Random random(0xfa2);
    const dvec3 far{0x1p40, -0x1p41, 0x1p42};
    for (int i = 0; i < 200; ++i) {
        Pose a = random_pose(random), b = random_pose(random);
        for (int k = 0; k < 3; ++k) {  // on a grid that the far position holds exactly
            a.position[k] = std::round(a.position[k]);
            b.position[k] = std::round(b.position[k]);
        }
        const dvec3 p = random_vector(random, 10.0);
        EXPECT_EQ(change_frame({a.position + far, a.orientation}, {b.position + far, b.orientation}, p), change_frame(a, b, p));
    }
}

TEST(Pose, TheDefaultChangesNothing) {
    const dvec3 p{1.0, -2.0, 3.0};
    EXPECT_EQ(transform_point(Pose{}, p), p);
    EXPECT_EQ(inverse(Pose{}), Pose{});
}

TEST(Pose, RotateWorksInFloatToo) {
    const quat q{std::sqrt(0.5f), 0.0f, std::sqrt(0.5f), 0.0f};
    const vec3 r = rotate(q, vec3{1.0f, 0.0f, 0.0f});
    EXPECT_NEAR(r.z, -1.0f, 1e-6f);
    EXPECT_NEAR(r.x, 0.0f, 1e-6f);
}

TEST(IsFinite, FindsEveryBadComponent) {
    const double bad[] = {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                          -std::numeric_limits<double>::infinity()};
    EXPECT_TRUE(is_finite(Pose{}));
    EXPECT_TRUE(is_finite(std::numeric_limits<double>::max()));
    EXPECT_TRUE(is_finite(std::numeric_limits<float>::denorm_min()));
    for (const double x : bad) {
        for (int k = 0; k < 7; ++k) {
            Pose pose;
            (k < 3 ? pose.position[k] : pose.orientation[k - 3]) = x;
            EXPECT_FALSE(is_finite(pose)) << k << " " << x;
        }
        EXPECT_FALSE(is_finite(static_cast<float>(x)));
    }
}

}  // namespace
}  // namespace carom
