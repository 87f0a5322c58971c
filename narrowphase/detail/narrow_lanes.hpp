// A kernel on the narrowest lanes that there are: for a single pair, which the widest ones would take longer over.
//
//   HWY_EXPORT(FindAxes);
//   CAROM_NARROW_DISPATCH(FindAxes)(pairs, axes, 1);   // where else HWY_DYNAMIC_DISPATCH stands
#pragma once

#include <carom/core/simd_targets.hpp>

#include <hwy/highway.h>
#include <hwy/targets.h>

#include <cstdint>

namespace carom::detail {

/// @return whether the processor has the instructions of a target.
template <std::int64_t target>
[[nodiscard]] bool has_target() noexcept {
    static const bool has = (hwy::SupportedTargets() & target) != 0;
    return has;
}

}  // namespace carom::detail

#if HWY_TARGETS & HWY_SSE4
#define CAROM_NARROW_DISPATCH(function) (*(carom::detail::has_target<HWY_SSE4>() ? &N_SSE4::function : &HWY_DYNAMIC_DISPATCH(function)))
#else
#define CAROM_NARROW_DISPATCH(function) HWY_DYNAMIC_DISPATCH(function)
#endif
