#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/broadphase/detail/overlap_kernel.cpp>
#include <hwy/foreach_target.h>

#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/core/lanes.hpp>

#include <carom/broadphase/detail/scan.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

template <bool sorted>
void overlaps_of_range(const Entries& e, std::size_t begin, std::size_t end, std::size_t last, PairBuffer& out) {
    const float* const lower0 = e.lower[0].data();
    const float* const upper0 = e.upper[0].data();
    const float* const lower1 = e.lower[1].data();
    const float* const upper1 = e.upper[1].data();
    const float* const lower2 = e.lower[2].data();
    const float* const upper2 = e.upper[2].data();
    const std::int32_t* const tag = e.tag.data();
    const Ints barred{static_cast<std::int32_t>(~kIndexMask)}, index{static_cast<std::int32_t>(kIndexMask)};
    for (std::size_t i = begin; i < end && !out.is_full(); ++i) {
        const Floats my_lower0 = lower0[i], my_lower1 = lower1[i], my_lower2 = lower2[i];
        const Floats my_upper0 = upper0[i], my_upper1 = upper1[i], my_upper2 = upper2[i];
        const Ints my_tag = tag[i];
        for (std::size_t j = i + 1; sorted || j < last; j += kLanes) {
            const Mask begun = load_unaligned(lower0 + j) <= my_upper0;
            Mask hit = begun & (load_unaligned(lower1 + j) <= my_upper1) & (load_unaligned(upper1 + j) >= my_lower1) &
                       (load_unaligned(lower2 + j) <= my_upper2) & (load_unaligned(upper2 + j) >= my_lower2);
            if constexpr (!sorted) hit = hit & (load_unaligned(upper0 + j) >= my_lower0);
            if (any(hit)) {
                const Ints tags = load_unaligned(tag + j);
                hit = hit & ((tags & my_tag & barred) == Ints{0});
                add_pairs(my_tag & index, tags & index, hit, out);
            }
            if (sorted && !all(begun)) break;
        }
    }
}

void overlaps_sorted(const Entries& e, std::size_t begin, std::size_t end, std::size_t last, PairBuffer& out) {
    overlaps_of_range<true>(e, begin, end, last, out);
}
void overlaps_any(const Entries& e, std::size_t begin, std::size_t end, std::size_t last, PairBuffer& out) {
    overlaps_of_range<false>(e, begin, end, last, out);
}

void begun_of_movers(const Entries& e, std::size_t end, std::span<const Mover> movers, PairBuffer& out) {
    for (const Mover& m : movers) {
        if (out.is_full()) return;
        scan_begun(e, 0, end, MovedBox(m), out);
    }
}

std::uint64_t near_of_range(const Entries& e, std::size_t begin, std::size_t end, const FloatAabb& box) {
    std::uint64_t near = 0;
    for (std::size_t i = begin; i < end; i += kLanes) {
        Mask hit =
            (load_unaligned(e.lower[0].data() + i) <= Floats(box.upper.x)) & (load_unaligned(e.upper[0].data() + i) >= Floats(box.lower.x));
        hit = hit & (load_unaligned(e.lower[1].data() + i) <= Floats(box.upper.y)) &
              (load_unaligned(e.upper[1].data() + i) >= Floats(box.lower.y));
        hit = hit & (load_unaligned(e.lower[2].data() + i) <= Floats(box.upper.z)) &
              (load_unaligned(e.upper[2].data() + i) >= Floats(box.lower.z));
        near |= std::uint64_t{bits(hit)} << (i - begin);
    }
    const std::size_t count = end - begin;  // sentinels overlap what is open on all sides
    return count < 64 ? near & ((std::uint64_t{1} << count) - 1) : near;
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <limits>

namespace carom::detail {

HWY_EXPORT(overlaps_sorted);
HWY_EXPORT(overlaps_any);
HWY_EXPORT(begun_of_movers);
HWY_EXPORT(near_of_range);

std::uint64_t find_near(const Entries& entries, std::size_t begin, std::size_t end, const FloatAabb& box) {
    return HWY_DYNAMIC_DISPATCH(near_of_range)(entries, begin, end, box);
}

void find_begun(const Entries& entries, std::size_t end, std::span<const Mover> movers, PairBuffer& out) {
    HWY_DYNAMIC_DISPATCH(begun_of_movers)(entries, end, movers, out);
}

void find_overlaps(const Entries& entries, std::size_t begin, std::size_t end, std::size_t last, Order order, PairBuffer& out) {
    if (order == Order::Sorted) {
        HWY_DYNAMIC_DISPATCH(overlaps_sorted)(entries, begin, end, last, out);
    } else {
        HWY_DYNAMIC_DISPATCH(overlaps_any)(entries, begin, end, last, out);
    }
}

void Entries::grow(std::size_t size) {
    size += kSentinels;  // a sentinel is looked at too, and reads as far ahead as a box
    if (tag.size() >= size) return;
    size += size / 4;  // sizes drift from step to step
    for (int k = 0; k < 3; ++k) {
        lower[k].resize(size);
        upper[k].resize(size);
    }
    tag.resize(size);
}

void Entries::close(std::size_t end) noexcept {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (std::size_t i = end; i < end + kSentinels; ++i) {
        for (int k = 0; k < 3; ++k) {
            lower[k][i] = kInfinity;
            upper[k][i] = -kInfinity;
        }
        tag[i] = 0;
    }
}

}  // namespace carom::detail

#endif  // HWY_ONCE
