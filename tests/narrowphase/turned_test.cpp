// Cylinder and cone against every convex shape and the plane: exact supports in long double are the oracle.
#include "turned_oracle.hpp"

#include <carom/collision/aabb.hpp>

#include <gtest/gtest.h>

namespace carom {
namespace {

using namespace test;

// Free poses, almost aligned ones, aligned ones, and deep ones.
Pose random_local(Random& r, int kind) {
    Pose pose{random_direction(r) * r.range(kind == 3 ? 0.0 : 0.2, kind == 3 ? 0.3 : 1.8), random_rotation(r)};
    if (kind == 1) pose.orientation = about(random_direction(r), r.range(-1e-5, 1e-5));
    if (kind == 2) pose.orientation = r.unit() < 0.5 ? kIdentityRotation : about({0, 0, 1}, 0.5 * kPi);
    return pose;
}

bool turned(ShapeType t) { return t == ShapeType::Cylinder || t == ShapeType::Cone; }

// How far the solid's surface is from the point in the direction `n`, at most: the reach less the point.
double over(const Reach& solid, const dvec3& n, const dvec3& p) { return static_cast<double>(solid(real(n)) - glm::dot(real(n), real(p))); }

struct Tally {
    int touching = 0, near = 0, apart = 0, undecided = 0;
};

void check_one(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb, float margin, Random& r, Tally& tally) {
    const Reach ra = reach_of(a, pa, pa.position), rb = reach_of(b, pb, pa.position);
    const Separation truth = greatest_gap(ra, rb, r);
    const double separation = static_cast<double>(truth.value);
    const double size = std::max(bounding_radius(a), bounding_radius(b));
    const double tolerance = 3e-6 * std::max(1.0, size);
    std::vector<Manifold> m;
    const CollideStatus status = collide(ShapePair{&a, &b, pa, pb, margin}, 0, m);
    tally.undecided += status != CollideStatus::Ok;
    // The oracle finds a gap; the true one may be greater by what its search leaves out, and never smaller.
    if (separation > static_cast<double>(margin) + tolerance) {
        ++tally.apart;
        ASSERT_TRUE(m.empty()) << separation;
        return;
    }
    if (separation > static_cast<double>(margin) - tolerance) return;
    ASSERT_EQ(m.size(), 1u) << separation;
    (separation < 0 ? tally.touching : tally.near)++;
    const dvec3 n(m[0].normal);
    ASSERT_NEAR(glm::dot(n, n), 1.0, 1e-6);
    const double along = static_cast<double>(gap_along(ra, rb, real(n / std::sqrt(glm::dot(n, n)))));
    const double least = static_cast<double>(least_separation(m[0]));
    ASSERT_NEAR(least, along, tolerance) << "the depth is not that along the normal";
    ASSERT_GT(along, separation - tolerance) << "beaten by " << dvec3(truth.normal).x << " " << dvec3(truth.normal).y << " "
                                             << dvec3(truth.normal).z << " not " << n.x << " " << n.y << " " << n.z;
    // Each point lies midway: half its separation up and down along the normal are points of A and of B, which no direction refutes. Two
    // lines along each other may be 2 % of the radius apart sideways: 1 % from the middle the surface has fallen by 5e-5 of it, and near
    // the tip of a cone, where there is no radius left, by that 1 %. And where a feature's normal stands in for one that is less deep by up
    // to 1e-6 of the size, and so up to sqrt(2e-6) off, the deepest points are off the normal by that share of the depth.
    const bool tip = type_of(a) == ShapeType::Cone || type_of(b) == ShapeType::Cone;
    const double sideways = (m[0].count > 2 ? 0.0 : tip ? 1e-2 * size : 5e-5 * size) + 1.5e-3 * std::max(0.0, -least);
    for (const ContactPoint& p : m[0].used()) {
        const dvec3 half = (0.5 * static_cast<double>(p.separation)) * n;
        for (int k = 0; k < 60; ++k) {
            const dvec3 u = random_direction(r);
            ASSERT_GT(over(ra, u, dvec3(p.position) - half), -2.0 * tolerance - sideways) << "not a point of A";
            ASSERT_GT(over(rb, u, dvec3(p.position) + half), -2.0 * tolerance - sideways) << "not a point of B";
        }
    }
}

TEST(Turned, SeparationAndNormalAreThoseOfTheExactSupports) {
    constexpr ShapeType kConvex[] = {ShapeType::Sphere,     ShapeType::Box,      ShapeType::Capsule,
                                     ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone};
    for (const ShapeType ta : kConvex) {
        for (const ShapeType tb : kConvex) {
            if (!turned(ta) && !turned(tb)) continue;
            Random r(815 + 10 * static_cast<std::uint64_t>(ta) + static_cast<std::uint64_t>(tb));
            Tally tally;
            constexpr int kCount = 60;
            for (int i = 0; i < kCount; ++i) {
                SCOPED_TRACE(testing::Message() << to_string(ta) << " " << to_string(tb) << " " << i);
                const Shape a = random_shape(ta, r), b = random_shape(tb, r);
                const Pose pa{random_direction(r) * 3.0, random_rotation(r)};
                check_one(a, pa, b, pa * random_local(r, i % 4), 0.05f, r, tally);
                if (HasFatalFailure()) return;
            }
            EXPECT_GT(tally.touching, kCount / 20) << to_string(ta) << " " << to_string(tb);
            EXPECT_GT(tally.apart, kCount / 20) << to_string(ta) << " " << to_string(tb);
            EXPECT_LE(tally.undecided, kCount / 10) << to_string(ta) << " " << to_string(tb);
        }
    }
}

// Every rotation brings some point of the rims lowest; a plane is met there.
TEST(Turned, PlaneMeetsTheLowestPoint) {
    Random r(99);
    for (int i = 0; i < 2000; ++i) {
        const Shape shape = random_shape(i % 2 == 0 ? ShapeType::Cylinder : ShapeType::Cone, r);
        Pose pose{random_direction(r), random_rotation(r)};
        if (i % 5 == 0) pose.orientation = about(random_direction(r), r.range(-1e-4, 1e-4));
        if (i % 5 == 1) pose.orientation = about({0, 0, 1}, 0.5 * kPi + r.range(-1e-4, 1e-4));
        const dvec3 normal = i % 5 < 2 ? dvec3{0, 1, 0} : random_direction(r);
        const Shape plane = Plane{vec3(normal), 0.0f};
        const dvec3 n(glm::normalize(dvec3(vec3(normal))));
        const double truth = -static_cast<double>(reach_of(shape, pose, dvec3{0.0})(real(-n)));
        const std::vector<Manifold> m = collide_all(shape, pose, plane, {}, 0.1f);
        if (truth > 0.1 + 1e-6) {
            ASSERT_TRUE(m.empty());
            continue;
        }
        if (truth > 0.1 - 1e-6) continue;
        ASSERT_EQ(m.size(), 1u);
        ASSERT_NEAR(static_cast<double>(least_separation(m[0])), truth, 2e-6) << i;
        ASSERT_NEAR(glm::dot(dvec3(m[0].normal), n), -1.0, 1e-6);
        for (const ContactPoint& p : m[0].used()) {
            const double height = glm::dot(n, dvec3(p.position) + pose.position);
            ASSERT_NEAR(height, 0.5 * static_cast<double>(p.separation), 2e-6);
        }
    }
}

int points(const Shape& a, const Pose& pa, const Shape& b, const Pose& pb) {
    const std::vector<Manifold> m = collide_all(a, pa, b, pb, 0.01f);
    return m.size() == 1 ? static_cast<int>(m[0].count) : -static_cast<int>(m.size());
}

// The area that the points of the manifold enclose, in the plane y = const.
double area_of(const Manifold& m) {
    double best = 0.0;
    for (std::size_t i = 0; i < m.count; ++i) {
        for (std::size_t j = 0; j < m.count; ++j) {
            for (std::size_t k = 0; k < m.count; ++k) {
                const vec3 u = m.points[j].position - m.points[i].position, v = m.points[k].position - m.points[i].position;
                best = std::max(best, 0.5 * std::abs(static_cast<double>(u.x * v.z - u.z * v.x)));
            }
        }
    }
    return best;
}

TEST(Turned, ManifoldsHaveThePointsThatCarry) {
    const Shape cylinder = Cylinder{0.5f, 1.0f}, cone = Cone{0.5f, 1.0f}, plane = Plane{};
    const Shape floor = Box{{5, 1, 5}};
    const dquat lying = about({0, 0, 1}, 0.5 * kPi);
    const Pose under{{0, -1, 0}};
    for (const auto& [ground, at] : {std::pair{plane, Pose{}}, std::pair{floor, under}}) {
        EXPECT_EQ(points(cylinder, {{0.2, 0.999, 0.1}}, ground, at), 4) << "standing";
        EXPECT_EQ(points(cone, {{0.2, 0.999, 0.1}}, ground, at), 4) << "on its base";
        EXPECT_EQ(points(cylinder, {{0.2, 0.499, 0.1}, lying}, ground, at), 2) << "lying";
        EXPECT_EQ(points(cylinder, {{0, 1.1172, 0}, about({0, 0, 1}, 0.5)}, ground, at), 1) << "on its rim";
        EXPECT_EQ(points(cone, {{0, 0.999, 0}, about({0, 0, 1}, kPi)}, ground, at), 1) << "on its tip";
        // A cone lies along its side: from the tip to the rim. Its side is at arctan(r / 2 h) of the axis.
        const double slope = std::atan2(0.5, 2.0);
        const Pose on_side{{0, 0.5 * std::cos(slope) - 1.0 * std::sin(slope) + 2.0 * std::sin(slope) * 0.5 - 1e-3, 0},
                           about({0, 0, 1}, 0.5 * kPi + slope)};
        const Reach low = reach_of(cone, on_side, dvec3{0.0});
        Pose settled = on_side;
        settled.position.y += static_cast<double>(low(RealVec(0, -1, 0))) - 1e-3;
        EXPECT_EQ(points(cone, settled, ground, at), 2) << "a cone on its side";
    }
    // Ends on ends: the common region of two discs, whole and in part.
    EXPECT_EQ(points(cylinder, {{0, 2.999, 0}}, cylinder, {{0, 1, 0}}), 4);
    EXPECT_GE(points(cylinder, {{0.6, 2.999, 0.1}}, cylinder, {{0, 1, 0}}), 3);
    EXPECT_EQ(points(cylinder, {{0, 0.999, 0}, lying}, cylinder, {{0.3, 0, 0}, lying}), 2) << "side along side";
    EXPECT_EQ(points(cylinder, {{0, 0.999, 0}, lying}, cylinder, {{0, 0, 0}, about({1, 0, 0}, 0.5 * kPi)}), 1) << "crossed";
    EXPECT_EQ(points(cylinder, {{0, 1.499, 0}}, cylinder, {{0, 0, 0}, lying}), 2) << "an end on a side";
    EXPECT_EQ(points(cylinder, {{0, 1.2499, 0}}, Shape{Capsule{0.25f, 0.4f}}, {{0, 0, 0}, lying}), 2) << "a capsule under an end";
    // The four points are well spread: a triangle of the largest quadrilateral in the disc has half of 2 r², and 16 corners lose nothing.
    const std::vector<Manifold> standing = collide_all(cylinder, {{0, 0.999, 0}}, floor, under, 0.01f);
    ASSERT_EQ(standing.size(), 1u);
    EXPECT_GT(area_of(standing[0]), 0.9 * 0.25);
}

// Sizes that are far from each other, and from 1.
TEST(Turned, FlatThinAndTinySolidsKeepTheirDepth) {
    const float sizes[][2] = {{1.0f, 1e-3f}, {1e-3f, 1.0f}, {1e-5f, 1e-5f}, {1000.0f, 1.0f}, {0.5f, 5e-5f}};
    Random r(31);
    Tally tally;
    for (const auto& s : sizes) {
        const double scale = static_cast<double>(std::max(s[0], s[1]));
        const Shape shapes[] = {Cylinder{s[0], s[1]}, Cone{s[0], s[1]}};
        for (const Shape& shape : shapes) {
            for (int i = 0; i < 40; ++i) {
                const auto f = [&](double x) { return static_cast<float>(x * scale); };
                const Shape others[] = {Sphere{f(0.3)}, Box{{f(0.3), f(0.5), f(0.4)}}, Capsule{f(0.1), f(0.5)}, shape};
                const Pose pb{random_direction(r) * r.range(0.0, 1.0) * scale, random_rotation(r)};
                const Shape& other = others[i % 4];
                const Reach ra = reach_of(shape, {}, dvec3{0.0}), rb = reach_of(other, pb, dvec3{0.0});
                const Separation truth = greatest_gap(ra, rb, r);
                const double tolerance = 5e-6 * scale, separation = static_cast<double>(truth.value);
                const std::vector<Manifold> m = collide_all(shape, {}, other, pb, 0.0f);
                if (std::abs(separation) < tolerance) continue;
                ASSERT_EQ(m.empty(), separation > 0.0) << s[0] << " " << s[1] << " " << i << " " << separation;
                if (m.empty()) continue;
                ++tally.touching;
                ASSERT_EQ(m.size(), 1u);
                const dvec3 n(m[0].normal);
                const double along = static_cast<double>(gap_along(ra, rb, real(n / std::sqrt(glm::dot(n, n)))));
                ASSERT_NEAR(static_cast<double>(least_separation(m[0])), along, tolerance) << s[0] << " " << s[1] << " " << i;
                ASSERT_GT(along, separation - tolerance) << s[0] << " " << s[1] << " " << i;
            }
        }
    }
    EXPECT_GT(tally.touching, 100);
}

// The names and places of points survive small motion.
TEST(Turned, SmallMotionKeepsThePoints) {
    const Shape cylinder = Cylinder{0.5f, 1.0f}, floor = Box{{5, 1, 5}};
    Random r(77);
    for (int i = 0; i < 300; ++i) {
        const Pose pose{{r.range(-1, 1), 0.9995, r.range(-1, 1)}, about({0, 1, 0}, r.range(0, 6))};
        const Pose moved{pose.position + random_direction(r) * 1e-7, about(random_direction(r), 1e-7) * pose.orientation};
        const std::vector<Manifold> m = collide_all(cylinder, pose, floor, {{0, -1, 0}}, 0.01f);
        const std::vector<Manifold> n = collide_all(cylinder, moved, floor, {{0, -1, 0}}, 0.01f);
        ASSERT_EQ(m.size(), 1u);
        ASSERT_EQ(n.size(), 1u);
        ASSERT_EQ(m[0].count, 4u);
        ASSERT_EQ(n[0].count, 4u);
        for (const ContactPoint& p : m[0].points) {  // which may change places
            const auto same = [&](const ContactPoint& q) { return q.feature == p.feature; };
            const auto found = std::find_if(n[0].points.begin(), n[0].points.end(), same);
            ASSERT_NE(found, n[0].points.end()) << i;
            EXPECT_LT(glm::length(p.position - found->position), 1e-5f) << i;
        }
    }
}

}  // namespace
}  // namespace carom
