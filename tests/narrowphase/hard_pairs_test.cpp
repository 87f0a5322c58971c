// Pairs at which narrowphases fail, each with the figure that stands in docs/stability.md: run with --gtest_filter='HardPairs.*' and read the
// lines "figure".
#include "oracle.hpp"

#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <set>

namespace carom {
namespace {

using namespace test;

void show(const char* name, double value) { std::printf("figure %-60s %.3g\n", name, value); }

std::set<std::uint64_t> names_of(const std::vector<Manifold>& manifolds) {
    std::set<std::uint64_t> names;
    for (const Manifold& m : manifolds) {
        for (const ContactPoint& p : m.used()) names.insert(p.feature);
    }
    return names;
}

// Coplanar faces, and edges parallel to 1e-1 .. 1e-12 rad, 0.01 deep: the oracle's depth, and names that stay while the box trembles.
TEST(HardPairs, FacesInOnePlaneAndEdgesNearlyParallel) {
    Random random(19);
    const Box box_a{{0.5f, 0.5f, 1.0f}}, box_b{{0.3f, 0.3f, 0.7f}};
    const std::array<std::array<Shape, 2>, 2> pairs{{{box_a, box_b}, {hull_of(corners_of(box_a)), hull_of(corners_of(box_b))}}};
    const double upright = double{0.5f} + double{0.3f}, on_edges = std::sqrt(0.5) + std::sqrt(0.18);
    double worst = 0.0;
    int flickered = 0, looks = 0;
    for (double angle = 0.1; angle > 0.5e-12; angle *= 0.1) {
        for (const bool edges : {false, true}) {
            const dquat lean = edges ? about({0, 0, 1}, 0.25 * kPi) : kIdentityRotation;
            for (const dvec3& axis : {dvec3{0, 1, 0}, dvec3{1, 0, 0}, dvec3{1, 2, 3}}) {
                const Pose pa{{0, 0, 0}, lean},
                    pb{{edges ? 0.001 : 0.101, (edges ? on_edges : upright) - 0.01, 0.103}, about(axis, angle) * lean};
                const double truth = static_cast<double>(greatest_separation(solid_of(box_a, pa, {}), solid_of(box_b, pb, {})).value);
                for (const auto& [a, b] : pairs) {
                    const std::vector<Manifold> m = collide_all(a, pa, b, pb, 0.02f);
                    ASSERT_EQ(m.size(), 1u) << angle;
                    worst = std::max(worst, std::abs(static_cast<double>(least_separation(m[0])) - truth));
                    EXPECT_EQ(overlaps(a, pa, b, pb), truth < 0.0 ? Overlap::Overlapping : Overlap::Apart);
                    const std::set<std::uint64_t> names = names_of(m);
                    for (int k = 0; k < 20; ++k) {
                        Pose moved = pb;
                        moved.position += 1e-9 * random_direction(random);
                        flickered += names_of(collide_all(a, pa, b, moved, 0.02f)) == names ? 0 : 1;
                        ++looks;
                    }
                }
            }
        }
    }
    show("19 depth, edges parallel to 1e-1 .. 1e-12 rad [m]", worst);
    show("19 looks of which a name changed, by 1e-9 m", static_cast<double>(flickered) / looks);
    EXPECT_LT(worst, 2e-6);
    EXPECT_LE(flickered, looks / 100);  // the axes of a face and of an edge tie where edges are parallel
}

struct TouchingPair {
    Shape a, b;
    Pose pose_a;
    Pose pose_b;  // so that the two touch at a point
    dvec3 out;    // unit, from a to b
};

// Pairs whose true separation is `gap` after b has moved along `out` by it, but for what doubles do to the positions.
std::vector<TouchingPair> touching_pairs(Random& random) {
    std::vector<TouchingPair> pairs;
    const Shape ball = Sphere{0.5f}, rod = Capsule{0.25f, 0.5f}, cube = Box{{0.5f, 0.5f, 0.5f}},
                cube_hull = hull_of(corners_of(Box{{0.5f, 0.5f, 0.5f}}));
    for (int i = 0; i < 40; ++i) {
        const dquat turn = random_rotation(random);
        const auto axis = [&](int k) {
            dvec3 e{0.0};
            e[k] = 1.0;
            return rotate(turn, e);
        };
        const dvec3 side = random.range(-0.4, 0.4) * axis(0) + random.range(-0.4, 0.4) * axis(2), up = axis(1);
        const dquat on_tip = turn * about({1, 0, -1}, std::atan(std::sqrt(2.0)));  // a corner of the cube points down
        for (const Shape* floor : {&cube, &cube_hull}) {
            pairs.push_back({*floor, ball, {{0, 0, 0}, turn}, {side + 1.0 * up, random_rotation(random)}, up});
            pairs.push_back({*floor, rod, {{0, 0, 0}, turn}, {0.1 * side + 0.75 * up, turn * about({0, 0, 1}, 0.5 * kPi)}, up});
            for (const Shape* tip : {&cube, &cube_hull}) {
                pairs.push_back({*floor, *tip, {{0, 0, 0}, turn}, {side + (0.5 + std::sqrt(0.75)) * up, on_tip}, up});
                pairs.push_back({*floor, *tip, {{0, 0, 0}, turn}, {side + 1.0 * up, turn}, up});
            }
        }
        pairs.push_back({ball, ball, {{0, 0, 0}, turn}, {up, random_rotation(random)}, up});
    }
    return pairs;
}

// Signed distances about contact: what is said of the depth and the distance holds the truth to the accuracy of the poses.
TEST(HardPairs, DistancesAndDepthsAtTouch) {
    Random random(20);
    const std::vector<TouchingPair> pairs = touching_pairs(random);
    double worst = 0.0, widest = 0.0;
    int undecided = 0, looks = 0;
    for (const double size : {0.0, 1e-15, 1e-12, 1e-9, 1e-7}) {
        for (const double gap : {-size, size}) {
            for (const TouchingPair& p : pairs) {
                Pose moved = p.pose_b;
                moved.position += gap * p.out;
                const DistanceResult d = distance(p.a, p.pose_a, p.b, moved);
                const PenetrationResult deep = penetration(p.a, p.pose_a, p.b, moved);
                const double rounding = 4e-14;  // of the poses, and E of distance.hpp of both
                if (d.status == DistanceStatus::Overlap) {
                    ASSERT_LT(gap, rounding);
                    worst = std::max(worst, std::max(deep.lower + gap, -gap - deep.upper));
                    widest = std::max(widest, deep.upper - deep.lower);
                    EXPECT_NEAR(glm::length(deep.normal), 1.0, 1e-12);
                } else {
                    ASSERT_GT(d.upper, gap - rounding);
                    worst = std::max(worst, std::max(d.lower - gap, gap - d.upper));
                    if (gap >= 1e-12) {
                        widest = std::max(widest, d.upper - d.lower);
                        undecided += d.status == DistanceStatus::Converged ? 0 : 1;
                        ++looks;
                    }
                }
            }
        }
    }
    show("20 bounds beyond the true depth or distance, |d| <= 1e-7 m [m]", worst);
    show("20, 21 bounds apart [m]", widest);
    show("21 searches at gaps of 1e-12 .. 1e-7 m without a proof", undecided);
    EXPECT_LT(worst, 4e-14);
    EXPECT_LT(widest, 1e-12);
    EXPECT_EQ(undecided, 0) << "of " << looks;
}

// How far a shape reaches below its origin.
double reach_below(const Shape& shape, const dquat& orientation) {
    const dvec3 down = rotate(glm::conjugate(orientation), dvec3{0, -1, 0});
    const double across = std::sqrt(down.x * down.x + down.z * down.z);
    const auto turned = [&](float half, float lower, float upper) {
        return std::max(double{half} * down.y + double{upper} * across, -double{half} * down.y + double{lower} * across);
    };
    if (const Sphere* s = std::get_if<Sphere>(&shape)) return double{s->radius};
    if (const Capsule* c = std::get_if<Capsule>(&shape)) return double{c->radius} + double{c->half_segment} * std::abs(down.y);
    if (const Cylinder* c = std::get_if<Cylinder>(&shape)) return turned(c->half_height, c->radius, c->radius);
    if (const Cone* c = std::get_if<Cone>(&shape)) return turned(c->half_height, c->radius, 0.0f);
    const std::vector<vec3> corners =
        std::holds_alternative<Box>(shape)
            ? corners_of(std::get<Box>(shape))
            : std::vector<vec3>(std::get<ConvexHullPtr>(shape)->vertices().begin(), std::get<ConvexHullPtr>(shape)->vertices().end());
    double most = 0.0;
    for (const vec3& v : corners) most = std::max(most, glm::dot(down, dvec3(v)));
    return most;
}

// 1e3 m of triangle under shapes of 0.05 m.
TEST(HardPairs, AHugeTriangleUnderSmallShapes) {
    Random random(23);
    const std::vector<vec3> v = {{-1000, 0, -1000}, {0, 0, 1500}, {1200, 0, -900}};
    const std::vector<TriangleMesh::Triangle> t = {{0, 1, 2}};
    const Shape ground = *TriangleMesh::build(v, t);
    const Shape shapes[] = {Sphere{0.025f},          Box{{0.025f, 0.025f, 0.025f}}, Capsule{0.01f, 0.015f},
                            Cylinder{0.02f, 0.025f}, Cone{0.02f, 0.025f},           hull_of(corners_of(Box{{0.025f, 0.025f, 0.025f}}))};
    double worst = 0.0;
    for (int i = 0; i < 600; ++i) {
        const Shape& shape = shapes[i % 6];
        Pose pose{{random.range(-300.0, 300.0), 0.0, random.range(-300.0, 300.0)}, random_rotation(random)};
        const double low = reach_below(shape, pose.orientation);
        pose.position.y = low - random.range(0.0, 0.01);
        const std::vector<Manifold> m = collide_all(shape, pose, ground, {}, 0.001f);
        ASSERT_FALSE(m.empty()) << i;
        worst = std::max(worst, std::abs(static_cast<double>(least_separation(m[0])) - (pose.position.y - low)));
    }
    show("23 depth over 1e3 m of triangle [size 0.05 m]", worst / 0.05);
    EXPECT_LT(worst, 1e-5 * 0.05);
}

TEST(HardPairs, ASmallBallOnASmallBox) {
    double worst = 0.0;
    for (const double depth : {0.0, 1e-5, 1e-3, 4e-3}) {
        for (const dvec3& at : {dvec3{0, 0, 0}, dvec3{0.002, 0, 0.001}}) {
            const std::vector<Manifold> m = collide_all(Shape{Sphere{0.01f}}, {at + dvec3{0, 0.0125 - depth, 0}, kIdentityRotation},
                                                        Shape{Box{{0.0025f, 0.0025f, 0.0025f}}}, {}, 1e-4f);
            ASSERT_EQ(m.size(), 1u);
            worst = std::max(worst, std::abs(static_cast<double>(least_separation(m[0])) + depth));
        }
    }
    show("24 depth of a ball of 10 mm on a box of 5 mm [m]", worst);
    EXPECT_LT(worst, 1e-8);
}

}  // namespace
}  // namespace carom
