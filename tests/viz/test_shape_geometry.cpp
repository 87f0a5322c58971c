// The triangles of each shape: how many, where, and which way they face.
#include <carom/collision/compound.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace carom {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const BodyId kBody{7, 2};

DebugLayer surface_of(const Shape& shape, const Pose& pose = {}, int segments = 20) {
    DebugLayer layer{.name = "shapes"};
    append_shape(layer, shape, pose, two_tone(palette(0), kBody, segments));
    return layer;
}

dvec3 corner(const DebugLayer& layer, const DebugTriangle& triangle, std::size_t k) {
    return dvec3(layer.vertices[triangle.vertices[k]].position);
}

/// By the divergence theorem; right only if the surface is closed and faces outward.
double volume(const DebugLayer& layer) {
    double sum = 0.0;
    for (const DebugTriangle& t : layer.triangles) {
        sum += glm::dot(corner(layer, t, 0), glm::cross(corner(layer, t, 1), corner(layer, t, 2))) / 6.0;
    }
    return sum;
}

/// Every edge, by position, runs once in each direction.
bool is_watertight(const DebugLayer& layer) {
    using Key = std::array<double, 6>;
    std::map<Key, int> edges;
    for (const DebugTriangle& t : layer.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const dvec3 a = corner(layer, t, k), b = corner(layer, t, (k + 1) % 3);
            ++edges[{a.x, a.y, a.z, b.x, b.y, b.z}];
            --edges[{b.x, b.y, b.z, a.x, a.y, a.z}];
        }
    }
    for (const auto& [key, count] : edges) {
        if (count != 0) return false;
    }
    return true;
}

/// Triangles face outward and the shading normals agree with them.
void expect_normals_agree(const DebugLayer& layer) {
    for (const DebugTriangle& t : layer.triangles) {
        const dvec3 face = glm::cross(corner(layer, t, 1) - corner(layer, t, 0), corner(layer, t, 2) - corner(layer, t, 0));
        for (const std::uint32_t v : t.vertices) {
            const dvec3 normal(layer.vertices[v].normal);
            EXPECT_NEAR(glm::dot(normal, normal), 1.0, 1e-5);
            EXPECT_GT(glm::dot(normal, face), 0.0);
        }
    }
}

Error error_of(const std::function<void()>& misuse) {
    try {
        misuse();
    } catch (const MisuseError& e) {
        return e.error();
    }
    ADD_FAILURE() << "nothing was reported";
    return {};
}

TEST(ShapeGeometry, BoxHasTwelveTrianglesThatEncloseItsVolume) {
    const DebugLayer layer = surface_of(Box{{0.5f, 1.0f, 1.5f}}, {{1.0, 2.0, 3.0}, rotation_about({0.0, 0.6, 0.8}, 0.7)});
    EXPECT_EQ(layer.triangles.size(), 12u);
    EXPECT_EQ(layer.vertices.size(), 24u);
    EXPECT_NEAR(volume(layer), 8.0 * 0.75, 1e-5);  // float vertices of size 4: 4 · 2^-24 each, area 22
    EXPECT_TRUE(is_watertight(layer));
    expect_normals_agree(layer);
}

TEST(ShapeGeometry, RoundShapesAreClosedAndApproachTheirVolume) {
    for (const int n : {4, 8, 20, 64}) {
        const DebugLayer sphere = surface_of(Sphere{0.5f}, {}, n);
        const DebugLayer capsule = surface_of(Capsule{0.5f, 0.75f}, {}, n);
        EXPECT_EQ(sphere.triangles.size(), static_cast<std::size_t>(n * (n - 2)));
        EXPECT_EQ(capsule.triangles.size(), static_cast<std::size_t>(n * n));
        EXPECT_TRUE(is_watertight(sphere));
        EXPECT_TRUE(is_watertight(capsule));
        expect_normals_agree(sphere);
        expect_normals_agree(capsule);
        // Inside the exact solid, and it holds that solid shrunk by cos(pi/n) for the chord round and again for the chord up.
        const double ball = 4.0 / 3.0 * kPi * 0.125, tube = kPi * 0.25 * 1.5;
        const double shrink = std::pow(std::cos(kPi / n), 6.0);
        EXPECT_LT(volume(sphere), ball);
        EXPECT_GT(volume(sphere), shrink * ball);
        EXPECT_LT(volume(capsule), ball + tube);
        EXPECT_GT(volume(capsule), shrink * (ball + tube));
    }
    EXPECT_EQ(surface_of(Capsule{0.5f, 0.0f}).triangles.size(), surface_of(Sphere{0.5f}).triangles.size());
}

TEST(ShapeGeometry, CylindersConesAndCompoundsAreClosedAndApproachTheirVolume) {
    for (const int n : {4, 20, 64}) {
        const DebugLayer cylinder = surface_of(Cylinder{0.5f, 0.75f}, {}, n), cone = surface_of(Cone{0.5f, 0.75f}, {}, n);
        EXPECT_EQ(cylinder.triangles.size(), static_cast<std::size_t>(4 * n - 4));
        EXPECT_EQ(cone.triangles.size(), static_cast<std::size_t>(2 * n - 2));
        const double shrink = n / (2.0 * kPi) * std::sin(2.0 * kPi / n);  // the polygon's area over the circle's
        const double tube = kPi * 0.25 * 1.5;
        EXPECT_NEAR(volume(cylinder), shrink * tube, 1e-5);
        EXPECT_NEAR(volume(cone), shrink * tube / 3.0, 1e-5);
        for (const DebugLayer& layer : {cylinder, cone}) {
            EXPECT_TRUE(is_watertight(layer));
            expect_normals_agree(layer);
        }
        const CompoundPtr both = *Compound::build({{Cylinder{0.5f, 0.75f}, {{1, 0, 0}}}, {Cone{0.5f, 0.75f}, {{-1, 0, 0}}}});
        const DebugLayer parts = surface_of(both, {{0, 2, 0}}, n);
        EXPECT_EQ(parts.triangles.size(), cylinder.triangles.size() + cone.triangles.size());
        EXPECT_NEAR(volume(parts), volume(cylinder) + volume(cone), 1e-5);
    }
}

TEST(ShapeGeometry, RoundVerticesLieOnTheSurface) {
    const Pose pose{{10.0, -3.0, 2.0}, rotation_from_vector({0.3, 1.1, -0.4})};
    const Capsule capsule{0.25f, 0.5f};
    for (const DebugVertex& v : surface_of(capsule, pose).vertices) {
        const dvec3 p = inverse_transform_point(pose, dvec3(v.position));
        const double y = std::max(std::abs(p.y) - 0.5, 0.0);
        EXPECT_NEAR(std::sqrt(p.x * p.x + y * y + p.z * p.z), 0.25, 2e-6);  // float positions of size 10: 10 · 2^-24 · sqrt(3)
    }
}

TEST(ShapeGeometry, ColoursAndBodyReachEveryTriangle) {
    const DebugLayer layer = surface_of(Sphere{1.0f});
    const ShapeStyle style = two_tone(palette(0), kBody);
    std::size_t second = 0;
    for (const DebugTriangle& t : layer.triangles) {
        EXPECT_EQ(t.body, kBody);
        EXPECT_TRUE(t.color == style.color || t.color == style.second);
        second += t.color == style.second ? 1 : 0;
    }
    EXPECT_EQ(second, layer.triangles.size() / 2);  // octants take turns
    EXPECT_FALSE(style.color == style.second);
}

TEST(ShapeGeometry, PlanePatchLiesInThePlaneAndHasTheStatedSize) {
    Random random(4711);
    for (int i = 0; i < 50; ++i) {
        const dvec3 n = glm::normalize(dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)});
        const Plane plane{vec3(n), static_cast<float>(random.range(-2, 2))};
        const Pose pose{{random.range(-5, 5), random.range(-5, 5), random.range(-5, 5)},
                        rotation_from_vector({random.range(-3, 3), random.range(-3, 3), 0.5})};
        const PlanePatch patch{{1.0, 2.0, 3.0}, 4.0, 6};
        DebugLayer layer{.name = "static"};
        append_plane(layer, plane, pose, patch, two_tone(palette(1), kBody));
        EXPECT_EQ(layer.triangles.size(), 72u);
        expect_normals_agree(layer);
        double area = 0.0;
        for (const DebugVertex& v : layer.vertices) {
            const dvec3 local = inverse_transform_point(pose, dvec3(v.position));
            EXPECT_NEAR(glm::dot(local, n), static_cast<double>(plane.offset), 1e-5);
        }
        for (const DebugTriangle& t : layer.triangles) {
            area += 0.5 * glm::length(glm::cross(corner(layer, t, 1) - corner(layer, t, 0),
                                                 corner(layer, t, 2) - corner(layer, t, 0)));
        }
        EXPECT_NEAR(area, 64.0, 1e-3);
    }
}

TEST(ShapeGeometry, BoxEdgesAreTwelveAndUnboundedBoxesAreLeftOut) {
    DebugLayer layer{.name = "bounds"};
    append_box_edges(layer, {{0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}}, {{5.0, 0.0, 0.0}}, palette(2), kBody);
    ASSERT_EQ(layer.lines.size(), 12u);
    double length = 0.0;
    for (const DebugLine& line : layer.lines) length += static_cast<double>(glm::length(line.b - line.a));
    EXPECT_NEAR(length, 4.0 * (1.0 + 2.0 + 3.0), 1e-5);
    append_box_edges(layer, Aabb{}, {}, palette(2), kBody);
    append_box_edges(layer, {dvec3{-std::numeric_limits<double>::infinity()}, dvec3{1.0}}, {}, palette(2), kBody);
    EXPECT_EQ(layer.lines.size(), 12u);
}

TEST(ShapeGeometry, MisuseIsReportedAndAppendsNothing) {
    DebugLayer layer{.name = "shapes"};
    const ShapeStyle style = two_tone(palette(0), kBody);
    EXPECT_EQ(error_of([&] { append_shape(layer, Plane{}, {}, style); }).code, ErrorCode::WrongType);
    EXPECT_EQ(error_of([&] { append_shape(layer, ConvexHullPtr{}, {}, style); }).code, ErrorCode::Empty);
    EXPECT_EQ(error_of([&] { append_shape(layer, TriangleMeshPtr{}, {}, style); }).code, ErrorCode::Empty);
    EXPECT_EQ(error_of([&] { append_shape(layer, CompoundPtr{}, {}, style); }).code, ErrorCode::Empty);
    EXPECT_EQ(error_of([&] { append_shape(layer, Box{}, {{kNaN, 0.0, 0.0}}, style); }).code, ErrorCode::NotFinite);
    for (const int n : {0, -4, 6, 260}) {
        EXPECT_EQ(error_of([&] { append_shape(layer, Sphere{}, {}, two_tone(palette(0), kBody, n)); }).code,
                  ErrorCode::InvalidArgument);
    }
    EXPECT_EQ(error_of([&] { append_plane(layer, {}, {}, {.half_size = 0.0}, style); }).code, ErrorCode::InvalidArgument);
    EXPECT_EQ(error_of([&] { append_plane(layer, {}, {}, {.tiles = 0}, style); }).code, ErrorCode::InvalidArgument);
    EXPECT_EQ(error_of([&] { append_plane(layer, {}, {}, {.center = dvec3{kNaN}}, style); }).code, ErrorCode::NotFinite);
    EXPECT_TRUE(layer.empty());
    EXPECT_TRUE(layer.vertices.empty());
}

}  // namespace
}  // namespace carom
