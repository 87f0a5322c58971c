#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/core/simd_width.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

int lane_count() { return kLanes; }

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <carom/core/check.hpp>
#include <carom/core/simd_width.hpp>

#include <hwy/targets.h>

#include <cstdint>
#include <string>

namespace carom {
namespace {

HWY_EXPORT(lane_count);

// What the processor has of what was compiled, asked before anything is masked.
std::int64_t machine_targets() {
    static const std::int64_t targets = hwy::SupportedTargets() & (HWY_TARGETS);
    return targets;
}

// Runs kernels on the best of `targets`.
void choose(std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

constexpr int width_of(std::int64_t target) {
    switch (target) {
#if HWY_ARCH_X86
        case HWY_AVX3: return 16;
        case HWY_AVX2: return 8;
#endif
        case HWY_SCALAR: return 1;
        default: return 4;
    }
}

// The best target of that width, 0 if there is none: lower bits are better targets.
std::int64_t target_of(int width) {
    for (std::int64_t rest = machine_targets(); rest != 0; rest &= rest - 1) {
        if (width_of(rest & -rest) == width) return rest & -rest;
    }
    return 0;
}

}  // namespace

int simd_width() { return HWY_DYNAMIC_DISPATCH(lane_count)(); }

std::vector<int> available_simd_widths() {
    std::vector<int> widths;
    for (const int width : {1, 4, 8, 16}) {
        if (target_of(width) != 0) widths.push_back(width);
    }
    return widths;
}

void set_simd_width(int width) {
    const std::int64_t target = width == 0 ? machine_targets() : target_of(width);
    CAROM_REQUIRE(target != 0, ErrorCode::InvalidArgument,
                  "no kernels of SIMD width " + std::to_string(width) + " on this machine");
    choose(target);
}

}  // namespace carom

#endif  // HWY_ONCE
