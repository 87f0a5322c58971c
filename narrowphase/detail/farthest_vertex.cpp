#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/farthest_vertex.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/farthest_vertex.hpp>

#include <bit>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using DoubleTag = hn::CappedTag<double, 8>;
using NarrowTag = hn::Rebind<float, DoubleTag>;
using Doubles = hn::Vec<DoubleTag>;
constexpr std::size_t kStep = hn::MaxLanes(DoubleTag());
constexpr std::size_t kTwo = 2 * kBundleWidth;

struct Direction {
    Doubles x, y, z;
};

HWY_INLINE Doubles along(const ConvexHull::VertexBundle& points, std::size_t lane, const Direction& d) {
    const Doubles x = hn::PromoteTo(DoubleTag(), hn::Load(NarrowTag(), points.x.lane + lane));
    const Doubles y = hn::PromoteTo(DoubleTag(), hn::Load(NarrowTag(), points.y.lane + lane));
    const Doubles z = hn::PromoteTo(DoubleTag(), hn::Load(NarrowTag(), points.z.lane + lane));
    return hn::Add(hn::Add(hn::Mul(x, d.x), hn::Mul(y, d.y)), hn::Mul(z, d.z));
}

HWY_INLINE std::uint32_t equal_bits(Doubles a, Doubles b) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(DoubleTag(), hn::Eq(a, b), bytes);
    return bytes[0] & ((1u << kStep) - 1u);
}

std::uint32_t FarthestVertex(std::span<const ConvexHull::VertexBundle> points, const dvec3& direction) {
    const DoubleTag tag;
    const Direction d{hn::Set(tag, direction.x), hn::Set(tag, direction.y), hn::Set(tag, direction.z)};
    Doubles most = hn::Set(tag, -std::numeric_limits<double>::infinity());
    alignas(64) double kept[kTwo];  // of the first two bundles, so that hulls of up to 32 vertices need no second look and no branch
    const std::size_t count = points.size() * kBundleWidth;
    for (std::size_t i = 0; i < count; i += kStep) {
        const Doubles reach = along(points[i / kBundleWidth], i % kBundleWidth, d);
        if (i < kTwo) hn::Store(reach, tag, kept + i);
        most = hn::Max(most, reach);
    }
    const Doubles top = hn::MaxOfLanes(tag, most);
    std::uint32_t equal = 0;
    for (std::size_t i = 0; i < kTwo && i < count; i += kStep) equal |= equal_bits(hn::Load(tag, kept + i), top) << i;
    if (equal != 0) return static_cast<std::uint32_t>(std::countr_zero(equal));
    for (std::size_t i = kTwo; i < count; i += kStep) {
        const std::uint32_t bits = equal_bits(along(points[i / kBundleWidth], i % kBundleWidth, d), top);
        if (bits != 0) return static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(std::countr_zero(bits));
    }
    return 0;
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(FarthestVertex);
std::uint32_t farthest_vertex(std::span<const ConvexHull::VertexBundle> vertices, const dvec3& direction) noexcept {
    return HWY_DYNAMIC_DISPATCH(FarthestVertex)(vertices, direction);
}
}  // namespace carom::detail
#endif
