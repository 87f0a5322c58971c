// Poses and shapes at which narrowphases give NaN or another answer each time: concentric and nested shapes, a centre on a surface, hulls and
// triangles as thin as they may be, triangles without an area, poses with a number that is none. One by one and in batches, every two types.
#include "oracle.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/distance.hpp>
#include <carom/narrowphase/overlap.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace carom {
namespace {

using namespace test;

bool is_convex(const Shape& s) { return is_convex_solid(type_of(s)); }

bool finite(const Manifold& m) {
    if (m.count < 1 || m.count > 4 || std::abs(glm::dot(dvec3(m.normal), dvec3(m.normal)) - 1.0) > 1e-6) return false;
    for (const ContactPoint& p : m.used()) {
        if (!is_finite(p.position) || !is_finite(p.separation)) return false;
    }
    return true;
}

Shape surface_of(const ConvexHull& hull, bool degenerate) {
    std::vector<vec3> vertices(hull.vertices().begin(), hull.vertices().end());
    std::vector<TriangleMesh::Triangle> triangles;
    for (const ConvexHull::Face& face : hull.faces()) {
        const auto& e = hull.edges();
        const std::uint32_t a = face.first_edge;
        for (std::uint32_t b = e[a].next; e[b].next != a; b = e[b].next) {
            triangles.push_back({e[a].origin, e[b].origin, e[e[b].next].origin});
            if (!degenerate) continue;
            triangles.push_back({e[a].origin, e[b].origin, e[b].origin});  // an edge
            triangles.push_back({e[b].origin, e[b].origin, e[b].origin});  // a corner
        }
    }
    return *TriangleMesh::build(vertices, triangles);
}

/// Triangles without an area: points, segments, three corners in line, and twice each.
Shape dust() {
    const std::vector<vec3> vertices{{0, 0, 0}, {0.3f, 0, 0},       {-0.3f, 0, 0},     {0, 0.4f, 0},
                                     {0, 0, 0}, {0.1f, 0.1f, 0.1f}, {0.2f, 0.2f, 0.2f}};
    return *TriangleMesh::build(vertices, std::vector<TriangleMesh::Triangle>{
                                              {0, 0, 0}, {0, 4, 0}, {0, 1, 2}, {0, 1, 1}, {3, 0, 3}, {0, 5, 6}, {0, 5, 6}, {1, 0, 2}});
}

/// One shape of each type, then the thinnest: a hull of 1:1e-5, a box and a capsule of 1:1e-6, needles of triangles of 1e6:1, surfaces with
/// triangles without an area, and nothing but these.
std::vector<Shape> odd_shapes() {
    Random r(77);
    std::vector<Shape> shapes{Sphere{0.5f},           Box{{0.5f, 0.4f, 0.3f}},      Capsule{0.2f, 0.5f},
                              Plane{{0, 1, 0}, 0.0f}, random_hull(r, 20, 0.4, 0.7), Cylinder{0.4f, 0.5f},
                              Cone{0.4f, 0.5f}};
    shapes.push_back(*Compound::build({{Sphere{0.3f}, {{0.2, 0, 0}}}, {Box{{0.2f, 0.3f, 0.2f}}, {}}, {Cone{0.2f, 0.3f}, {}}}));
    shapes.push_back(surface_of(*std::get<ConvexHullPtr>(shapes[4]), false));
    std::vector<vec3> plate;
    for (const float z : {-5e-6f, 5e-6f}) {
        for (int k = 0; k < 6; ++k) plate.push_back({std::cos(float(k)), std::sin(float(k)), z});
    }
    if (const ConvexHullPtr hull = hull_of(plate)) shapes.push_back(hull);
    shapes.push_back(Box{{0.5f, 5e-7f, 0.5f}});
    shapes.push_back(Capsule{5e-7f, 0.5f});
    const std::vector<vec3> needles{{-1, 0, 0}, {1, 0, 0}, {0, 1e-6f, 0}, {0, 0, 1e-6f}, {1, 0, 1e-6f}};
    shapes.push_back(*TriangleMesh::build(needles, std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {0, 1, 3}, {0, 4, 1}, {2, 1, 0}}));
    shapes.push_back(surface_of(*std::get<ConvexHullPtr>(shapes[4]), true));
    shapes.push_back(dust());
    return shapes;
}

/// Of two shapes at one place, turned and not; beside each other by what puts a centre on a surface; and a hair apart.
std::vector<Pose> odd_poses() {
    std::vector<Pose> poses{{}};
    poses.push_back({{0, 0, 0}, {0.5, 0.5, 0.5, 0.5}});
    poses.push_back({{0, 0, 0}, about({1, 2, 3}, 1.0)});
    poses.push_back({{0, 0, 0}, about({0, 0, 1}, 1e-9)});
    for (const double d : {0.5, 0.4, 0.3, 1.0, 0.8, 1e-12, 1e-300}) {
        for (int k = 0; k < 3; ++k) {
            Pose pose;
            pose.position[k] = d;
            poses.push_back(pose);
        }
    }
    return poses;
}

struct OddPairs {
    std::vector<Shape> shapes = odd_shapes();
    std::vector<ShapePair> pairs;

    explicit OddPairs(float margin) {
        for (const Shape& a : shapes) {
            for (const Shape& b : shapes) {
                if (!can_collide(type_of(a), type_of(b))) continue;
                for (const Pose& pose : odd_poses()) pairs.push_back({&a, &b, Pose{}, pose, margin});
            }
        }
    }
};

TEST(Degenerate, EveryAnswerIsFiniteAndTheSameAloneAndInBatchesOfAnyWidth) {
    for (const float margin : {0.0f, 0.02f}) {
        const OddPairs odd(margin);
        std::vector<Manifold> single;
        std::size_t first = 0;
        for (std::uint32_t i = 0; i < odd.pairs.size(); ++i) {
            const CollideStatus status = collide(odd.pairs[i], i, single), again_status = [&] {
                std::vector<Manifold> again;
                const CollideStatus second = collide(odd.pairs[i], i, again);
                EXPECT_EQ(again.size(), single.size() - first) << i;
                EXPECT_TRUE(again.empty() || std::memcmp(again.data(), single.data() + first, again.size() * sizeof(Manifold)) == 0) << i;
                return second;
            }();
            ASSERT_EQ(status, again_status) << i;
            for (; first < single.size(); ++first) {
                ASSERT_TRUE(finite(single[first]))
                    << i << ": " << to_string(type_of(*odd.pairs[i].a)) << " " << to_string(type_of(*odd.pairs[i].b));
            }
        }
        EXPECT_GT(single.size(), odd.pairs.size() / 2);
        SerialExecutor serial;
        CollideScratch scratch;
        for (const int width : available_simd_widths()) {
            set_simd_width(width);
            std::vector<Manifold> batch;
            collide(odd.pairs, serial, scratch, batch);
            ASSERT_EQ(batch.size(), single.size()) << width;
            EXPECT_EQ(std::memcmp(batch.data(), single.data(), batch.size() * sizeof(Manifold)), 0) << width;
        }
        set_simd_width(0);
    }
}

// What is concentric or nested overlaps, whatever is asked, and parts along a unit normal.
TEST(Degenerate, DistancesDepthsAndVerdictsOfConvexShapesHold) {
    const OddPairs odd(0.0f);
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<NumberedPair> pairs;
    std::size_t overlapping = 0;
    for (const ShapePair& pair : odd.pairs) {
        if (!is_convex(*pair.a) || !is_convex(*pair.b)) continue;
        SCOPED_TRACE(testing::Message() << to_string(type_of(*pair.a)) << " " << to_string(type_of(*pair.b)) << " " << pairs.size());
        const auto n = static_cast<std::uint32_t>(shapes.size());
        shapes.insert(shapes.end(), {pair.a, pair.b});
        poses.insert(poses.end(), {pair.pose_a, pair.pose_b});
        pairs.push_back({n, n + 1, 0.0f});
        const DistanceResult gap = distance(*pair.a, pair.pose_a, *pair.b, pair.pose_b);
        const PenetrationResult depth = penetration(*pair.a, pair.pose_a, *pair.b, pair.pose_b);
        const Overlap verdict = overlaps(*pair.a, pair.pose_a, *pair.b, pair.pose_b);
        ASSERT_TRUE(gap.lower >= 0.0 && gap.lower <= gap.upper && is_finite(gap.upper));
        ASSERT_TRUE(depth.lower >= 0.0 && depth.lower <= depth.upper && is_finite(depth.upper));
        ASSERT_TRUE(is_finite(gap.on_a) && is_finite(gap.on_b) && is_finite(gap.normal) && is_finite(depth.normal));
        if (pair.pose_b.position == dvec3{0.0}) {  // both hold their centres, but for rounding of what is thin
            ASSERT_NE(verdict, Overlap::Apart);
        }
        if (verdict != Overlap::Overlapping) continue;
        ++overlapping;
        ASSERT_GT(depth.upper, 0.0);
        ASSERT_NEAR(glm::length(depth.normal), 1.0, 1e-9);
        ASSERT_EQ(gap.lower, 0.0);
    }
    EXPECT_GT(overlapping, pairs.size() / 4);
    SerialExecutor serial;
    for (const int width : available_simd_widths()) {
        set_simd_width(width);
        std::vector<Overlap> verdicts;
        std::vector<DistanceResult> gaps;
        overlaps({shapes, poses}, pairs, serial, verdicts);
        distance({shapes, poses}, pairs, serial, {}, gaps);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const Overlap one = overlaps(*shapes[2 * i], poses[2 * i], *shapes[2 * i + 1], poses[2 * i + 1]);
            ASSERT_FALSE(verdicts[i] != one && verdicts[i] != Overlap::Undecided && one != Overlap::Undecided) << i;
            ASSERT_TRUE(gaps[i].lower <= gaps[i].upper && is_finite(gaps[i].upper)) << i;
        }
    }
    set_simd_width(0);
}

TEST(Degenerate, TrianglesWithoutAnAreaTouchBallsAloneAndTakeNothingAway) {
    Random r(78);
    const ConvexHullPtr hull = random_hull(r, 20, 0.4, 0.7);
    const Shape clean = surface_of(*hull, false), strewn = surface_of(*hull, true), none = dust();
    ASSERT_GT(std::get<TriangleMeshPtr>(strewn)->degenerate_count(), 0u);
    ASSERT_EQ(std::get<TriangleMeshPtr>(none)->degenerate_count(), std::get<TriangleMeshPtr>(none)->triangles().size());
    int touching = 0;
    for (const ShapeType type :
         {ShapeType::Sphere, ShapeType::Box, ShapeType::Capsule, ShapeType::ConvexHull, ShapeType::Cylinder, ShapeType::Cone}) {
        for (int i = 0; i < 60; ++i) {
            SCOPED_TRACE(testing::Message() << to_string(type) << " " << i);
            const Shape shape = random_shape(type, r);
            const Pose at{random_direction(r) * r.range(0.6, 1.4), random_rotation(r)};
            const std::vector<Manifold> m = collide_all(shape, at, clean, {}, 0.02f), w = collide_all(shape, at, strewn, {}, 0.02f);
            ASSERT_EQ(m.empty(), w.empty());
            const bool touches = !collide_all(shape, {{0.05, 0.02, 0.01}, at.orientation}, none, {}, 0.02f).empty();
            ASSERT_EQ(touches, type == ShapeType::Sphere) << "a ball is as far as the points of a triangle are; others ask for its plane";
            if (m.empty()) continue;
            ++touching;
            // The strewn surface is met by its triangles, which is as exact where it is less deep than they are large.
            if (const float least = least_separation(m[0]); least > -0.02f) {
                float other = 1.0f;
                for (const Manifold& x : w) other = std::min(other, least_separation(x));
                ASSERT_NEAR(other, least, 2e-6f);
            }
        }
    }
    EXPECT_GT(touching, 60);
}

int g_reports = 0;
ErrorCode g_code{};
void count_report(const Error& error) {
    ++g_reports;
    g_code = error.code;
}

TEST(Degenerate, EachNumberOfAPoseThatIsNoneIsRefusedForEveryTwoTypes) {
    const std::vector<Shape> shapes = odd_shapes();
    const ErrorHandler before = set_error_handler(count_report);
    SerialExecutor serial;
    CollideScratch scratch;
    for (const Shape& a : shapes) {
        for (const Shape& b : shapes) {
            if (!can_collide(type_of(a), type_of(b))) continue;
            for (int k = 0; k < 14; ++k) {
                const double bad = k % 3 == 0 ? std::numeric_limits<double>::quiet_NaN()
                                              : (k % 3 == 1 ? 1.0 : -1.0) * std::numeric_limits<double>::infinity();
                Pose poses[2];
                Pose& pose = poses[k / 7];
                double* const numbers[] = {&pose.position.x,    &pose.position.y,    &pose.position.z,   &pose.orientation.x,
                                           &pose.orientation.y, &pose.orientation.z, &pose.orientation.w};
                *numbers[k % 7] = bad;
                SCOPED_TRACE(testing::Message() << to_string(type_of(a)) << " " << to_string(type_of(b)) << " " << k);
                g_reports = 0;
                std::vector<Manifold> out(3);
                const ShapePair pair{&a, &b, poses[0], poses[1], 0.01f};
                collide(pair, 0, out);
                EXPECT_EQ(g_code, ErrorCode::NotFinite);
                collide(std::span(&pair, 1), serial, scratch, out);
                EXPECT_EQ(g_code, ErrorCode::NotFinite);
                const Shape* pointers[] = {&a, &b};
                const NumberedPair numbered{0, 1, 0.01f};
                collide({pointers, poses}, {&numbered, 1}, serial, scratch, out);
                EXPECT_EQ(g_code, ErrorCode::NotFinite);
                ASSERT_EQ(out.size(), 3u);
                ASSERT_EQ(g_reports, 3);
                if (!is_convex(a) || !is_convex(b)) continue;
                std::vector<Overlap> verdicts(2);
                std::vector<DistanceResult> gaps(2);
                EXPECT_TRUE(std::isinf(distance(a, poses[0], b, poses[1]).upper));
                EXPECT_EQ(overlaps(a, poses[0], b, poses[1]), Overlap::Undecided);
                EXPECT_EQ(penetration(a, poses[0], b, poses[1]).normal, dvec3{0.0});
                overlaps({pointers, poses}, {&numbered, 1}, serial, verdicts);
                distance({pointers, poses}, {&numbered, 1}, serial, {}, gaps);
                EXPECT_EQ(verdicts.size() + gaps.size(), 4u);
                ASSERT_EQ(g_reports, 8);
            }
        }
    }
    set_error_handler(before);
}

}  // namespace
}  // namespace carom
