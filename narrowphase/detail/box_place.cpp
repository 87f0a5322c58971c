// From boxes in the world to pairs in the frames of their first boxes, and from patches back to manifolds.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_place.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/box_names.hpp>
#include <carom/narrowphase/detail/narrow_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

constexpr std::size_t kLineStride = sizeof(BoxLine) / sizeof(float);
constexpr std::size_t kManifoldStride = sizeof(Manifold) / sizeof(float);
static_assert(offsetof(Manifold, points) == 0 && sizeof(ContactPoint) == 24 && offsetof(ContactPoint, separation) == 12);
static_assert(offsetof(Manifold, normal) == 96 && offsetof(Manifold, pair) == 108 && offsetof(Manifold, count) == 112);

// One box of each lane.
struct WideBox {
    Floats3 axis[3];
    Floats half[3];
};

HWY_INLINE WideBox read_axes(const float* lines, const std::int32_t* numbers) {
    Floats x[3], y[3], z[3], half[3];
#pragma GCC unroll 3
    for (std::size_t k = 0; k < 3; ++k) gather_rows(lines, numbers, kLineStride, 4 * k, x[k], y[k], z[k], half[k]);
    return {{{x[0], y[0], z[0]}, {x[1], y[1], z[1]}, {x[2], y[2], z[2]}}, {half[0], half[1], half[2]}};
}

HWY_INLINE Floats longest(const WideBox& box) { return max(max(box.half[0], box.half[1]), box.half[2]); }
HWY_INLINE Floats diagonal(const WideBox& box) {
    return sqrt((box.half[0] * box.half[0] + box.half[1] * box.half[1]) + box.half[2] * box.half[2]);
}

// A difference or a sum, and what its rounding took (Knuth 1969, vol. 2, 4.2.2, theorem B).
struct Rounded {
    Floats value, error;
};
HWY_INLINE Rounded sum_of(Floats a, Floats b) {
    const Floats sum = a + b, b_seen = sum - a;
    return {sum, (a - (sum - b_seen)) + (b - b_seen)};
}

// From A's centre to B's, in the world: the parts may cancel, so what rounding takes of the first two differences is kept.
HWY_INLINE Floats3 between(const float* lines, const std::int32_t* a, const std::int32_t* b, Mask& unusual) {
    Floats ax[3], ay[3], az[3], bx[3], by[3], bz[3];
    const Floats zero(0.0f);
#pragma GCC unroll 3
    for (std::size_t k = 0; k < 3; ++k) {
        Floats a_rest, b_rest;
        gather_rows(lines, a, kLineStride, 12 + 4 * k, ax[k], ay[k], az[k], a_rest);
        gather_rows(lines, b, kLineStride, 12 + 4 * k, bx[k], by[k], bz[k], b_rest);
        unusual = unusual | (a_rest + b_rest > zero);
    }
    const auto difference = [](const Floats(&from)[3], const Floats(&to)[3]) {
        const Rounded large = sum_of(to[0], -from[0]), middle = sum_of(to[1], -from[1]);
        const Rounded sum = sum_of(large.value, middle.value);
        return sum.value + ((sum.error + (large.error + middle.error)) + (to[2] - from[2]));
    };
    return {difference(ax, bx), difference(ay, by), difference(az, bz)};
}

unsigned place_lanes(const float* lines, const BoxNumberBundle& numbers, BoxPairBundle& out, int lane) {
    const std::int32_t *const of_a = numbers.a.lane + lane, *const of_b = numbers.b.lane + lane;
    const WideBox a = read_axes(lines, of_a), b = read_axes(lines, of_b);
    const Floats margin = load(numbers.margin.lane + lane);
    Mask unusual = margin != margin;
    const Floats3 offset = between(lines, of_a, of_b, unusual);
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
        store(a.half[i], out.half_a[i].lane + lane);
        store(b.half[i], out.half_b[i].lane + lane);
        store(dot(a.axis[i], offset), out.offset[i].lane + lane);
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) store(dot(a.axis[i], b.axis[j]), out.rotation[i][j].lane + lane);
    }
    store(margin, out.margin.lane + lane);
    const Floats most_a = longest(a), most_b = longest(b), most = max(most_a, most_b);
    const Floats reach(kUnusualRatio);
    unusual = unusual | (most_a > reach * (diagonal(b) + margin)) | (most_b > reach * (diagonal(a) + margin));
    unusual = unusual | (most <= Floats(kSmallestUsual)) | (most >= Floats(kLargestUsual));
    return bits(unusual);
}

void PlaceBoxes(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<BoxPairBundle> pairs,
                std::span<std::uint32_t> unusual, int lanes) {
    const float* const rows = lines.data()->axis[0];
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        unusual[k] = 0;
        for (int lane = 0; lane < lanes; lane += kLanes) unusual[k] |= place_lanes(rows, numbers[k], pairs[k], lane) << lane;
    }
}

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
        const Ints toward = (select(normal[0] < zero, none, Ints(1)) + select(normal[1] < zero, none, Ints(2))) + select(normal[2] < zero, none, Ints(4));
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

HWY_INLINE Floats3 turned(const WideBox& box, const Floats3& v) { return v.x * box.axis[0] + (v.y * box.axis[1] + v.z * box.axis[2]); }

void write_lanes(const float* lines, const BoxNumberBundle& numbers, const BoxWayBundle& way, const BoxAxisBundle& axes,
                 const BoxPatchBundle& patch, float* manifolds, int lane) {
    const std::int32_t* const to = way.to.lane + lane;
    const WideBox box = read_axes(lines, numbers.a.lane + lane);
    const auto three = [lane](const FloatBundle* b) {
        return Floats3{load(b[0].lane + lane), load(b[1].lane + lane), load(b[2].lane + lane)};
    };
    const Floats3 normal = three(patch.normal), of_b = three(patch.normal_b), centre = three(way.centre);
    const Floats unit = load(way.unit.lane + lane), zero(0.0f);
    const Ints count = load(patch.count.lane + lane), edges = load(axes.code.lane + lane) - Ints(kFirstEdge), none(0);
    const Mask by_edges = edges >= none;
    const Ints along_a = select(by_edges, select(edges < Ints(3), none, select(edges < Ints(6), Ints(1), Ints(2))), none);
    const Ints along_b = select(by_edges, edges - (along_a + (along_a + along_a)), none);
    const WideNames names_a(kBoxNames.corners_and_sides, load(patch.face_a.lane + lane), {normal.x, normal.y, normal.z}, along_a);
    const WideNames names_b(kBoxNames.corners_and_edges, load(patch.face_b.lane + lane), {-of_b.x, -of_b.y, -of_b.z}, along_b);
    Floats row[6 * 4];  // of the four points, as they lie in memory
    Ints low[4], high[4];  // of the names
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const BoxPatchBundle::Point& point = patch.points[static_cast<std::size_t>(k)];
        const PointNames names = names_of(point, lane, names_a, names_b);
        Mask is_taken = zero > zero;
        for (int i = 0; i < k; ++i) is_taken = is_taken | ((low[i] == names.name.low) & (high[i] == names.name.high));
        low[k] = select(is_taken, names.plain.low, names.name.low);
        high[k] = select(is_taken, names.plain.high, names.name.high);
        const Mask used = count > Ints(k);
        const Floats3 position = turned(box, unit * three(point.position) + centre);
        Floats* const at = row + 6 * k;
        at[0] = select(used, position.x, zero);
        at[1] = select(used, position.y, zero);
        at[2] = select(used, position.z, zero);
        at[3] = select(used, unit * load(point.separation.lane + lane), zero);
        at[4] = select(used, as_floats(low[k]), zero);
        at[5] = select(used, as_floats(high[k]), zero);
    }
#pragma GCC unroll 6
    for (std::size_t r = 0; r < 6; ++r) {
        const Floats* const at = row + 4 * r;
        scatter_rows(manifolds, to, kManifoldStride, 4 * r, at[0], at[1], at[2], at[3], kNoManifold);
    }
    const Floats3 n = turned(box, normal);
    scatter_rows(manifolds, to, kManifoldStride, 24, n.x, n.y, n.z, as_floats(load(way.pair.lane + lane)), kNoManifold);
    scatter_rows(manifolds, to, kManifoldStride, 28, as_floats(count), zero, zero, zero, kNoManifold);
}

void WriteManifolds(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<const BoxWayBundle> ways,
                    std::span<const BoxAxisBundle> axes, std::span<const BoxPatchBundle> patches, Manifold* manifolds, int lanes) {
    const float* const rows = lines.data()->axis[0];
    for (std::size_t k = 0; k < patches.size(); ++k) {
        for (int lane = 0; lane < lanes; lane += kLanes) {
            write_lanes(rows, numbers[k], ways[k], axes[k], patches[k], reinterpret_cast<float*>(manifolds), lane);
        }
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(PlaceBoxes);
HWY_EXPORT(WriteManifolds);

void place_boxes(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<BoxPairBundle> pairs,
                 std::span<std::uint32_t> unusual, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(PlaceBoxes)(lines, numbers, pairs, unusual, 1);
    HWY_DYNAMIC_DISPATCH(PlaceBoxes)(lines, numbers, pairs, unusual, kBundleWidth);
}

void write_box_manifolds(std::span<const BoxLine> lines, std::span<const BoxNumberBundle> numbers, std::span<const BoxWayBundle> ways,
                         std::span<const BoxAxisBundle> axes, std::span<const BoxPatchBundle> patches, Manifold* manifolds,
                         BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(WriteManifolds)(lines, numbers, ways, axes, patches, manifolds, 1);
    HWY_DYNAMIC_DISPATCH(WriteManifolds)(lines, numbers, ways, axes, patches, manifolds, kBundleWidth);
}
}  // namespace carom::detail
#endif
