// Rows of memory to lanes and back: gather and scatter by 128-bit loads and in-register transposes, which beat the
// hardware's gather on every machine we measured. Included by core/lanes.hpp, which says how kernel files are written.
//
//   Floats x, y, z, w;
//   gather_rows(positions, bundle.body + lane, 4, 0, x, y, z, w);   // lane l reads positions[4 * body[l] + 0 .. + 3]

#if defined(CAROM_CORE_LANES_ROWS_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_CORE_LANES_ROWS_HPP
#undef CAROM_CORE_LANES_ROWS_HPP
#else
#define CAROM_CORE_LANES_ROWS_HPP
#endif

#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {

/// Transposes the 4 x 4 matrix in each 128-bit block of a, b, c, d; its own inverse.
HWY_INLINE void transpose_blocks(Floats& a, Floats& b, Floats& c, Floats& d) {
#if HWY_TARGET != HWY_SCALAR
    const hn::Repartition<std::uint64_t, FloatTag> wide;
    const auto ab_low = hn::BitCast(wide, hn::InterleaveLower(FloatTag(), a.raw, b.raw));
    const auto ab_high = hn::BitCast(wide, hn::InterleaveUpper(FloatTag(), a.raw, b.raw));
    const auto cd_low = hn::BitCast(wide, hn::InterleaveLower(FloatTag(), c.raw, d.raw));
    const auto cd_high = hn::BitCast(wide, hn::InterleaveUpper(FloatTag(), c.raw, d.raw));
    a = Floats{hn::BitCast(FloatTag(), hn::InterleaveLower(wide, ab_low, cd_low))};
    b = Floats{hn::BitCast(FloatTag(), hn::InterleaveUpper(wide, ab_low, cd_low))};
    c = Floats{hn::BitCast(FloatTag(), hn::InterleaveLower(wide, ab_high, cd_high))};
    d = Floats{hn::BitCast(FloatTag(), hn::InterleaveUpper(wide, ab_high, cd_high))};
#else
    static_cast<void>(a), static_cast<void>(b), static_cast<void>(c), static_cast<void>(d);
#endif
}

namespace detail {

#if HWY_TARGET != HWY_SCALAR
using BlockTag = hn::Simd<float, 4, 0>;

/// @return four floats each of rows[0], rows[4], ... , a block each.
template <int lanes>
HWY_INLINE auto load_blocks(const float* base, const std::int32_t* rows, std::size_t stride) {
    if constexpr (lanes == 4) {
        return hn::LoadU(BlockTag(), base + static_cast<std::size_t>(rows[0]) * stride);
    } else {
        const auto low = load_blocks<lanes / 2>(base, rows, stride);
        const auto high = load_blocks<lanes / 2>(base, rows + lanes / 2, stride);
        return hn::Combine(hn::Simd<float, lanes, 0>(), high, low);
    }
}

/// Writes the first blocks of a, b, c, d to rows[0 .. 3], the second ones to rows[4 .. 7], and so on; rows >= limit are
/// left alone.
template <int lanes, class V>
HWY_INLINE void store_blocks(V a, V b, V c, V d, float* base, const std::int32_t* rows, std::size_t stride,
                             std::int32_t limit) {
    if constexpr (lanes == 4) {
        if (rows[0] < limit) hn::Store(a, BlockTag(), base + static_cast<std::size_t>(rows[0]) * stride);
        if (rows[1] < limit) hn::Store(b, BlockTag(), base + static_cast<std::size_t>(rows[1]) * stride);
        if (rows[2] < limit) hn::Store(c, BlockTag(), base + static_cast<std::size_t>(rows[2]) * stride);
        if (rows[3] < limit) hn::Store(d, BlockTag(), base + static_cast<std::size_t>(rows[3]) * stride);
    } else {
        const hn::Simd<float, lanes / 2, 0> half;
        store_blocks<lanes / 2>(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c),
                                hn::LowerHalf(half, d), base, rows, stride, limit);
        store_blocks<lanes / 2>(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c),
                                hn::UpperHalf(half, d), base, rows + lanes / 2, stride, limit);
    }
}
#endif

}  // namespace detail

/// Lane l of a, b, c, d becomes the four floats at base + rows[l] * row_stride + column.
/// @param rows        (kLanes,), >= 0; repeats are allowed.
/// @param row_stride  in floats. Reads of any alignment are right; those that straddle a cache line cost more.
HWY_INLINE void gather_rows(const float* base, const std::int32_t* rows, std::size_t row_stride, std::size_t column,
                            Floats& a, Floats& b, Floats& c, Floats& d) {
    base += column;
#if HWY_TARGET == HWY_SCALAR
    const float* row = base + static_cast<std::size_t>(rows[0]) * row_stride;
    a = row[0], b = row[1], c = row[2], d = row[3];
#else
    a = Floats{detail::load_blocks<kLanes>(base, rows, row_stride)};
    b = Floats{detail::load_blocks<kLanes>(base, rows + 1, row_stride)};
    c = Floats{detail::load_blocks<kLanes>(base, rows + 2, row_stride)};
    d = Floats{detail::load_blocks<kLanes>(base, rows + 3, row_stride)};
    transpose_blocks(a, b, c, d);
#endif
}

/// Writes lane l of a, b, c, d to the four floats at base + rows[l] * row_stride + column, in lane order: of lanes that
/// share a row, the last one's values stay. `base`, `row_stride` and `column` keep every write 16-byte aligned.
/// @param limit  rows >= limit are not written: data that must not change and that other threads may read.
HWY_INLINE void scatter_rows(float* base, const std::int32_t* rows, std::size_t row_stride, std::size_t column, Floats a,
                             Floats b, Floats c, Floats d, std::int32_t limit = INT32_MAX) {
    base += column;
#if HWY_TARGET == HWY_SCALAR
    if (rows[0] >= limit) return;
    float* row = base + static_cast<std::size_t>(rows[0]) * row_stride;
    hn::StoreU(a.raw, FloatTag(), row);
    hn::StoreU(b.raw, FloatTag(), row + 1);
    hn::StoreU(c.raw, FloatTag(), row + 2);
    hn::StoreU(d.raw, FloatTag(), row + 3);
#else
    transpose_blocks(a, b, c, d);
    detail::store_blocks<kLanes>(a.raw, b.raw, c.raw, d.raw, base, rows, row_stride, limit);
#endif
}

namespace detail {

#if HWY_TARGET != HWY_SCALAR
/// Adds eight floats of each of `rows`, whose low halves stand in the blocks of `low` and whose high halves in those of `high`.
template <int lanes, class V>
HWY_INLINE void add_blocks(V low, V high, float* base, const std::int32_t* rows, std::size_t stride, std::int32_t limit) {
    if constexpr (lanes == 4) {
        if (rows[0] >= limit) return;
        float* const row = base + static_cast<std::size_t>(rows[0]) * stride;
        hn::Store(hn::Add(hn::Load(BlockTag(), row), low), BlockTag(), row);
        hn::Store(hn::Add(hn::Load(BlockTag(), row + 4), high), BlockTag(), row + 4);
    } else if constexpr (lanes == 8) {  // a row is as long as a register
        const hn::Simd<float, lanes, 0> whole;
        float* const first = base + static_cast<std::size_t>(rows[0]) * stride;
        if (rows[0] < limit) hn::Store(hn::Add(hn::Load(whole, first), hn::ConcatLowerLower(whole, high, low)), whole, first);
        float* const second = base + static_cast<std::size_t>(rows[4]) * stride;
        if (rows[4] < limit) hn::Store(hn::Add(hn::Load(whole, second), hn::ConcatUpperUpper(whole, high, low)), whole, second);
    } else {
        const hn::Simd<float, lanes / 2, 0> half;
        add_blocks<lanes / 2>(hn::LowerHalf(half, low), hn::LowerHalf(half, high), base, rows, stride, limit);
        add_blocks<lanes / 2>(hn::UpperHalf(half, low), hn::UpperHalf(half, high), base, rows + lanes / 2, stride, limit);
    }
}
#endif

}  // namespace detail

/// Adds lane l of v[0 .. 7] to the eight floats at base + rows[l] * row_stride. Rows below the limit differ from lane to lane; `base` and
/// `row_stride` keep every row 32-byte aligned.
/// @param limit  rows >= limit are left alone, and not read.
HWY_INLINE void add_rows(float* base, const std::int32_t* rows, std::size_t row_stride, Floats (&v)[8], std::int32_t limit) {
#if HWY_TARGET == HWY_SCALAR
    if (rows[0] >= limit) return;
    float* row = base + static_cast<std::size_t>(rows[0]) * row_stride;
    for (std::size_t k = 0; k < 8; ++k) hn::StoreU((Floats{row[k]} + v[k]).raw, FloatTag(), row + k);
#else
    transpose_blocks(v[0], v[1], v[2], v[3]);
    transpose_blocks(v[4], v[5], v[6], v[7]);
    for (int k = 0; k < 4; ++k) detail::add_blocks<kLanes>(v[k].raw, v[4 + k].raw, base, rows + k, row_stride, limit);
#endif
}

}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
