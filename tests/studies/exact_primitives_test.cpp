// The 300-bit oracle for primitives, by hand-made cases; and the studies that use it.
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/primitive_cases.hpp>
#include <carom/studies/oracle/exact_primitives.hpp>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <set>

namespace carom::accuracy {
namespace {

using geo::Ray;

constexpr double kUlp = 0x1p-52;

TEST(ExactPrimitives, ASphereIsTouchedAndOneUlpFartherMissed) {
    const geo::Sphere<double> ball{{0, 0, 0}, 1.0};
    const auto at_height = [&](double y) { return oracle::first_hit(ball, Ray<double>{.origin = {-3, y, 0}, .direction = {2, 0, 0}}); };
    EXPECT_EQ(at_height(0.0).value, 1.0);
    EXPECT_TRUE(at_height(1.0).hit);
    EXPECT_EQ(at_height(1.0).value, 1.5);
    EXPECT_FALSE(at_height(1.0 + kUlp).hit);
    const auto inside = oracle::first_hit(ball, Ray<double>{.origin = {0.5, 0, 0}, .direction = {1, 0, 0}});
    EXPECT_TRUE(inside.hit);
    EXPECT_EQ(inside.value, 0.0) << "starts inside";
    EXPECT_FALSE(oracle::first_hit(ball, Ray<double>{.origin = {3, 0, 0}, .direction = {1, 0, 0}}).hit) << "behind";
    EXPECT_FALSE(oracle::first_hit(ball, Ray<double>{.origin = {-3, 0, 0}, .direction = {1, 0, 0}, .t_max = 1.9}).hit);
}

TEST(ExactPrimitives, ABoxIsClosed) {
    const geo::Aabb<double> box{{-1, -1, -1}, {1, 1, 1}};
    const auto along = [&](double y) { return oracle::first_hit(box, Ray<double>{.origin = {-3, y, 0}, .direction = {4, 0, -0.0}}); };
    EXPECT_EQ(along(0.0).value, 0.5);
    EXPECT_TRUE(along(1.0).hit) << "in the plane of a face";
    EXPECT_FALSE(along(1.0 + kUlp).hit);
    const Ray<double> at_edge{.origin = {-2, 0, 0}, .direction = {1, 1, 0}};
    EXPECT_EQ(oracle::first_hit(box, at_edge).value, 1.0) << "enters and leaves at one edge";
    EXPECT_FALSE(oracle::first_hit(box, Ray<double>{.origin = {-2, kUlp, 0}, .direction = {1, 1, 0}}).hit);
}

TEST(ExactPrimitives, ATriangleOwnsItsEdgesAndHasNoThickness) {
    const geo::Triangle<double> t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const auto down = [&](double x, double y) { return oracle::first_hit(t, Ray<double>{.origin = {x, y, 3}, .direction = {0, 0, -2}}); };
    EXPECT_EQ(down(0.25, 0.25).value, 1.5);
    EXPECT_TRUE(down(0.5, 0.5).hit);
    EXPECT_FALSE(down(0.5, 0.5 + kUlp).hit);
    EXPECT_FALSE(oracle::first_hit(t, Ray<double>{.origin = {-1, 0.2, 0}, .direction = {1, 0, 0}}).hit) << "in its plane";
}

TEST(ExactPrimitives, Distances) {
    const geo::Triangle<double> t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    EXPECT_EQ(oracle::distance({1, 1, 3}, t).value, 3.0) << "face";
    EXPECT_EQ(oracle::distance({2, -3, 4}, t).value, 5.0) << "edge";
    EXPECT_EQ(oracle::distance({-3, -4, 0}, t).value, 5.0) << "corner";
    EXPECT_EQ(oracle::distance({4, 4, 0}, t).value, std::sqrt(8.0)) << "long edge";
    EXPECT_TRUE(oracle::distance({1, 1, 0}, t).hit);
    const geo::Triangle<double> needle{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}};
    EXPECT_EQ(oracle::distance({2, 3, 4}, needle).value, 5.0) << "no area";

    const auto apart = [](const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
        const geo::Segment<double> p{a, b}, q{c, d};
        EXPECT_EQ(oracle::distance(p, q).value, oracle::distance(q, p).value);
        return oracle::distance(p, q).value;
    };
    EXPECT_EQ(apart({-1, 0, 0}, {1, 0, 0}, {0, -1, 2}, {0, 1, 2}), 2.0) << "crossing lines";
    EXPECT_EQ(apart({-1, 0, 0}, {1, 0, 0}, {4, 0, 4}, {9, 0, 4}), 5.0) << "parallel, apart";
    EXPECT_EQ(apart({-1, 0, 0}, {1, 0, 0}, {0, 3, 0}, {9, 3, 0}), 3.0) << "parallel, beside";
    EXPECT_EQ(apart({0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}), 5.0) << "points";
    EXPECT_EQ(apart({0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}), 0.0);
}

TEST(ExactPrimitives, OverlapsAreClosed) {
    const geo::Aabb<double> box{{0, 0, 0}, {1, 1, 1}};
    EXPECT_TRUE(oracle::overlap(geo::Sphere<double>{{4, 5, 0.5}, 5.0}, box).hit);
    EXPECT_FALSE(oracle::overlap(geo::Sphere<double>{{4 + 4 * kUlp, 5, 0.5}, 5.0}, box).hit);
    const geo::Capsule<double> lying{{{-1, 0, 0}, {1, 0, 0}}, 0.5}, across{{{0, -1, 1}, {0, 1, 1}}, 0.5};
    EXPECT_TRUE(oracle::overlap(lying, across).hit);
    EXPECT_FALSE(oracle::overlap(lying, geo::Capsule<double>{{{0, -1, 1 + kUlp}, {0, 1, 1 + kUlp}}, 0.5}).hit);

    const auto boxes = [](const dvec3& center, const dmat3& axes) {
        return oracle::overlap(geo::Obb<double>{{0, 0, 0}, {1, 1, 1}, dmat3(1.0)}, geo::Obb<double>{center, {1, 1, 1}, axes}).hit;
    };
    EXPECT_TRUE(boxes({2, 2, 2}, dmat3(1.0))) << "corner to corner";
    EXPECT_FALSE(boxes({2 + 2 * kUlp, 0, 0}, dmat3(1.0)));
    // Turned by 45 degrees about z, as columns that are not of unit length: sides of 1 along (1, 1) and (-1, 1).
    const dmat3 turned{{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}};
    EXPECT_TRUE(boxes({3, 0, 0}, turned)) << "an edge to a face";
    EXPECT_FALSE(boxes({3 + 4 * kUlp, 0, 0}, turned));
    // Edge against edge, which only a cross product of edges separates: diamonds on z and on x.
    const geo::Obb<double> a{{0, 0, 0}, {1, 1, 9}, {{1, 1, 0}, {-1, 1, 0}, {0, 0, 1}}};
    const auto b = [&](double y) { return geo::Obb<double>{{0, y, 0}, {9, 1, 1}, {{1, 0, 0}, {0, 1, 1}, {0, -1, 1}}}; };
    EXPECT_TRUE(oracle::overlap(a, b(4.0)).hit);
    EXPECT_FALSE(oracle::overlap(a, b(4.0 + 4 * kUlp)).hit);
}

TEST(PrimitiveParts, EveryKindUnderEveryConditionAndVerdictsOfBothKinds) {
    const std::vector<PrimitivePart> parts = primitive_parts(true), again = primitive_parts(true);
    std::set<std::string> kinds, conditions;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        kinds.insert(parts[i].kind);
        conditions.insert(parts[i].condition);
        const PartSample in_double = parts[i].in_double(), in_float = parts[i].in_float();
        EXPECT_EQ(in_double.failures + in_float.failures, 0u) << parts[i].kind << ' ' << parts[i].condition;
        // Where nothing touches, both precisions decide every case as 300 bits do.
        const bool boxes = parts[i].kind == "boxes";  // whose axes are rounded for float
        if (parts[i].condition != "touch") {
            EXPECT_LT(in_double.error_sum, 1e-12 * static_cast<double>(parts[i].count)) << parts[i].kind << ' ' << parts[i].condition;
            EXPECT_LT(in_float.error_sum, (boxes ? 0.01 : 1e-6) * static_cast<double>(parts[i].count)) << parts[i].kind << ' ' << parts[i].condition;
        }
        EXPECT_EQ(again[i].in_float().error_sum, in_float.error_sum) << "the same cases each time";
    }
    EXPECT_EQ(kinds.size() * conditions.size(), parts.size());
    EXPECT_EQ(kinds.size(), 8u);
    EXPECT_EQ(conditions.size(), 4u);
}

TEST(StudyCatalogue, FirstStudiesHaveTheNamesOfTheirGroups) {
    std::set<std::string> names;
    for (const StudyGroup& group : study_catalogue()) {
        const std::vector<Study> studies = find_study(group.name)->make({.quick = true});
        ASSERT_FALSE(studies.empty());
        EXPECT_EQ(studies[0].name, group.name);
        for (const Study& study : studies) {
            EXPECT_TRUE(names.insert(study.name).second) << study.name << " is there twice";
            EXPECT_EQ(study.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos) << study.name;
            for (const Candidate& candidate : study.candidates) {
                EXPECT_TRUE(candidate.who == "carom" || candidate.who == "euler") << candidate.who << ": no peers without being asked for";
            }
        }
    }
    EXPECT_EQ(find_study("speed").error().code, ErrorCode::UnknownName);
    EXPECT_NE(find_study("speed").error().message.find("primitives"), std::string::npos);
}

TEST(StudyCatalogue, PeersJoinTheStudiesOfRays) {
    StudyOptions options{.quick = true};
    options.ray_peers.push_back({"nobody", {{"mode", "blind"}}, [](const RayCases&) { return [](const carom::Ray&) { return std::optional<double>{}; }; }});
    const std::vector<Study> studies = find_study("rays")->make(options);
    const StudyResult result = measure(studies[0], {.repeats = 1});
    const Point& blind = result.points.back();
    EXPECT_EQ(blind.who, "nobody");
    EXPECT_GT(blind.error, 0.3) << "misses everything that is hit";
}

}  // namespace
}  // namespace carom::accuracy
