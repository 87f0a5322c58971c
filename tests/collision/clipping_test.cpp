// Segments and polygons against half-spaces, boxes and frusta: exact rationals, areas, counts and shared edges.
#include <carom/collision/clipping.hpp>
#include <carom/core/random.hpp>

#include <gtest/gtest.h>
#include <fuzz/clipping_check.hpp>

#include <array>
#include <limits>
#include <type_traits>
#include <vector>

namespace carom {
namespace {

template <class T>
class Clipping : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(Clipping, Precisions);

class ClippingBy : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(InFloatThenDouble, ClippingBy, testing::Range(0, 2 * test::kClippings));

TEST_P(ClippingBy, IsRightWithinItsBoundByExactRationals) {
    Random random(static_cast<std::uint64_t>(4200 + GetParam()));
    for (int i = 0; i < 300; ++i) {
        std::vector<std::uint8_t> bytes = test::random_bytes(random, 160);
        bytes[0] = static_cast<std::uint8_t>(GetParam());
        ASSERT_EQ(test::clipping_fault(bytes), "") << "scene " << i;
    }
}

template <class T>
dvec3 vector_area(std::span<const geo::Vec3<T>> polygon) {
    dvec3 area{0.0};
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        area += 0.5 * glm::cross(dvec3(polygon[i - 1]) - dvec3(polygon[0]), dvec3(polygon[i]) - dvec3(polygon[0]));
    }
    return area;
}

template <class T>
std::vector<geo::Vec3<T>> polygon_of(Random& random) {
    const std::vector<std::uint8_t> bytes = test::random_bytes(random, 40);
    test::Draw<T> draw(bytes);
    return draw.polygon();
}

TYPED_TEST(Clipping, BothSidesOfAPlaneHaveTheAreaOfThePolygon) {
    using T = TypeParam;
    Random random(4301);
    geo::PolygonClipper<T> clipper;
    int cut = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::vector<geo::Vec3<T>> polygon = polygon_of<T>(random);
        const dvec3 n{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        double size = 0.0;
        for (const geo::Vec3<T>& c : polygon) size = std::max(size, glm::length(dvec3(c)));
        const geo::Plane<T> plane{geo::Vec3<T>(n), static_cast<T>(size * random.range(-0.5, 0.5))};
        const dvec3 below = vector_area(clipper.clip(polygon, plane));
        const bool is_cut = clipper.clip(polygon, plane).size() > 0;
        const std::span<const geo::Vec3<T>> rest = clipper.clip(polygon, geo::Plane<T>{-plane.normal, -plane.offset});
        cut += is_cut && !rest.empty() ? 1 : 0;
        const dvec3 whole = vector_area(std::span<const geo::Vec3<T>>(polygon));
        const double tolerance = 64.0 * static_cast<double>(std::numeric_limits<T>::epsilon()) * size * size;
        EXPECT_LE(glm::length(below + vector_area(rest) - whole), tolerance) << i;
    }
    EXPECT_GT(cut, 700);
}

TYPED_TEST(Clipping, ConvexPolygonsGainOneCornerAPlaneAtMost) {
    using T = TypeParam;
    Random random(4302);
    geo::PolygonClipper<T> clipper;
    for (int i = 0; i < 500; ++i) {
        std::vector<geo::Vec3<T>> polygon;
        const int n = 3 + i % 6;
        for (int k = 0; k < n; ++k) {
            const SinCos turn = sin_cos(2.0 * kPi * k / n);
            polygon.push_back(geo::Vec3<T>(dvec3{turn.cos, turn.sin, random.range(-1e-7, 1e-7)}));
        }
        std::vector<geo::Plane<T>> planes;
        for (int k = 0; k < 6; ++k) {
            const dvec3 normal{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
            planes.push_back({geo::Vec3<T>(normal), static_cast<T>(random.range(0.0, 0.7))});
        }
        const auto left = clipper.clip(polygon, std::span<const geo::Plane<T>>(planes));
        EXPECT_LE(left.size(), polygon.size() + planes.size());
        EXPECT_TRUE(left.empty() || left.size() >= 3);
    }
}

TYPED_TEST(Clipping, NeighboursAreCutAtTheSamePoint) {
    using T = TypeParam;
    Random random(4303);
    geo::PolygonClipper<T> one;
    geo::PolygonClipper<T> other;
    int shared = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto point = [&] {
            return geo::Vec3<T>(dvec3{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)});
        };
        const geo::Vec3<T> a = point();
        const geo::Vec3<T> b = point();
        const geo::Plane<T> plane{point(), T(0)};
        if ((glm::dot(plane.normal, a) > T(0)) == (glm::dot(plane.normal, b) > T(0))) continue;
        const std::array<geo::Vec3<T>, 3> left{a, b, point()};
        const std::array<geo::Vec3<T>, 3> right{b, a, point()};
        const auto p = one.clip(left, plane);
        const auto q = other.clip(right, plane);
        int same = 0;
        for (const geo::Vec3<T>& c : p) {
            same += std::ranges::find(q, c) != q.end() ? 1 : 0;
        }
        EXPECT_GE(same, 2) << "the end that is inside, and the cut";
        ++shared;
    }
    EXPECT_GT(shared, 500);
}

TYPED_TEST(Clipping, WhatIsCutToABoxIsInItToTheBit) {
    using T = TypeParam;
    Random random(4304);
    geo::PolygonClipper<T> clipper;
    int cut = 0;
    for (int i = 0; i < 3000; ++i) {
        const auto point = [&](double half) {
            return geo::Vec3<T>(dvec3{random.range(-half, half), random.range(-half, half), random.range(-half, half)});
        };
        const geo::Vec3<T> p = point(1.0);
        const geo::Vec3<T> q = point(1.0);
        const geo::Aabb<T> box{glm::min(p, q), glm::max(p, q)};
        const auto inside = [&](const geo::Vec3<T>& c) { return geo::outcode(box, c) == 0; };
        const std::array<geo::Vec3<T>, 3> triangle{point(2.0), point(2.0), point(2.0)};
        const auto left = clipper.clip(triangle, box);
        EXPECT_TRUE(std::ranges::all_of(left, inside)) << i;
        EXPECT_LE(left.size(), 9u);
        const auto part = geo::clip(geo::Segment<T>{triangle[0], triangle[1]}, box);
        EXPECT_TRUE(!part || (inside(part->segment.a) && inside(part->segment.b))) << i;
        cut += !left.empty() && part ? 1 : 0;
    }
    EXPECT_GT(cut, 100);
}

TYPED_TEST(Clipping, WhatIsInsideOrInAFaceIsKeptBitForBit) {
    using T = TypeParam;
    const geo::Aabb<T> box{{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}};
    const std::array<geo::Vec3<T>, 4> face{{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
    geo::PolygonClipper<T> clipper;
    EXPECT_TRUE(std::ranges::equal(clipper.clip(face, box), face));
    EXPECT_TRUE(std::ranges::equal(clipper.clip(face, geo::Obb<T>{.half_extents = {1, 1, 1}}), face));
    EXPECT_TRUE(std::ranges::equal(clipper.clip(clipper.clip(face, box), box), face)) << "its own result";
    const auto part = geo::clip(geo::Segment<T>{face[0], face[1]}, box);
    ASSERT_TRUE(part);
    EXPECT_EQ(part->t_a, T(0));
    EXPECT_EQ(part->t_b, T(1));
    EXPECT_TRUE(part->segment.a == face[0] && part->segment.b == face[1]);
    const std::array<geo::Vec3<T>, 3> touching{{{1, 0, 0}, {2, 1, 0}, {2, -1, 0}}};
    EXPECT_TRUE(clipper.clip(touching, box).empty()) << "one corner is no polygon";
    const auto corner = geo::clip(geo::Segment<T>{{T(1), T(0), T(0)}, {T(2), T(0), T(0)}}, box);
    EXPECT_TRUE(corner && corner->t_b == T(0));
}

TYPED_TEST(Clipping, ACutRunsWhereItShould) {
    using T = TypeParam;
    const geo::Aabb<T> box{{T(0), T(0), T(0)}, {T(1), T(1), T(1)}};
    const geo::Segment<T> through{{T(-1), T(0.5), T(0.25)}, {T(3), T(0.5), T(0.25)}};
    for (const auto& part : {geo::clip(through, box),
                             geo::clip(through, geo::Obb<T>{{T(0.5), T(0.5), T(0.5)}, {T(0.5), T(0.5), T(0.5)}})}) {
        ASSERT_TRUE(part);
        EXPECT_EQ(part->t_a, T(0.25));
        EXPECT_EQ(part->t_b, T(0.5));
        EXPECT_EQ(part->segment.a, (geo::Vec3<T>{T(0), T(0.5), T(0.25)}));
        EXPECT_EQ(part->segment.b, (geo::Vec3<T>{T(1), T(0.5), T(0.25)}));
    }
    EXPECT_FALSE(geo::clip(geo::Segment<T>{{T(-1), T(0.5), T(0)}, {T(0.5), T(2.5), T(0)}}, box))
        << "past the edge, no bit in common";
    EXPECT_EQ(geo::outcode(box, geo::Vec3<T>{T(-1), T(2), T(0.5)}), 0b001001u);
}

TYPED_TEST(Clipping, AFrustumCutsLikeItsPlanes) {
    using T = TypeParam;
    const geo::Frustum<T> view =
        geo::frustum_of(geo::Camera<T>{.fovy = T(1.5707963), .near_distance = T(1), .far_distance = T(9)}).value();
    const auto part = geo::clip(geo::Segment<T>{{T(0), T(0), T(3)}, {T(0), T(0), T(-13)}}, view);
    ASSERT_TRUE(part);
    EXPECT_EQ(part->segment.a.z, T(-1));
    EXPECT_EQ(part->segment.b.z, T(-9));
    const std::array<geo::Vec3<T>, 4> wall{{{-99, -99, -4}, {99, -99, -4}, {99, 99, -4}, {-99, 99, -4}}};
    geo::PolygonClipper<T> clipper;
    const auto seen = clipper.clip(wall, view);
    ASSERT_EQ(seen.size(), 4u);
    EXPECT_NEAR(glm::length(vector_area(seen)), 64.0, 1e-4) << "8 m across at a distance of 4 m";
}

TYPED_TEST(Clipping, OfBadInputNothingIsKept) {
    using T = TypeParam;
    constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
    constexpr T kInf = std::numeric_limits<T>::infinity();
    const geo::Aabb<T> box{{T(-1), T(-1), T(-1)}, {T(1), T(1), T(1)}};
    const geo::Aabb<T> inverted{{T(1), T(1), T(1)}, {T(-1), T(-1), T(-1)}};
    const geo::Obb<T> negative{.half_extents = {T(1), T(-1), T(1)}};
    const geo::Plane<T> all{{T(0), T(0), T(0)}, T(1)};
    const geo::Plane<T> none{{T(0), T(0), T(0)}, T(-1)};
    const geo::Segment<T> segment{{T(0), T(0), T(0)}, {T(0.5), T(0), T(0)}};
    const std::array<geo::Vec3<T>, 3> triangle{{{0, 0, 0}, {T(0.5), 0, 0}, {0, T(0.5), 0}}};
    geo::PolygonClipper<T> clipper;
    EXPECT_TRUE(geo::clip(segment, box) && geo::clip(segment, all));
    EXPECT_FALSE(geo::clip(segment, inverted) || geo::clip(segment, negative) || geo::clip(segment, none));
    EXPECT_EQ(clipper.clip(triangle, box).size(), 3u);
    EXPECT_EQ(clipper.clip(triangle, all).size(), 3u);
    EXPECT_TRUE(clipper.clip(triangle, inverted).empty() && clipper.clip(triangle, negative).empty() &&
                clipper.clip(triangle, none).empty());
    EXPECT_TRUE(clipper.clip({}, box).empty());
    for (const T bad : {kNan, kInf, -kInf}) {
        const geo::Plane<T> plane{{T(0), bad, T(0)}, T(1)};
        const geo::Plane<T> offset{{T(0), T(1), T(0)}, bad};
        EXPECT_FALSE(geo::clip(segment, plane) || geo::clip(segment, offset));
        EXPECT_TRUE(clipper.clip(triangle, plane).empty() && clipper.clip(triangle, offset).empty());
        const geo::Segment<T> wrong{{bad, T(0), T(0)}, {T(0.5), T(0), T(0)}};
        EXPECT_FALSE(geo::clip(wrong, box) || geo::clip(wrong, all) ||
                     geo::clip(wrong, geo::Obb<T>{.half_extents = {1, 1, 1}}));
        std::array<geo::Vec3<T>, 3> spoilt = triangle;
        spoilt[1].z = bad;
        EXPECT_TRUE(clipper.clip(spoilt, box).empty() && clipper.clip(spoilt, all).empty());
    }
}

}  // namespace
}  // namespace carom
