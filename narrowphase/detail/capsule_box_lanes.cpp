// Capsules against boxes: eight pairs at a time, in double, the same operations in the same order as in capsule_box.cpp, which explains them and
// takes one pair: the same bits.
#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/capsule_box_lanes.cpp>
#include <hwy/foreach_target.h>

#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/round_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

HWY_INLINE Doubles sign_of(Doubles x) { return select(x < Doubles(0.0), Doubles(-1.0), Doubles(1.0)); }
HWY_INLINE Doubles excess(Doubles x, Doubles h) { return select(x < -h, x + h, select(x > h, x - h, Doubles(0.0))); }

// As common_size() of detail/polytope_axis.hpp.
HWY_INLINE Doubles common_size(Doubles a, Doubles b) {
    const DoubleMask a_larger = a > b;
    const Doubles larger = select(a_larger, a, b), smaller = select(a_larger, b, a);
    const Doubles few = Doubles(8.0) * smaller + Doubles(1e-8) * larger;
    return select(few < larger, few, larger);
}

// What belongs to one axis of the box.
struct Coordinate {
    Doubles centre, along, half;
    HWY_INLINE Doubles at(Doubles t) const { return centre + along * t; }
    HWY_INLINE Doubles slope(Doubles t) const { return along * excess(at(t), half); }
};

struct Core {
    Coordinate x, y, z;
    HWY_INLINE Doubles3 at(Doubles t) const { return {x.at(t), y.at(t), z.at(t)}; }
    HWY_INLINE Doubles slope(Doubles t) const { return (x.slope(t) + y.slope(t)) + z.slope(t); }
};

// Where the slope changes sign: the last place found at which it is not positive, the first at which it is not negative.
struct Bracket {
    Doubles low, high, before, after;

    // Where coordinate i comes in or leaves.
    HWY_INLINE void offer(const Coordinate& i, const Coordinate& j, const Coordinate& k) {
        const Doubles zero(0.0), one(1.0);
        const Doubles inverse = one / i.along;
        for (const Doubles side : {-i.half, i.half}) {
            const Doubles t = (side - i.centre) * inverse, slope = j.slope(t) + k.slope(t);
            const DoubleMask inside = (t > -one) & (t < one);
            const DoubleMask raises = inside & (slope <= zero) & (t > low), lowers = inside & (slope >= zero) & (t < high);
            low = select(raises, t, low);
            before = select(raises, slope, before);
            high = select(lowers, t, high);
            after = select(lowers, slope, after);
        }
    }
    HWY_INLINE Doubles zero_of() const {
        const Doubles zero(0.0), between = low + (high - low) * (before / (before - after));
        return select(!(before < zero), low, select(!(after > zero), high, between));
    }
};

HWY_INLINE Doubles closest_parameter(const Core& core) {
    const Doubles one(1.0);
    Bracket bracket{-one, one, core.slope(-one), core.slope(one)};
    bracket.offer(core.x, core.y, core.z);
    bracket.offer(core.y, core.z, core.x);
    bracket.offer(core.z, core.x, core.y);
    return bracket.zero_of();
}

struct BoxAxis {
    Doubles3 outward;
    Doubles separation;
};

struct EdgeAxis {
    Doubles separation, j, k;
    DoubleMask better;

    // The axis square to the core and to i.
    HWY_INLINE EdgeAxis(const Coordinate& at_j, const Coordinate& at_k, Doubles dd, Doubles& needed) : better(nowhere()) {
        const Doubles length_sq = at_k.along * at_k.along + at_j.along * at_j.along, inverse = Doubles(1.0) / sqrt(length_sq);
        const Doubles height = at_k.along * at_j.centre - at_j.along * at_k.centre;
        separation = (abs(height) - (abs(at_k.along) * at_j.half + abs(at_j.along) * at_k.half)) * inverse;
        better = (length_sq > Doubles(kParallelSine * kParallelSine) * dd) & (separation > needed);
        needed = select(better, separation, needed);
        const Doubles scale = sign_of(height) * inverse;
        j = at_k.along * scale;
        k = (-at_j.along) * scale;
    }
};

HWY_INLINE BoxAxis deepest_axis(const Core& core, Doubles size) {
    const auto of_face = [](const Coordinate& i) { return (abs(i.centre) - abs(i.along)) - i.half; };
    const Doubles zero(0.0), by_x = of_face(core.x), by_y = of_face(core.y), by_z = of_face(core.z);
    const DoubleMask over_x = by_y > by_x;
    const Doubles by_xy = select(over_x, by_y, by_x);
    const DoubleMask is_z = by_z > by_xy, is_y = over_x & !is_z, is_x = !(over_x | is_z);
    const auto face_normal = [zero](DoubleMask is, const Coordinate& i) { return select(is, sign_of(i.centre), zero); };
    BoxAxis axis{{face_normal(is_x, core.x), face_normal(is_y, core.y), face_normal(is_z, core.z)}, select(is_z, by_z, by_xy)};
    Doubles needed = axis.separation + Doubles(kFacePreference) * size;
    const Doubles dd = (core.x.along * core.x.along + core.y.along * core.y.along) + core.z.along * core.z.along;
    const EdgeAxis x(core.y, core.z, dd, needed), y(core.z, core.x, dd, needed), z(core.x, core.y, dd, needed);
    const auto take = [&axis](const EdgeAxis& edge, const Doubles3& outward) {
        axis = {select(edge.better, outward, axis.outward), select(edge.better, edge.separation, axis.separation)};
    };
    take(x, {zero, x.j, x.k});
    take(y, {y.k, zero, y.j});
    take(z, {z.j, z.k, zero});
    return axis;
}

struct Cut {
    Doubles t, edge;
};

struct FaceStretch {
    DoubleMask is_x, is_y, is_z;
    Doubles sign, inverse_slope, offset;
    Cut low, high;
    HWY_INLINE Doubles distance(const Doubles3& p) const {
        return (sign * select(is_z, p.z, select(is_y, p.y, p.x)) - offset) * inverse_slope;
    }

    HWY_INLINE void cut_by_side(DoubleMask there, Doubles from, Doubles to, Doubles inverse, Doubles allowed, Doubles edge) {
        const DoubleMask cuts = there & !((from <= allowed) & (to <= allowed)), enters = from > to;
        const Doubles t = Doubles(2.0) * clamp01(from * inverse) - Doubles(1.0);
        const DoubleMask raises = cuts & enters & (t > low.t), lowers = cuts & !enters & (t < high.t);
        low = {select(raises, t, low.t), select(raises, edge, low.edge)};
        high = {select(lowers, t, high.t), select(lowers, edge, high.edge)};
    }

    // Both sides of the face along axis i, numbered `number`; edges are called as edge_number() does.
    HWY_INLINE void cut_by_sides(int number, DoubleMask is_i, DoubleMask face_is_next, Doubles from, Doubles to, Doubles half,
                                 Doubles allowed) {
        const Doubles inverse = Doubles(1.0) / (from - to);
        const Doubles up = select(sign < Doubles(0.0), Doubles(0.0), Doubles(1.0));
        for (int side = 0; side < 2; ++side) {
            const Doubles turn(side == 0 ? -1.0 : 1.0), at_side(side);
            const Doubles along_third = Doubles(4 * ((number + 2) % 3)) + (at_side + Doubles(2.0) * up);
            const Doubles along_next = Doubles(4 * ((number + 1) % 3)) + (up + Doubles(2.0) * at_side);
            cut_by_side(!is_i, turn * from - half, turn * to - half, turn * inverse, allowed,
                        select(face_is_next, along_third, along_next));
        }
    }
};

HWY_INLINE FaceStretch stretch_over_face(const Core& core, const Doubles3& outward, Doubles allowed) {
    const Doubles one(1.0), zero(0.0), x = abs(outward.x), y = abs(outward.y), z = abs(outward.z);
    const DoubleMask over_x = y > x;
    const Doubles xy = select(over_x, y, x);
    const DoubleMask is_z = z > xy, is_y = over_x & !is_z, is_x = !(over_x | is_z);
    const auto pick = [&](Doubles of_x, Doubles of_y, Doubles of_z) { return select(is_z, of_z, select(is_y, of_y, of_x)); };
    FaceStretch stretch{is_x,
                        is_y,
                        is_z,
                        sign_of(pick(outward.x, outward.y, outward.z)),
                        one / pick(x, y, z),
                        pick(core.x.half, core.y.half, core.z.half),
                        {-one, zero},
                        {one, zero}};
    const auto end = [&](auto&& of) { return Doubles3{of(core.x), of(core.y), of(core.z)}; };
    const Doubles3 from = end([](const Coordinate&i) { return i.centre - i.along; }),
                   to = end([](const Coordinate&i) { return i.centre + i.along; });
    const Doubles3 from_in_face = from - outward * stretch.distance(from), to_in_face = to - outward * stretch.distance(to);
    stretch.cut_by_sides(0, is_x, is_y, from_in_face.x, to_in_face.x, core.x.half, allowed);
    stretch.cut_by_sides(1, is_y, is_z, from_in_face.y, to_in_face.y, core.y.half, allowed);
    stretch.cut_by_sides(2, is_z, is_x, from_in_face.z, to_in_face.z, core.z.half, allowed);
    return stretch;
}

// feature_name() of an end of the core or of an edge of the box, which a double holds.
HWY_INLINE Doubles name_of(const Cut& cut, DoubleMask from, DoubleMask to) {
    const DoubleMask at_from = from & (cut.t < Doubles(2.0 * kSnap - 1.0)), at_to = to & (cut.t > Doubles(1.0 - 2.0 * kSnap));
    return select(at_from, Doubles(0x1p62), select(at_to, Doubles(0x1p62 + 0x1p31), cut.edge));
}

// Up to two points along the core. @param t  the one that is nearest.
// @param beside  how far beside a face the core may be.
HWY_INLINE WideContact<2> points_of(const WideFrame& f, const Core& core, Doubles half_segment, Doubles radius, const BoxAxis& axis,
                                    DoubleMask apart, Doubles t, DoubleMask touches, Doubles size, Doubles beside) {
    const Doubles zero(0.0), one(1.0);
    const FaceStretch stretch = stretch_over_face(core, axis.outward, Doubles(kInsideTolerance) * size + beside);
    const Cut &low = stretch.low, &high = stretch.high;
    const Doubles low_distance = stretch.distance(core.at(low.t)), high_distance = stretch.distance(core.at(high.t));
    const Doubles tolerance = Doubles(kPointTolerance) * size;
    const DoubleMask found = touches & !(least(low_distance, high_distance) > axis.separation + tolerance);
    const DoubleMask has_low = found & (low_distance - radius <= f.margin), has_high = found & (high_distance - radius <= f.margin);
    const Doubles3 along{core.x.along, core.y.along, core.z.along}, across = cross(axis.outward, along) * (high.t - low.t);
    const Doubles rise = dot(axis.outward, along);
    const Doubles stand_in = select(apart | !(abs(rise) > tolerance), t, select(rise > zero, -one, one));
    const DoubleMask two = has_low & has_high & (low.t < high.t) & (dot(across, across) > tolerance * tolerance);
    const DoubleMask high_alone = has_high & !(two | (has_low & (low_distance <= high_distance)));
    const DoubleMask at_nearest = !(has_low | high_alone);

    const auto pick = [&](Doubles of_low, Doubles of_high, Doubles nearest) {
        return select(at_nearest, nearest, select(high_alone, of_high, of_low));
    };
    const Cut first{pick(low.t, high.t, stand_in), pick(low.edge, high.edge, zero)};
    const Doubles3 normal = -(f.rotation * axis.outward);
    const auto at = [&](Doubles s) { return Doubles3{zero, s * half_segment, zero}; };
    const Doubles distance = pick(low_distance, high_distance, axis.separation);
    return {normal,
            {ball_point(at(first.t), radius, normal, distance, touches, name_of(first, touches, !two)),
             ball_point(at(high.t), radius, normal, high_distance, two, name_of(high, nowhere(), two))}};
}

struct CapsuleBox {
    static HWY_INLINE WideContact<2> touch(const WideFrame& f, const Sizes& size) {
        const Doubles radius = size.first[0], half_segment = size.first[1];
        const Doubles3 half{size.second[0], size.second[1], size.second[2]}, centre = f.rotation.back(zero3() - f.translation);
        const Doubles3 along = Doubles3{f.rotation.x.y, f.rotation.y.y, f.rotation.z.y} * half_segment;
        const Core core{{centre.x, along.x, half.x}, {centre.y, along.y, half.y}, {centre.z, along.z, half.z}};

        const Doubles t = closest_parameter(core);
        const Doubles3 nearest = core.at(t), out{excess(nearest.x, half.x), excess(nearest.y, half.y), excess(nearest.z, half.z)};
        const Doubles distance = sqrt(dot(out, out));
        const DoubleMask touches = distance - radius <= f.margin;
        const WideContactPoint no_point{zero3(), Doubles(0.0), Doubles(0.0), nowhere()};
        if (none(touches)) return {zero3(), {no_point, no_point}};

        const Doubles box_size = Doubles(2.0) * greatest(greatest(half.x, half.y), half.z), length = Doubles(2.0) * half_segment;
        const DoubleMask apart = distance > Doubles(kTouching) * box_size;
        BoxAxis axis{out * (Doubles(1.0) / distance), distance};
        if (!none(touches & !apart)) {
            const BoxAxis deepest = deepest_axis(core, common_size(box_size, length));
            axis = {select(apart, axis.outward, deepest.outward), select(apart, axis.separation, deepest.separation)};
        }
        const Doubles beside = select(apart, Doubles(0.0), Doubles(kTouching) * box_size);
        return points_of(f, core, half_segment, radius, axis, apart, t, touches, common_size(box_size, greatest(length, radius)), beside);
    }
};

void CapsuleBoxLanes(const BatchInput& input, std::span<const std::uint32_t> chosen, ManifoldList& out) {
    run<CapsuleBox>(input, chosen, ShapeType::Capsule, out);
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(CapsuleBoxLanes);

void capsule_box_lanes(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace&, ManifoldList& out) {
    HWY_DYNAMIC_DISPATCH(CapsuleBoxLanes)(input, chosen, out);
}
}  // namespace carom::detail
#endif
