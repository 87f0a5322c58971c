// Arrays of structs into lanes: sixteen boxes or triangles as they lie in memory become one register for each of their numbers.
// Included by kernel files after core/lanes.hpp, which says how those are written.
//
//   Floats box[6];                                       // lower.x, lower.y, lower.z, upper.x, ...
//   load_records<6>(floats, first, count, box);          // lane l: record first + l, or the last one

#if defined(CAROM_COLLISION_DETAIL_RECORD_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_COLLISION_DETAIL_RECORD_LANES_HPP
#undef CAROM_COLLISION_DETAIL_RECORD_LANES_HPP
#else
#define CAROM_COLLISION_DETAIL_RECORD_LANES_HPP
#endif

#include <carom/core/bundle.hpp>
#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::geo::detail::HWY_NAMESPACE {

using namespace carom::HWY_NAMESPACE;

/// Lane l of x[k] becomes number k of the record first + l; lanes past the end repeat the last record.
/// @param records  (count * size,), first < count. @tparam size  at least 4.
template <int size>
HWY_INLINE void load_records(const float* records, std::size_t first, std::size_t count, Floats (&x)[size]) {
    std::int32_t rows[kLanes];
    const std::size_t last = count - 1 - first;
    for (int l = 0; l < kLanes; ++l) {
        const auto lane = static_cast<std::size_t>(l);
        rows[l] = static_cast<std::int32_t>(lane < last ? lane : last);
    }
    const float* const base = records + first * static_cast<std::size_t>(size);
    // The last four numbers overlap the four before them, rather than the end of the array.
    for (int k = 0;; k += 4) {
        const int column = k + 4 <= size ? k : size - 4;
        gather_rows(base, rows, static_cast<std::size_t>(size), static_cast<std::size_t>(column), x[column], x[column + 1], x[column + 2],
                    x[column + 3]);
        if (column + 4 == size) break;
    }
}

/// Writes the lanes below `count`.
HWY_INLINE void store_some(Floats x, std::size_t count, float* to) {
    if (count >= static_cast<std::size_t>(kLanes)) {
        store_unaligned(x, to);
        return;
    }
    FloatBundle lanes;
    store(x, lanes.lane);
    std::memcpy(to, lanes.lane, count * sizeof(float));
}

/// Writes 1 or 0 for each lane below `count`.
HWY_INLINE void store_truths(Mask m, std::size_t count, std::uint8_t* to) {
    std::uint8_t bytes[kLanes];
    const unsigned set = bits(m);
    for (int l = 0; l < kLanes; ++l) bytes[l] = static_cast<std::uint8_t>((set >> l) & 1u);
    if (count >= static_cast<std::size_t>(kLanes)) {
        std::memcpy(to, bytes, static_cast<std::size_t>(kLanes));
    } else {
        std::memcpy(to, bytes, count);
    }
}

/// Appends the numbers of the true lanes below `count` to `unclear`, which has room for kLanes more than it will ever hold.
HWY_INLINE std::size_t note_unclear(Mask m, std::size_t first, std::size_t count, std::int32_t* unclear) {
    if (none(m)) return 0;
    const int valid = count - first < static_cast<std::size_t>(kLanes) ? static_cast<int>(count - first) : kLanes;
    return compress_store(lane_numbers() + Ints{static_cast<std::int32_t>(first)}, m & first_lanes(valid), unclear);
}

}  // namespace carom::geo::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
