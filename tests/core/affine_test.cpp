// Affine maps: poses both ways, typed refusals of what is not rigid, and normals that stay perpendicular to the surface.
#include <carom/core/affine.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/core/rotations.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

namespace carom {
namespace {

constexpr double kTolerance = 4e-15;

dvec3 random_vector(Random& random, double size) {
    return {random.range(-size, size), random.range(-size, size), random.range(-size, size)};
}
Pose random_pose(Random& random) { return {random_vector(random, 10.0), rotation_from_vector(random_vector(random, 3.0))}; }

dmat4 with_linear(const dmat3& linear, const dvec3& position) {
    return {glm::dvec4(linear[0], 0.0), glm::dvec4(linear[1], 0.0), glm::dvec4(linear[2], 0.0), glm::dvec4(position, 1.0)};
}

void expect_same(const Pose& a, const Pose& b, double tolerance) {
    EXPECT_EQ(a.position, b.position);
    const dmat3 x = rotation_matrix(a.orientation), y = rotation_matrix(b.orientation);
    for (int k = 0; k < 9; ++k) EXPECT_NEAR(x[k / 3][k % 3], y[k / 3][k % 3], tolerance);
}

TEST(Affine, APoseSurvivesItsMatrix) {
    Random random(0xaf1);
    for (int i = 0; i < 1000; ++i) {
        const Pose pose = random_pose(random);
        const dmat4 m = to_matrix(pose);
        const dvec3 p = random_vector(random, 10.0);
        const dvec3 a = dvec3(m * glm::dvec4(p, 1.0)), b = transform_point(pose, p);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-13);
        expect_same(pose_from_matrix(m).value(), pose, kTolerance);
        // A matrix of floats is rigid enough, and what it lost is put right as far as its rotation goes.
        const Pose rough = pose_from_matrix(dmat4(glm::mat4(m))).value();
        EXPECT_NEAR(glm::dot(rough.orientation, rough.orientation), 1.0, 1e-15);
        expect_same({pose.position, rough.orientation}, pose, 4e-7);
    }
}

ErrorCode refusal(const dmat4& m, const std::string& word) {
    const Result<Pose> pose = pose_from_matrix(m);
    EXPECT_FALSE(pose.has_value());
    if (pose) return ErrorCode::Io;
    EXPECT_NE(pose.error().message.find(word), std::string::npos) << pose.error().message;
    EXPECT_EQ(pose.error().where, "pose_from_matrix");
    return pose.error().code;
}

TEST(Affine, WhatIsNotRigidIsRefusedByName) {
    Random random(0xaf2);
    for (int i = 0; i < 200; ++i) {
        const Pose pose = random_pose(random);
        const dmat3 r = rotation_matrix(pose.orientation);
        EXPECT_EQ(refusal(with_linear(r * 1.001, pose.position), "scales"), ErrorCode::InvalidArgument);
        dmat3 stretched = r;
        stretched[i % 3] *= 0.99;
        EXPECT_EQ(refusal(with_linear(stretched, pose.position), "scales"), ErrorCode::InvalidArgument);
        dmat3 sheared = r;
        sheared[i % 3] += 1e-4 * r[(i + 1) % 3];
        EXPECT_EQ(refusal(with_linear(sheared, pose.position), "shears"), ErrorCode::InvalidArgument);
        dmat3 mirrored = r;
        mirrored[i % 3] = -mirrored[i % 3];
        EXPECT_EQ(refusal(with_linear(mirrored, pose.position), "mirrors"), ErrorCode::InvalidArgument);
        dmat3 flat = r;
        flat[i % 3] = dvec3{0.0};
        EXPECT_EQ(refusal(with_linear(flat, pose.position), "flattens"), ErrorCode::Degenerate);
        dmat4 projecting = to_matrix(pose);
        projecting[i % 3][3] = 1e-9;
        EXPECT_EQ(refusal(projecting, "projection"), ErrorCode::InvalidArgument);
    }
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        for (int k = 0; k < 16; ++k) {
            dmat4 m{1.0};
            m[k / 4][k % 4] = bad;
            EXPECT_EQ(refusal(m, "finite"), ErrorCode::NotFinite);
            EXPECT_EQ(decompose(m).error().code, ErrorCode::NotFinite);
        }
    }
    EXPECT_TRUE(pose_from_matrix(with_linear(dmat3{1.01}, dvec3{0.0}), 0.03).has_value()) << "the tolerance is the caller's";
}

TEST(Affine, DecomposesIntoRotationAndScale) {
    Random random(0xaf3);
    for (int i = 0; i < 1000; ++i) {
        const Pose pose = random_pose(random);
        const dmat3 r = rotation_matrix(pose.orientation);
        dvec3 scale{0.0};
        for (int k = 0; k < 3; ++k) scale[k] = std::ldexp(random.range(1.0, 2.0), static_cast<int>(random.range(-300, 300)));
        if (i % 2 == 0) scale.x = -scale.x;
        const ScaledPose got = decompose(with_linear({r[0] * scale.x, r[1] * scale.y, r[2] * scale.z}, pose.position)).value();
        expect_same(got.pose, pose, kTolerance);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(got.scale[k] / scale[k], 1.0, kTolerance);
    }
    dmat3 sheared{1.0};
    sheared[1] = {0.5, 2.0, 0.0};
    EXPECT_EQ(decompose(with_linear(sheared, dvec3{0.0})).error().code, ErrorCode::InvalidArgument);
    sheared[1] = {0.5, 0.0, 0.0};
    EXPECT_EQ(decompose(with_linear(sheared, dvec3{0.0})).error().code, ErrorCode::Degenerate);
}

TEST(Affine, ColumnsInAPlaneAreDegenerateHoweverTheyAreRounded) {
    EXPECT_EQ(decompose(with_linear({{0.1, 0.2, 0.3}, {0.4, 0.5, 0.6}, {0.7, 0.8, 0.9}}, dvec3{0.0})).error().code, ErrorCode::Degenerate);
    Random random(0xaf5);
    for (int i = 0; i < 3000; ++i) {
        const dvec3 u = random_vector(random, 1.0), v = random_vector(random, 1.0);
        const auto in_plane = [&] { return random.range(-1, 1) * u + random.range(-1, 1) * v; };
        const dmat3 flat{in_plane(), in_plane(), in_plane()};
        EXPECT_EQ(decompose(with_linear(flat, dvec3{0.0})).error().code, ErrorCode::Degenerate) << i;
    }
    dmat3 steep{1.0};
    steep[1] = {1.0, 1e-13, 0.0};
    EXPECT_EQ(decompose(with_linear(steep, dvec3{0.0})).error().code, ErrorCode::InvalidArgument) << "flat nearly, but not to rounding";
}

TEST(Affine, NormalsStayPerpendicularAndOnTheirSide) {
    Random random(0xaf4);
    for (int i = 0; i < 2000; ++i) {
        const dmat3 m{random_vector(random, 1.0), random_vector(random, 1.0), random_vector(random, 1.0)};
        const double det = glm::dot(m[0], glm::cross(m[1], m[2]));
        if (std::fabs(det) < 0.05) continue;
        const dvec3 n = random_vector(random, 1.0), along = random_vector(random, 1.0);
        const dvec3 u = glm::cross(n, along), v = glm::cross(n, u);
        const double scale = i % 3 == 0 ? std::ldexp(1.0, i % 2 == 0 ? 700 : -700) : 1.0;
        const dvec3 got = transform_normal(scale * m, n * (i % 5 == 0 ? 1e-200 : 1.0));
        ASSERT_NEAR(glm::dot(got, got), 1.0, 1e-14);
        const dvec3 mu = m * u, mv = m * v, mn = m * n;
        // The inverse has entries of at most 6 / det; some roundings of that.
        EXPECT_NEAR(glm::dot(got, mu) / glm::length(mu), 0.0, 1e-13) << det;
        EXPECT_NEAR(glm::dot(got, mv) / glm::length(mv), 0.0, 1e-13) << det;
        EXPECT_GT(glm::dot(got, mn), 0.0) << "mirrors too";
    }
}

TEST(Affine, NormalsOfFlattenedSpaceAndBadInput) {
    dmat3 flat{1.0};
    flat[2] = dvec3{0.0};
    EXPECT_EQ(transform_normal(flat, {0, 0, -2}), (dvec3{0, 0, -1}));  // the plane itself survives
    EXPECT_EQ(transform_normal(flat, {1, 0, 0}), dvec3{0.0});          // this one becomes a line
    EXPECT_EQ(transform_normal(dmat3{0.0}, {1, 0, 0}), dvec3{0.0});
    EXPECT_EQ(transform_normal(dmat3{1.0}, dvec3{0.0}), dvec3{0.0});
    EXPECT_EQ(transform_normal(dmat3{std::numeric_limits<double>::quiet_NaN()}, {1, 0, 0}), dvec3{0.0});
    EXPECT_EQ(transform_normal(dmat3{1.0}, {std::numeric_limits<double>::infinity(), 0, 0}), dvec3{0.0});
}

}  // namespace
}  // namespace carom
