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

// Two boxes of each lane: axes and B's position from A's in the world.
struct WideBoxes {
    Floats3 axis_a[3], axis_b[3];
    Floats3 half_a, half_b;
    Floats3 between;
};

using HalfTag = hn::Rebind<float, DoubleTag>;  // as many floats as there are doubles in a vector
using HalfFloats = hn::Vec<HalfTag>;

#if HWY_TARGET == HWY_SCALAR
HWY_INLINE HalfFloats to_half(Doubles a) {
    return HalfFloats(static_cast<float>(a.raw.raw));
}  // DemoteTo() would make infinite numbers finite
HWY_INLINE Floats joined(const HalfFloats (&parts)[kParts]) { return Floats{parts[0]}; }
#else
HWY_INLINE HalfFloats to_half(Doubles a) { return hn::DemoteTo(HalfTag(), a.raw); }
HWY_INLINE Floats joined(const HalfFloats (&parts)[kParts]) { return Floats{hn::Combine(FloatTag(), parts[1], parts[0])}; }
#endif

// As glm::mat3_cast() has the axes, to the bit: factors are doubled and not sums, which is exact either way.
HWY_INLINE void read_axes(const WidePose& pose, HalfFloats (&axis)[9][kParts], int part) {
    const Doubles x = pose.orientation[0], y = pose.orientation[1], z = pose.orientation[2], w = pose.orientation[3];
    const Doubles x2 = x + x, y2 = y + y, z2 = z + z, one(1.0);
    const Doubles xx = x * x2, yy = y * y2, zz = z * z2, xz = x * z2, xy = x * y2, yz = y * z2, wx = w * x2, wy = w * y2, wz = w * z2;
    const Doubles axes[9] = {one - (yy + zz), xy + wz, xz - wy, xy - wz, one - (xx + zz), yz + wx, xz + wy, yz - wx, one - (xx + yy)};
#pragma GCC unroll 9
    for (int k = 0; k < 9; ++k) axis[k][part] = to_half(axes[k]);
}

// @tparam one  whether only the first lane counts: what is beyond the first vector of doubles is not read then.
template <bool one>
HWY_INLINE WideBoxes read_boxes(const Sources& from_a, const Sources& from_b) {
    HalfFloats axis_a[9][kParts], axis_b[9][kParts], between[3][kParts];
#pragma GCC unroll 2
    for (int part = 0; part < (one ? 1 : kParts); ++part) {
        const WidePose a = read_poses(from_a.pose + part * kDoubleLanes), b = read_poses(from_b.pose + part * kDoubleLanes);
        read_axes(a, axis_a, part);
        read_axes(b, axis_b, part);
#pragma GCC unroll 3
        for (int i = 0; i < 3; ++i) between[i][part] = to_half(b.position[i] - a.position[i]);
    }
    if constexpr (one) {
        for (int k = 0; k < 9; ++k) axis_a[k][kParts - 1] = axis_a[k][0], axis_b[k][kParts - 1] = axis_b[k][0];
        for (int i = 0; i < 3; ++i) between[i][kParts - 1] = between[i][0];
    }
    const auto row = [](const HalfFloats(&axis)[9][kParts], int k) {
        return Floats3{joined(axis[k]), joined(axis[k + 1]), joined(axis[k + 2])};
    };
    return {{row(axis_a, 0), row(axis_a, 3), row(axis_a, 6)},
            {row(axis_b, 0), row(axis_b, 3), row(axis_b, 6)},
            read_half_extents(from_a.half),
            read_half_extents(from_b.half),
            {joined(between[0]), joined(between[1]), joined(between[2])}};
}

HWY_INLINE Floats longest(const Floats3& v) { return max(max(v.x, v.y), v.z); }

// What float cannot take as it is.
HWY_INLINE Mask is_unusual(const WideBoxes& boxes, Floats margin) {
    const Floats most_a = longest(boxes.half_a), most_b = longest(boxes.half_b), most = max(most_a, most_b);
    const auto exceeds = [&](Floats size, const Floats3& other) {  // by much what the other reaches, which is compared without its root
        const Floats reach = size * Floats(1.0f / kUnusualRatio) - margin;
        return (reach > Floats(0.0f)) & (reach * reach > dot(other, other));
    };
    const Mask sizes = exceeds(most_a, boxes.half_b) | exceeds(most_b, boxes.half_a);
    const Floats distance = longest({abs(boxes.between.x), abs(boxes.between.y), abs(boxes.between.z)});
    return sizes | (most <= Floats(kSmallestUsual)) | (most >= Floats(kLargestUsual)) | (distance > Floats(kMostDistance));
}

HWY_INLINE WidePair pair_of(const WideBoxes& boxes, Floats margin) {
    const auto& a = boxes.axis_a;
    const auto& b = boxes.axis_b;
    const auto row = [&](int i) { return Floats3{dot(a[i], b[0]), dot(a[i], b[1]), dot(a[i], b[2])}; };
    return {boxes.half_a,
            boxes.half_b,
            {row(0), row(1), row(2)},
            {dot(a[0], boxes.between), dot(a[1], boxes.between), dot(a[2], boxes.between)},
            margin};
}

// Of poses that are not finite rotation or offset are not either: what is infinite or NaN stays so in sums and products.
HWY_INLINE Mask is_finite(const WidePair& pair) {
    const auto sum = [](const Floats3& v) { return (v.x + v.y) + v.z; };
    const Floats all = (sum(pair.rotation[0]) + sum(pair.rotation[1])) + (sum(pair.rotation[2]) + sum(pair.offset));
    return abs(all) < Floats(std::numeric_limits<float>::infinity());
}

// Whether no points of faces are looked for: edges decide, and neither face is square to the normal nor do both face it. Where rounding has
// it otherwise than build_box_patch(), either is right.
HWY_INLINE Mask by_edges_alone(const WidePair& pair, Ints code) {
    const Ints edge = code - Ints(kFirstEdge);
    const Mask is_edge = edge >= Ints(0), i0 = edge < Ints(3), i1 = edge < Ints(6);
    const Ints j = edge - select(i0, Ints(0), select(i1, Ints(3), Ints(6)));
    const Mask j0 = j == Ints(0), j1 = j == Ints(1);
    const auto& [r0, r1, r2] = pair.rotation;
    const Floats3 b{select(j0, r0.x, select(j1, r0.y, r0.z)), select(j0, r1.x, select(j1, r1.y, r1.z)),
                    select(j0, r2.x, select(j1, r2.y, r2.z))};
    const Floats zero(0.0f);
    const Floats3 n{select(i0, zero, select(i1, b.z, -b.y)), select(i0, -b.z, select(i1, zero, b.x)),
                    select(i0, b.y, select(i1, -b.x, zero))};
    const Floats3 along_b = n.x * r0 + (n.y * r1 + n.z * r2);
    const Floats facing_a = longest({n.x * n.x, n.y * n.y, n.z * n.z});
    const Floats facing_b = longest({along_b.x * along_b.x, along_b.y * along_b.y, along_b.z * along_b.z});
    const Floats length_sq = dot(n, n);
    const auto within = [&](double cosine) { return Floats(static_cast<float>(cosine * cosine)) * length_sq; };
    return is_edge & (max(facing_a, facing_b) < within(kSquareCosine)) & (min(facing_a, facing_b) < within(kFacingCosine));
}

// Which lanes go where.
struct Chosen {
    decltype(hn::IndicesFromVec(IntTag(), RawInts())) lanes;  // the first `count` of these
    Ints place;                                               // of each
    std::size_t count;

    HWY_INLINE Ints of(Ints x) const { return Ints{hn::TableLookupLanes(x.raw, lanes)}; }
    HWY_INLINE Floats of(Floats x) const { return as_floats(of(as_ints(x))); }
};
// The lanes of `m`, in order. @param places  by lane.
HWY_INLINE Chosen choose(Ints lanes, Mask m, Ints places) {
    alignas(64) std::int32_t numbers[kStep], to[kStep];
    const std::size_t count = compress_store(lanes, m, numbers);
    compress_store(places, m, to);
    return {hn::IndicesFromVec(IntTag(), load(numbers).raw), load(to), count};
}

// The first lane alone, which stays where it is.
struct OnlyOne {
    Ints place;
    std::size_t count = 1;

    HWY_INLINE Ints of(Ints x) const { return x; }
    HWY_INLINE Floats of(Floats x) const { return x; }
};

template <class Lanes>
HWY_INLINE void append(const WidePair& pair, const WideBoxes& boxes, const BestAxis& best, Mask unusual, Ints number, const Lanes& chosen,
                       BoxPairBlock& out) {
    const std::size_t at = out.count;
    const auto put = [&](Floats x, float* to) { hn::StoreU(chosen.of(x).raw, FloatTag(), to + at); };
    const auto put_number = [&](Ints x, std::int32_t* to) { hn::StoreU(x.raw, IntTag(), to + at); };
    const auto put_three = [&](const Floats3& v, BoxPairBlock::Column* to) { put(v.x, to[0]), put(v.y, to[1]), put(v.z, to[2]); };
    put_three(pair.half_a, out.half_a), put_three(pair.half_b, out.half_b), put_three(pair.offset, out.offset);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) put_three(pair.rotation[i], out.rotation[i]), put_three(boxes.axis_a[i], out.axis_a[i]);
    put(pair.margin, out.margin), put(best.separation, out.separation);
    put_number(chosen.of(best.code), out.code), put_number(chosen.of(number), out.pair), put_number(chosen.place, out.place);
    if (any(unusual)) {
        if (!out.any_unusual) std::fill_n(out.unusual, at, 0);
        out.any_unusual = true;
    }
    if (out.any_unusual) put_number(chosen.of(select(unusual, Ints(1), Ints(0))), out.unusual);
    out.count += chosen.count;
}

// Lists the lanes of `kept`: those that meet by edges alone by themselves.
template <bool one>
HWY_INLINE void list(const WidePair& pair, const WideBoxes& boxes, const BestAxis& best, Mask unusual, Ints number, Mask kept,
                     BoxesNear& out) {
    alignas(64) std::int32_t dense[kStep];
    const Mask alone = by_edges_alone(pair, best.code) & !unusual;
    if constexpr (one) {
        if (none(kept)) return;
        const bool by_edges = any(alone & kept);
        append(pair, boxes, best, unusual & kept, number, OnlyOne{Ints(out.listed++)}, by_edges ? out.edges : out.faces);
        return;
    }
    const std::size_t count = compress_store(lane_numbers(), kept, dense);  // the places are theirs
    if (count == 0) return;
    const Ints lanes = load(dense), place = lane_numbers() + Ints(out.listed);
    const auto order = hn::IndicesFromVec(IntTag(), lanes.raw);
    const Mask is_alone = Ints{hn::TableLookupLanes(select(alone, Ints(1), Ints(0)).raw, order)} == Ints(1);
    const Mask is_there = first_lanes(static_cast<int>(count));
    append(pair, boxes, best, unusual & kept, number, choose(lanes, is_there & !is_alone, place), out.faces);
    if (any(is_there & is_alone)) append(pair, boxes, best, first_lanes(0), number, choose(lanes, is_there & is_alone, place), out.edges);
    out.listed += static_cast<std::int32_t>(count);
}

// Fetches the poses of pairs that follow, lanes [begin, end) of `chosen`: poses are read once, and in any order. A few at a time between other work, since
// what is more than a core has on its way at once holds up all that comes after.
HWY_INLINE void fetch(const BatchInput& input, const std::uint32_t* chosen, std::size_t begin, std::size_t end) {
    const NumberedPair* const pairs = input.pairs.data();
    const Pose* const poses = input.placed.poses.data();
    const std::size_t pair_count = input.pairs.size();
    for (std::size_t l = begin; l < end; ++l) {
        const NumberedPair& next = pairs[std::min(chosen[l] + kAhead, pair_count - 1)];
        hwy::Prefetch(&poses[next.a].orientation);
        hwy::Prefetch(&poses[next.b].orientation);
    }
}

// Where the boxes of as many pairs as there are lanes lie.
struct Bundle {
    Sources a, b;
    alignas(64) float margin[kStep];
    alignas(64) std::int32_t number[kStep];
};
HWY_INLINE void find_sources(const BatchInput& input, const std::uint32_t* chosen, Bundle& out) {
    const NumberedPair* const pairs = input.pairs.data();
    const Pose* const poses = input.placed.poses.data();
    const Shape* const* const shapes = input.placed.shapes.data();
    for (std::size_t l = 0; l < kStep; ++l) {
        const std::size_t i = chosen[l];
        const NumberedPair& pair = pairs[i];
        out.a.pose[l] = poses + pair.a, out.b.pose[l] = poses + pair.b;
        out.a.half[l] = &as<Box>(*shapes[pair.a]).half_extents, out.b.half[l] = &as<Box>(*shapes[pair.b]).half_extents;
        out.margin[l] = pair.margin + pair.slack;
        out.number[l] = static_cast<std::int32_t>(i);
    }
}

// @tparam one  whether there is one pair and no more.
template <bool one>
HWY_INLINE void find_near(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxesNear& out) {
    Bundle from;
    Mask not_finite = first_lanes(0);
    std::uint32_t last[kStep];
    for (std::size_t first = 0; first < chosen.size(); first += kStep) {
        const std::size_t count = std::min(kStep, chosen.size() - first);
        if (count < kStep) {  // the last stands in for those that are not there
            for (std::size_t l = 0; l < kStep; ++l) last[l] = chosen[first + std::min(l, count - 1)];
        }
        const std::uint32_t* const now = count < kStep ? last : chosen.data() + first;
        find_sources(input, now, from);
        const auto fetch_quarter = [&](std::size_t k) __attribute__((always_inline)) {
            if constexpr (!one) fetch(input, now, k * kStep / 4, (k + 1) * kStep / 4);
        };
        fetch_quarter(0);
        const WideBoxes boxes = read_boxes<one>(from.a, from.b);
        fetch_quarter(1);
        const Floats margin = load(from.margin);
        const WidePair pair = pair_of(boxes, margin);
        const Mask unusual = is_unusual(boxes, margin), finite = is_finite(pair);
        fetch_quarter(2);
        const BestAxis best = best_axis(pair);
        fetch_quarter(3);
        not_finite = not_finite | !(finite | unusual);
        const Mask kept = (((!best.apart) & finite) | unusual) & first_lanes(static_cast<int>(count));
        list<one>(pair, boxes, best, unusual, load(from.number), kept, out);
    }
    if (any(not_finite)) out.all_finite = false;
}
void FindNear(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxesNear& out) { find_near<false>(input, chosen, out); }
void FindOne(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxesNear& out) { find_near<true>(input, chosen, out); }

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
HWY_EXPORT(FindOne);
HWY_EXPORT(FindAxes);

void find_near_boxes(const BatchInput& input, std::span<const std::uint32_t> chosen, BoxesNear& out, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(FindOne)(input, chosen.first(1), out);
    HWY_DYNAMIC_DISPATCH(FindNear)(input, chosen, out);
}
void find_box_axes(BoxPairBlock& block, std::size_t bundle, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(FindAxes)(block, bundle, 1);
    HWY_DYNAMIC_DISPATCH(FindAxes)(block, bundle, kBundleWidth);
}
}  // namespace carom::detail
#endif
