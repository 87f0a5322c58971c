// Poses to lanes of doubles, by transposes in registers: each pose is read where it lies, and nothing is written on the way.
//
//   WidePose pose = read_poses(pointers + lane);   // kDoubleLanes of them
//   read_half_extents(boxes);                      // kLanes

// This guard lets the file through once for each target.
#if defined(CAROM_NARROWPHASE_POSE_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_NARROWPHASE_POSE_LANES_HPP
#undef CAROM_NARROWPHASE_POSE_LANES_HPP
#else
#define CAROM_NARROWPHASE_POSE_LANES_HPP
#endif

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/shape_layout.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

struct WidePose {
    Doubles position[3];
    Doubles orientation[4];  ///< x y z w
};

// Four doubles at `offset` of each pose, a lane a pose.
HWY_INLINE void read_four(const Pose* const* poses, std::size_t offset, Doubles (&out)[4]) {
    const auto at = [&](int k) { return reinterpret_cast<const double*>(poses[k]) + offset; };
#if HWY_TARGET == HWY_SCALAR
    for (std::size_t k = 0; k < 4; ++k) out[k] = at(0)[k];
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
    // Rows k and, where there are eight lanes, k + 4, one above the other; then the four by four of each half.
    const hn::Simd<double, 4, 0> four;
#if HWY_TARGET == HWY_AVX3
    const auto row = [&](int k) { return hn::Combine(DoubleTag(), hn::LoadU(four, at(k + 4)), hn::LoadU(four, at(k))); };
#else
    const auto row = [&](int k) { return hn::LoadU(four, at(k)); };
#endif
    const auto a = row(0), b = row(1), c = row(2), d = row(3);
    const auto ab_even = hn::InterleaveLower(DoubleTag(), a, b), ab_odd = hn::InterleaveUpper(DoubleTag(), a, b);
    const auto cd_even = hn::InterleaveLower(DoubleTag(), c, d), cd_odd = hn::InterleaveUpper(DoubleTag(), c, d);
    out[0] = Doubles{hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_even), ab_even)};
    out[1] = Doubles{hn::OddEvenBlocks(hn::SwapAdjacentBlocks(cd_odd), ab_odd)};
    out[2] = Doubles{hn::OddEvenBlocks(cd_even, hn::SwapAdjacentBlocks(ab_even))};
    out[3] = Doubles{hn::OddEvenBlocks(cd_odd, hn::SwapAdjacentBlocks(ab_odd))};
#else
    static_assert(kDoubleLanes == 2);
    for (std::size_t k = 0; k < 4; k += 2) {
        const auto a = hn::LoadU(DoubleTag(), at(0) + k), b = hn::LoadU(DoubleTag(), at(1) + k);
        out[k] = Doubles{hn::InterleaveLower(DoubleTag(), a, b)};
        out[k + 1] = Doubles{hn::InterleaveUpper(DoubleTag(), a, b)};
    }
#endif
}

/// @param poses  (kDoubleLanes,)
HWY_INLINE WidePose read_poses(const Pose* const* poses) {
    Doubles first[4], second[4];
    read_four(poses, 0, first);
    read_four(poses, 3, second);
    return {{first[0], first[1], first[2]}, {second[0], second[1], second[2], second[3]}};
}

// The three floats at each pointer; a fourth is read and means nothing.
#if HWY_TARGET != HWY_SCALAR
template <int lanes>
HWY_INLINE auto blocks_at(const vec3* const* from) {
    if constexpr (lanes == 4) {
        return hn::LoadU(hn::Simd<float, 4, 0>(), &from[0]->x);
    } else {
        return hn::Combine(hn::Simd<float, lanes, 0>(), blocks_at<lanes / 2>(from + lanes / 2), blocks_at<lanes / 2>(from));
    }
}
#endif

/// @param from  (kLanes,), of boxes in shapes.
HWY_INLINE Floats3 read_half_extents(const vec3* const* from) {
#if HWY_TARGET == HWY_SCALAR
    return {from[0]->x, from[0]->y, from[0]->z};
#else
    Floats x{blocks_at<kLanes>(from)}, y{blocks_at<kLanes>(from + 1)}, z{blocks_at<kLanes>(from + 2)}, nothing{blocks_at<kLanes>(from + 3)};
    transpose_blocks(x, y, z, nothing);
    return {x, y, z};
#endif
}

}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
