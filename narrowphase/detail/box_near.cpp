// Which of many pairs of boxes are not apart, and how they lie: from poses in double to pairs in the frames of their first boxes.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_near.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes_doubles.hpp>
#include <carom/narrowphase/detail/box_axes_lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/narrow_lanes.hpp>
#include <carom/narrowphase/detail/pose_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

constexpr std::size_t kStep = static_cast<std::size_t>(kLanes);
constexpr int kParts = kLanes / kDoubleLanes;  // vectors of doubles to one of floats
constexpr std::size_t kAhead = 32;             // pairs whose poses are fetched: they are read once, and in no order of memory
constexpr float kMostDistance = 1e30f;         // beyond, differences of positions may leave the range of floats

// One box of each lane: where it lies in memory.
struct Sources {
    const Pose* pose[kStep];
    const vec3* half[kStep];
};

// A double as three floats that add up to it.
struct ThreeParts {
    Floats part[3];
};
// One box of each lane, in the world.
struct WideBox {
    Floats3 axis[3];
    Floats3 half;
    ThreeParts position[3];
};

using HalfTag = hn::Rebind<float, DoubleTag>;  // as many floats as there are doubles in a vector
using HalfFloats = hn::Vec<HalfTag>;

HWY_INLINE HalfFloats to_half(Doubles a) { return hn::DemoteTo(HalfTag(), a.raw); }
#if HWY_TARGET == HWY_SCALAR
HWY_INLINE Floats joined(const HalfFloats (&parts)[kParts]) { return Floats{parts[0]}; }
#else
HWY_INLINE Floats joined(const HalfFloats (&parts)[kParts]) { return Floats{hn::Combine(FloatTag(), parts[1], parts[0])}; }
#endif

// As glm::mat3_cast() has the axes.
HWY_INLINE void read_axes(const WidePose& pose, HalfFloats (&axis)[9][kParts], int part) {
    const Doubles x = pose.orientation[0], y = pose.orientation[1], z = pose.orientation[2], w = pose.orientation[3];
    const Doubles xx = x * x, yy = y * y, zz = z * z, xz = x * z, xy = x * y, yz = y * z, wx = w * x, wy = w * y, wz = w * z;
    const Doubles one(1.0), two(2.0);
    const Doubles axes[9] = {one - two * (yy + zz), two * (xy + wz),       two * (xz - wy),  //
                             two * (xy - wz),       one - two * (xx + zz), two * (yz + wx),  //
                             two * (xz + wy),       two * (yz - wx),       one - two * (xx + yy)};
#pragma GCC unroll 9
    for (int k = 0; k < 9; ++k) axis[k][part] = to_half(axes[k]);
}

HWY_INLINE WideBox read_boxes(const Sources& from) {
    HalfFloats axis[9][kParts], position[9][kParts];
#pragma GCC unroll 2
    for (int part = 0; part < kParts; ++part) {
        const WidePose pose = read_poses(from.pose + part * kDoubleLanes);
        read_axes(pose, axis, part);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) {
            Doubles rest = pose.position[i];
#pragma GCC unroll 3
            for (int k = 0; k < 3; ++k) {
                position[3 * i + k][part] = to_half(rest);
                rest = rest - Doubles(hn::PromoteTo(DoubleTag(), position[3 * i + k][part]));
            }
        }
    }
    const auto row = [&](int k) { return Floats3{joined(axis[k]), joined(axis[k + 1]), joined(axis[k + 2])}; };
    const auto parts = [&](int k) { return ThreeParts{{joined(position[k]), joined(position[k + 1]), joined(position[k + 2])}}; };
    return {{row(0), row(3), row(6)}, read_half_extents(from.half), {parts(0), parts(3), parts(6)}};
}

HWY_INLINE Floats longest(const WideBox& box) { return max(max(box.half.x, box.half.y), box.half.z); }
HWY_INLINE Floats diagonal(const WideBox& box) { return length(box.half); }

// A difference or a sum, and what its rounding took (Knuth 1969, vol. 2, 4.2.2, theorem B).
struct Rounded {
    Floats value, error;
};
HWY_INLINE Rounded sum_of(Floats a, Floats b) {
    const Floats sum = a + b, b_seen = sum - a;
    return {sum, (a - (sum - b_seen)) + (b - b_seen)};
}

// A coordinate of B's centre from A's, in the world: the parts may cancel, so what rounding takes of the first two differences is kept.
HWY_INLINE Floats difference(const ThreeParts& from, const ThreeParts& to) {
    const Rounded large = sum_of(to.part[0], -from.part[0]), middle = sum_of(to.part[1], -from.part[1]);
    const Rounded sum = sum_of(large.value, middle.value);
    return sum.value + ((sum.error + (large.error + middle.error)) + (to.part[2] - from.part[2]));
}

// What float cannot take as it is.
HWY_INLINE Mask is_unusual(const WideBox& a, const WideBox& b, Floats margin) {
    const Floats most_a = longest(a), most_b = longest(b), most = max(most_a, most_b), reach(kUnusualRatio), far(kMostDistance);
    const Mask sizes = (most_a > reach * (diagonal(b) + margin)) | (most_b > reach * (diagonal(a) + margin));
    Floats distance(0.0f);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) distance = max(max(abs(a.position[i].part[0]), abs(b.position[i].part[0])), distance);
    return (margin != margin) | sizes | (most <= Floats(kSmallestUsual)) | (most >= Floats(kLargestUsual)) | (distance > far);
}

HWY_INLINE WidePair pair_of(const WideBox& a, const WideBox& b, Floats margin) {
    const Floats3 offset{difference(a.position[0], b.position[0]), difference(a.position[1], b.position[1]),
                         difference(a.position[2], b.position[2])};
    const auto row = [&](int i) { return Floats3{dot(a.axis[i], b.axis[0]), dot(a.axis[i], b.axis[1]), dot(a.axis[i], b.axis[2])}; };
    return {a.half, b.half, {row(0), row(1), row(2)}, {dot(a.axis[0], offset), dot(a.axis[1], offset), dot(a.axis[2], offset)}, margin};
}

// Of poses that are not finite, which are refused once all is done, rotation or offset are not either.
HWY_INLINE Mask is_finite(const WidePair& pair) {
    const auto sum = [](const Floats3& v) { return (v.x + v.y) + v.z; };
    const Floats all = (sum(pair.rotation[0]) + sum(pair.rotation[1])) + (sum(pair.rotation[2]) + sum(pair.offset));
    return abs(all) < Floats(std::numeric_limits<float>::infinity());
}

HWY_INLINE void append(const WidePair& pair, const WideBox& a, const BestAxis& best, Mask unusual, Ints number, Mask kept,
                       BoxPairBlock& out) {
    const std::size_t at = out.count;
    const auto put = [&](Floats x, float* to) { compress_store(as_ints(x), kept, reinterpret_cast<std::int32_t*>(to) + at); };
    const auto put_three = [&](const Floats3& v, BoxPairBlock::Column* to) { put(v.x, to[0]), put(v.y, to[1]), put(v.z, to[2]); };
    put_three(pair.half_a, out.half_a), put_three(pair.half_b, out.half_b), put_three(pair.offset, out.offset);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) put_three(pair.rotation[i], out.rotation[i]), put_three(a.axis[i], out.axis_a[i]);
    put(pair.margin, out.margin), put(best.separation, out.separation);
    compress_store(best.code, kept, out.code + at);
    if (any(unusual & kept)) {
        if (!out.any_unusual) std::fill_n(out.unusual, at, 0);
        out.any_unusual = true;
    }
    if (out.any_unusual) compress_store(select(unusual, Ints(1), Ints(0)), kept, out.unusual + at);
    out.count += compress_store(number, kept, out.pair + at);
}

// Where the boxes of as many pairs as there are lanes lie. Those that follow are fetched: poses are read once, and in any order.
struct Bundle {
    Sources a, b;
    alignas(64) float margin[kStep];
    alignas(64) std::int32_t number[kStep];
};
HWY_INLINE void find_sources(const BatchInput& input, const std::uint32_t* chosen, Bundle& out) {
    const NumberedPair* const pairs = input.pairs.data();
    const Pose* const poses = input.placed.poses.data();
    const Shape* const* const shapes = input.placed.shapes.data();
    const std::size_t pair_count = input.pairs.size();
    for (std::size_t l = 0; l < kStep; ++l) {
        const std::size_t i = chosen[l];
        const NumberedPair &pair = pairs[i], &next = pairs[std::min(i + kAhead, pair_count - 1)];
        hwy::Prefetch(&poses[next.a].orientation);
        hwy::Prefetch(&poses[next.b].orientation);
        out.a.pose[l] = poses + pair.a, out.b.pose[l] = poses + pair.b;
        out.a.half[l] = &as<Box>(*shapes[pair.a]).half_extents, out.b.half[l] = &as<Box>(*shapes[pair.b]).half_extents;
        out.margin[l] = pair.margin + pair.slack;
        out.number[l] = static_cast<std::int32_t>(i);
    }
}

void FindNear(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxPairBlock& out) {
    Bundle from;
    std::uint32_t last[kStep];
    for (std::size_t first = 0; first < chosen.size(); first += kStep) {
        const std::size_t count = std::min(kStep, chosen.size() - first);
        if (count < kStep) {  // the last stands in for those that are not there
            for (std::size_t l = 0; l < kStep; ++l) last[l] = chosen[first + std::min(l, count - 1)];
        }
        find_sources(input, count < kStep ? last : chosen.data() + first, from);
        const WideBox a = read_boxes(from.a), b = read_boxes(from.b);
        const Floats margin = load(from.margin);
        const WidePair pair = pair_of(a, b, margin);
        const Mask unusual = is_unusual(a, b, margin);
        const BestAxis best = best_axis(pair);
        const Mask kept = (((!best.apart) & is_finite(pair)) | unusual) & first_lanes(static_cast<int>(count));
        append(pair, a, best, unusual, load(from.number), kept, out);
    }
}

void FindAxes(BoxPairBlock& block, std::size_t bundle, int lanes) {
    for (std::size_t k = bundle * kBundleWidth; k < bundle * kBundleWidth + static_cast<std::size_t>(lanes); k += kStep) {
        const auto three = [k](const BoxPairBlock::Column* from) {
            return Floats3{load(from[0] + k), load(from[1] + k), load(from[2] + k)};
        };
        const WidePair pair{three(block.half_a),
                            three(block.half_b),
                            {three(block.rotation[0]), three(block.rotation[1]), three(block.rotation[2])},
                            three(block.offset),
                            load(block.margin + k)};
        const BestAxis best = best_axis(pair);
        store(best.separation, block.separation + k);
        store(best.code, block.code + k);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(FindNear);
HWY_EXPORT(FindAxes);

void find_near_boxes(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxPairBlock& out, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(FindNear)(input, chosen, out);
    HWY_DYNAMIC_DISPATCH(FindNear)(input, chosen, out);
}
void find_box_axes(BoxPairBlock& block, std::size_t bundle, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(FindAxes)(block, bundle, 1);
    HWY_DYNAMIC_DISPATCH(FindAxes)(block, bundle, kBundleWidth);
}
}  // namespace carom::detail
#endif
