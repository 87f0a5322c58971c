// How a crate on a level ground must be reported, whatever the ground is made of.
//
//   test::expect_stands_on_corners(manifolds, crate, 0.5, 0.5, -0.001f);
#pragma once

#include "oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace carom::test {

/// A crate stands on a level ground: one manifold, a point at each of its four lower corners, each with a name of its own.
inline void expect_stands_on_corners(const std::vector<Manifold>& found, const Pose& crate, double half_x, double half_z,
                                     float separation) {
    ASSERT_EQ(found.size(), 1u);
    ASSERT_EQ(found[0].count, 4u);
    EXPECT_NEAR(found[0].normal.y, -1.0f, 1e-6f);
    std::set<std::uint64_t> names;
    for (const ContactPoint& p : found[0].used()) {
        EXPECT_NEAR(p.separation, separation, 1e-6f);
        const dvec3 local = rotate_inverse(crate.orientation, dvec3(p.position));
        EXPECT_NEAR(std::abs(local.x), half_x, 1e-5);
        EXPECT_NEAR(std::abs(local.z), half_z, 1e-5);
        names.insert(p.feature);
    }
    EXPECT_EQ(names.size(), 4u);
}

}  // namespace carom::test
