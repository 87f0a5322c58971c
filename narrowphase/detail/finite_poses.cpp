// Whether many poses are finite, as wide as the machine allows.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/finite_poses.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/finite_poses.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

bool PosesAreFinite(std::span<const Pose> poses) {
    // x - x is 0 for finite numbers and NaN for all others, and a NaN survives the sum.
    const hn::CappedTag<double, 8> tag;
    constexpr std::size_t kStep = hn::MaxLanes(hn::CappedTag<double, 8>());
    const auto* const numbers = reinterpret_cast<const double*>(poses.data());
    const std::size_t count = 7 * poses.size();
    auto sum = hn::Zero(tag), second = sum, third = sum, fourth = sum;  // several, so that no addition waits for the one before
    std::size_t i = 0;
    for (; i + 4 * kStep <= count; i += 4 * kStep) {
        const auto a = hn::LoadU(tag, numbers + i), b = hn::LoadU(tag, numbers + i + kStep);
        const auto c = hn::LoadU(tag, numbers + i + 2 * kStep), d = hn::LoadU(tag, numbers + i + 3 * kStep);
        sum = hn::Add(sum, hn::Sub(a, a)), second = hn::Add(second, hn::Sub(b, b));
        third = hn::Add(third, hn::Sub(c, c)), fourth = hn::Add(fourth, hn::Sub(d, d));
    }
    sum = hn::Add(hn::Add(sum, second), hn::Add(third, fourth));
    for (; i + kStep <= count; i += kStep) {
        const auto x = hn::LoadU(tag, numbers + i);
        sum = hn::Add(sum, hn::Sub(x, x));
    }
    bool finite = hn::AllTrue(tag, hn::Eq(sum, hn::Zero(tag)));
    for (; i < count; ++i) finite = finite && numbers[i] - numbers[i] == 0.0;
    return finite;
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(PosesAreFinite);
bool poses_are_finite(std::span<const Pose> poses) { return HWY_DYNAMIC_DISPATCH(PosesAreFinite)(poses); }
}  // namespace carom::detail
#endif
