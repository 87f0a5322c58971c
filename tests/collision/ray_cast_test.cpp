// Rays against solids: verdicts and distances from a bisection of the solid's own function in long double.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include "ray_solids.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace carom {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RealPoint along(const Ray& ray, Real t) {
    const Real x = ray.direction.x, y = ray.direction.y, z = ray.direction.z;
    const Real length = std::sqrt(x * x + y * y + z * z);
    return {ray.origin.x + t * x / length, ray.origin.y + t * y / length, ray.origin.z + t * z / length};
}

struct Truth {
    Real least;     ///< of the function along the ray within `reach`; its sign is the verdict
    Real distance;  ///< of the first point where it is not positive
};

Truth truth(const Solid& solid, const Ray& ray, Real reach) {
    const auto f = [&](Real t) { return solid.function(along(ray, t)); };
    if (f(0) <= 0) {
        return {f(0), 0};
    }
    Real low = 0, high = reach;
    for (int i = 0; i < 220; ++i) {  // golden-section by thirds: (2/3)^220 leaves nothing of the range
        const Real a = low + (high - low) / 3, b = high - (high - low) / 3;
        (f(a) < f(b) ? high : low) = f(a) < f(b) ? b : a;
    }
    const Truth result{f(low), low};
    Real outside = 0, inside = low;
    for (int i = 0; i < 80 && result.least < 0; ++i) {
        const Real middle = (outside + inside) / 2;
        (f(middle) > 0 ? outside : inside) = middle;
    }
    return {result.least, inside};
}

/// Every property of one cast; `scale` is the larger of the ray's way and the solid, which rounding is relative to.
void expect_true(const Solid& solid, const Ray& ray) {
    const std::optional<RayHit> hit = cast_ray(solid.shape, ray);
    const double way = glm::length(ray.origin) + 4.0 * solid.size;
    const Truth t = truth(solid, ray, 3 * static_cast<Real>(way));
    const double tolerance = 1e-13 * std::max(way, solid.size);
    if (hit && hit->distance > 3.0 * way) {
        ASSERT_EQ(type_of(solid.shape), ShapeType::Plane) << "only a plane reaches as far";
        return;
    }
    SCOPED_TRACE(solid.name);
    if (!hit) {
        EXPECT_GE(t.least, -tolerance) << "missed";
        return;
    }
    EXPECT_LE(t.least, tolerance) << "hit where there is nothing";
    EXPECT_TRUE(is_finite(hit->distance) && is_finite(hit->point) && is_finite(hit->normal));
    EXPECT_NEAR(glm::length(hit->normal), 1.0, 1e-14);
    EXPECT_EQ(hit->triangle, 0u);
    const dvec3 direction = glm::normalize(ray.direction);
    if (t.least <= 0 && t.distance == 0) {
        EXPECT_EQ(hit->distance, 0.0);
        EXPECT_EQ(hit->point, ray.origin);
        EXPECT_NEAR(glm::dot(hit->normal, direction), -1.0, 1e-14);
        return;
    }
    const double facing = -glm::dot(hit->normal, direction);
    EXPECT_GE(facing, -1e-7);
    if (facing > 1e-3 && t.least < -1e-6 * solid.size) {  // else the distance is ill-conditioned: it grazes a face or a corner
        EXPECT_NEAR(hit->distance, static_cast<double>(t.distance), tolerance / facing);
        EXPECT_NEAR(static_cast<double>(solid.function({hit->point.x, hit->point.y, hit->point.z})), 0.0,
                    1e-14 * solid.size + tolerance);
        const dvec3 expected = ray.origin + hit->distance * direction;
        EXPECT_NEAR(glm::length(hit->point - expected), 0.0, 2.0 * tolerance / facing);
    }
}

TEST(RayCast, AgreesWithBisectionOnRandomRays) {
    Random random(201);
    int hits = 0;
    for (const Solid& solid : solids()) {
        for (int i = 0; i < 1500; ++i) {
            const dvec3 target = random_point(random, 1.1);
            Ray ray{random_point(random, 3.0)};
            ray.direction = (target - ray.origin) * random.range(0.1, 5.0);
            expect_true(solid, ray);
            hits += cast_ray(solid.shape, ray).has_value() ? 1 : 0;
        }
    }
    EXPECT_GT(hits, 3000);
    EXPECT_LT(hits, 9000);
}

TEST(RayCast, AgreesOnAxisParallelRaysWithEitherZero) {
    Random random(202);
    for (const Solid& solid : solids()) {
        for (int i = 0; i < 600; ++i) {
            const int axis = i % 3;
            Ray ray{random_point(random, 1.5), dvec3{random.unit() < 0.5 ? -0.0 : 0.0}};
            ray.direction[(axis + 1) % 3] = random.unit() < 0.5 ? -0.0 : 0.0;
            ray.direction[axis] = random.unit() < 0.5 ? -2.0 : 2.0;
            expect_true(solid, ray);
        }
    }
}

TEST(RayCast, AgreesOnFarOrigins) {
    Random random(203);
    for (const Solid& solid : solids()) {
        for (int i = 0; i < 300; ++i) {
            Ray ray{random_point(random, 1.0) * (i % 3 == 0 ? 1e3 : i % 3 == 1 ? 1e6 : 1e9)};
            ray.direction = random_point(random, 0.5) - ray.origin;
            expect_true(solid, ray);
        }
    }
}

TEST(RayCast, AgreesAtExtremeSizes) {
    Random random(204);
    for (const float s : {1e-30f, 1e-6f, 1e6f, 1e30f}) {
        for (const Solid& solid : {sphere(0.7f * s), box(s * vec3{0.5f, 1.0f, 0.25f}), capsule(0.3f * s, 0.8f * s)}) {
            for (int i = 0; i < 200; ++i) {
                Ray ray{random_point(random, 3.0) * static_cast<double>(s)};
                ray.direction = random_point(random, 1.0) * static_cast<double>(s) - ray.origin;
                expect_true(solid, ray);
            }
        }
    }
}

TEST(RayCast, OriginOnTheSurfaceHitsThereWhateverTheDirection) {
    Random random(205);
    const std::vector<std::pair<Shape, dvec3>> cases{
        {Sphere{1.0f}, {0, 1, 0}},  {Box{{1, 2, 3}}, {0.5, 2, 1}},          {Box{{1, 2, 3}}, {1, 2, 3}},
        {Capsule{1.0f, 1.0f}, {1, 0.5, 0}}, {Capsule{1.0f, 1.0f}, {0, -2, 0}}, {Plane{{0, 1, 0}, 2.0f}, {7, 2, 9}}};
    for (const auto& [shape, origin] : cases) {
        for (int i = 0; i < 50; ++i) {
            const std::optional<RayHit> hit = cast_ray(shape, {origin, random_point(random, 1.0), 0.0});
            ASSERT_TRUE(hit);
            EXPECT_EQ(hit->distance, 0.0);
            EXPECT_EQ(hit->point, origin);
        }
    }
}

TEST(RayCast, GrazesByTheLastBit) {
    const auto hits = [](const Shape& shape, const dvec3& origin, const dvec3& direction) {
        return cast_ray(shape, {origin, direction}).has_value();
    };
    const double above = std::nextafter(1.0, 2.0);
    EXPECT_TRUE(hits(Sphere{1.0f}, {-5, 1, 0}, {1, 0, 0}));
    EXPECT_FALSE(hits(Sphere{1.0f}, {-5, above, 0}, {1, 0, 0}));
    EXPECT_TRUE(hits(Box{{1, 1, 1}}, {-5, 1, 1}, {1, 0, -0.0}));
    EXPECT_FALSE(hits(Box{{1, 1, 1}}, {-5, 1, above}, {1, -0.0, 0}));
    EXPECT_TRUE(hits(Capsule{1.0f, 1.0f}, {-5, 0.5, 1}, {1, 0, 0}));
    EXPECT_FALSE(hits(Capsule{1.0f, 1.0f}, {-5, 0.5, above}, {1, 0, 0}));
    EXPECT_TRUE(hits(Capsule{1.0f, 1.0f}, {1, -5, 0}, {0, 1, 0}));
    EXPECT_FALSE(hits(Capsule{1.0f, 1.0f}, {above, -5, 0}, {0, 1, 0}));
    EXPECT_FALSE(hits(Plane{{0, 1, 0}, 1.0f}, {0, above, 0}, {1, 0, 0}));
    EXPECT_FALSE(hits(Plane{{0, 1, 0}, 1.0f}, {0, above, 0}, {0, 1, 0}));
    EXPECT_TRUE(hits(Plane{{0, 1, 0}, 1.0f}, {0, above, 0}, {0, -1, 0}));
}

TEST(RayCast, BoxCornersAndEdgesAreHit) {
    const Shape box = Box{{1, 1, 1}};
    const std::optional<RayHit> corner = cast_ray(box, {{3, 3, 3}, {-1, -1, -1}});
    ASSERT_TRUE(corner);
    EXPECT_EQ(corner->point, (dvec3{1, 1, 1}));
    EXPECT_EQ(corner->normal, (dvec3{1, 0, 0})) << "ties go to the first axis";
    const std::optional<RayHit> edge = cast_ray(box, {{0.5, 3, 3}, {0, -1, -1}});
    ASSERT_TRUE(edge);
    EXPECT_EQ(edge->point, (dvec3{0.5, 1, 1}));
}

TEST(RayCast, AHullOfABoxIsTheBox) {
    const vec3 h{0.5f, 1.0f, 0.25f};
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i) {
        corners.push_back(h * vec3{i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
    }
    const Shape hull = ConvexHull::build(corners).value();
    Random random(206);
    for (int i = 0; i < 5000; ++i) {
        Ray ray{random_point(random, 2.0)};
        ray.direction = random_point(random, 1.0) - ray.origin;
        const std::optional<RayHit> a = cast_ray(Box{h}, ray);
        const std::optional<RayHit> b = cast_ray(hull, ray);
        ASSERT_EQ(a.has_value(), b.has_value());
        if (a) {
            EXPECT_NEAR(a->distance, b->distance, 1e-12 / std::max(1e-3, -glm::dot(a->normal, glm::normalize(ray.direction))));
            EXPECT_NEAR(glm::length(a->normal - b->normal), 0.0, 1e-14);
        }
    }
}

TEST(RayCast, MaxDistanceIsClosedToTheLastBit) {
    Random random(207);
    std::vector<Shape> shapes;
    for (const Solid& solid : solids()) {
        shapes.push_back(solid.shape);
    }
    const MeshData ball = test::sphere_mesh(9, 7, 1.0);
    shapes.push_back(TriangleMesh::build(ball.vertices, ball.triangles).value());
    int hits = 0;
    for (const Shape& shape : shapes) {
        for (int i = 0; i < 300; ++i) {
            Ray ray{random_point(random, i % 2 == 0 ? 3.0 : 300.0)};
            ray.direction = random_point(random, 0.5) - ray.origin;
            const std::optional<RayHit> hit = cast_ray(shape, ray);
            if (!hit || hit->distance == 0.0) {
                continue;
            }
            ++hits;
            ray.max_distance = hit->distance;
            ASSERT_TRUE(cast_ray(shape, ray));
            EXPECT_EQ(cast_ray(shape, ray)->distance, hit->distance);
            ray.max_distance = std::nextafter(hit->distance, 0.0);
            EXPECT_FALSE(cast_ray(shape, ray));
        }
    }
    EXPECT_GT(hits, 1000);
}

TEST(RayCast, TheLengthOfTheDirectionDoesNotCount) {
    for (const Solid& solid : solids()) {
        const Ray ray{{0.1, 5.0, 0.2}, {0.0, -1.0, 0.0}};
        const std::optional<RayHit> hit = cast_ray(solid.shape, ray);
        if (!hit) {  // the second plane's ray starts inside or leads away; the others must be hit
            EXPECT_EQ(type_of(solid.shape), ShapeType::Plane);
            continue;
        }
        for (const double length : {5e-324, 1e-300, 1e-20, 7.0, 1e20, 1e308}) {
            const std::optional<RayHit> same = cast_ray(solid.shape, {ray.origin, ray.direction * length});
            ASSERT_TRUE(same) << solid.name << ' ' << length;
            EXPECT_EQ(same->distance, hit->distance);
            EXPECT_EQ(same->normal, hit->normal);
        }
    }
}

TEST(RayCast, BadRaysAreNamedAndHitNothing) {
    const auto expect_bad = [](const Ray& ray, ErrorCode code) {
        ASSERT_FALSE(validate(ray));
        EXPECT_EQ(validate(ray).error().code, code);
        for (const Solid& solid : solids()) {
            EXPECT_FALSE(cast_ray(solid.shape, ray));
            EXPECT_FALSE(cast_ray(solid.shape, Pose{}, ray));
        }
    };
    EXPECT_TRUE(validate(Ray{}));
    EXPECT_TRUE(validate(Ray{{0, 0, 0}, {0, 0, 5e-324}, 0.0}));
    expect_bad({{kNan, 0, 0}}, ErrorCode::NotFinite);
    expect_bad({{0, kInfinity, 0}}, ErrorCode::NotFinite);
    expect_bad({{0, 0, 0}, {0, kNan, 0}}, ErrorCode::NotFinite);
    expect_bad({{0, 0, 0}, {-kInfinity, 0, 0}}, ErrorCode::NotFinite);
    expect_bad({{0, 0, 0}, {0, -0.0, 0}}, ErrorCode::InvalidArgument);
    expect_bad({{0, 0, 0}, {0, 0, 1}, kNan}, ErrorCode::InvalidArgument);
    expect_bad({{0, 0, 0}, {0, 0, 1}, -1.0}, ErrorCode::InvalidArgument);
    const Ray good{{0, 0, 0}, {0, 0, 1}};
    EXPECT_FALSE(cast_ray(Sphere{}, {dvec3{kNan, 0, 0}}, good));
    EXPECT_FALSE(cast_ray(ConvexHullPtr{}, good));
    EXPECT_FALSE(cast_ray(TriangleMeshPtr{}, good));
}

TEST(RayCast, NeverGivesNanForExtremeRays) {
    const std::vector<double> values{0.0, -0.0, 5e-324, -1e-300, 1e-30, 0.5, -1.0, 1e30, -1e160, 1e308};
    const MeshData ball = test::sphere_mesh(5, 4, 1.0);
    std::vector<Solid> all = solids();
    all.push_back({"mesh", TriangleMesh::build(ball.vertices, ball.triangles).value(), {}, 1.0});
    Random random(208);
    const auto pick = [&] { return values[static_cast<std::size_t>(random.unit() * static_cast<double>(values.size()))]; };
    for (int i = 0; i < 20000; ++i) {
        Ray ray;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = pick();
            ray.direction[k] = pick();
        }
        for (const Solid& solid : all) {
            if (const std::optional<RayHit> hit = cast_ray(solid.shape, ray)) {
                EXPECT_TRUE(is_finite(hit->distance) && is_finite(hit->point) && is_finite(hit->normal)) << solid.name;
                EXPECT_GE(hit->distance, 0.0);
                EXPECT_NEAR(glm::length(hit->normal), 1.0, 1e-5);
            }
        }
    }
}

TEST(RayCast, PlacedByAPoseEqualsTheLocalCast) {
    Random random(209);
    std::vector<Solid> all = solids();
    const MeshData ball = test::sphere_mesh(9, 7, 1.0);
    all.push_back({"mesh", TriangleMesh::build(ball.vertices, ball.triangles).value(), {}, 1.0});
    int hits = 0;
    for (const Solid& solid : all) {
        for (int i = 0; i < 300; ++i) {
            const Pose pose{random_point(random, 20.0), rotation_from_vector(random_point(random, 3.0))};
            Ray local{random_point(random, 3.0)};
            local.direction = random_point(random, 0.5) - local.origin;
            const Ray placed{transform_point(pose, local.origin), rotate(pose.orientation, local.direction)};
            const std::optional<RayHit> a = cast_ray(solid.shape, local);
            const std::optional<RayHit> b = cast_ray(solid.shape, pose, placed);
            if (!a || -glm::dot(a->normal, glm::normalize(local.direction)) < 0.05) {
                continue;  // rounding of the pose may change what grazes
            }
            ++hits;
            ASSERT_TRUE(b) << solid.name;
            EXPECT_NEAR(a->distance, b->distance, 1e-12) << solid.name;
            EXPECT_NEAR(glm::length(transform_point(pose, a->point) - b->point), 0.0, 1e-12) << solid.name;
            EXPECT_NEAR(glm::length(rotate(pose.orientation, a->normal) - b->normal), 0.0, 1e-12) << solid.name;
        }
    }
    EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace carom
