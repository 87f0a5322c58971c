// The exact sign of a determinant.
#include <carom/collision/detail/orientation.hpp>

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

}  // namespace
}  // namespace carom
