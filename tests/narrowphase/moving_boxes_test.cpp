// Boxes that meet, by their fifteen axes: against the same boxes as hulls, which GJK searches, against the axes in long double, and against
// constructions that graze.
#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/moving_boxes.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace carom {
namespace {

Shape hull_of(const Box& box) {
    std::vector<vec3> corners;
    for (unsigned k = 0; k < 8; ++k) corners.push_back(box.half_extents * vec3{k & 1u ? 1 : -1, k & 2u ? 1 : -1, k & 4u ? 1 : -1});
    return *ConvexHull::build(corners);
}

Box any_box(Random& random, double least, double most) {
    const auto size = [&] { return static_cast<float>(least * std::pow(most / least, random.unit())); };
    return {{size(), size(), size()}};
}

/// @return whether the two share points at t: proved.
bool overlap_at(const Shape& a, const RigidMotion& ma, const Shape& b, const RigidMotion& mb, double t) {
    return distance(a, pose_at(ma, t), b, pose_at(mb, t)).status == DistanceStatus::Overlap;
}

/// What is wrong with an answer, or "".
std::string fault(const Shape& a, const RigidMotion& ma, const Shape& b, const RigidMotion& mb, const Impact& impact, double near) {
    if (impact.status == ImpactStatus::Overlapping) {
        return distance(a, pose_at(ma, 0.0), b, pose_at(mb, 0.0)).lower > near ? "they are apart" : "";
    }
    for (int k = 0; k <= 60; ++k) {
        const double s = k < 50 ? impact.t * k / 50 : impact.t * (1.0 - std::ldexp(1.0, -(k - 45) * 3));
        if (overlap_at(a, ma, b, mb, s)) return "they overlap at " + std::to_string(s);
    }
    if (impact.status != ImpactStatus::Touching) return impact.status == ImpactStatus::Separated ? "" : to_string(impact.status);
    const Pose at_a = pose_at(ma, impact.t), at_b = pose_at(mb, impact.t);
    const DistanceResult d = distance(a, at_a, b, at_b);
    if (d.lower > near) return "not near: " + std::to_string(d.lower);
    if (std::abs(glm::length(impact.normal) - 1.0) > 1e-12) return "no normal";
    const auto outside = [&](const Shape& shape, const Pose& pose) {
        const dvec3 half(std::get<Box>(shape).half_extents), p = inverse_transform_point(pose, impact.point);
        return glm::length(glm::clamp(p, -half, half) - p);
    };
    if (outside(b, at_b) > near) return "the point is not on B";
    if (outside(a, at_a) > 2.0 * near) return "the point is not on A";
    // The plane through the point parts them.
    const auto above = [&](const Shape& shape, const Pose& pose, const dvec3& n) {
        const dvec3 half(std::get<Box>(shape).half_extents);
        return glm::dot(n, pose.position - impact.point) + glm::dot(half, glm::abs(rotate_inverse(pose.orientation, n)));
    };
    if (above(a, at_a, impact.normal) > near || above(b, at_b, -impact.normal) > near) return "the normal parts them not";
    return "";
}

RigidMotion any_motion(Random& random, double distance, double turn) {
    RigidMotion m{.start = {distance * test::random_direction(random), test::random_rotation(random)}};
    m.translation = random.range(0.3, 2.0) * test::random_direction(random) - random.range(0.3, 2.5) * m.start.position;
    m.rotation = turn * test::random_direction(random);
    m.pivot = 0.3 * test::random_direction(random);
    return m;
}

void meet_as_hulls_do(double turn, double least_size, double separation, int pairs) {
    Random random(0xb0c5 + static_cast<std::uint64_t>(100.0 * turn));
    int touching = 0, checks = 0, hull_checks = 0;
    double latest = 0.0;
    for (int i = 0; i < pairs; ++i) {
        const Box box_a = any_box(random, least_size, 1.0), box_b = any_box(random, least_size, 1.0);
        const Shape a = box_a, b = box_b, hull_a = hull_of(box_a), hull_b = hull_of(box_b);
        const RigidMotion ma = any_motion(random, 3.5, i % 4 == 0 ? 0.0 : turn * random.unit());
        const RigidMotion mb = any_motion(random, 0.5, i % 3 == 0 ? 0.0 : turn * random.unit());
        const TimeOfImpactSettings settings{.separation = separation, .most_checks = 2000};
        const Impact boxes = time_of_impact(a, ma, b, mb, settings), hulls = time_of_impact(hull_a, ma, hull_b, mb, settings);
        ASSERT_EQ(fault(a, ma, b, mb, boxes, separation + 1e-8), "") << i << " " << to_string(boxes.status);
        checks += boxes.checks, hull_checks += hulls.checks;
        if (boxes.status != hulls.status) {  // by the gap that counts as touching: it grazes
            const Impact& met = may_touch(boxes.status) ? boxes : hulls;
            ASSERT_TRUE(&met == &hulls) << i;
            ASSERT_FALSE(overlap_at(a, ma, b, mb, met.t)) << i;
            continue;
        }
        if (boxes.status != ImpactStatus::Touching) continue;
        ++touching;
        latest = std::max(latest, std::abs(boxes.t - hulls.t));
    }
    std::printf("turn %4.1f: %d of %d touch, checks %.2f, of hulls %.2f, times apart by %.2g\n", turn, touching, pairs,
                1.0 * checks / pairs, 1.0 * hull_checks / pairs, latest);
    EXPECT_GT(touching, pairs / 20);
    EXPECT_LT(touching, pairs - pairs / 20);
    EXPECT_LT(latest, 2e-4);  // 1e-9 of a gap, where they graze
    if (turn > 0.0) {
        EXPECT_LT(checks, hull_checks + hull_checks / 10);
    }
}

TEST(MovingBoxes, TheyMeetAsHullsDo) {
    meet_as_hulls_do(0.0, 0.1, 0.0, 4000);
    meet_as_hulls_do(0.7, 0.1, 0.0, 3000);
    meet_as_hulls_do(6.0, 0.1, 0.0, 1500);
    meet_as_hulls_do(0.0, 1e-4, 0.0, 2000);
    meet_as_hulls_do(0.7, 1e-4, 0.0, 1500);
}

TEST(MovingBoxes, TheyComeWithinASeparationAsHullsDo) {
    meet_as_hulls_do(0.0, 0.1, 0.2, 1500);
    meet_as_hulls_do(0.7, 0.1, 0.2, 1500);
}

/// At t = 1/2 they are `gap` apart and slide along the plane between them, so the gap is never less.
TEST(MovingBoxes, GrazingIsSeenOnBothSides) {
    Random random(0x96a2e);
    int apart = 0, met = 0;
    for (int i = 0; i < 6'000; ++i) {
        const Shape a = any_box(random, 0.2, 1.0), b = any_box(random, 0.2, 1.0);
        RigidMotion ma{.start = {dvec3{0.0}, test::random_rotation(random)}};
        RigidMotion mb{.start = {4.0 * test::random_direction(random), i % 3 == 0 ? ma.start.orientation : test::random_rotation(random)}};
        const DistanceResult d = distance(a, ma.start, b, mb.start);
        ASSERT_GT(d.lower, 0.0);
        const double size = std::pow(10.0, random.range(-15.7, -6.0)), gap = i % 2 == 0 ? size : -size;
        mb.start.position += (gap - d.lower) * d.normal;
        const dvec3 slide = glm::normalize(glm::cross(d.normal, test::random_direction(random)));
        const double way = std::pow(10.0, random.range(-1.0, 2.0));
        mb.translation = way * slide;
        mb.start.position -= 0.5 * mb.translation;
        const Impact impact = time_of_impact(a, ma, b, mb);
        const double rounding = 1e-13 * (8.0 + way);  // of this construction, too
        if (gap > rounding) {
            ASSERT_EQ(impact.status, ImpactStatus::Separated) << i << " " << gap;
            ++apart;
        } else if (gap < -rounding) {
            ASSERT_TRUE(may_touch(impact.status)) << i << " " << gap;
            ASSERT_LE(impact.t, 0.5) << i << " " << gap;
            ++met;
        }
    }
    EXPECT_GT(apart, 1'200);
    EXPECT_GT(met, 1'200);
}

/// One slides over the other by so many roundings of the height, or so deep in it.
TEST(MovingBoxes, AnUlpEitherWayIsNeverMissed) {
    const Shape a = Box{{0.5f, 0.375f, 0.75f}}, b = Box{{0.25f, 0.625f, 0.5f}};
    for (const dvec3& along : {dvec3{4.0, 0.0, 0.0}, dvec3{3.0, 0.0, 1.0}, dvec3{0.0, 0.0, -4.0}}) {
        for (int step = -60; step <= 60; ++step) {
            const double power = std::ldexp(1.0, std::abs(step) / 2 - 52), off = step < 0 ? -power : step > 0 ? power : 0.0;
            const RigidMotion over{.start = {dvec3{0.0, 1.0 + off, 0.0} - 0.5 * along, kIdentityRotation}, .translation = along};
            const Impact impact = time_of_impact(a, {}, b, over);
            if (off <= 0.0) {
                ASSERT_EQ(impact.status, ImpactStatus::Touching) << off;
                ASSERT_LT(impact.t, 0.5) << off;
            } else if (off > 2e-13) {
                ASSERT_EQ(impact.status, ImpactStatus::Separated) << off;
            }
        }
    }
}

/// Boxes along the axes whose coordinates are eighths: exact intervals say when they meet, also of no extent, and beginning or ending in touch.
TEST(MovingBoxes, OnAGridTheTimesAreThoseOfTheIntervals) {
    Random random(0x9e1d);
    const auto eighths = [&](int from, int to) { return 0.125 * std::floor(random.range(from, to + 1)); };
    int touching = 0, overlapping = 0, separated = 0;
    for (int i = 0; i < 40'000; ++i) {
        const int least = i % 5 == 0 ? 0 : 1;
        const dvec3 half_a{eighths(least, 8), eighths(least, 8), eighths(least, 8)},
            half_b{eighths(least, 8), eighths(least, 8), eighths(least, 8)};
        const dvec3 from{eighths(-24, 24), eighths(-24, 24), eighths(-24, 24)}, along{eighths(-16, 16), eighths(-16, 16), eighths(-16, 16)};
        double in = 0.0, out = 1.0;
        for (int k = 0; k < 3; ++k) {
            const double room = half_a[k] + half_b[k];
            if (along[k] == 0.0) {
                if (std::abs(from[k]) > room) out = -1.0;
                continue;
            }
            const double t0 = (-room - from[k]) / along[k], t1 = (room - from[k]) / along[k];
            in = std::max(in, std::min(t0, t1)), out = std::min(out, std::max(t0, t1));
        }
        const bool meet = in <= out * (1.0 + 1e-15);
        const RigidMotion still{}, moves{.start = {from, kIdentityRotation}, .translation = along};
        const Impact impact = time_of_impact(Box{vec3(half_a)}, still, Box{vec3(half_b)}, moves);
        if (!meet) {
            ASSERT_EQ(impact.status, ImpactStatus::Separated) << i;
            ++separated;
            continue;
        }
        ASSERT_EQ(impact.status, in == 0.0 ? ImpactStatus::Overlapping : ImpactStatus::Touching) << i << " " << in << " " << impact.t;
        ASSERT_LE(impact.t, in) << i;
        ASSERT_NEAR(impact.t, in, 1e-8) << i;
        ++(in == 0.0 ? overlapping : touching);
    }
    EXPECT_GT(touching, 2'000);
    EXPECT_GT(overlapping, 500);
    EXPECT_GT(separated, 10'000);
}

/// Long boxes that cross at small angles: an axis square to both edges is the difference of products that all but cancel.
TEST(MovingBoxes, EdgesNextToParallelAreNeitherMissedNorMadeUp) {
    Random random(0xed9e);
    int touching = 0;
    for (int i = 0; i < 3'000; ++i) {
        const Shape a = Box{{1.0f, 0.05f, 0.05f}}, b = Box{{1.0f, 0.05f, 0.05f}};
        const double angle = std::pow(10.0, random.range(-17.0, -1.0));
        const dquat turned = test::random_rotation(random), quarter{std::cos(0.125 * kPi), std::sin(0.125 * kPi), 0.0, 0.0};
        const dquat aside{std::cos(0.5 * angle), 0.0, std::sin(0.5 * angle), 0.0};
        // Both stand on an edge, and are turned against each other about the way between them.
        RigidMotion ma{.start = {dvec3{0.0}, turned * quarter}},
            mb{.start = {rotate(turned, {random.range(-0.5, 0.5), 0.4, 0.0}), turned * aside * quarter}};
        mb.translation = rotate(turned, {0.0, -1.0, random.range(-0.1, 0.1)});
        const Impact impact = time_of_impact(a, ma, b, mb);
        ASSERT_EQ(impact.status, ImpactStatus::Touching) << i << " " << angle;
        ASSERT_EQ(fault(a, ma, b, mb, impact, 1e-8), "") << i << " " << angle;
        ++touching;
        ma.rotation = random.range(0.0, 0.3) * test::random_direction(random);
        const Impact turning = time_of_impact(a, ma, b, mb);
        ASSERT_EQ(fault(a, ma, b, mb, turning, 1e-8), "") << i << " " << angle;
    }
    EXPECT_EQ(touching, 3'000);
}

TEST(MovingBoxes, WithoutAWayTheyAreWhatTheyAreAtTheStart) {
    const Shape box = Box{{0.5f, 0.25f, 1.0f}};
    Random random(0x0);
    for (int i = 0; i < 500; ++i) {
        const RigidMotion ma{.start = {dvec3{0.0}, test::random_rotation(random)}};
        RigidMotion mb{.start = {random.range(0.0, 2.5) * test::random_direction(random), test::random_rotation(random)}};
        const bool overlap = overlap_at(box, ma, box, mb, 0.0);
        const Impact impact = time_of_impact(box, ma, box, mb);
        ASSERT_EQ(impact.status, overlap ? ImpactStatus::Overlapping : ImpactStatus::Separated) << i;
        ASSERT_EQ(impact.t, overlap ? 0.0 : 1.0) << i;
        if (overlap) continue;
        mb.translation = ma.start.position - mb.start.position;
        const Impact met = time_of_impact(box, ma, box, mb);
        ASSERT_EQ(met.status, ImpactStatus::Touching) << i;
        const Impact before = time_of_impact(box, ma, box, mb, {.until = met.t * (1.0 - 1e-12)});
        ASSERT_EQ(before.status, ImpactStatus::Separated) << i;
        ASSERT_EQ(before.t, met.t * (1.0 - 1e-12)) << i;
        ASSERT_EQ(time_of_impact(box, ma, box, mb, {.until = met.t}).status, ImpactStatus::Touching) << i;
    }
}

/// The farther the way, the more of it rounding hides: the answer is early by that and never late.
TEST(MovingBoxes, AfterALongWayTheyAreMetNoLater) {
    Random random(0xfa12);
    for (int i = 0; i < 4'000; ++i) {
        const Box box_a = any_box(random, 0.1, 1.0), box_b = any_box(random, 0.1, 1.0);
        const Shape a = box_a, b = box_b;
        const RigidMotion ma{.start = {dvec3{0.0}, test::random_rotation(random)}};
        const double way = std::pow(10.0, random.range(2.0, 30.0));
        const dvec3 direction = test::random_direction(random);
        RigidMotion mb{.start = {4.0 * direction + random.unit() * test::random_direction(random), test::random_rotation(random)}};
        mb.translation = -way * direction;
        const Impact far = time_of_impact(a, ma, b, mb);
        ASSERT_TRUE(may_touch(far.status) || way < 1e13) << i;
        // The same way, cut to what matters.
        RigidMotion cut = mb;
        cut.translation = -8.0 * direction;
        const Impact near = time_of_impact(a, ma, b, cut);
        if (!may_touch(near.status)) continue;
        ASSERT_TRUE(may_touch(far.status)) << i << " " << way;
        ASSERT_LE(far.t * way, near.t * 8.0 * (1.0 + 1e-9) + 1e-9) << i << " " << way;
        if (far.status == ImpactStatus::Touching && way < 1e6) {
            ASSERT_NEAR(far.t * way, near.t * 8.0, 1e-6) << i << " " << way;
        }
    }
}

using Long = long double;
struct Axis {
    Long n[3];
    int a = detail::BoxAxis::kNone, b = detail::BoxAxis::kNone;
};

/// The fifteen axes in long double, one after the other. @return when they last let the boxes meet, or 2.
Long last_entry(const detail::BoxPlaces& at, const dvec3& along) {
    std::vector<Axis> axes;
    const auto column = [](const dmat3& m, int k) { return Axis{{Long(m[k].x), Long(m[k].y), Long(m[k].z)}}; };
    for (int k = 0; k < 3; ++k) axes.push_back(column(at.axes_a, k)), axes.push_back(column(at.axes_b, k));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const Axis u = column(at.axes_a, i), v = column(at.axes_b, j);
            axes.push_back({{u.n[1] * v.n[2] - u.n[2] * v.n[1], u.n[2] * v.n[0] - u.n[0] * v.n[2], u.n[0] * v.n[1] - u.n[1] * v.n[0]}});
        }
    }
    Long in = 0.0L, out = 1.0L;
    for (const Axis& axis : axes) {
        const auto dot = [&](const dvec3& v) { return axis.n[0] * Long(v.x) + axis.n[1] * Long(v.y) + axis.n[2] * Long(v.z); };
        Long room = 0.0L;
        for (int k = 0; k < 3; ++k)
            room += Long(at.half_a[k]) * std::abs(dot(at.axes_a[k])) + Long(at.half_b[k]) * std::abs(dot(at.axes_b[k]));
        const Long height = dot(at.between), speed = dot(along);
        if (speed == 0.0L) {
            if (std::abs(height) > room) return 2.0L;
            continue;
        }
        const Long t0 = (-room - height) / speed, t1 = (room - height) / speed;
        in = std::max(in, std::min(t0, t1)), out = std::min(out, std::max(t0, t1));
    }
    return in <= out ? in : 2.0L;
}

// From ten thousand kilometres away, where rounding is all that is left of the gap at the end.
TEST(MovingBoxes, WhatTouchesHasANormal) {
    Random random(97);
    for (int i = 0; i < 300; ++i) {
        const Box a = any_box(random, 0.2, 1.0), b = any_box(random, 0.2, 1.0);
        const dvec3 way = 1e8 * test::random_direction(random);
        const auto turn = [&] { return 0.1 * dvec3{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)}; };
        const RigidMotion of_a{.start = {dvec3{0.0}, test::random_rotation(random)}, .rotation = turn()};
        const RigidMotion of_b{.start = {way, test::random_rotation(random)}, .translation = -2.0 * way, .rotation = turn()};
        const Impact impact = time_of_impact(a, of_a, b, of_b, {});
        ASSERT_EQ(impact.status, ImpactStatus::Touching) << i;
        ASSERT_NEAR(glm::length(impact.normal), 1.0, 1e-12) << i;
    }
}

TEST(MovingBoxes, TheLastAxisIsThatOfLongDoubles) {
    Random random(0x1a57);
    int met = 0, passed = 0;
    Long earliest = 0.0L;
    for (int i = 0; i < 20'000; ++i) {
        const dmat3 axes_a = glm::mat3_cast(test::random_rotation(random)), axes_b = glm::mat3_cast(test::random_rotation(random));
        const dvec3 half_a(any_box(random, 0.1, 1.0).half_extents), half_b(any_box(random, 0.1, 1.0).half_extents);
        const dvec3 between = 4.0 * test::random_direction(random),
                    along = random.range(0.5, 8.0) * test::random_direction(random) - between;
        const double rounding = 0x1p-46 * (glm::length(between) + glm::length(along) + glm::length(half_a) + glm::length(half_b));
        const detail::BoxPlaces places{half_a, axes_a, half_b, axes_b, between};
        const detail::BoxAxes boxes(places);
        const detail::BoxSlide slide = boxes.slide(along, 1.0, rounding);
        const Long exact = last_entry(places, along);
        if (slide.passes) {
            ASSERT_EQ(exact, 2.0L) << i;
            ++passed;
            continue;
        }
        if (exact > 1.0L) continue;  // they pass nearer to each other than rounding
        ASSERT_LE(Long(slide.t), exact) << i;
        if (exact == 0.0L) continue;
        ++met;
        ASSERT_TRUE(slide.axis.exists()) << i;
        const double speed = std::abs(glm::dot(boxes.normal(slide.axis), along));
        const double sine =
            slide.axis.a < 3 && slide.axis.b < 3 ? glm::length(glm::cross(axes_a[slide.axis.a], axes_b[slide.axis.b])) : 1.0;
        ASSERT_LE(exact - Long(slide.t), Long(1.6 * rounding / (speed * sine))) << i;
        earliest = std::max(earliest, (exact - Long(slide.t)) * Long(speed * sine / rounding));
        // The boxes touch across it then.
        const detail::BoxTouch touch = boxes.touch(slide.axis, slide.t * along, 0.0);
        ASSERT_LE(touch.distance, 1e-9 + 4.0 * rounding / sine) << i;
        // And of those that part them now, it lasts longest, since nothing turns.
        const detail::BoxAxis longest = boxes.longest({along, dvec3{0.0}, dvec3{0.0}, 0.0}, rounding);
        ASSERT_EQ(longest.a, slide.axis.a) << i;
        ASSERT_EQ(longest.b, slide.axis.b) << i;
        ASSERT_EQ(longest.sign, slide.axis.sign) << i;
    }
    std::printf("times of the fifteen axes are early by at most %.2f of the rounding that is allowed for\n", static_cast<double>(earliest));
    EXPECT_GT(met, 3'000);
    EXPECT_GT(passed, 3'000);
}

}  // namespace
}  // namespace carom
