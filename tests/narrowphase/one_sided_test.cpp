// One-sided meshes: what has its centre in front meets them as it meets any mesh, what has it behind meets nothing.
#include "oracle.hpp"

#include <support/box_mesh.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/executor.hpp>
#include <carom/narrowphase/explain.hpp>
#include <carom/narrowphase/shape_cast.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace carom {
namespace {

using namespace test;

constexpr ShapeType kSolids[] = {ShapeType::Sphere,     ShapeType::Box,      ShapeType::Capsule,
                                 ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone};

double hill(double x, double z) { return 0.4 * std::sin(1.5 * x) * std::cos(2.0 * z + 1.0); }

TriangleMeshPtr hills(bool one_sided) {
    const MeshData data = height_grid(48, 48, 0.25, hill);
    return *TriangleMesh::build(data.vertices, data.triangles, {.one_sided = one_sided});
}

TriangleMeshPtr sheet(bool one_sided) {
    const MeshData data = height_grid(8, 8, 1.0, [](double, double) { return 0.0; });
    return *TriangleMesh::build(data.vertices, data.triangles, {.one_sided = one_sided});
}

/// The height of the grid's surface under a point, as its triangles have it.
double surface_height(const TriangleMesh& mesh, double x, double z) {
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
        const auto c = mesh.corners(t);
        const auto side = [&](const vec3& p, const vec3& q) {
            return (double(q.x) - double(p.x)) * (z - double(p.z)) - (double(q.z) - double(p.z)) * (x - double(p.x));
        };
        const double u = side(c[0], c[1]), v = side(c[1], c[2]), w = side(c[2], c[0]);
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) continue;
        return (v * double(c[0].y) + w * double(c[1].y) + u * double(c[2].y)) / (u + v + w);
    }
    return 0.0;
}

bool same(const std::vector<Manifold>& a, const std::vector<Manifold>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Manifold)) == 0);
}

/// Where the part or shape of which the contact is has its centre.
dvec3 centre_of(const Shape& shape, const Pose& at) {
    const ConvexHullPtr* hull = std::get_if<ConvexHullPtr>(&shape);
    return hull != nullptr ? transform_point(at, (*hull)->centre()) : at.position;
}

TEST(OneSided, AFlatSheetIsTheSameFromTheFrontAndNothingFromBehind) {
    const Shape both = sheet(false), one = sheet(true);
    Random r(900);
    int front = 0, back = 0;
    for (const ShapeType type : kSolids) {
        for (int i = 0; i < 400; ++i) {
            const Shape shape = random_shape(type, r);
            const Pose ground{random_direction(r), random_rotation(r)};
            const Pose local{{r.range(-2.5, 2.5), r.range(-0.8, 0.8), r.range(-2.5, 2.5)}, random_rotation(r)}, at = ground * local;
            const std::vector<Manifold> full = collide_all(shape, at, both, ground, 0.02f),
                                        half = collide_all(shape, at, one, ground, 0.02f);
            if (centre_of(shape, local).y > 1e-9) {
                EXPECT_TRUE(same(full, half)) << to_string(type) << " " << i;
                front += full.empty() ? 0 : 1;
            } else {
                EXPECT_TRUE(half.empty()) << to_string(type) << " " << i;
                EXPECT_TRUE(collide_all(one, ground, shape, at, 0.02f).empty());
                back += full.empty() ? 0 : 1;
            }
        }
    }
    EXPECT_GT(front, 300);
    EXPECT_GT(back, 300);
}

TEST(OneSided, HillsPushWhatHasItsCentreOverThem) {
    const TriangleMeshPtr surface = hills(true);
    const Shape both = hills(false), one = surface;
    Random r(901);
    int front = 0, back = 0;
    for (const ShapeType type : kSolids) {
        for (int i = 0; i < 500; ++i) {
            const Shape shape = random_shape(type, r);
            const double x = r.range(-4.0, 4.0), z = r.range(-4.0, 4.0);
            const Pose at{{x, hill(x, z) + r.range(-0.7, 0.7), z}, random_rotation(r)};
            const dvec3 centre = centre_of(shape, at);
            const double height = centre.y - surface_height(*surface, centre.x, centre.z);
            if (std::abs(height) < 1e-6) continue;
            const std::vector<Manifold> half = collide_all(shape, at, one, {}, 0.02f);
            const bool touches = explain({&shape, &both, at, {}, 0.02f}).verdict == PairVerdict::Touching;
            const PairExplanation why = explain({&shape, &one, at, {}, 0.02f});
            EXPECT_EQ(why.disagreement, "") << to_string(type) << " " << i;
            if (height < 0.0) {
                EXPECT_TRUE(half.empty()) << to_string(type) << " " << i << " at " << height;
                EXPECT_TRUE(why.back_face) << to_string(type) << " " << i;
                back += touches ? 1 : 0;
            } else if (touches) {
                EXPECT_FALSE(half.empty()) << to_string(type) << " " << i << " at " << height;
                EXPECT_FALSE(why.back_face) << to_string(type) << " " << i;
                ++front;
            }
        }
    }
    EXPECT_GT(front, 500);
    EXPECT_GT(back, 500);
}

// Under the edge of a steep ditch a centre may be in front of the plane of one wall, and is behind the surface all the same.
TEST(OneSided, UnderADitchIsBehind) {
    const std::vector<vec3> v{{-1, 1.7f, -3}, {-1, 1.7f, 3}, {0, 0, -3}, {0, 0, 3}, {1, 1.7f, -3}, {1, 1.7f, 3}};
    const std::vector<TriangleMesh::Triangle> t{{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
    const Shape both = *TriangleMesh::build(v, t), one = *TriangleMesh::build(v, t, {.one_sided = true});
    for (const Shape& shape : {Shape{Sphere{0.3f}}, Shape{Box{{0.2f, 0.2f, 0.2f}}}, Shape{Capsule{0.2f, 0.1f}}, Shape{Cylinder{0.2f, 0.2f}}}) {
        const Pose under{{-0.1, -0.1, 0.2}, kIdentityRotation}, in{{-0.1, 0.35, 0.2}, kIdentityRotation};
        EXPECT_FALSE(collide_all(shape, under, both, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_TRUE(collide_all(shape, under, one, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_FALSE(collide_all(shape, in, one, {}, 0.0f).empty()) << to_string(type_of(shape));
        const RigidMotion up{.start = {{-0.2, -1.6, 0.2}, kIdentityRotation}, .translation = {0.2, 3.0, 0.0}};
        EXPECT_EQ(cast_shape(shape, up, one, {}).status, ImpactStatus::Separated) << to_string(type_of(shape));
        // In front of one wall's plane all the way to the edge.
        const RigidMotion slanting{.start = {{-1.0, -0.9, 0.2}, kIdentityRotation}, .translation = {0.85, 0.75, 0.0}};
        EXPECT_EQ(cast_shape(shape, slanting, both, {}).status, ImpactStatus::Touching) << to_string(type_of(shape));
        EXPECT_EQ(cast_shape(shape, slanting, one, {}).status, ImpactStatus::Separated) << to_string(type_of(shape));
    }
}

TEST(OneSided, AClosedMeshLetsOutWhatIsInIt) {
    const TriangleMeshPtr crate = box_mesh({1.0f, 1.0f, 1.0f}, 4);
    const Shape both = crate, one = *TriangleMesh::build(crate->vertices(), crate->triangles(), {.one_sided = true});
    const Shape ball = Sphere{0.3f}, box = Box{{0.3f, 0.3f, 0.3f}}, small = box_mesh({0.2f, 0.2f, 0.2f}, 2);
    for (const Shape* shape : {&ball, &box, &small}) {
        const Pose inside{{0.1, 0.9, 0.0}, kIdentityRotation}, outside{{0.1, 1.1, 0.0}, kIdentityRotation};
        EXPECT_FALSE(collide_all(*shape, inside, both, {}, 0.0f).empty());
        EXPECT_TRUE(collide_all(*shape, inside, one, {}, 0.0f).empty());
        EXPECT_TRUE(same(collide_all(*shape, outside, both, {}, 0.0f), collide_all(*shape, outside, one, {}, 0.0f)));
        EXPECT_FALSE(collide_all(*shape, outside, one, {}, 0.0f).empty());
    }
    // A mesh inside that touches nothing is led out of a closed one, but for this.
    EXPECT_FALSE(collide_all(small, {}, both, {}, 0.0f).empty());
    EXPECT_TRUE(collide_all(small, {}, one, {}, 0.0f).empty());
}

TEST(OneSided, MeshesMeetWithTheirMiddlesInFront) {
    const Shape both = sheet(false), one = sheet(true), crate = box_mesh({0.5f, 0.25f, 0.375f}, 3);
    Random r(902);
    int front = 0;
    for (int i = 0; i < 200; ++i) {
        const Pose ground{random_direction(r), random_rotation(r)}, turn{dvec3{0.0}, about({0, 1, 0}, r.range(0, 6))};
        const Pose over = ground * Pose{{r.range(-2, 2), 0.25 - 0.01 * r.unit(), r.range(-2, 2)}} * turn;
        const Pose under = ground * Pose{{r.range(-2, 2), -0.25 + 0.01 * r.unit(), r.range(-2, 2)}} * turn;
        const std::vector<Manifold> full = collide_all(crate, over, both, ground, 0.01f);
        EXPECT_TRUE(same(full, collide_all(crate, over, one, ground, 0.01f))) << i;
        EXPECT_TRUE(same(collide_all(both, ground, crate, over, 0.01f), collide_all(one, ground, crate, over, 0.01f))) << i;
        front += full.empty() ? 0 : 1;
        EXPECT_TRUE(collide_all(crate, under, one, ground, 0.01f).empty()) << i;
        EXPECT_TRUE(collide_all(one, ground, crate, under, 0.01f).empty()) << i;
        EXPECT_TRUE(explain({&crate, &one, under, ground, 0.01f}).back_face) << i;
        EXPECT_FALSE(explain({&crate, &one, over, ground, 0.01f}).back_face) << i;
    }
    EXPECT_EQ(front, 200);
}

TEST(OneSided, EachPartOfACompoundHasItsOwnCentre) {
    const Shape one = sheet(true);
    const Shape bar =
        *Compound::build({{Sphere{0.2f}, {{0, 0.15, 0}, kIdentityRotation}}, {Sphere{0.2f}, {{0, -0.15, 0}, kIdentityRotation}}});
    const std::vector<Manifold> m = collide_all(bar, {{0.3, 0.0, 0.2}, kIdentityRotation}, one, {}, 0.0f);
    ASSERT_EQ(m.size(), 1u);
    EXPECT_EQ(m[0].part_a, 0u);
    EXPECT_NEAR(least_separation(m[0]), -0.05f, 1e-6f);
    EXPECT_EQ(explain({&bar, &one, {{0.3, 0.0, 0.2}, kIdentityRotation}, {}, 0.0f}).disagreement, "");
}

// The batch looks at pairs anew only where they have moved by more than their slack: what comes through from behind is seen at once.
TEST(OneSided, ABatchSeesWhatComesThrough) {
    const Shape one = sheet(true), ball = Sphere{0.2f};
    const Shape* shapes[] = {&ball, &one};
    std::vector<Manifold> last, now;
    SerialExecutor serial;
    CollideScratch scratch;
    for (int i = 0; i < 40; ++i) {
        const Pose poses[] = {{{0.3, -0.01 + 0.001 * i, 0.2}, kIdentityRotation}, {}};
        const NumberedPair pair{0, 1, 0.01f, 0.05f, i == 0 ? kNewPair : 0};
        collide({shapes, poses}, std::span(&pair, 1), last, serial, scratch, now);
        const bool in_front = poses[0].position.y >= 0.0;
        EXPECT_EQ(!now.empty(), in_front) << i;
        std::swap(last, now);
    }
}

TEST(OneSided, CastsFromBehindGoThrough) {
    const Shape both = sheet(false), one = sheet(true);
    Random r(903);
    for (const ShapeType type : kSolids) {
        for (int i = 0; i < 60; ++i) {
            const Shape shape = random_shape(type, r);
            const Pose ground{random_direction(r), random_rotation(r)};
            const double height = 3.0 + bounding_radius(shape);
            const dvec3 aside{r.range(-0.5, 0.5), 0.0, r.range(-0.5, 0.5)}, along{r.range(-1, 1), -2.0 * height, r.range(-1, 1)};
            const dquat turn = random_rotation(r);
            const dvec3 spin = i % 2 == 0 ? dvec3{0.0} : 3.0 * random_direction(r);
            const auto motion = [&](double side) {
                return RigidMotion{ground * Pose{dvec3{0, side * height, 0} + aside, turn},
                                   transform_vector(ground, {along.x, side * along.y, along.z}), spin};
            };
            const ShapeImpact full = cast_shape(shape, motion(1.0), both, ground), half = cast_shape(shape, motion(1.0), one, ground);
            ASSERT_EQ(full.status, ImpactStatus::Touching) << to_string(type) << " " << i;
            EXPECT_EQ(half.status, full.status) << to_string(type) << " " << i;
            EXPECT_EQ(half.t, full.t) << to_string(type) << " " << i;
            EXPECT_EQ(cast_shape(shape, motion(-1.0), both, ground).status, ImpactStatus::Touching) << to_string(type) << " " << i;
            EXPECT_EQ(cast_shape(shape, motion(-1.0), one, ground).status, ImpactStatus::Separated) << to_string(type) << " " << i;
        }
    }
}

// Past the border and then against it from below: the path begins in front, the contact is behind.
TEST(OneSided, TheBorderHasABackToo) {
    const Shape one = sheet(true), both = sheet(false);
    const RigidMotion under{.start = {{6.0, 1.0, 0.0}, kIdentityRotation}, .translation = {-4.0, -3.1, 0.0}};
    const RigidMotion over{.start = {{6.0, 1.0, 0.0}, kIdentityRotation}, .translation = {-4.0, -1.0, 0.0}};
    for (const Shape& shape : {Shape{Sphere{0.5f}}, Shape{Box{{0.4f, 0.4f, 0.4f}}}}) {
        const Pose below{{4.3, -0.1, 0.3}, kIdentityRotation}, above{{4.3, 0.1, 0.3}, kIdentityRotation};
        EXPECT_FALSE(collide_all(shape, below, both, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_TRUE(collide_all(shape, below, one, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_TRUE(same(collide_all(shape, above, one, {}, 0.0f), collide_all(shape, above, both, {}, 0.0f))) << to_string(type_of(shape));
        EXPECT_FALSE(collide_all(shape, above, one, {}, 0.0f).empty()) << to_string(type_of(shape));
        EXPECT_EQ(cast_shape(shape, under, both, {}).status, ImpactStatus::Touching) << to_string(type_of(shape));
        EXPECT_EQ(cast_shape(shape, under, one, {}).status, ImpactStatus::Separated) << to_string(type_of(shape));
        EXPECT_EQ(cast_shape(shape, over, one, {}).status, ImpactStatus::Touching) << to_string(type_of(shape));
    }
}

}  // namespace
}  // namespace carom
