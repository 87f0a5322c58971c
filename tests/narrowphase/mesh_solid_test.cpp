// Closed meshes that bound convex solids: contacts are those of the solid, however long the shape and fine the triangles; what has room inside
// stays there.
#include "oracle.hpp"

#include <support/box_mesh.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/explain.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace carom {
namespace {

using namespace test;
using oracle::surface_of;

float deepest(const std::vector<Manifold>& manifolds) {
    float least = 1.0f;
    for (const Manifold& m : manifolds) least = std::min(least, least_separation(m));
    return least;
}

/// As long as no plate of the tests is wide, so that none has room for it.
Shape long_shape(ShapeType type, Random& r) {
    const auto size = [&](double low, double high) { return static_cast<float>(r.range(low, high)); };
    switch (type) {
        case ShapeType::Capsule:
            return Capsule{size(0.01, 0.1), 2.0f};
        case ShapeType::Cylinder:
            return Cylinder{size(0.01, 0.1), 2.0f};
        case ShapeType::Cone:
            return Cone{size(0.05, 0.3), 2.0f};
        case ShapeType::Box:
            return Box{{size(0.01, 0.1), 2.0f, size(0.01, 0.3)}};
        default: {
            std::vector<vec3> cloud{{0.0f, 2.0f, 0.0f}, {0.0f, -2.0f, 0.0f}};
            for (int i = 0; i < 16; ++i) cloud.push_back(vec3(random_direction(r) * dvec3{0.1, 2.0, 0.2}));
            return hull_of(cloud);
        }
    }
}

constexpr ShapeType kLong[] = {ShapeType::Capsule, ShapeType::Box, ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone};

/// A box as a hull, and its surface.
struct Plate {
    Shape solid, surface;

    Plate(Random& r, int quads) {
        const vec3 half{static_cast<float>(r.range(0.1, 0.6)), static_cast<float>(r.range(0.005, 0.1)),
                        static_cast<float>(r.range(0.1, 0.6))};
        solid = hull_of(corners_of(Box{half}));
        surface = box_mesh(half, quads);
    }
};

TEST(MeshSolid, LongShapesThroughPlatesAreAsDeepAsInTheSolid) {
    for (const ShapeType type : kLong) {
        Random r(1200 + static_cast<std::uint64_t>(type));
        int through = 0;
        for (int i = 0; i < 1500; ++i) {
            const Plate plate(r, 1 + 3 * (i % 3));
            const Shape shape = long_shape(type, r);
            const Pose at{random_direction(r) * r.range(0.0, 2.0), random_rotation(r)}, lies{dvec3{0.0}, random_rotation(r)};
            const std::vector<Manifold> s = collide_all(shape, at, plate.solid, lies, 0.02f),
                                        m = collide_all(shape, at, plate.surface, lies, 0.02f);
            ASSERT_EQ(s.size(), m.size()) << to_string(type) << " " << i;
            if (s.empty()) continue;
            EXPECT_NEAR(deepest(m), deepest(s), 4e-6f * 4.0f) << to_string(type) << " " << i;
            EXPECT_GT(glm::dot(dvec3(m[0].normal), dvec3(s[0].normal)), 1.0 - 1e-6) << to_string(type) << " " << i;
            const std::vector<Manifold> back = collide_all(plate.surface, lies, shape, at, 0.02f);
            ASSERT_EQ(back.size(), 1u);
            EXPECT_NEAR(deepest(back), deepest(m), 1e-6f);
            through += deepest(s) < 0.0f;
            EXPECT_EQ(explain({&shape, &plate.surface, at, lies, 0.02f}).disagreement, "") << to_string(type) << " " << i;
        }
        EXPECT_GT(through, 300) << to_string(type);
    }
}

// Against all separating axes in long double, which know nothing of hulls or triangles.
TEST(MeshSolid, DepthsAreThoseOfAllSeparatingAxes) {
    Random r(1210);
    for (int i = 0; i < 2000; ++i) {
        const Plate plate(r, 1 + i % 4);
        const Shape shape = long_shape(i % 2 == 0 ? ShapeType::Capsule : ShapeType::Box, r);
        const Pose at{random_direction(r) * r.range(0.0, 1.5), random_rotation(r)};
        const Solid solid = solid_of(*std::get<ConvexHullPtr>(plate.solid), {}, at.position);
        const std::vector<Manifold> m = collide_all(shape, at, plate.surface, {}, 0.0f);
        Real truth = 0;
        if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
            const dvec3 half{0.0, static_cast<double>(capsule->half_segment), 0.0};
            truth = signed_distance(solid_of_segment(placed(-half, at, at.position), placed(half, at, at.position)), solid) -
                    Real(capsule->radius);
        } else {
            truth = greatest_separation(solid_of(std::get<Box>(shape), at, at.position), solid).value;
        }
        if (truth > -1e-6) continue;
        ASSERT_EQ(m.size(), 1u) << i;
        EXPECT_NEAR(static_cast<double>(deepest(m)), static_cast<double>(truth), 1e-6 * 4.0) << i;
    }
}

// Hulls, and meshes of both, to a third of the smaller one.
TEST(MeshSolid, HullsAndMeshesAreAsDeepAsHulls) {
    Random r(1220);
    int deep = 0;
    for (int i = 0; i < 2000; ++i) {
        const ConvexHullPtr p = random_hull(r, 32, 0.4, 0.9), q = random_hull(r, 24, 0.3, 0.8);
        const Shape solids[] = {p, q}, surfaces[] = {surface_of(*p), surface_of(*q)};
        const Pose at{random_direction(r) * r.range(0.5, 1.6), random_rotation(r)};
        const std::vector<Manifold> s = collide_all(solids[0], at, solids[1], {}, 0.1f);
        for (const bool both : {false, true}) {
            const std::vector<Manifold> m = collide_all(both ? surfaces[0] : solids[0], at, surfaces[1], {}, 0.1f);
            ASSERT_EQ(m.size(), s.size()) << i;
            if (s.empty()) continue;
            EXPECT_NEAR(deepest(m), deepest(s), 2e-6f) << i;
        }
        deep += !s.empty() && deepest(s) < -0.05f;
    }
    EXPECT_GT(deep, 500);
}

// Points stay on the surface: midway between it and the other's.
TEST(MeshSolid, PointsLieOnTheTriangles) {
    Random r(1230);
    for (int i = 0; i < 500; ++i) {
        const vec3 half{static_cast<float>(r.range(0.2, 0.6)), 0.1f, static_cast<float>(r.range(0.2, 0.6))};
        const TriangleMeshPtr mesh = box_mesh(half, 5);
        const Shape plate = mesh, shape = Box{{0.1f, 0.1f, 0.1f}};
        const Pose at{{r.range(-0.3, 0.3), 0.19, r.range(-0.3, 0.3)}, about({0, 1, 0}, r.range(0, 6))};
        const std::vector<Manifold> m = collide_all(shape, at, plate, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u);
        for (const ContactPoint& p : m[0].used()) {
            const dvec3 on = at.position + dvec3(p.position) + 0.5 * static_cast<double>(p.separation) * dvec3(m[0].normal);
            Real nearest = 1;
            for (std::uint32_t t = 0; t < mesh->triangles().size(); ++t) {
                const auto c = mesh->corners(t);
                nearest = std::min(nearest, distance_to_triangle({real(dvec3(c[0])), real(dvec3(c[1])), real(dvec3(c[2]))}, real(on)));
            }
            EXPECT_LT(nearest, Real(1e-6)) << i;
        }
    }
}

// A closed mesh is a room to what fits in it, whichever way it is wound: that is pushed back in. What does not fit is led out.
TEST(MeshSolid, WhatHasRoomInsideStaysInside) {
    const Shape room = box_mesh({1.0f, 1.0f, 1.0f}, 3);
    const Shape shapes[] = {Box{{0.2f, 0.2f, 0.2f}}, Capsule{0.1f, 0.1f}, Sphere{0.2f}, Cylinder{0.2f, 0.2f},
                            hull_of(corners_of(Box{{0.2f, 0.2f, 0.2f}}))};
    for (const Shape& shape : shapes) {
        std::vector<Manifold> m = collide_all(shape, {{0.3, -0.801, 0.2}}, room, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u) << to_string(type_of(shape));
        EXPECT_NEAR(m[0].normal.y, -1.0f, 1e-6f) << to_string(type_of(shape));
        EXPECT_NEAR(deepest(m), -0.001f, 1e-6f) << to_string(type_of(shape));
        EXPECT_TRUE(collide_all(shape, {{0.3, -0.1, 0.2}}, room, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_EQ(explain({&shape, &room, {{0.3, -0.801, 0.2}}, {}, 0.0f}).disagreement, "");
        // With its centre outside it is pushed out.
        m = collide_all(shape, {{0.3, -1.05, 0.2}}, room, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u) << to_string(type_of(shape));
        EXPECT_NEAR(m[0].normal.y, 1.0f, 1e-6f) << to_string(type_of(shape));
    }
    const Shape large[] = {Sphere{1.2f}, Capsule{0.1f, 1.5f}, Box{{0.1f, 1.5f, 0.1f}}};
    for (const Shape& shape : large) {
        const std::vector<Manifold> m = collide_all(shape, {{0.9, 0.0, 0.0}}, room, {}, 0.0f);
        ASSERT_EQ(m.size(), 1u) << to_string(type_of(shape));
        EXPECT_NEAR(m[0].normal.x, -1.0f, 1e-6f) << to_string(type_of(shape));
        EXPECT_LT(deepest(m), -0.1f) << to_string(type_of(shape));
    }
}

// A pole that is a hair longer than the room is wide, as one is that leans in it and is held by both walls: it stays in, and on the floor.
TEST(MeshSolid, WhatIsWedgedInARoomStaysInside) {
    const Shape room = box_mesh({2.0f, 2.0f, 2.0f}, 1);
    for (const float half : {1.999f, 2.001f, 2.02f}) {
        for (const Shape& pole : {Shape{Box{{half, 0.05f, 0.05f}}}, Shape{Capsule{0.05f, half - 0.05f}}}) {
            const bool is_box = type_of(pole) == ShapeType::Box;
            const dquat q = is_box ? kIdentityRotation : dquat{std::sqrt(0.5), 0, 0, std::sqrt(0.5)};  // along x
            bool stands = false;
            for (const Manifold& m : collide_all(pole, {{0.0, -1.96, 0.0}, q}, room, {}, 0.01f)) {
                for (const ContactPoint& point : m.used()) EXPECT_GT(point.separation, -0.11f) << half;
                EXPECT_LT(m.normal.y, 0.5f) << "the floor pushes up, so the normal from the pole to it is down: " << half;
                stands |= m.normal.y < -0.5f;
            }
            EXPECT_TRUE(stands) << half;
        }
    }
}

// Turned against a room that it would fit, a crate is in the walls by its corners: these are pushed back, and the crate is not led out by its
// own width.
TEST(MeshSolid, ACrateTurnedInItsRoomStaysInside) {
    Random r(1250);
    int exact = 0, reaching = 0;
    for (const float half : {0.45f, 0.49f, 0.5f, 0.505f}) {
        const Shape crates[] = {Box{vec3{half}}, hull_of(corners_of(Box{vec3{half}}))};
        for (int i = 0; i < 400; ++i) {
            const Shape room = box_mesh(vec3{0.5f}, 1 + 2 * (i % 2));
            const dquat turn = about(i % 3 == 0 ? dvec3{0, 1, 0} : random_direction(r), r.range(0.0, 0.35));
            const Pose at{0.01 * random_direction(r), turn}, lies{dvec3{0.0}, i % 5 == 0 ? random_rotation(r) : kIdentityRotation};
            const Pose in_world{rotate(lies.orientation, at.position), lies.orientation * at.orientation};
            const Aabb reach = bounds(crates[0], at);
            const double through = std::max({reach.upper.x, reach.upper.y, reach.upper.z, -reach.lower.x, -reach.lower.y, -reach.lower.z}) - 0.5;
            for (const Shape& crate : crates) {
                const std::vector<Manifold> m = collide_all(crate, in_world, room, lies, 0.0f);
                if (through > 1e-5) {
                    EXPECT_FALSE(m.empty()) << half << " " << i;
                    EXPECT_GT(static_cast<double>(deepest(m)), -through - 1e-5) << half << " " << i;
                    exact += std::abs(static_cast<double>(deepest(m)) + through) < 1e-5;
                    ++reaching;
                }
                // Normals lead out of the crate into the walls.
                for (const Manifold& wall : m) {
                    const dvec3 point = dvec3(wall.points[0].position);
                    EXPECT_GT(glm::dot(dvec3(wall.normal), point), 0.3) << half << " " << i;
                }
                EXPECT_EQ(explain({&crate, &room, in_world, lies, 0.0f}).disagreement, "") << half << " " << i;
            }
        }
    }
    EXPECT_GT(reaching, 2000);
    EXPECT_GT(exact, reaching * 95 / 100) << "the others are deeper than a third of the triangles";
    // What is longer than the room in a direction does not fit, however it is turned.
    const Shape room = box_mesh(vec3{0.5f}, 1);
    for (const Shape& shape : {Shape{Box{{0.52f, 0.52f, 0.52f}}}, Shape{Box{{0.8f, 0.2f, 0.2f}}}, Shape{Capsule{0.1f, 0.5f}}}) {
        EXPECT_LT(deepest(collide_all(shape, {{0.1, 0.05, 0.0}, kIdentityRotation}, room, {}, 0.0f)), -0.3f) << to_string(type_of(shape));
    }
}

TEST(MeshSolid, AMeshInsideOfASolidIsLedOutTheShortestWay) {
    const Shape outer = box_mesh({1.0f, 1.0f, 1.0f}, 3), inner = box_mesh({0.1f, 0.1f, 0.1f}, 1);
    std::vector<Manifold> m;
    EXPECT_EQ(collide({&inner, &outer, {{0.3, 0.1, 0.05}}, {}, 0.01f}, 0, m), CollideStatus::Ok);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_NEAR(deepest(m), -0.8f, 1e-6f);
    EXPECT_NEAR(m[0].normal.x, -1.0f, 1e-6f);
}

// From the front to the bit what the same mesh with two sides says; from inside nothing.
TEST(MeshSolid, OneSidedSolidsPushFromOutside) {
    Random r(1240);
    int outside = 0, inside = 0;
    for (const ShapeType type : kLong) {
        for (int i = 0; i < 300; ++i) {
            const vec3 half{static_cast<float>(r.range(0.1, 0.6)), static_cast<float>(r.range(0.02, 0.3)), 0.4f};
            const TriangleMeshPtr mesh = box_mesh(half, 2);
            const Shape both = mesh, one = *TriangleMesh::build(mesh->vertices(), mesh->triangles(), {.one_sided = true}),
                        shape = long_shape(type, r);
            const Pose at{random_direction(r) * r.range(0.0, 1.0), random_rotation(r)};
            const ConvexHullPtr* hull = std::get_if<ConvexHullPtr>(&shape);
            const dvec3 gap = glm::abs(hull != nullptr ? transform_point(at, (*hull)->centre()) : at.position) - dvec3(half);
            const double above = std::max({gap.x, gap.y, gap.z});
            const std::vector<Manifold> full = collide_all(shape, at, both, {}, 0.0f), m = collide_all(shape, at, one, {}, 0.0f);
            if (above < -1e-6) {
                EXPECT_TRUE(m.empty()) << to_string(type) << " " << i;
                inside += full.empty() ? 0 : 1;
            } else if (above > 1e-6) {
                EXPECT_TRUE(m.size() == full.size() && (m.empty() || std::memcmp(m.data(), full.data(), m.size() * sizeof(Manifold)) == 0));
                outside += full.empty() ? 0 : 1;
            }
            EXPECT_EQ(explain({&shape, &one, at, {}, 0.0f}).disagreement, "") << to_string(type) << " " << i;
        }
    }
    EXPECT_GT(outside, 200);
    EXPECT_GT(inside, 200);
}

// Each part by itself, and the parts' numbers stay.
TEST(MeshSolid, PartsOfCompoundsMeetItToo) {
    const std::vector<CompoundPart> parts{{Capsule{0.05f, 1.0f}, {{0.3, 0.0, 0.0}, kIdentityRotation}},
                                          {Box{{0.05f, 1.0f, 0.05f}}, {{-0.3, 0.0, 0.0}, kIdentityRotation}}};
    const Shape rake = *Compound::build(parts), plate = box_mesh({0.6f, 0.05f, 0.1f}, 4),
                solid = hull_of(corners_of(Box{{0.6f, 0.05f, 0.1f}}));
    const Pose at{{0.0, 0.1, 0.05}, kIdentityRotation};
    const std::vector<Manifold> m = collide_all(rake, at, plate, {}, 0.0f), s = collide_all(rake, at, solid, {}, 0.0f);
    ASSERT_EQ(m.size(), 2u);
    ASSERT_EQ(s.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(m[k].part_a, s[k].part_a);
        EXPECT_NEAR(least_separation(m[k]), -0.1f, 1e-6f);
        EXPECT_NEAR(m[k].normal.z, -1.0f, 1e-6f);
    }
}

}  // namespace
}  // namespace carom
