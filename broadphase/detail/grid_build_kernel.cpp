// What building a grid level does box by box, many at once: where boxes lie, their cells, their copies in the order of the cells.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/broadphase/detail/grid_build_kernel.cpp>
#include <hwy/foreach_target.h>

#include <carom/broadphase/detail/grid_level.hpp>
#include <carom/core/lanes.hpp>

#include <carom/broadphase/detail/cell_lanes.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::int32_t kFloatsABox = sizeof(FloatAabb) / sizeof(float);
static_assert(sizeof(FloatAabb) == 6 * sizeof(float));

// Slots i .. i + kLanes - 1 of a list; beyond its end the last one again.
HWY_INLINE Ints slots_at(std::span<const std::uint32_t> slots, std::size_t i) {
    const auto* const list = reinterpret_cast<const std::int32_t*>(slots.data());  // below 2^28, or kNobody
    if (i + kLanes <= slots.size()) return load_unaligned(list + i);
    alignas(64) std::int32_t lanes[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) lanes[k] = list[std::min(i + k, slots.size() - 1)];
    return load(lanes);
}

// Where boxes begin, counted in floats.
HWY_INLINE Ints places_of(Ints slots) {
    const Ints twice = slots + slots;
    return twice + (twice + twice);
}

CornerSpread corner_spread(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots) {
    const float* const floats = &boxes[0].lower.x;
    Floats low[3], high[3], edge[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = Floats{kInfinity};
        high[k] = Floats{-kInfinity};
    }
    for (std::size_t i = 0; i < slots.size(); i += kLanes) {
        const Ints at = places_of(slots_at(slots, i));
        for (int k = 0; k < 3; ++k) {
            const Floats lower = gather(floats + k, at), upper = gather(floats + 3 + k, at);
            low[k] = min(low[k], lower);
            high[k] = max(high[k], lower);
            edge[k] = max(edge[k], upper - lower);
        }
    }
    CornerSpread out;
    for (int k = 0; k < 3; ++k) {
        out.low[k] = least_lane(low[k]);
        out.high[k] = greatest_lane(high[k]);
        out.edge[k] = std::nextafter(greatest_lane(edge[k]), kInfinity);
    }
    return out;
}

void homes(const CellMap& map, std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots, std::uint32_t* cell,
           std::uint32_t* code) {
    const float* const floats = &boxes[0].lower.x;
    alignas(64) std::int32_t c[3][kLanes];
    for (std::size_t i = 0; i < slots.size(); i += kLanes) {
        const Ints at = places_of(slots_at(slots, i));
        for (int k = 0; k < 3; ++k) {
            store(WideMap(map, k).coordinate(gather(floats + map.axes[k], at)), c[k]);
        }
        const std::size_t count = std::min(slots.size() - i, static_cast<std::size_t>(kLanes));
        for (std::size_t k = 0; k < count; ++k) {
            const auto x = static_cast<std::uint32_t>(c[0][k]), y = static_cast<std::uint32_t>(c[1][k]),
                       z = static_cast<std::uint32_t>(c[2][k]);
            cell[i + k] = map.cell(x, y, z);
            if (map.hashed) code[i + k] = CellMap::code(x, y, z);
        }
    }
}

void fill(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> order, std::size_t first, std::size_t last, const int axes[3],
          Entries& entries) {
    const float* const floats = &boxes[0].lower.x;
    static_assert(kEntriesAtOnce % kLanes == 0);
    for (std::size_t i = first; i < last; i += kLanes) {
        const Ints slots = slots_at(order, i);
        const Mask empty = slots < Ints{0};
        const Ints tags = select(empty, Ints{0}, slots), at = places_of(tags);
        for (int k = 0; k < 3; ++k) {
            store_unaligned(select(empty, Floats{kInfinity}, gather(floats + axes[k], at)), entries.lower[k].data() + i);
            store_unaligned(select(empty, Floats{-kInfinity}, gather(floats + 3 + axes[k], at)), entries.upper[k].data() + i);
        }
        store_unaligned(tags, entries.tag.data() + i);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::detail {

HWY_EXPORT(corner_spread);
HWY_EXPORT(homes);
HWY_EXPORT(fill);

CornerSpread spread_of(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots) {
    return HWY_DYNAMIC_DISPATCH(corner_spread)(boxes, slots);
}
void find_homes(const CellMap& map, std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots, std::uint32_t* cell,
                std::uint32_t* code) {
    HWY_DYNAMIC_DISPATCH(homes)(map, boxes, slots, cell, code);
}
void fill_entries(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> order, std::size_t first, std::size_t last,
                  const int axes[3], Entries& entries) {
    HWY_DYNAMIC_DISPATCH(fill)(boxes, order, first, last, axes, entries);
}

}  // namespace carom::detail

#endif  // HWY_ONCE
