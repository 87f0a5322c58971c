// Eight pairs side by side in double, on their way into lanes and out of them.
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/narrowphase/detail/kernel.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::detail {

/// Poses of the two shapes (position, then x y z w), the numbers that describe them, and the margin.
struct PairRows {
    DoubleBundle first[7], second[7];
    DoubleBundle size_first[3];  ///< of a sphere its radius; of a capsule its radius and the half of its segment; of a box its half extents
    DoubleBundle size_second[4];  ///< the same; of a plane normal and offset
    DoubleBundle margin;

    /// @param chosen  1..8 pairs; the first stands in for those that are not there. @param swapped  each pair's B is the first shape.
    void fill(const BatchInput& input, std::span<const std::uint32_t> chosen, bool swapped) noexcept;
};

/// Eight floats beside eight doubles.
struct alignas(kBundleAlignment / 2) HalfBundle {
    float lane[kDoubleBundleWidth] = {};
};

/// What touches, rounded to what manifolds hold, with 1, 2 or 4 points at most.
template <std::size_t Points>
struct ContactRows {
    struct Point {
        HalfBundle position[3], separation;
        DoubleBundle feature;
        unsigned valid = 0;  ///< bits of the lanes
    };
    HalfBundle normal[3];
    Point points[Points];

    /// Appends the manifolds of the pairs that have a point, in their order.
    void write(std::span<const std::uint32_t> chosen, ManifoldList& out) const;
};

}  // namespace carom::detail
