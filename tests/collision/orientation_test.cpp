// The exact sign of a determinant.
#include <carom/collision/detail/orientation.hpp>
#include <carom/core/random.hpp>

#include <support/rational.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace carom {
namespace {

TEST(Orientation, ExactWhereDoublesAreNot) {
    // A point moved off a slanted plane by one unit of the last place of a float.
    const dvec3 u{0.5f, 0.25f, -0.125f};
    const dvec3 v{-0.25f, 0.5f, 0.375f};
    const dvec3 origin{0.25, 0.5, 0.125};
    const dvec3 d = origin + u + v;
    EXPECT_EQ(detail::orientation(origin, origin + u, origin + v, d), 0);
    const dvec3 n = glm::cross(u, v);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float towards : {-10.0f, 10.0f}) {
            dvec3 moved_point = d;
            moved_point[axis] = static_cast<double>(std::nextafter(static_cast<float>(d[axis]), towards));
            const double side = (moved_point[axis] - d[axis]) * n[axis];
            EXPECT_EQ(detail::orientation(origin, origin + u, origin + v, moved_point), side > 0.0 ? 1 : -1);
        }
    }
    // The determinant is far below what the sum of products in double can resolve.
    const double big = 0x1p60;
    const double tiny = 0x1p-60;
    EXPECT_EQ(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, 0.0}), 0);
    EXPECT_EQ(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, tiny}),
              -detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, -tiny}));
    EXPECT_NE(detail::orientation({big, big, big}, {-big, -big, -big}, {big, -big, 0.0}, {0.0, 0.0, tiny}), 0);
}

/// Triangles with corners of floats, of doubles and of both, with the fourth point in their plane or an ulp or so beside it: differences of
/// the points are exact, or are not.
TEST(Orientation, IsThatOfRationalsWhetherDifferencesAreExactOrNot) {
    using exact::Rational;
    const auto exact_sign = [](const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
        Rational u[3], v[3], w[3];
        for (int k = 0; k < 3; ++k) {
            u[k] = Rational(b[k]) - Rational(a[k]), v[k] = Rational(c[k]) - Rational(a[k]), w[k] = Rational(d[k]) - Rational(a[k]);
        }
        const Rational zero, sum = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) + w[2] * (u[0] * v[1] - u[1] * v[0]);
        return (sum > zero ? 1 : 0) - (sum < zero ? 1 : 0);
    };
    Random r(41);
    int signs[3] = {0, 0, 0};
    for (int i = 0; i < 4000; ++i) {
        const auto number = [&](double scale) {
            const double x = scale * r.range(-1.0, 1.0);
            return i % 2 == 0 ? static_cast<double>(static_cast<float>(x)) : x;
        };
        const auto point = [&](double scale) { return dvec3{number(scale), number(scale), number(scale)}; };
        const double far = i % 3 == 0 ? 0.0 : std::ldexp(1.0, i % 24);
        const dvec3 origin = point(far), u = point(1.0), v = point(1.0);
        const double s = std::ldexp(std::floor(r.range(-8.0, 8.0)), -2), t = std::ldexp(std::floor(r.range(-8.0, 8.0)), -2);
        const dvec3 a = origin, b = origin + u, c = origin + v;
        dvec3 d = origin + s * (b - a) + t * (c - a);
        const int axis = static_cast<int>(r.range(0.0, 3.0));
        if (i % 5 != 0 && std::abs(d[axis]) > 1e-9) d[axis] = std::nextafter(d[axis], r.range(-1.0, 1.0) < 0.0 ? -1e9 : 1e9);
        const int expected = exact_sign(a, b, c, d);
        ++signs[expected + 1];
        ASSERT_EQ(detail::orientation(a, b, c, d), expected) << i;
        ASSERT_EQ(detail::exact_orientation(a, b, c, d), expected) << i;
    }
    for (const int count : signs) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace carom
