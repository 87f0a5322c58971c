// validate(Shape): every field's range, and errors that name the field.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/shapes.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace carom {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_refused(const Shape& shape, ErrorCode code, const std::string& field) {
    const Status status = validate(shape);
    ASSERT_FALSE(status.ok()) << field;
    EXPECT_EQ(status.error().code, code) << field;
    EXPECT_NE(status.error().message.find(field), std::string::npos) << status.error().message;
}

TEST(Shapes, DefaultsAreValid) {
    EXPECT_TRUE(validate(Sphere{}).ok());
    EXPECT_TRUE(validate(Box{}).ok());
    EXPECT_TRUE(validate(Capsule{}).ok());
    EXPECT_TRUE(validate(Plane{}).ok());
    EXPECT_TRUE(validate(Capsule{0.5f, 0.0f}).ok()) << "a capsule may be a ball";
    EXPECT_TRUE(validate(Sphere{std::numeric_limits<float>::denorm_min()}).ok());
}

TEST(Shapes, SizesMustBePositiveAndFinite) {
    for (const float bad : {0.0f, -1.0f, -0.0f}) {
        expect_refused(Sphere{bad}, ErrorCode::InvalidArgument, "Sphere::radius");
        expect_refused(Box{{bad, 1, 1}}, ErrorCode::InvalidArgument, "Box::half_extents.x");
        expect_refused(Box{{1, bad, 1}}, ErrorCode::InvalidArgument, "Box::half_extents.y");
        expect_refused(Box{{1, 1, bad}}, ErrorCode::InvalidArgument, "Box::half_extents.z");
        expect_refused(Capsule{bad, 1}, ErrorCode::InvalidArgument, "Capsule::radius");
    }
    expect_refused(Capsule{1, -1e-20f}, ErrorCode::InvalidArgument, "Capsule::half_segment");
    for (const float bad : {kInf, -kInf, kNan}) {
        expect_refused(Sphere{bad}, ErrorCode::NotFinite, "Sphere::radius");
        expect_refused(Box{{bad, 1, 1}}, ErrorCode::NotFinite, "Box::half_extents.x");
        expect_refused(Box{{1, bad, 1}}, ErrorCode::NotFinite, "Box::half_extents.y");
        expect_refused(Box{{1, 1, bad}}, ErrorCode::NotFinite, "Box::half_extents.z");
        expect_refused(Capsule{bad, 1}, ErrorCode::NotFinite, "Capsule::radius");
        expect_refused(Capsule{1, bad}, ErrorCode::NotFinite, "Capsule::half_segment");
        expect_refused(Plane{{0, bad, 0}, 0}, ErrorCode::NotFinite, "Plane::normal");
        expect_refused(Plane{{0, 1, 0}, bad}, ErrorCode::NotFinite, "Plane::offset");
    }
}

TEST(Shapes, PlaneNormalMustBeOfUnitLength) {
    EXPECT_TRUE(validate(Plane{{0.6f, 0.8f, 0.0f}, -3.0f}).ok());
    EXPECT_TRUE(validate(Plane{{0.0f, 1.000009f, 0.0f}, 0.0f}).ok());
    expect_refused(Plane{{0.0f, 1.00002f, 0.0f}, 0.0f}, ErrorCode::InvalidArgument, "Plane::normal");
    expect_refused(Plane{{0.0f, 0.99998f, 0.0f}, 0.0f}, ErrorCode::InvalidArgument, "Plane::normal");
    expect_refused(Plane{{0.0f, 0.0f, 0.0f}, 0.0f}, ErrorCode::InvalidArgument, "Plane::normal");
    expect_refused(Plane{{1e38f, 1e38f, 1e38f}, 0.0f}, ErrorCode::InvalidArgument, "Plane::normal");
}

TEST(Shapes, PointersMustNotBeNull) {
    expect_refused(ConvexHullPtr{}, ErrorCode::Empty, "ConvexHullPtr");
    expect_refused(TriangleMeshPtr{}, ErrorCode::Empty, "TriangleMeshPtr");
    const std::vector<vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    EXPECT_TRUE(validate(*ConvexHull::build(points)).ok());
}

TEST(Shapes, TypesAndNamesFollowTheVariant) {
    const std::array<Shape, 6> shapes{Sphere{}, Box{}, Capsule{}, Plane{}, ConvexHullPtr{}, TriangleMeshPtr{}};
    const std::array<std::string, 6> names{"sphere", "box", "capsule", "plane", "convex_hull", "triangle_mesh"};
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        EXPECT_EQ(to_string(type_of(shapes[i])), names[i]);
        EXPECT_EQ(is_bounded(shapes[i]), names[i] != "plane");
    }
}

}  // namespace
}  // namespace carom
