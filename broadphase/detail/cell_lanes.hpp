// The cells of many corners at once.
//
//   const WideMap rows(level.map, 1);                 // inside a kernel file, after core/lanes.hpp
//   Ints row = rows.coordinate(load_unaligned(lower));

// This guard lets the file through once for each target.
#if defined(CAROM_BROADPHASE_CELL_LANES_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_BROADPHASE_CELL_LANES_HPP
#undef CAROM_BROADPHASE_CELL_LANES_HPP
#else
#define CAROM_BROADPHASE_CELL_LANES_HPP
#endif

#include <carom/broadphase/detail/grid_level.hpp>
#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

// CellMap's coordinates along an axis, to the bit.
struct WideMap {
    Floats origin, per_metre, last, reach;
    HWY_INLINE WideMap(const CellMap& map, int k)
        : origin(map.origin[k]), per_metre(map.per_metre[k]), last(map.last[k]), reach(map.reach[k]) {}
    HWY_INLINE Ints coordinate(Floats x) const { return truncate(max(min((x - origin) * per_metre, last), Floats{0.0f})); }
    HWY_INLINE Ints reaching(Floats lower) const {
        return coordinate((lower - reach) - Floats{CellMap::kRounding} * (abs(lower) + reach));
    }
};

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
