// Boxes against planes: eight pairs at a time, in double, the same operations in the same order as box_plane() in polytope_plane.cpp and
// reduce_points(), which take one pair: the same bits.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_plane_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/round_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

constexpr int kCorners = 8;

// Of a corner: where it is in the plane, how far over it, and its number.
struct WideCandidate {
    Doubles u, w, separation, number;
};
HWY_INLINE WideCandidate select_point(DoubleMask m, const WideCandidate& yes, const WideCandidate& no) {
    return {select(m, yes.u, no.u), select(m, yes.w, no.w), select(m, yes.separation, no.separation), select(m, yes.number, no.number)};
}

// A candidate where there is one. (What lanes hold is never made by a constructor that the compiler adds: it would be of no target.)
struct WideChoice {
    WideCandidate point;
    DoubleMask valid;
};

HWY_INLINE Doubles distance_sq(const WideCandidate& a, const WideCandidate& b) {
    return (b.u - a.u) * (b.u - a.u) + (b.w - a.w) * (b.w - a.w);
}
HWY_INLINE Doubles area2(const WideCandidate& a, const WideCandidate& b, const WideCandidate& c) {
    return (b.u - a.u) * (c.w - a.w) - (b.w - a.w) * (c.u - a.u);
}

// The highest score, and a point of those that score as much, where it is over what was asked for.
struct Scored {
    Doubles score;
    WideCandidate point;
};

struct Corners {
    WideCandidate at[kCorners];
    DoubleMask reported[kCorners];

    // As best_of() in reduce.hpp: names are in the order of the numbers. The greatest round by round, as each comparison waits for those before it.
    // @tparam Equal, Score  as there.
    template <class Equal, class Score>
    HWY_INLINE Scored best_of(Doubles least, const Equal& equal, const Score& score) const {
        Doubles scores[kCorners];
#pragma GCC unroll 8
        for (int i = 0; i < kCorners; ++i) scores[i] = select(reported[i], score(at[i]), Doubles(-std::numeric_limits<double>::infinity()));
        const auto of_four = [&](int i) { return greatest(greatest(scores[i], scores[i + 1]), greatest(scores[i + 2], scores[i + 3])); };
        const Doubles best = greatest(of_four(0), of_four(4)), bar = greatest(equal(best), least);
        WideCandidate point = at[kCorners - 1];
#pragma GCC unroll 8
        for (int i = kCorners - 2; i >= 0; --i) point = select_point(scores[i] > bar, at[i], point);
        return {best, point};
    }
};

struct Choices {
    WideChoice slot[4];
};

// As choose_outline().
HWY_INLINE Choices choose_outline(const Corners& corners, Doubles tolerance, Doubles start_u, Doubles start_w, DoubleMask any) {
    const Doubles least_distance = tolerance * tolerance;
    const WideCandidate a = corners
                                .best_of(
                                    Doubles(-std::numeric_limits<double>::infinity()), [&](Doubles best) { return best - tolerance; },
                                    [&](const WideCandidate& p) { return p.u * start_u + p.w * start_w; })
                                .point;
    const Scored second = corners.best_of(
        least_distance, [](Doubles best) { return Doubles(kAsFar) * best; }, [&](const WideCandidate& p) { return distance_sq(a, p); });
    const WideCandidate& b = second.point;

    const Doubles least = tolerance * sqrt(second.score);
    const auto less = [&](Doubles best) { return best - least; };
    const Scored left = corners.best_of(least, less, [&](const WideCandidate& p) { return area2(a, b, p); });
    const Scored right = corners.best_of(least, less, [&](const WideCandidate& p) { return -area2(a, b, p); });
    const DoubleMask no_right = !(right.score > least), is_left = no_right | ((left.score > least) & (left.score >= right.score - least));
    const WideCandidate c = select_point(is_left, left.point, right.point);
    const Doubles turn = select(is_left, Doubles(-1.0), Doubles(1.0));
    const Scored fourth = corners.best_of(least, less, [&](const WideCandidate& p) {
        return greatest(greatest(turn * area2(a, b, p), turn * area2(b, c, p)), turn * area2(c, a, p));
    });
    const DoubleMask two = any & (second.score > least_distance), three = two & (greatest(left.score, right.score) > least);
    return {{{a, any}, {b, two}, {c, three}, {fourth.point, three & (fourth.score > least)}}};
}

// As reduce_points().
HWY_INLINE Choices reduce_corners(const Corners& corners, Doubles tolerance, Doubles start_u, Doubles start_w, DoubleMask any) {
    Choices chosen = choose_outline(corners, tolerance, start_u, start_w, any);
    WideChoice(&slot)[4] = chosen.slot;
    Doubles lowest = slot[0].point.separation;
    for (int k = 1; k < 4; ++k) lowest = select(slot[k].valid, least(lowest, slot[k].point.separation), lowest);
    const Doubles least_depth = tolerance - lowest;
    const Scored deepest = corners.best_of(
        least_depth, [&](Doubles best) { return best - Doubles(0x1p-6) * tolerance; },
        [](const WideCandidate& p) { return -p.separation; });
    const DoubleMask deeper = any & (deepest.score > least_depth);
    if (none(deeper)) return chosen;

    Doubles nearest = distance_sq(slot[0].point, deepest.point), replaced(0.0);
    for (int k = 1; k < 4; ++k) {
        const Doubles sq = distance_sq(slot[k].point, deepest.point);
        const DoubleMask nearer = slot[k].valid & (sq < Doubles(kAsFar) * nearest);
        nearest = select(nearer, sq, nearest);
        replaced = select(nearer, Doubles(k), replaced);
    }
    // It comes after the last of fewer than four, or in place of the nearest.
    const DoubleMask added = (deeper & !slot[3].valid) & (nearest > tolerance * tolerance);
    const DoubleMask had[4] = {slot[0].valid, slot[1].valid, slot[2].valid, slot[3].valid};
    for (int k = 0; k < 4; ++k) {
        const DoubleMask after_last = k == 0 ? nowhere() : added & had[k - 1] & !had[k];
        const DoubleMask here = after_last | (deeper & !added & (replaced == Doubles(k)));
        slot[k] = {select_point(here, deepest.point, slot[k].point), had[k] | after_last};
    }
    return chosen;
}

// As outline_start() for one normal.
HWY_INLINE Doubles3 outline_start(const Doubles3& normal) {
    const Doubles x = abs(normal.x), y = abs(normal.y), z = abs(normal.z), zero(0.0), one(1.0), slant(0.381966);
    const DoubleMask is_y = (y >= x) & (y >= z), is_x = x >= z;
    return select(is_y, {one, zero, slant}, select(is_x, {zero, one, slant}, {one, slant, zero}));
}

struct BoxPlane {
    static HWY_INLINE WideContact<4> touch(const WideFrame& f, const Sizes& size) {
        const WidePlane plane(f, size);
        const Doubles3 half{size.first[0], size.first[1], size.first[2]};
        const auto corner = [&](DoubleMask x, DoubleMask y, DoubleMask z) {
            return Doubles3{select(x, half.x, -half.x), select(y, half.y, -half.y), select(z, half.z, -half.z)};
        };
        const Doubles zero(0.0), two(2.0), four(4.0);
        const Doubles3 axis_u = any_perpendicular(plane.normal), axis_w = cross(axis_u, plane.normal);
        const auto candidate = [&](int i) -> WideCandidate {
            const Doubles3 p{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
            return {dot(p, axis_u), dot(p, axis_w), plane.distance(p), Doubles(i)};
        };
        const WideCandidate c[kCorners] = {candidate(0), candidate(1), candidate(2), candidate(3),
                                           candidate(4), candidate(5), candidate(6), candidate(7)};
        const auto reported = [&](int i) { return c[i].separation <= f.margin; };
        const Corners corners{{c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7]},
                              {reported(0), reported(1), reported(2), reported(3), reported(4), reported(5), reported(6), reported(7)}};
        DoubleMask any = corners.reported[0];
        for (int i = 1; i < kCorners; ++i) any = any | corners.reported[i];
        const Doubles3 normal = -plane.normal;
        const WideContactPoint no_point{zero3(), zero, zero, nowhere()};
        WideContact<4> contact{normal, {no_point, no_point, no_point, no_point}};
        if (none(any)) return contact;

        const Doubles3 start = outline_start(plane.normal);
        const Doubles tolerance = Doubles(kPointTolerance) * greatest(greatest(half.x, half.y), half.z);
        const Choices chosen = reduce_corners(corners, tolerance, dot(start, axis_u), dot(start, axis_w), any);
        for (int k = 0; k < 4; ++k) {
            const auto& [point, valid] = chosen.slot[k];
            const DoubleMask z = point.number >= four;
            const Doubles in_layer = select(z, point.number - four, point.number);
            const DoubleMask y = in_layer >= two, x = select(y, in_layer - two, in_layer) > zero;
            // feature_name(FeatureKind::VertexOfFirst, number, 0), which a double holds.
            const Doubles feature = Doubles(0x1p62) + point.number * Doubles(0x1p31);
            contact.points[k] = {corner(x, y, z) - plane.normal * (Doubles(0.5) * point.separation), point.separation, feature, valid};
        }
        return contact;
    }
};

void BoxPlaneLanes(const BatchInput& input, std::span<const std::uint32_t> chosen, ManifoldList& out) {
    run<BoxPlane>(input, chosen, ShapeType::Box, out);
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(BoxPlaneLanes);

void box_plane_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(BoxPlaneLanes)(input, chosen, out);
}
}  // namespace carom::detail
#endif
