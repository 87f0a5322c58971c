// The width of wide data in memory: always 16 lanes, whatever the machine has.
//
//   struct ContactBundle { FloatBundle normal_x, normal_y, normal_z; IntBundle body_a, body_b; };
//   for (int lane = 0; lane < kBundleWidth; lane += kLanes) { Floats x = load(b.normal_x.lane + lane); ... }
//
// Kernels walk a bundle in steps of their own lane count (core/lanes.hpp). Every lane therefore sees the same operations
// on the same data at each SIMD width, and results have the same bits by construction.
#pragma once

#include <cstddef>
#include <cstdint>

namespace carom {

inline constexpr int kBundleWidth = 16;
inline constexpr std::size_t kBundleAlignment = 64;

/// Doubles come eight to a cache line.
inline constexpr int kDoubleBundleWidth = 8;

/// Sixteen floats, one cache line. Padding lanes are to be zeroed: stale denormals are slow.
struct alignas(kBundleAlignment) FloatBundle {
    float lane[kBundleWidth] = {};
};

/// Sixteen integers, one cache line.
struct alignas(kBundleAlignment) IntBundle {
    std::int32_t lane[kBundleWidth] = {};
};

/// Eight doubles, one cache line.
struct alignas(kBundleAlignment) DoubleBundle {
    double lane[kDoubleBundleWidth] = {};
};

/// @return how many bundles hold `count` items.
[[nodiscard]] constexpr std::size_t bundle_count(std::size_t count) noexcept {
    return (count + kBundleWidth - 1) / kBundleWidth;
}

}  // namespace carom
