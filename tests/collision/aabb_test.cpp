// bounds(): holds the exact shape, judged in long double, and is tight.
#include <carom/collision/aabb.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using Exact = glm::vec<3, long double>;  // 64 bits of mantissa: 2048 times finer than what is tested

Exact exact_point(const Pose& pose, const Exact& local) {
    const glm::qua<long double> q{pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z};
    return Exact{pose.position} + rotate(q, local);
}

Exact exact_unrotate(const Pose& pose, const Exact& v) {
    const glm::qua<long double> q{pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z};
    return rotate_inverse(q, v);
}

bool holds(const Aabb& box, const Exact& p) {
    for (int i = 0; i < 3; ++i) {
        if (!(static_cast<long double>(box.lower[i]) <= p[i] && p[i] <= static_cast<long double>(box.upper[i]))) return false;
    }
    return true;
}

dvec3 random_vector(Random& random, double size) {
    return {random.range(-size, size), random.range(-size, size), random.range(-size, size)};
}

Pose random_pose(Random& random, double distance) {
    Pose pose{random_vector(random, distance), kIdentityRotation};
    const dvec3 v = random_vector(random, 1.0);
    pose.orientation = glm::normalize(dquat{random.range(-1, 1), v.x, v.y, v.z});
    return pose;
}

/// The farthest point of a shape along a local direction, in long double.
Exact support(const Sphere& s, const Exact& d) { return glm::normalize(d) * static_cast<long double>(s.radius); }
Exact support(const Box& b, const Exact& d) {
    const Exact h{b.half_extents};
    return {d.x < 0 ? -h.x : h.x, d.y < 0 ? -h.y : h.y, d.z < 0 ? -h.z : h.z};
}
Exact support(const Capsule& c, const Exact& d) {
    const auto h = static_cast<long double>(c.half_segment);
    return Exact{0, d.y < 0 ? -h : h, 0} + glm::normalize(d) * static_cast<long double>(c.radius);
}
Exact support(std::span<const vec3> vertices, const Exact& d) {
    Exact best{vertices[0]};
    for (const vec3& v : vertices) {
        if (glm::dot(Exact{v}, d) > glm::dot(best, d)) best = Exact{v};
    }
    return best;
}

/// Checks enclosure of points on the surface, and on each axis how far the box reaches beyond the farthest of them.
template <class Support>
void expect_tight(const Shape& shape, const Support& farthest, double reach, Random& random, int poses) {
    for (int k = 0; k < poses; ++k) {
        const double distance = std::ldexp(1.0, k % 40 - 20) * reach;
        const Pose pose = random_pose(random, k % 5 == 0 ? 0.0 : distance);
        const Aabb box = bounds(shape, pose);
        const auto slack = static_cast<long double>(0x1p-46 * (glm::length(pose.position) + reach));
        for (int axis = 0; axis < 3; ++axis) {
            for (const int sign : {-1, 1}) {
                Exact direction{0.0L};
                direction[axis] = sign;
                const Exact local = farthest(exact_unrotate(pose, direction));
                const Exact world = exact_point(pose, local);
                EXPECT_TRUE(holds(box, world)) << "pose " << k << ", axis " << axis;
                const double side = sign < 0 ? box.lower[axis] : box.upper[axis];
                EXPECT_LE((static_cast<long double>(side) - world[axis]) * sign, slack) << "pose " << k << ", axis " << axis;
                EXPECT_TRUE(holds(box, Exact{transform_point(pose, dvec3{local})})) << "pose " << k;
            }
        }
        for (int i = 0; i < 20; ++i) {
            const Exact local = farthest(Exact{random_vector(random, 1.0)});
            EXPECT_TRUE(holds(box, exact_point(pose, local)));
        }
    }
}

TEST(Bounds, SimpleShapesAreHeldTightly) {
    Random random(31);
    for (int k = 0; k < 40; ++k) {
        const float size = std::ldexp(1.0f, k % 30 - 15);
        const auto draw = [&] { return size * static_cast<float>(random.range(0.01, 1.0)); };
        const Sphere sphere{draw()};
        const Box box{{draw(), draw(), draw()}};
        const Capsule capsule{draw(), k % 4 == 0 ? 0.0f : draw()};
        expect_tight(sphere, [&](const Exact& d) { return support(sphere, d); }, bounding_radius(sphere), random, 50);
        expect_tight(box, [&](const Exact& d) { return support(box, d); }, bounding_radius(box), random, 50);
        expect_tight(capsule, [&](const Exact& d) { return support(capsule, d); }, bounding_radius(capsule), random, 50);
    }
}

TEST(Bounds, HullsAreHeldTightly) {
    Random random(32);
    for (int k = 0; k < 40; ++k) {
        std::vector<vec3> points;
        const dvec3 away = random_vector(random, k % 3 == 0 ? 100.0 : 0.0);
        for (int i = 0; i < 30; ++i) points.emplace_back(away + random_vector(random, 1.0));
        const ConvexHullPtr hull = *ConvexHull::build(points);
        expect_tight(hull, [&](const Exact& d) { return support(hull->vertices(), d); }, bounding_radius(hull), random, 50);
    }
}

std::vector<TriangleMesh::Triangle> strip(std::uint32_t vertices) {
    std::vector<TriangleMesh::Triangle> triangles;
    for (std::uint32_t i = 2; i < vertices; ++i) triangles.push_back({i - 2, i - 1, i});
    return triangles;
}

TEST(Bounds, AMeshGetsTheTurnedBoxOfItsVertices) {
    Random random(33);
    for (int k = 0; k < 40; ++k) {
        std::vector<vec3> points;
        const dvec3 away = random_vector(random, k % 2 == 0 ? 10.0 : 0.0);
        for (int i = 0; i < 30; ++i) points.emplace_back(away + random_vector(random, 1.0));
        const TriangleMeshPtr mesh = *TriangleMesh::build(points, strip(30));
        const Aabb local = mesh->local_bounds();
        std::vector<vec3> box_corners;
        for (int i = 0; i < 8; ++i) {
            box_corners.emplace_back(i & 1 ? local.upper.x : local.lower.x, i & 2 ? local.upper.y : local.lower.y,
                                     i & 4 ? local.upper.z : local.lower.z);
        }
        double reach = 0.0;
        for (const vec3& c : box_corners) reach = std::max(reach, glm::length(dvec3{c}));
        expect_tight(mesh, [&](const Exact& d) { return support(box_corners, d); }, reach, random, 30);
        long double farthest = 0;
        for (const vec3& p : points) farthest = std::max(farthest, glm::length(Exact{p}));
        EXPECT_GE(static_cast<long double>(bounding_radius(mesh)), farthest);
        EXPECT_NEAR(bounding_radius(mesh), static_cast<double>(farthest), 1e-14 * static_cast<double>(farthest));
        const dvec3 size = local.upper - local.lower;
        EXPECT_EQ(smallest_extent(mesh), std::min({size.x, size.y, size.z}));
    }
}

TEST(Bounds, APlaneIsUnbounded) {
    const double inf = std::numeric_limits<double>::infinity();
    const Aabb box = bounds(Plane{}, Pose{});
    EXPECT_EQ(box.lower, dvec3{-inf});
    EXPECT_EQ(box.upper, dvec3{inf});
    EXPECT_FALSE(is_empty(box));
    EXPECT_EQ(bounding_radius(Plane{}), inf);
    EXPECT_EQ(smallest_extent(Plane{}), inf);
}

TEST(Bounds, RadiusHoldsEveryPoint) {
    Random random(34);
    for (int k = 0; k < 1000; ++k) {
        const auto draw = [&] { return static_cast<float>(random.range(0.01, 1.0)); };
        const Box box{{draw(), draw(), draw()}};
        EXPECT_GE(static_cast<long double>(bounding_radius(box)), glm::length(Exact{box.half_extents}));
        EXPECT_NEAR(bounding_radius(box), static_cast<double>(glm::length(Exact{box.half_extents})), 1e-14);
        const Capsule capsule{draw(), draw()};
        const long double end = static_cast<long double>(capsule.radius) + static_cast<long double>(capsule.half_segment);
        EXPECT_GE(static_cast<long double>(bounding_radius(capsule)), end);
        EXPECT_NEAR(bounding_radius(capsule), static_cast<double>(end), 1e-14);
        std::vector<vec3> points;
        for (int i = 0; i < 8; ++i) points.emplace_back(random_vector(random, 1.0));
        const ConvexHullPtr hull = *ConvexHull::build(points);
        long double farthest = 0;
        for (const vec3& v : hull->vertices()) farthest = std::max(farthest, glm::length(Exact{v}));
        EXPECT_GE(static_cast<long double>(bounding_radius(hull)), farthest);
        EXPECT_NEAR(bounding_radius(hull), static_cast<double>(farthest), 1e-14);
    }
    EXPECT_EQ(bounding_radius(Sphere{0.3f}), static_cast<double>(0.3f));
}

TEST(Bounds, SmallestExtent) {
    EXPECT_EQ(smallest_extent(Sphere{0.25f}), 0.5);
    EXPECT_EQ(smallest_extent(Box{{1.0f, 0.125f, 2.0f}}), 0.25);
    EXPECT_EQ(smallest_extent(Capsule{0.25f, 3.0f}), 0.5);
    const std::vector<vec3> points{{0, 0, 1}, {4, 0, 1}, {0, 3, 1}, {0, 0, 1.5f}};
    // Across the slanted face x/4 + y/3 + (z - 1)/0.5 = 1, which is less than the 0.5 across the base.
    EXPECT_NEAR(smallest_extent(*ConvexHull::build(points)), 1.0 / std::sqrt(1.0 / 16.0 + 1.0 / 9.0 + 4.0), 1e-6);
}

TEST(Bounds, SmallestExtentOfAHullDoesNotDependOnHowItLies) {
    const dquat turn = rotation_from_vector({0.3, 0.7, 0.4});
    std::vector<vec3> rod;
    for (int i = 0; i < 8; ++i) {
        const dvec3 corner{(i & 1) != 0 ? 2.0 : -2.0, (i & 2) != 0 ? 0.1 : -0.1, (i & 4) != 0 ? 0.1 : -0.1};
        rod.push_back(vec3{rotate(turn, corner)});
    }
    EXPECT_NEAR(smallest_extent(*ConvexHull::build(rod)), 0.2, 1e-6);
}

TEST(Aabb, OperationsFollowClosedIntervals) {
    const Aabb a{{0, 0, 0}, {1, 1, 1}};
    const Aabb touching{{1, 0, 0}, {2, 1, 1}};
    const Aabb apart{{1.0 + 1e-15, 0, 0}, {2, 1, 1}};
    EXPECT_TRUE(overlaps(a, touching));
    EXPECT_FALSE(overlaps(a, apart));
    EXPECT_TRUE(is_empty(Aabb{}));
    EXPECT_FALSE(is_empty(a));
    EXPECT_EQ(merge(Aabb{}, a), a);
    EXPECT_EQ(merge(a, touching), (Aabb{{0, 0, 0}, {2, 1, 1}}));
    EXPECT_EQ(inflate(a, 0.5), (Aabb{{-0.5, -0.5, -0.5}, {1.5, 1.5, 1.5}}));
}

}  // namespace
}  // namespace carom
