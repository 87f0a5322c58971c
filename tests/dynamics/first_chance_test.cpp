// The bounds that the continuous stage goes by before it asks for a time of impact: never later than the time, near it where there is nothing but balls, and the same
// bodies at every SIMD width.
#include <carom/core/random.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/dynamics/detail/course_table.hpp>
#include <carom/dynamics/detail/first_chance.hpp>
#include <carom/dynamics/detail/path_touch.hpp>

#include <support/random_pose.hpp>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

dvec3 somewhere(Random& r, double far) { return r.range(0.0, far) * test::random_direction(r); }
double begin_of(Random& r) { return r.unit() < 0.4 ? 0.0 : r.range(0.0, 0.9); }
Course some_course(Random& r, double far = 3.0) {
    return {.at = somewhere(r, far), .begin = begin_of(r), .rate = somewhere(r, 8.0), .play = r.unit() < 0.5 ? 0.0 : r.range(0.0, 0.1)};
}
dvec3 place(const Course& course, double t) { return course.at + (t - course.begin) * course.rate; }

/// That `apart`, of which less than 0 touches, is more before `t`, and not much more at it.
template <class Apart>
void expect_first(double t, double from, const Apart& apart, const char* what, int i) {
    const double until = std::min(t, 1.0);
    for (int k = 0; k < 200; ++k) {
        const double at = from + (until - from) * k / 200.0;
        if (at >= until) break;
        ASSERT_GT(apart(at), -1e-9) << what << ' ' << i << " at " << at << " of " << t;
    }
    if (t == kNoChance) return;
    ASSERT_GE(t, from) << what << ' ' << i;
    ASSERT_LT(apart(t), 1e-6) << what << ' ' << i << " at " << t;
}

TEST(FirstChance, OfBallsIsWhenTheyTouch) {
    Random r(1);
    int met = 0, at_once = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Course a = some_course(r), b = some_course(r);
        const double from = std::max(a.begin, b.begin), reach_a = r.range(0.01, 0.5), reach_b = r.range(0.01, 0.5),
                     room = r.range(0.0, 0.01);
        const double t = first_chance({&a, reach_a}, {&b, reach_b}, from, room);
        const double swapped = first_chance({&b, reach_b}, {&a, reach_a}, from, room);
        ASSERT_TRUE(swapped == t || std::abs(swapped - t) < 1e-9) << swapped << " and " << t;
        const auto apart = [&](double at) {
            return glm::length(place(a, at) - place(b, at)) - (reach_a + reach_b + a.play + b.play + room);
        };
        expect_first(t, from, apart, "balls", i);
        met += t < 1.0 ? 1 : 0;
        at_once += t == from ? 1 : 0;
    }
    EXPECT_GT(met, 300) << "or else nothing is tested";
    EXPECT_GT(at_once, 20);
    EXPECT_LT(at_once, 3 * met / 4) << "or else all touch when they start";
}

TEST(FirstChance, OfABallAndABoxIsNoLaterThanTheyTouch) {
    Random r(2);
    int met = 0;
    for (int i = 0; i < 4000; ++i) {
        const Course a = some_course(r);
        const dvec3 corner = somewhere(r, 2.0);
        const Aabb box{corner, corner + glm::abs(somewhere(r, 2.0))};
        const double reach = r.range(0.01, 0.5), t = first_chance({&a, reach}, box, a.begin, 0.0);
        const auto apart = [&](double at) {  // along some axis: the sides moved outward, corners and all
            const dvec3 p = place(a, at), outside = glm::max(box.lower - p, p - box.upper);
            return std::max({outside.x, outside.y, outside.z}) - (reach + a.play);
        };
        expect_first(t, a.begin, apart, "box", i);
        met += t < 1.0 ? 1 : 0;
    }
    EXPECT_GT(met, 300);
}

TEST(FirstChance, OfAHalfSpaceIsWhenTheyTouch) {
    Random r(3);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        const Course a = some_course(r), plane{.begin = 0.0, .rate = somewhere(r, 3.0)};
        const dvec3 normal = test::random_direction(r), foot = somewhere(r, 2.0);
        const double reach = r.range(0.01, 0.5), t = first_chance({&a, reach}, plane, foot, normal, a.begin, 0.0);
        expect_first(
            t, a.begin, [&](double at) { return glm::dot(normal, place(a, at) - (foot + at * plane.rate)) - (reach + a.play); }, "plane",
            i);
        met += t < 1.0 ? 1 : 0;
    }
    EXPECT_GT(met, 300);
}

// A wall that goes and turns: its corners, one by one, against the ball.
TEST(FirstChance, OfAWallThatTurnsIsNoLaterThanItTouches) {
    Random r(4);
    int met = 0, never = 0;
    for (int i = 0; i < 1500; ++i) {
        const Box wall{vec3{2.0f, 1.5f, 0.01f}};
        const PathPiece piece{
            .start = {somewhere(r, 3.0), test::random_rotation(r)}, .translation = somewhere(r, 1.0), .rotation = somewhere(r, 0.3)};
        BodyPath path;
        path.go(piece);
        const Course b = course_of(path), a = some_course(r, 5.0);
        const double reach = r.range(0.01, 0.2), t = first_chance({&a, reach}, {&b, 2.6}, bounds(wall, piece.start), a.begin, 0.0);
        for (int k = 0; k < 60; ++k) {
            const double at = a.begin + (std::min(t, 1.0) - a.begin) * k / 60.0;
            if (at >= std::min(t, 1.0)) break;
            const Pose pose = pose_at(piece, at);
            const dvec3 p = inverse_transform_point(pose, place(a, at)),
                        outside = glm::max(glm::abs(p) - dvec3(wall.half_extents), dvec3{0.0});
            ASSERT_GT(glm::length(outside), reach) << i << " at " << at << " of " << t;
        }
        met += t < 1.0 ? 1 : 0;
        never += t == kNoChance ? 1 : 0;
    }
    EXPECT_GT(met, 100);
    EXPECT_GT(never, 100);
}

/// A body that flies: how fast it may turn tells how much its path bends.
struct Flyer {
    Shape shape = Sphere{0.1f};
    Pose local{};
    double reach = 0.0;
    BodyMass mass;
    BodyPath path;
};
void launch(Random& r, Flyer& flyer) {
    if (r.unit() < 0.5) flyer.shape = Box{vec3{0.05f, 0.1f, 0.3f}};
    flyer.reach = std::holds_alternative<Box>(flyer.shape) ? 0.33 : 0.1001;
    static_cast<FreeRotation&>(flyer.mass) = FreeRotation{dvec3{0.03, 0.02, 0.005}, dvec3{1.0 / 0.03, 1.0 / 0.02, 1.0 / 0.005}};
    flyer.mass.mass = flyer.mass.inverse_mass = 1.0;
    const BodyState start{.pose = {somewhere(r, 2.0), test::random_rotation(r)},
                          .velocity = somewhere(r, 300.0),
                          .spin = somewhere(r, std::pow(10.0, r.range(-1.0, 3.0)))};
    flyer.path.fly({start, {.acceleration = {0.0, -9.81, 0.0}}}, flyer.mass, 0.0, {1.0 / 60.0, flyer.reach, 0.005});
}

TEST(FirstChance, NoSearchFindsAnEarlierTime) {
    Random r(5);
    Cores cores;
    int met = 0, later = 0;
    for (int i = 0; i < 40000; ++i) {
        Flyer a, b;
        launch(r, a), launch(r, b);
        const double from = r.unit() < 0.5 ? 0.0 : r.range(0.0, 0.5), tolerance = 1e-5;
        const Course course_a = course_of(a.path), course_b = course_of(b.path);
        const double t = first_chance({&course_a, a.reach}, {&course_b, b.reach}, from, 2.0 * tolerance);
        PathSearch search{
            .a = {&a.path, &a.shape, &a.local, a.reach}, .b = {&b.path, &b.shape, &b.local, b.reach}, .from = from, .tolerance = tolerance};
        if (!touch(search, from, 1.0, cores)) continue;
        ++met;
        later += t > from ? 1 : 0;
        ASSERT_LE(t, search.t) << i;
    }
    EXPECT_GT(met, 300);
    EXPECT_GT(later, 100) << "or else all overlap when they start";
}

TEST(CourseTable, ListsAllWhoHaveAChanceAndFewOthers) {
    Random r(6);
    for (const std::size_t count : {1u, 7u, 8u, 9u, 500u}) {
        CourseTable table;
        table.resize(count);
        std::vector<Course> courses;
        std::vector<double> reaches;
        for (std::size_t k = 0; k < count; ++k) {
            courses.push_back(some_course(r, k % 10 == 0 ? 1e5 : 1.5));
            reaches.push_back(r.range(0.01, 0.3));
        }
        for (std::size_t k = 0; k < count; ++k) table.set(k, {&courses[k], reaches[k]});
        int chances = 0, listed = 0;
        for (int i = 0; i < 300; ++i) {
            const Course own = some_course(r, 1.5);
            const double from = 0.9 + 0.1 * r.unit() * r.unit(),
                         to = i % 3 == 0   ? from
                              : i % 3 == 1 ? 1.0
                                           : r.range(from, 1.0),
                         room = 1e-4;
            std::vector<std::uint32_t> expected, found;
            set_simd_width(available_simd_widths().front());
            table.list_near({&own, 0.1}, from, to, room, expected);
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                found.assign(1, 77);  // appended to
                table.list_near({&own, 0.1}, from, to, room, found);
                ASSERT_EQ(found.front(), 77u);
                found.erase(found.begin());
                ASSERT_EQ(found, expected) << "width " << width;
            }
            ASSERT_TRUE(std::is_sorted(found.begin(), found.end()));
            listed += static_cast<int>(found.size());
            for (std::uint32_t k = 0; k < count; ++k) {
                if (!(first_chance({&own, 0.1}, {&courses[k], reaches[k]}, from, room) <= to)) continue;
                ++chances;
                ASSERT_TRUE(std::binary_search(found.begin(), found.end(), k)) << k << " of " << count;
            }
        }
        EXPECT_GT(chances, count == 500 ? 300 : -1);
        EXPECT_LE(listed, chances + chances / 20 + 2);
    }
    set_simd_width(0);
}

// What is no number may be anywhere.
TEST(CourseTable, ListsWhatIsNoNumber) {
    CourseTable table;
    table.resize(2);
    const Course lost{.at = dvec3{std::nan("")}}, far{.at = {100.0, 0.0, 0.0}}, own{.rate = {1.0, 0.0, 0.0}};
    table.set(0, {&lost, 1.0}), table.set(1, {&far, 1.0});
    std::vector<std::uint32_t> found;
    table.list_near({&own, 1.0}, 0.0, 1.0, 0.0, found);
    EXPECT_EQ(found, std::vector<std::uint32_t>{0});
    EXPECT_EQ(first_chance({&own, 1.0}, {&lost, 1.0}, 0.0, 0.0), 0.0);
    EXPECT_EQ(first_chance({&own, 1.0}, {&far, 1.0}, 0.0, 0.0), kNoChance);
}

}  // namespace
}  // namespace carom::dynamics
