// Patches of boxes, named, as manifolds in the world.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_write.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/box_names.hpp>
#include <carom/narrowphase/detail/narrow_lanes.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

constexpr std::size_t kManifoldStride = sizeof(Manifold) / sizeof(float);
static_assert(offsetof(Manifold, points) == 0 && sizeof(ContactPoint) == 24 && offsetof(ContactPoint, separation) == 12);
static_assert(offsetof(Manifold, normal) == 96 && offsetof(Manifold, pair) == 108 && offsetof(Manifold, count) == 112);

template <class Number>
HWY_INLINE Ints look_up(const Number* table, Ints index) {
    static_assert(sizeof(Number) == sizeof(float));
    return as_ints(gather(reinterpret_cast<const float*>(table), index));  // the same 32 bits
}

// The names of the features of one face of each lane.
struct WideNames {
    Ints numbers;  ///< eight, of four bits each
    Ints leading;  ///< the edge along the axis that was given

    /// @param table  of box_names.hpp. @param along  an axis.
    HWY_INLINE WideNames(const std::uint32_t* table, Ints axis, const Floats (&normal)[3], Ints along) {
        const Floats zero(0.0f);
        const Ints none(0);
        const Ints toward =
            (select(normal[0] < zero, none, Ints(1)) + select(normal[1] < zero, none, Ints(2))) + select(normal[2] < zero, none, Ints(4));
        numbers = look_up(table, Ints{hn::ShiftLeft<3>(axis.raw)} + toward);
        leading = look_up(kBoxNames.leading, Ints{hn::ShiftLeft<3>(along.raw)} + toward);
    }
    HWY_INLINE Ints corner(Ints k) const { return Ints{hn::Shr(numbers.raw, hn::ShiftLeft<2>(k.raw))} & Ints(15); }
    /// The edge or side, as the table has it.
    HWY_INLINE Ints edge(Ints k) const { return corner(k + Ints(4)); }
};

// feature_name() as two halves.
struct WideName {
    Ints low, high;
};
HWY_INLINE WideName select(Mask m, const WideName& yes, const WideName& no) {
    return {select(m, yes.low, no.low), select(m, yes.high, no.high)};
}

// A point's two names: after a corner of B, or else of A, that it lies at, otherwise after its two edges; and the latter, which two points
// that lie at one corner have of their own.
struct PointNames {
    WideName name, plain;
};
HWY_INLINE PointNames names_of(const BoxPatchBundle::Point& point, int lane, const WideNames& a, const WideNames& b) {
    const Ints candidate = load(point.candidate.lane + lane), nothing(-1), zero(0);
    const Mask is_corner_b = candidate < Ints(kCornerOfA), is_corner_a = (!is_corner_b) & (candidate < Ints(kCrossing));
    const Ints own_a = select(is_corner_a, candidate - Ints(kCornerOfA), nothing), own_b = select(is_corner_b, candidate, nothing);
    const Ints at_a = select(is_corner_a, own_a, load(point.corner_a.lane + lane));
    const Ints at_b = select(is_corner_b, own_b, load(point.corner_b.lane + lane));

    const Mask crosses = candidate == Ints(kEdges);
    const Ints crossing = select(is_corner_a | is_corner_b | crosses, zero, candidate - Ints(kCrossing));
    const Ints first = select(crosses, a.leading, a.edge(Ints{hn::ShiftRight<2>(crossing.raw)}));
    const Ints second = select(crosses, b.leading, b.edge(crossing & Ints(3)));
    const WideName by_edges{Ints{hn::ShiftLeft<31>(first.raw)} | second, Ints{hn::ShiftRight<1>(first.raw)}};

    const auto with_corners = [&](Ints corner_a, Ints corner_b) {
        const Mask has_a = corner_a >= zero, has_b = corner_b >= zero;
        const Ints name_a = a.corner(select(has_a, corner_a, zero)), name_b = b.corner(select(has_b, corner_b, zero));
        const WideName of_a{Ints{hn::ShiftLeft<31>(name_a.raw)}, Ints(1 << 30) | Ints{hn::ShiftRight<1>(name_a.raw)}};
        const WideName of_b{name_b, Ints(static_cast<std::int32_t>(0x80000000u))};
        return select(has_b, of_b, select(has_a, of_a, by_edges));
    };
    return {with_corners(at_a, at_b), with_corners(own_a, own_b)};
}

HWY_INLINE Floats3 turned(const Floats3 (&axis)[3], const Floats3& v) { return v.x * axis[0] + (v.y * axis[1] + v.z * axis[2]); }

// @tparam kPoints  of a patch at most: 1 or 4.
template <int kPoints>
void write_lanes(const BoxPairBlock& block, std::size_t at, const BoxPatchBundle& patch, const IntBundle& places, float* manifolds,
                 int lane) {
    const std::int32_t* const to = places.lane + lane;
    const auto from_block = [at](const BoxPairBlock::Column* b) { return Floats3{load(b[0] + at), load(b[1] + at), load(b[2] + at)}; };
    const auto three = [lane](const FloatBundle* b) {
        return Floats3{load(b[0].lane + lane), load(b[1].lane + lane), load(b[2].lane + lane)};
    };
    const Floats3 axis[3] = {from_block(block.axis_a[0]), from_block(block.axis_a[1]), from_block(block.axis_a[2])};
    const Floats3 normal = three(patch.normal), of_b = three(patch.normal_b), centre = from_block(block.centre);
    const Floats unit = load(block.unit + at), zero(0.0f);
    const Ints count = load(patch.count.lane + lane), edges = load(block.code + at) - Ints(kFirstEdge), none(0);
    const Mask by_edges = edges >= none;
    const Ints along_a = select(by_edges, select(edges < Ints(3), none, select(edges < Ints(6), Ints(1), Ints(2))), none);
    const Ints along_b = select(by_edges, edges - (along_a + (along_a + along_a)), none);
    const WideNames names_a(kBoxNames.corners_and_sides, load(patch.face_a.lane + lane), {normal.x, normal.y, normal.z}, along_a);
    const WideNames names_b(kBoxNames.corners_and_edges, load(patch.face_b.lane + lane), {-of_b.x, -of_b.y, -of_b.z}, along_b);
    Floats row[6 * 4];     // of the four points, as they lie in memory
    Ints low[4], high[4];  // of the names
#pragma GCC unroll 4
    for (int k = 0; k < kPoints; ++k) {
        const BoxPatchBundle::Point& point = patch.points[static_cast<std::size_t>(k)];
        const PointNames names = names_of(point, lane, names_a, names_b);
        Mask is_taken = zero > zero;
        for (int i = 0; i < k; ++i) is_taken = is_taken | ((low[i] == names.name.low) & (high[i] == names.name.high));
        low[k] = select(is_taken, names.plain.low, names.name.low);
        high[k] = select(is_taken, names.plain.high, names.name.high);
        const Mask used = count > Ints(k);
        const Floats3 position = turned(axis, unit * three(point.position) + centre);
        Floats* const numbers = row + 6 * k;
        numbers[0] = select(used, position.x, zero);
        numbers[1] = select(used, position.y, zero);
        numbers[2] = select(used, position.z, zero);
        numbers[3] = select(used, unit * load(point.separation.lane + lane), zero);
        numbers[4] = select(used, as_floats(low[k]), zero);
        numbers[5] = select(used, as_floats(high[k]), zero);
    }
#pragma GCC unroll 6
    for (std::size_t r = 0; r < 6; ++r) {
        const Floats* const numbers = row + 4 * r;
        scatter_rows(manifolds, to, kManifoldStride, 4 * r, numbers[0], numbers[1], numbers[2], numbers[3], kNoManifold);
    }
    const Floats3 n = turned(axis, normal);
    scatter_rows(manifolds, to, kManifoldStride, 24, n.x, n.y, n.z, as_floats(load(block.pair + at)), kNoManifold);
    scatter_rows(manifolds, to, kManifoldStride, 28, as_floats(count), zero, zero, zero, kNoManifold);
}

template <int kPoints>
HWY_INLINE void write_bundle(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                             Manifold* manifolds, int lanes) {
    for (int lane = 0; lane < lanes; lane += kLanes) {
        write_lanes<kPoints>(block, bundle * kBundleWidth + static_cast<std::size_t>(lane), patch, to, reinterpret_cast<float*>(manifolds),
                             lane);
    }
}
void WriteManifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to, Manifold* manifolds,
                    int lanes) {
    write_bundle<4>(block, bundle, patch, to, manifolds, lanes);
}
void WriteEdgeManifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                        Manifold* manifolds, int lanes) {
    write_bundle<1>(block, bundle, patch, to, manifolds, lanes);
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(WriteManifolds);
void write_box_manifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                         Manifold* manifolds, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(WriteManifolds)(block, bundle, patch, to, manifolds, 1);
    HWY_DYNAMIC_DISPATCH(WriteManifolds)(block, bundle, patch, to, manifolds, kBundleWidth);
}
HWY_EXPORT(WriteEdgeManifolds);
void write_edge_manifolds(const BoxPairBlock& block, std::size_t bundle, const BoxPatchBundle& patch, const IntBundle& to,
                          Manifold* manifolds, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(WriteEdgeManifolds)(block, bundle, patch, to, manifolds, 1);
    HWY_DYNAMIC_DISPATCH(WriteEdgeManifolds)(block, bundle, patch, to, manifolds, kBundleWidth);
}
}  // namespace carom::detail
#endif
