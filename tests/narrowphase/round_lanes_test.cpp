// Kernels of spheres, capsules, boxes and planes for many pairs at once against those for one pair: the same bits.
#include "near_pairs.hpp"

#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/collide.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>

namespace carom {
namespace {

using namespace test;

Shape shape_of(Random& r, int kind) {
    const auto size = [&] { return static_cast<float>(r.range(0.1, 1.0)); };
    switch (kind) {
        case 0:
            return Sphere{size()};
        case 1:
            return Capsule{.radius = size(), .half_segment = r.range(0.0, 1.0) < 0.2 ? 0.0f : size()};
        case 2:
            return Box{r.range(0.0, 1.0) < 0.5 ? vec3(size()) : vec3(size(), size(), size())};
        default:
            return Plane{vec3(random_direction(r)), static_cast<float>(r.range(-1.0, 1.0))};
    }
}

// Turns and places where closed forms have to choose: none at all, along an axis, in the middle of one another.
Pose pose_of(Random& r) {
    Pose pose{random_direction(r) * r.range(0.0, 1.5), random_rotation(r)};
    const double chance = r.range(0.0, 1.0);
    if (chance < 0.3) pose.orientation = kIdentityRotation;
    if (chance < 0.2 || chance > 0.9) pose.position = {0.0, chance < 0.1 ? 0.0 : r.range(-0.6, 0.6), 0.0};
    return pose;
}

struct Crowd {
    std::vector<Shape> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;

    void add(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, float margin) {
        const auto number = static_cast<std::uint32_t>(shapes.size());
        shapes.insert(shapes.end(), {a, b});
        poses.insert(poses.end(), {pose_a, pose_b});
        pairs.push_back({number, number + 1, margin});
    }
    /// Either way round.
    void add_both(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, float margin) {
        add(a, pose_a, b, pose_b, margin);
        add(b, pose_b, a, pose_a, margin);
    }
};

Crowd random_crowd(std::uint64_t seed) {
    Crowd crowd;
    Random r(seed);
    for (int i = 0; i < 4000; ++i) {
        const int first = static_cast<int>(r.range(0.0, 4.0)), second = static_cast<int>(r.range(0.0, first == 3 ? 3.0 : 4.0));
        const dvec3 origin = i % 5 == 0 ? dvec3{1e6, -3e5, 2e6} : dvec3{0.0};
        const Shape a = shape_of(r, first);
        Pose pose_a = pose_of(r);
        const Shape b = shape_of(r, second);
        Pose pose_b = pose_of(r);
        pose_a.position += origin;
        pose_b.position = i % 8 == 0 ? pose_a.position : pose_b.position + origin;
        crowd.add(a, pose_a, b, pose_b, i % 3 == 0 ? 0.0f : 0.1f);
    }
    crowd.poses[0].position = {1e308, 0.0, 0.0};  // the difference overflows
    crowd.poses[1].position = {-1e308, 0.0, 0.0};
    return crowd;
}

using Touching = std::map<std::pair<ShapeType, ShapeType>, int>;

// @return how many of each two types touch.
Touching expect_the_bits_of_one_pair_at_a_time(const Crowd& crowd) {
    std::vector<const Shape*> placed;
    for (const Shape& shape : crowd.shapes) placed.push_back(&shape);
    std::vector<Manifold> expected;
    Touching touching;
    for (std::uint32_t i = 0; i < crowd.pairs.size(); ++i) {
        const NumberedPair& p = crowd.pairs[i];
        const std::size_t before = expected.size();
        const ShapePair pair{placed[p.a], placed[p.b], crowd.poses[p.a], crowd.poses[p.b], p.margin};
        EXPECT_EQ(collide(pair, i, expected), CollideStatus::Ok);
        if (expected.size() > before) ++touching[{type_of(*pair.a), type_of(*pair.b)}];
    }

    SerialExecutor executor;
    for (const int width : available_simd_widths()) {
        SCOPED_TRACE(testing::Message() << "width " << width);
        set_simd_width(width);
        CollideScratch scratch;
        std::vector<Manifold> found;
        collide({placed, crowd.poses}, crowd.pairs, executor, scratch, found);
        EXPECT_EQ(found.size(), expected.size());
        for (std::size_t m = 0; m < std::min(found.size(), expected.size()); ++m) {
            const Manifold &a = found[m], &b = expected[m];
            const bool same = a.pair == b.pair && a.count == b.count && std::memcmp(&a.normal, &b.normal, sizeof(a.normal)) == 0 &&
                              std::memcmp(a.points.data(), b.points.data(), sizeof(a.points)) == 0;
            EXPECT_TRUE(same) << "pair " << b.pair;
            if (!same) break;
        }
    }
    set_simd_width(0);
    return touching;
}

TEST(RoundLanes, HaveTheBitsOfOnePairAtATime) {
    const Touching touching = expect_the_bits_of_one_pair_at_a_time(random_crowd(41));
    EXPECT_EQ(touching.size(), 15u);  // every two of the four kinds, either way round, but two planes
    for (const auto& [types, count] : touching) EXPECT_GT(count, 60) << to_string(types.first) << " and " << to_string(types.second);
}

// Near contact, aligned, deep, thin, far away, tiny and huge, and with balls in the place of capsules.
TEST(RoundLanes, HaveTheBitsOfOnePairAtATimeInAllConditions) {
    constexpr ShapeType kTypes[] = {ShapeType::Sphere, ShapeType::Capsule, ShapeType::Box};
    for (const Condition condition : kConditions) {
        SCOPED_TRACE(testing::Message() << "condition " << static_cast<int>(condition));
        Crowd crowd;
        Random r(4200 + static_cast<std::uint64_t>(condition));
        for (const ShapeType a : kTypes) {
            for (const ShapeType b : kTypes) {
                if (a == ShapeType::Box && b == ShapeType::Box) continue;  // in float: another kernel than that for one pair
                for (int i = 0; i < 300; ++i) {
                    NearPair p = near_pair(r, a, b, condition);
                    if (i % 8 == 0 && a == ShapeType::Capsule) std::get<Capsule>(p.a).half_segment = 0.0f;
                    crowd.add(p.a, p.pose_a, p.b, p.pose_b, static_cast<float>(p.size * (i % 3 == 0 ? 0.0 : i % 3 == 1 ? 1e-3 : 0.1)));
                }
            }
        }
        const Touching touching = expect_the_bits_of_one_pair_at_a_time(crowd);
        EXPECT_EQ(touching.size(), 8u);
        for (const auto& [types, count] : touching) EXPECT_GT(count, 50) << to_string(types.first) << " and " << to_string(types.second);
        if (HasFailure()) return;
    }
}

// Boxes that lie on a plane with a corner, an edge or a face, or all but so: every number of points, and ties that only the order decides.
TEST(RoundLanes, BoxesOnPlanesHaveTheBitsOfOnePairAtATime) {
    Crowd crowd;
    Random r(43);
    for (int i = 0; i < 6000; ++i) {
        const double size = i % 10 == 0 ? std::exp2(std::floor(r.range(-100.0, 100.0))) : 1.0;
        const auto extent = [&] { return static_cast<float>(size * (i % 7 == 0 ? std::exp2(r.range(-20.0, 0.0)) : r.range(0.1, 1.0))); };
        const Box box = r.unit() < 0.3 ? Box{vec3(extent())} : Box{{extent(), extent(), extent()}};
        const dvec3 half(box.half_extents);
        // A normal along an axis of the box, between two or three of them, or anywhere; then tilted by up to 1e-3, mostly by far less.
        dvec3 up{i % 4 < 1 ? 0.0 : half.y, half.x, i % 4 < 2 ? 0.0 : half.z};
        if (i % 4 == 3) up = random_direction(r) * half;
        if (r.unit() < 0.5) up += random_direction(r) * glm::length(up) * std::exp2(r.range(-54.0, -10.0));
        const Plane plane{vec3(up / glm::length(up)), static_cast<float>(size * r.range(-0.5, 0.5))};
        const dvec3 normal = dvec3(plane.normal) / glm::length(dvec3(plane.normal));
        const double reach = glm::dot(glm::abs(normal), half);
        const double low =
            r.unit() < 0.7 ? size * (r.unit() < 0.2 ? 0.0 : r.range(-1.0, 1.0) * std::exp2(r.range(-54.0, -1.0))) : -2.0 * reach * r.unit();
        const double offset = static_cast<double>(plane.offset) / glm::length(dvec3(plane.normal));
        Pose box_pose{normal * (offset + reach + low)}, plane_pose;
        if (i % 3 == 0) {  // placed anywhere
            plane_pose = {random_direction(r) * (i % 2 == 0 ? 1e6 : size), random_rotation(r)};
            box_pose = plane_pose * box_pose;
        }
        crowd.add_both(box, box_pose, plane, plane_pose, static_cast<float>(size * (i % 5 == 0 ? 0.0 : std::exp2(r.range(-20.0, 0.0)))));
    }
    const Touching touching = expect_the_bits_of_one_pair_at_a_time(crowd);
    EXPECT_EQ(touching.size(), 2u);
    for (const auto& [types, count] : touching) EXPECT_GT(count, 4000);
}

// Capsules along faces and edges of a box, through it, standing on it and beside it, all but parallel, by factors of two up to a million larger.
TEST(RoundLanes, CapsulesAlongBoxesHaveTheBitsOfOnePairAtATime) {
    Crowd crowd;
    Random r(44);
    for (int i = 0; i < 6000; ++i) {
        const auto extent = [&] { return static_cast<float>(r.range(0.1, 1.0)); };
        const Box box = r.unit() < 0.3 ? Box{vec3(extent())} : Box{{extent(), extent(), extent()}};
        const float scale = i % 5 == 0 ? std::exp2(static_cast<float>(std::floor(r.range(-20.0, 20.0)))) : 1.0f;
        const Capsule capsule{scale * extent(), i % 9 == 0 ? 0.0f : scale * extent()};
        const dvec3 half(box.half_extents);
        // On the surface: a corner, an edge, a face, or inside of it.
        const auto on = [&](double h) { return r.unit() < 0.4 ? (r.unit() < 0.5 ? -h : h) : r.range(-h, h); };
        const double gap = static_cast<double>(capsule.radius) * (r.unit() < 0.3 ? 0.0 : r.range(-1.0, 1.1));
        Pose pose{dvec3{on(half.x), on(half.y), on(half.z)} + gap * (r.unit() < 0.5 ? random_direction(r) : dvec3{0.0, 1.0, 0.0}),
                  quarter_turns(r)};
        if (r.unit() < 0.5)
            pose.orientation = glm::normalize(pose.orientation * about(random_direction(r), std::exp2(r.range(-54.0, -3.0))));
        const Pose placed = i % 3 == 0 ? Pose{random_direction(r) * 1e5, random_rotation(r)} : Pose{};
        crowd.add_both(capsule, placed * pose, box, placed, i % 4 == 0 ? 0.0f : 0.05f);
    }
    const Touching touching = expect_the_bits_of_one_pair_at_a_time(crowd);
    EXPECT_EQ(touching.size(), 2u);
    for (const auto& [types, count] : touching) EXPECT_GT(count, 4000);
}

}  // namespace
}  // namespace carom
