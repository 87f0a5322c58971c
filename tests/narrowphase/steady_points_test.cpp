// PlacedShapes::steady: of a patch of more than four corners four are chosen, and the choice does not hang on small differences of depth.
#include <carom/collision/convex_hull.hpp>
#include <carom/core/check.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/math.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/narrowphase/collide.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

namespace carom {
namespace {

constexpr double kDepth = 4e-4;

// A box, turned by 0.4 rad about y and tilted by little about a level axis, overlaps the top of another by kDepth: its lower face and that top share eight
// corners, whose depths differ by some `tilt` of the size.
struct Tilted {
    Shape box = Box{vec3{0.5f}};
    Pose lower, upper;

    Tilted(double direction, double tilt) {
        const dvec3 axis{std::cos(direction), 0.0, std::sin(direction)};
        upper.orientation = rotation_from_vector(tilt * axis) * rotation_from_vector({0.0, 0.4, 0.0});
        upper.position = {0.0, 1.0 - kDepth, 0.0};
    }
};

std::vector<Manifold> single(const Shape& a, const Shape& b, const Tilted& t, bool steady) {
    std::vector<Manifold> out;
    collide({&a, &b, t.lower, t.upper, 1e-3f, steady}, 0, out);
    return out;
}

std::vector<Manifold> batch(const Tilted& t, bool steady) {
    const std::array<const Shape*, 2> shapes{&t.box, &t.box};
    const std::array<Pose, 2> poses{t.lower, t.upper};
    const NumberedPair pair{.a = 0, .b = 1, .margin = 1e-3f};
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> out;
    collide({shapes, poses, steady}, {&pair, 1}, executor, scratch, out);
    return out;
}

std::set<std::uint64_t> corners_of(const Manifold& m) {
    std::set<std::uint64_t> corners;
    for (const ContactPoint& p : m.used()) corners.insert(p.feature);
    return corners;
}

double depth_of(const Manifold& m) {
    double depth = 0.0;
    for (const ContactPoint& p : m.used()) depth = std::max(depth, -static_cast<double>(p.separation));
    return depth;
}

constexpr int kDirections = 48;
double direction(int k) { return 2.0 * std::numbers::pi * (k + 0.3) / kDirections; }

// The sets of corners that are chosen over all directions of the tilt.
template <class Collide>
std::size_t choices(double tilt, const Collide& collide) {
    std::set<std::set<std::uint64_t>> all;
    for (int k = 0; k < kDirections; ++k) {
        const std::vector<Manifold> found = collide(Tilted(direction(k), tilt));
        EXPECT_EQ(found.size(), 1u);
        if (found.empty()) continue;
        EXPECT_EQ(found[0].count, 4u);
        all.insert(corners_of(found[0]));
    }
    return all.size();
}

TEST(SteadyPoints, AFewPercentOfTheDepthChangeNothing) {
    const double tilt = 0.1 * kDepth;
    EXPECT_GT(choices(tilt, [](const Tilted& t) { return batch(t, false); }), 2u);
    EXPECT_EQ(choices(tilt, [](const Tilted& t) { return batch(t, true); }), 1u);
}

TEST(SteadyPoints, NorDoTheyOfHulls) {
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f});
    const Shape hull = *ConvexHull::build(corners);
    const double tilt = 0.1 * kDepth;
    EXPECT_GT(choices(tilt, [&](const Tilted& t) { return single(t.box, hull, t, false); }), 2u);
    EXPECT_EQ(choices(tilt, [&](const Tilted& t) { return single(t.box, hull, t, true); }), 1u);
}

// What is left out is deeper by a third at the most, and by 1e-3 of the half extent: beyond, the deepest is one of the four.
TEST(SteadyPoints, TheDepthIsTrueToAThirdAndToTheCap) {
    double most = 0.0, farthest = 0.0;
    for (const double tilt : {0.1 * kDepth, 0.3 * kDepth, kDepth, 3.0 * kDepth, 10.0 * kDepth}) {
        for (int k = 0; k < kDirections; ++k) {
            const Tilted t(direction(k), tilt);
            const double exact = depth_of(batch(t, false).at(0)), steady = depth_of(batch(t, true).at(0));
            EXPECT_LE(steady, exact);
            most = std::max(most, exact / steady);
            farthest = std::max(farthest, exact - steady);
        }
    }
    EXPECT_LE(most, 1.31);
    EXPECT_GT(most, 1.05);
    for (int k = 0; k < kDirections; ++k) {  // deep: the cap alone
        Tilted t(direction(k), 0.02);
        t.upper.position.y -= 0.03;
        farthest = std::max(farthest, depth_of(batch(t, false).at(0)) - depth_of(batch(t, true).at(0)));
    }
    EXPECT_LE(farthest, 1e-3 * 0.5 + 1e-5);
    EXPECT_GT(farthest, 1e-4);
}

TEST(SteadyPoints, BatchesAreSinglesToTheBitAtEveryWidth) {
    for (int k = 0; k < kDirections; ++k) {
        const Tilted t(direction(k), 0.3 * kDepth);
        for (const bool steady : {false, true}) {
            const std::vector<Manifold> alone = single(t.box, t.box, t, steady);
            for (const int width : available_simd_widths()) {
                set_simd_width(width);
                const std::vector<Manifold> found = batch(t, steady);
                ASSERT_EQ(found.size(), alone.size());
                EXPECT_EQ(std::memcmp(found.data(), alone.data(), alone.size() * sizeof(Manifold)), 0) << k << " " << width;
            }
            set_simd_width(0);
        }
    }
}

// Pairs that bring their own shapes are steady all or none.
TEST(SteadyPoints, OfPairsWithTheirOwnShapesToo) {
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> found;
    for (int k = 0; k < kDirections; ++k) {
        const Tilted t(direction(k), 0.3 * kDepth);
        for (const bool steady : {false, true}) {
            const ShapePair pair{&t.box, &t.box, t.lower, t.upper, 1e-3f, steady};
            const std::vector<Manifold> alone = single(t.box, t.box, t, steady);
            collide(std::span(&pair, 1), executor, scratch, found);
            ASSERT_EQ(found.size(), alone.size());
            EXPECT_EQ(std::memcmp(found.data(), alone.data(), alone.size() * sizeof(Manifold)), 0) << k;
        }
    }
    const std::vector<Manifold> before = found;
    const Tilted t(0.0, 0.0);
    const std::array<ShapePair, 2> mixed{ShapePair{&t.box, &t.box, t.lower, t.upper, 1e-3f, true}, ShapePair{&t.box, &t.box, t.lower, t.upper, 1e-3f, false}};
    static int misuses;
    misuses = 0;
    const ErrorHandler handler = set_error_handler([](const Error& error) { misuses += error.code == ErrorCode::InvalidArgument ? 1 : 100; });
    collide(mixed, executor, scratch, found);
    set_error_handler(handler);
    EXPECT_EQ(misuses, 1);
    ASSERT_EQ(found.size(), before.size());
    EXPECT_EQ(std::memcmp(found.data(), before.data(), before.size() * sizeof(Manifold)), 0);
}

}  // namespace
}  // namespace carom
