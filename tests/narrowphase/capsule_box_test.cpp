// Capsule against box: the closed form beside the search over a hull of the same corners and beside brute force.
#include "near_pairs.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace carom {
namespace {

using namespace test;

struct Case {
    Capsule capsule;
    Box box;
    Pose pose_capsule, pose_box;
    float margin = 0.0f;

    [[nodiscard]] std::vector<Manifold> found() const { return collide_all(capsule, pose_capsule, box, pose_box, margin); }
    [[nodiscard]] std::vector<Manifold> found_as_hull() const {
        return collide_all(capsule, pose_capsule, Shape{hull_of(corners_of(box))}, pose_box, margin);
    }
    [[nodiscard]] double size() const {
        const vec3 h = box.half_extents;
        return 2.0 * static_cast<double>(std::max({h.x, h.y, h.z, capsule.half_segment + capsule.radius}));
    }
    [[nodiscard]] Solid core() const {
        const double h = static_cast<double>(capsule.half_segment);
        return solid_of_segment(placed({0, -h, 0}, pose_capsule, pose_capsule.position),
                                placed({0, h, 0}, pose_capsule, pose_capsule.position));
    }
    [[nodiscard]] Solid solid_box() const { return solid_of(box, pose_box, pose_capsule.position); }
};

Case case_of(Random& r, Condition condition, int i) {
    const NearPair p = near_pair(r, ShapeType::Capsule, ShapeType::Box, condition);
    Case c{std::get<Capsule>(p.a), std::get<Box>(p.b), p.pose_a, p.pose_b,
           static_cast<float>(p.size * (i % 3 == 0   ? 0.0
                                        : i % 3 == 1 ? 1e-3
                                                     : 0.1))};
    if (i % 7 == 0) c.capsule.half_segment = 0.0f;
    return c;
}

TEST(CapsuleBox, TouchesLikeAHullInAllConditions) {
    for (const Condition condition : kConditions) {
        Random r(61 + static_cast<std::uint64_t>(condition));
        int touching = 0;
        for (int i = 0; i < 3000; ++i) {
            SCOPED_TRACE(testing::Message() << "condition " << static_cast<int>(condition) << ", case " << i);
            const Case c = case_of(r, condition, i);
            const std::vector<Manifold> box = c.found(), hull = c.found_as_hull();
            const double allowed = 1.5e-6 * c.size();  // a face may stand for an edge that is better by 1e-6
            if (box.size() != hull.size()) {
                ASSERT_NEAR(least_separation(box.empty() ? hull[0] : box[0]), c.margin, allowed);
                continue;
            }
            if (box.empty()) continue;
            ++touching;
            ASSERT_NEAR(static_cast<double>(least_separation(box[0])), static_cast<double>(least_separation(hull[0])), allowed);
        }
        EXPECT_GT(touching, 1000);
    }
}

TEST(CapsuleBox, DepthAndNormalAreThoseOfBruteForceInAllConditions) {
    for (const Condition condition : kConditions) {
        Random r(71 + static_cast<std::uint64_t>(condition));
        int deep = 0;
        for (int i = 0; i < 250; ++i) {
            SCOPED_TRACE(testing::Message() << "condition " << static_cast<int>(condition) << ", case " << i);
            const Case c = case_of(r, condition, i);
            const Solid core = c.core(), box = c.solid_box();
            const double radius = static_cast<double>(c.capsule.radius), size = c.size();
            const double truth = static_cast<double>(signed_distance(core, box)) - radius;
            const std::vector<Manifold> found = c.found();
            if (std::abs(truth - static_cast<double>(c.margin)) < 1e-6 * size) continue;
            ASSERT_EQ(found.size(), truth < static_cast<double>(c.margin) ? 1u : 0u);
            if (found.empty()) continue;
            const double least = static_cast<double>(least_separation(found[0]));
            ASSERT_NEAR(least, truth, 1e-6 * size);
            const dvec3 n(found[0].normal);
            ASSERT_NEAR(glm::dot(n, n), 1.0, 1e-6);
            // Moving the box out along the normal by the depth parts the two.
            if (truth > 0.0) continue;
            ++deep;
            ASSERT_NEAR(static_cast<double>(gap_along(core, box, real(n))) - radius, least, 1e-6 * size);
        }
        EXPECT_GT(deep, 40);
    }
}

// Each point lies midway between a ball on the capsule's axis and the plane of a face of the box.
TEST(CapsuleBox, PointsLieBetweenTheAxisAndAFace) {
    int points = 0;
    for (const Condition condition : kConditions) {
        Random r(81 + static_cast<std::uint64_t>(condition));
        for (int i = 0; i < 1000; ++i) {
            SCOPED_TRACE(testing::Message() << "condition " << static_cast<int>(condition) << ", case " << i);
            const Case c = case_of(r, condition, i);
            for (const Manifold& m : c.found()) {
                std::set<std::uint64_t> names;
                for (const ContactPoint& p : m.used()) {
                    const dvec3 normal(m.normal), position(p.position);
                    const double half_gap = 0.5 * static_cast<double>(p.separation), radius = static_cast<double>(c.capsule.radius);
                    const dvec3 on_axis = rotate_inverse(c.pose_capsule.orientation, position - (radius + half_gap) * normal);
                    const double h = static_cast<double>(c.capsule.half_segment);
                    ASSERT_LT(glm::length(on_axis - dvec3{0.0, glm::clamp(on_axis.y, -h, h), 0.0}), 1e-6 * c.size());
                    const dvec3 between = c.pose_box.position - c.pose_capsule.position;
                    const dvec3 outside = glm::abs(rotate_inverse(c.pose_box.orientation, position + half_gap * normal - between)) -
                                          dvec3(c.box.half_extents);
                    ASSERT_NEAR(std::max({outside.x, outside.y, outside.z}), 0.0, 1e-6 * c.size());
                    names.insert(p.feature);
                    ++points;
                }
                ASSERT_EQ(names.size(), m.count);
            }
        }
    }
    EXPECT_GT(points, 6000);
}

// A capsule lies on a face, half of them over its edge: two points, whose names stay.
TEST(CapsuleBox, NamesSurviveSmallMotion) {
    Random r(91);
    const Capsule capsule{0.2f, 0.5f};
    int over_edge = 0;
    for (int i = 0; i < 1000; ++i) {
        const Box box{{1.0f, 0.5f, 0.8f}};
        const Pose pose{{r.range(-1.2, 1.2), 0.699, r.range(-0.6, 0.6)},
                        about({0, 1, 0}, r.range(-0.15, 0.15)) * about({0, 0, 1}, 0.5 * kPi)};
        const auto names = [&](const Pose& at) {
            std::map<std::uint64_t, vec3> by_name;
            for (const Manifold& m : collide_all(capsule, at, box, {}, 0.02f)) {
                for (const ContactPoint& p : m.used()) by_name[p.feature] = p.position + vec3(at.position);
            }
            return by_name;
        };
        const auto before = names(pose);
        ASSERT_EQ(before.size(), 2u) << i;
        over_edge += std::abs(pose.position.x) > 0.53 ? 1 : 0;
        Pose moved = pose;
        moved.position += random_direction(r) * 1e-4;
        moved.orientation = about(random_direction(r), 1e-4) * moved.orientation;
        const auto after = names(moved);
        ASSERT_EQ(after.size(), 2u) << i;
        // Within a fiftieth of the core's length of an end the name is the end's: there it changes.
        if (std::abs(std::abs(pose.position.x) - 0.52) < 0.01) continue;
        for (const auto& [name, position] : after) {
            const auto same = before.find(name);
            ASSERT_TRUE(same != before.end()) << i;
            EXPECT_LT(glm::length(dvec3(position) - dvec3(same->second)), 1e-3) << i;
        }
    }
    EXPECT_GT(over_edge, 300);
}

// What two points would carry side by side is one point: over a face by less than a millionth of the size, or standing upright.
TEST(CapsuleBox, PointsFartherApartThanTheToleranceAreTwo) {
    const Capsule capsule{0.2f, 0.5f};
    const Box box{{1.0f, 0.5f, 1.0f}};
    const dquat lying = about({0, 0, 1}, 0.5 * kPi);
    for (const double over : {0.3, 1e-2, 1e-4, 1e-5, 1e-7, 1e-9}) {
        const std::vector<Manifold> found = collide_all(capsule, {{1.5 - over, 0.699, 0.1}, lying}, box, {}, 0.01f);
        ASSERT_EQ(found.size(), 1u) << over;
        EXPECT_EQ(found[0].count, over > 5e-6 ? 2u : 1u) << over;
        EXPECT_NEAR(least_separation(found[0]), -0.001f, 1e-7f) << over;
    }
    for (const double tilt : {0.1, 1e-3, 1e-5, 1e-7, 0.0}) {  // the upper end is within the margin
        const Pose standing{{0.1, 1.199, -0.2}, about({1, 0, 1}, tilt)};
        const std::vector<Manifold> found = collide_all(capsule, standing, box, {}, 2.0f);
        ASSERT_EQ(found.size(), 1u) << tilt;
        EXPECT_EQ(found[0].count, tilt > 5e-6 ? 2u : 1u) << tilt;
        EXPECT_NEAR(static_cast<double>(least_separation(found[0])), 1.199 - 0.5 * std::cos(tilt) - 0.7, 1e-7) << tilt;
        EXPECT_TRUE(collide_all(capsule, standing, box, {}, 0.01f)[0].count == 1u) << tilt;
    }
}

// Beside an edge, parallel to it or all but so, where the core is over the line of the edge but for rounding.
TEST(CapsuleBox, ACapsuleAlongAnEdgeHasTwoPoints) {
    Random r(92);
    for (int i = 0; i < 3000; ++i) {
        const Box box{{1.0f, 0.5f, 0.8f}};
        const Capsule capsule{0.2f, 0.4f};
        const double angle = r.range(0.01, 0.5 * kPi - 0.01), tilt = i % 2 == 0 ? 0.0 : std::exp2(r.range(-54.0, -36.0));
        const dvec3 outward{std::sin(angle), std::cos(angle), 0.0};
        const Pose along{dvec3{1.0, 0.5, r.range(-0.3, 0.3)} + 0.199 * outward,
                         about(random_direction(r), tilt) * about({1, 0, 0}, 0.5 * kPi)};
        const Pose placed{random_direction(r), random_rotation(r)};
        const std::vector<Manifold> found = collide_all(capsule, placed * along, box, placed, 0.01f);
        ASSERT_EQ(found.size(), 1u) << i;
        ASSERT_EQ(found[0].count, 2u) << i;
        ASSERT_LT(glm::length(dvec3(found[0].normal) + rotate(placed.orientation, outward)), 1e-6) << i;
        for (const ContactPoint& p : found[0].used()) ASSERT_NEAR(p.separation, -0.001f, 1e-6f) << i;
    }
}

// At the margin to the last bit: whoever touches has a point.
// Beside two faces at once by what still counts as touching: 0.7f is 1.2e-8 less than 0.7. Capsules upright on the edge, tilted by a rounding or two.
TEST(CapsuleBox, BesideAnEdgeByARoundingThePointsStay) {
    for (const float h : {0.7f, 0.45f, 0.35f, 0.9f, 0.3f, 0.55f, 1.1f, 0.65f}) {
        const double at = std::round(100.0 * static_cast<double>(h)) / 100.0;
        for (const double tilt : {0.0, 1e-16, -1e-16, 1e-15, -1e-15, 1e-12, -1e-12, 1e-10, -1e-10}) {
            const Case c{Capsule{0.2f, 0.5f}, Box{{h, 1.0f, h}}, {{at, 1.2, at}, {1.0, tilt, 0.0, 0.0}}, {}};
            for (const std::vector<Manifold>& m : {c.found(), c.found_as_hull()}) {
                ASSERT_EQ(m.size(), 1u);
                ASSERT_EQ(m[0].count, 2u) << h << " " << tilt;
                double low = 9.0, high = -9.0;
                for (const ContactPoint& p : m[0].used()) {
                    EXPECT_NEAR(static_cast<double>(p.separation), -0.2, 1e-7);
                    low = std::min(low, static_cast<double>(p.position.y) + 1.2);
                    high = std::max(high, static_cast<double>(p.position.y) + 1.2);
                }
                EXPECT_NEAR(low, 0.7, 1e-6) << h << " " << tilt;
                EXPECT_NEAR(high, 1.0, 1e-6) << h << " " << tilt;
            }
        }
    }
}

// The end of a core at a face, beside the edge of the face by less than what counts as touching, and leaving it slowly.
TEST(CapsuleBox, AnEndBesideAnEdgeIsAsDeepAsItIs) {
    for (double gap = 0.2e-9; gap < 2e-8; gap *= 1.3) {
        for (const double angle : {-1e-9, -5e-9, -1e-8, -2e-8, -3e-8, -1e-7, -1e-6, 1e-8}) {
            const dvec3 along{std::cos(angle), 0.0, std::sin(angle)};
            for (const float margin : {0.0f, 0.5f}) {
                const Case c{Capsule{0.2f, 0.5f},
                             Box{{0.5f, 1.0f, 0.5f}},
                             {dvec3{0.5, 0.0, 0.5 + gap} + 0.5 * along, about({0, 1, 0}, -angle) * about({0, 0, 1}, -0.5 * kPi)},
                             {},
                             margin};
                for (const std::vector<Manifold>& m : {c.found(), c.found_as_hull()}) {
                    ASSERT_EQ(m.size(), 1u);
                    EXPECT_NEAR(static_cast<double>(least_separation(m[0])), -0.2, 1e-6) << gap << " " << angle << " " << margin;
                }
            }
        }
    }
}

TEST(CapsuleBox, WhatTouchesHasAPoint) {
    Random r(93);
    const Box box{{1.0f, 0.5f, 0.75f}};
    int touching = 0, apart = 0;
    for (int i = 0; i < 20000; ++i) {
        const Capsule capsule{static_cast<float>(r.range(0.1, 1.0)), i % 4 == 0 ? 0.0f : 0.5f};
        const dquat turn = random_rotation(r);
        const dvec3 along = rotate(turn, dvec3{0.0, static_cast<double>(capsule.half_segment), 0.0});
        // The lower end of the core is a radius away from a corner, and the rest of it farther.
        const dvec3 outward = glm::abs(random_direction(r)), corner = dvec3(box.half_extents) * glm::sign(along + dvec3{1e-300});
        const Pose pose{corner + glm::sign(corner) * outward * static_cast<double>(capsule.radius) + along, turn};
        const std::vector<Manifold> found = collide_all(capsule, pose, box, {}, 0.0f);
        (found.empty() ? apart : touching)++;
        for (const Manifold& m : found) ASSERT_GE(m.count, 1u) << i;
    }
    EXPECT_GT(touching, 5000);
    EXPECT_GT(apart, 5000);
}

// Inside or across a box, where two ways out are equally short, there is a unit normal and the depth is right.
TEST(CapsuleBox, ConcentricOnesPartAlongAFace) {
    const Box box{{0.5f, 0.5f, 0.5f}};
    for (const double half : {0.0, 0.1, 0.5, 2.0}) {
        for (const dquat& turn : {kIdentityRotation, about({0, 0, 1}, 0.5 * kPi), about({0, 0, 1}, 0.25 * kPi), about({1, 2, 3}, 1.0)}) {
            const Case c{{0.25f, static_cast<float>(half)}, box, {{0, 0, 0}, turn}, {}, 0.0f};
            const std::vector<Manifold> found = c.found();
            ASSERT_EQ(found.size(), 1u);
            const double truth = static_cast<double>(signed_distance(c.core(), c.solid_box())) - 0.25;
            EXPECT_NEAR(static_cast<double>(least_separation(found[0])), truth, 1e-6);
            EXPECT_NEAR(glm::length(dvec3(found[0].normal)), 1.0, 1e-6);
        }
    }
}

// Tolerances are shares of the smaller shape: a capsule on the ground keeps both points, however large the ground is.
TEST(CapsuleBox, ASmallCapsuleOnALargeBoxLiesOnTwoPoints) {
    const Capsule capsule{0.05f, 0.1f};
    for (const float reach : {1.0f, 1e2f, 1e4f, 1e6f}) {
        const Box ground{{reach, 1.0f, reach}};
        const Pose lying{{0.3, 1.049, -0.2}, about({0, 0, 1}, 0.5 * kPi)};
        const std::vector<Manifold> found = collide_all(capsule, lying, ground, {}, 0.005f);
        ASSERT_EQ(found.size(), 1u) << reach;
        EXPECT_EQ(found[0].count, 2u) << reach;
        for (const ContactPoint& p : found[0].used()) EXPECT_NEAR(static_cast<double>(p.separation), -0.001, 1e-7) << reach;
    }
}

// Too far apart for the squares of distances, or for the distance itself: no contact, and nothing that is not a number.
TEST(CapsuleBox, FarApartIsApart) {
    for (const double far : {1e10, 1e160, 1e307, 1.7e308}) {
        for (const dvec3& where : {dvec3{far, 0, 0}, dvec3{-far, far, far}}) {
            const Case c{{0.2f, 0.5f}, {{1, 1, 1}}, {where, about({1, 2, 3}, 1.0)}, {{0, 0, 0}, about({3, 1, 2}, 2.0)}, 1.0f};
            EXPECT_TRUE(c.found().empty()) << far;
        }
    }
}

}  // namespace
}  // namespace carom
