// Sides of planes and distances from them against exact rationals.
#include <carom/collision/plane_tests.hpp>
#include <carom/core/random.hpp>

#include <support/exact_ray.hpp>
#include <support/query_cases.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace carom {
namespace {

using exact::Rational;
using geo::Side;

template <class T>
class PlaneTests : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(PlaneTests, Precisions);

/// The exact extent of a shape about a plane: heights low to high, both widened by the root of reach_sq.
struct Exact {
    Rational low, high, reach_sq;

    void add(const Rational& height, bool first) {
        low = first ? height : std::min(low, height);
        high = first ? height : std::max(high, height);
    }
    /// Whether all of it is above `level`.
    [[nodiscard]] bool above(const Rational& level) const {
        return low > level && exact::square(low - level) > reach_sq;
    }
    [[nodiscard]] bool below(const Rational& level) const {
        return high < level && exact::square(high - level) > reach_sq;
    }
};

template <class T>
Exact exact_extent(const geo::Plane<T>& plane, std::span<const geo::Vec3<T>> points, T radius) {
    const exact::Vec n = exact::vec(plane.normal);
    Exact e;
    for (std::size_t i = 0; i < points.size(); ++i) {
        e.add(exact::dot(n, exact::vec(points[i])) - exact::number(plane.offset), i == 0);
    }
    e.reach_sq = exact::square(exact::number(radius)) * exact::length_sq(n);
    return e;
}

template <class T>
Exact exact_extent(const geo::Plane<T>& plane, const geo::Obb<T>& box) {
    const exact::Vec n = exact::vec(plane.normal);
    const std::array<geo::Vec3<T>, 1> center{box.center};
    Exact e = exact_extent<T>(plane, center, T(0));
    for (int k = 0; k < 3; ++k) {
        const Rational reach =
            exact::magnitude(exact::dot(n, exact::vec(box.axes[k]))) * exact::number(box.half_extents[k]);
        e.low -= reach;
        e.high += reach;
    }
    return e;
}

/// Half an ulp of T about `x`.
template <class T>
Rational rounding(const Rational& x) {
    return exact::number(static_cast<double>(std::numeric_limits<T>::epsilon()) / 2.0) * exact::magnitude(x) +
           exact::number(std::numeric_limits<T>::denorm_min());
}

/// The verdict is that of the exact plane moved by at most `by`; the exact distances are within that of the reported
/// ones.
template <class T, class Shape>
void expect_right(const geo::Plane<T>& plane, const Shape& shape, const Exact& e, const Rational& by, T margin) {
    const Side side = geo::side_of(plane, shape, margin);
    const Rational m = exact::number(margin);
    if (side == Side::Above) {
        EXPECT_TRUE(e.above(m - by));
    } else if (side == Side::Below) {
        EXPECT_TRUE(e.below(by - m));
    } else {
        EXPECT_FALSE(e.above(m + by) || e.below(-by - m));
    }
    const geo::Extent<T> extent = geo::extent(plane, shape);
    if (!std::isfinite(extent.lowest) || !std::isfinite(extent.highest)) {
        return;  // beyond float
    }
    const Rational reach = exact::sqrt_up(e.reach_sq);
    const Rational low = exact::number(extent.lowest);
    const Rational high = exact::number(extent.highest);
    EXPECT_LE(exact::magnitude(e.low - reach - low), 2 * by + rounding<T>(low) + exact::number(0x1p-49) * reach);
    EXPECT_LE(exact::magnitude(e.high + reach - high), 2 * by + rounding<T>(high) + exact::number(0x1p-49) * reach);
}

TYPED_TEST(PlaneTests, SidesAndDistancesAreExactWithinTheirBound) {
    using T = TypeParam;
    Random random(4401);
    int across = 0;
    for (int i = 0; i < 600; ++i) {
        const std::vector<std::uint8_t> bytes = test::random_bytes(random, 200);
        test::Draw<T> draw(bytes);
        geo::Plane<T> plane = draw.plane();
        const geo::Triangle<T> triangle = draw.triangle();
        if (i % 2 == 0) {  // through or beside a corner by an ulp
            plane.offset = glm::dot(plane.normal, triangle.a);
            if (!is_finite(plane.offset)) continue;
        }
        const T margin = i % 3 == 0 ? draw.length() : T(0);
        const std::array<geo::Vec3<T>, 3> corners{triangle.a, triangle.b, triangle.c};
        const Exact flat = exact_extent<T>(plane, corners, T(0));
        // Heights within 4 ulp, and with no margin their signs are right: the verdict is the exact one.
        const Rational four_ulp =
            exact::number(4.0 * exact::kEps) * std::max(exact::magnitude(flat.low), exact::magnitude(flat.high));
        const Side side = geo::side_of(plane, triangle, margin);
        across += side == Side::Across ? 1 : 0;
        if (margin == T(0)) {
            EXPECT_EQ(side == Side::Above, flat.above(0));
            EXPECT_EQ(side == Side::Below, flat.below(0));
        }
        EXPECT_EQ(side, geo::side_of(plane, std::span<const geo::Vec3<T>>(corners), margin));
        expect_right(plane, triangle, flat, four_ulp, margin);

        const geo::Aabb<T> box = draw.aabb();
        const test::Points<T> box_corners = test::anchors(box);
        const Exact boxed = exact_extent<T>(plane, box_corners, T(0));
        if (margin == T(0)) {
            EXPECT_EQ(geo::side_of(plane, box) == Side::Above, boxed.above(0));
            EXPECT_EQ(geo::side_of(plane, box) == Side::Below, boxed.below(0));
        }
        expect_right(
            plane, box, boxed,
            exact::number(4.0 * exact::kEps) * std::max(exact::magnitude(boxed.low), exact::magnitude(boxed.high)),
            margin);
        const std::array<geo::Vec3<T>, 1> point{box.lower};
        EXPECT_EQ(geo::side_of(plane, box.lower) == Side::Above, exact_extent<T>(plane, point, T(0)).above(0));

        const auto bound = [&](const Exact& e, const Rational& size) {
            return exact::number(12.0 * exact::kEps) *
                   (std::max(exact::magnitude(e.low), exact::magnitude(e.high)) +
                    size * exact::sqrt_up(exact::length_sq(exact::vec(plane.normal))));
        };
        const geo::Capsule<T> capsule{{triangle.a, triangle.b}, draw.length()};
        const std::array<geo::Vec3<T>, 2> ends{triangle.a, triangle.b};
        const Exact round = exact_extent<T>(plane, ends, capsule.radius);
        expect_right(plane, capsule, round, bound(round, exact::number(capsule.radius)), margin);
        const geo::Sphere<T> sphere{triangle.a, capsule.radius};
        const Exact ball = exact_extent<T>(plane, {ends.data(), 1}, capsule.radius);
        expect_right(plane, sphere, ball, bound(ball, exact::number(capsule.radius)), margin);

        const geo::Obb<T> obb = draw.obb();
        const Exact turned = exact_extent(plane, obb);
        expect_right(plane, obb, turned, bound(turned, 2 * exact::largest(exact::vec(obb.half_extents))), margin);
    }
    EXPECT_GT(across, 200);
}

TYPED_TEST(PlaneTests, TouchingIsAcrossAndTheMarginIsClosed) {
    using T = TypeParam;
    const geo::Plane<T> floor{{T(0), T(2), T(0)}, T(1)};  // y = 0.5, distances in half metres
    EXPECT_EQ(geo::side_of(floor, geo::Sphere<T>{{T(0), T(1.5), T(0)}, T(1)}), Side::Across);
    EXPECT_EQ(geo::side_of(floor, geo::Sphere<T>{{T(0), T(1.75), T(0)}, T(1)}), Side::Above);
    EXPECT_EQ(geo::side_of(floor, geo::Sphere<T>{{T(0), T(1.75), T(0)}, T(1)}, T(0.5)), Side::Across);
    EXPECT_EQ(geo::side_of(floor, geo::Sphere<T>{{T(0), T(1.75), T(0)}, T(1)}, T(0.25)), Side::Above);
    EXPECT_EQ(geo::side_of(floor, geo::Vec3<T>{T(7), T(0.5), T(-7)}), Side::Across);
    EXPECT_EQ(geo::side_of(floor, geo::Vec3<T>{T(7), T(0.25), T(-7)}), Side::Below);
    EXPECT_EQ(geo::signed_distance(floor, geo::Vec3<T>{T(7), T(0.25), T(-7)}), T(-0.5));
    const geo::Extent<T> e =
        geo::extent(floor, geo::Obb<T>{.center = {T(9), T(3), T(9)}, .half_extents = {T(1), T(2), T(3)}});
    EXPECT_EQ(e.lowest, T(1));
    EXPECT_EQ(e.highest, T(9));
}

TYPED_TEST(PlaneTests, BadInputIsAcrossAndNotANumber) {
    using T = TypeParam;
    constexpr T kNan = std::numeric_limits<T>::quiet_NaN();
    const geo::Plane<T> floor{};
    const auto expect_bad = [&](const geo::Plane<T>& plane, const auto& shape) {
        EXPECT_EQ(geo::side_of(plane, shape), Side::Across);
        EXPECT_TRUE(std::isnan(geo::extent(plane, shape).lowest) && std::isnan(geo::extent(plane, shape).highest));
    };
    const geo::Vec3<T> up{T(0), T(5), T(0)};
    for (int k = 0; k < 3; ++k) {
        geo::Vec3<T> bad = up;
        bad[k] = kNan;
        EXPECT_EQ(geo::side_of(floor, bad), Side::Across);
        expect_bad(floor, geo::Triangle<T>{up, bad, up});
        expect_bad(floor, geo::Sphere<T>{bad, T(1)});
        expect_bad(floor, geo::Capsule<T>{{up, bad}, T(1)});
        expect_bad(floor, geo::Obb<T>{.center = bad, .half_extents = {1, 1, 1}});
        expect_bad({bad, T(0)}, geo::Sphere<T>{up, T(1)});
    }
    expect_bad({.offset = kNan}, geo::Sphere<T>{up, T(1)});
    expect_bad(floor, geo::Sphere<T>{up, T(-1)});
    expect_bad(floor, geo::Sphere<T>{up, kNan});
    expect_bad(floor, geo::Capsule<T>{{up, up}, T(-1)});
    expect_bad(floor, geo::Aabb<T>{up, -up});
    expect_bad(floor, geo::Aabb<T>{{T(0), kNan, T(0)}, up});
    expect_bad(floor, geo::Obb<T>{.center = up, .half_extents = {T(1), T(1), T(-1)}});
    expect_bad(floor, std::span<const geo::Vec3<T>>{});
}

}  // namespace
}  // namespace carom
