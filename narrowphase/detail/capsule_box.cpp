// Capsule against box, in the box's frame, where the three coordinates are all alike: the core of the capsule is the segment c + t d with t in
// [-1, 1], the box is |x| <= h.
//
// Apart: the distance from the box, sqrt(sum of e_i^2) with e_i by how much |c_i + t d_i| exceeds h_i, is convex in t. The derivative of its
// square is linear between the six t at which a coordinate comes in between the faces or leaves, so it is zero between the last of these at
// which it is not positive and the first at which it is not negative. Deep: the greatest separation over three faces and three edge axes.
// Then the stretch of the core over the face that faces it most, seen along the normal. No search, no loop whose length depends on the pair:
// capsule_box_lanes.cpp does the same operations in the same order, eight pairs at a time, with the same bits.
#include <carom/narrowphase/detail/box_names.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/round_contact.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

struct Core {
    dvec3 centre{0.0}, along{0.0};  // c, d
    double length = 0.0;            // of the whole segment
    [[nodiscard]] dvec3 at(double t) const noexcept { return centre + t * along; }
};

constexpr int next(int axis) noexcept { return (axis + 1) % 3; }
double sign_of(double x) noexcept { return x < 0.0 ? -1.0 : 1.0; }

// By how much x leaves the interval [-h, h].
double excess(double x, double h) noexcept { return x < -h ? x + h : (x > h ? x - h : 0.0); }

// Half of the derivative of the squared distance, of coordinate i.
double slope_of(const Core& core, const dvec3& half, double t, int i) noexcept {
    return core.along[i] * excess(core.centre[i] + t * core.along[i], half[i]);
}
double whole_slope(const Core& core, const dvec3& half, double t) noexcept {
    return slope_of(core, half, t, 0) + slope_of(core, half, t, 1) + slope_of(core, half, t, 2);
}

// The parameter of a point of the core closest to the box.
double closest_parameter(const Core& core, const dvec3& half) noexcept {
    double low = -1.0, high = 1.0;
    double before = whole_slope(core, half, low), after = whole_slope(core, half, high);
    for (int i = 0; i < 3; ++i) {
        const double inverse = 1.0 / core.along[i];
        for (const double side : {-half[i], half[i]}) {
            const double t = (side - core.centre[i]) * inverse;
            if (!(t > -1.0 && t < 1.0)) continue;
            // Coordinate i is on its face here and adds nothing, whatever rounding says.
            const double slope = slope_of(core, half, t, next(i)) + slope_of(core, half, t, next(next(i)));
            if (slope <= 0.0 && t > low) low = t, before = slope;
            if (slope >= 0.0 && t < high) high = t, after = slope;
        }
    }
    if (!(before < 0.0)) return low;
    if (!(after > 0.0)) return high;
    return low + (high - low) * (before / (before - after));
}

struct BoxAxis {
    dvec3 outward{0.0};       // from the box to the core
    double separation = 0.0;  // of the core
};

// Where the core reaches into the box or touches it. An edge axis is square to the core, which is as near all along then.
BoxAxis deepest_axis(const Core& core, const dvec3& half, double size) noexcept {
    const dvec3 &c = core.centre, &d = core.along;
    const auto of_face = [&](int i) { return std::abs(c[i]) - std::abs(d[i]) - half[i]; };
    int face = 0;
    for (int i = 1; i < 3; ++i) {
        if (of_face(i) > of_face(face)) face = i;
    }
    BoxAxis axis{dvec3{0.0}, of_face(face)};
    axis.outward[face] = sign_of(c[face]);
    double needed = axis.separation + kFacePreference * size;
    const double dd = glm::dot(d, d);
    for (int i = 0; i < 3; ++i) {
        const int j = next(i), k = next(j);
        const double length_sq = d[k] * d[k] + d[j] * d[j];
        if (!(length_sq > kParallelSine * kParallelSine * dd)) continue;
        const double inverse = 1.0 / std::sqrt(length_sq), height = d[k] * c[j] - d[j] * c[k];
        const double separation = (std::abs(height) - (std::abs(d[k]) * half[j] + std::abs(d[j]) * half[k])) * inverse;
        if (!(separation > needed)) continue;
        needed = separation;
        const double scale = sign_of(height) * inverse;
        axis = {dvec3{0.0}, separation};
        axis.outward[j] = d[k] * scale;
        axis.outward[k] = -d[j] * scale;
    }
    return axis;
}

// A side of the face: where the core crosses the plane through it along the normal.
struct Cut {
    double t = 0.0;
    std::int32_t edge = 0;
};

// The face that faces the core most, and the stretch of the core over it. There is one, as the core is over the face where it is nearest; but
// where it is beside the face by little more than what is allowed for, and nearly along its side, rounding may put low after high, or both far along the core.
struct FaceStretch {
    int axis = 0;
    double sign = 1.0;           // of its normal
    double inverse_slope = 1.0;  // of its normal along the axis of contact
    double offset = 0.0;         // of the face
    Cut low{-1.0, 0}, high{1.0, 0};

    // How far the core is from the plane of the face, along the normal of contact.
    [[nodiscard]] double distance(const dvec3& p) const noexcept { return (sign * p[axis] - offset) * inverse_slope; }
};

// @param from, to  by how much the ends of the core are outside of the side. @param inverse  of their difference.
void cut_by_side(double from, double to, double inverse, double allowed, std::int32_t edge, FaceStretch& stretch) noexcept {
    if (from <= allowed && to <= allowed) return;
    const double t = 2.0 * clamp01(from * inverse) - 1.0;
    if (from > to) {
        if (t > stretch.low.t) stretch.low = {t, edge};
    } else if (t < stretch.high.t) {
        stretch.high = {t, edge};
    }
}

FaceStretch stretch_over_face(const Core& core, const dvec3& half, const dvec3& outward, double allowed) noexcept {
    FaceStretch stretch;
    for (int i = 1; i < 3; ++i) {
        if (std::abs(outward[i]) > std::abs(outward[stretch.axis])) stretch.axis = i;
    }
    stretch.sign = sign_of(outward[stretch.axis]);
    stretch.inverse_slope = 1.0 / std::abs(outward[stretch.axis]);
    stretch.offset = half[stretch.axis];
    const dvec3 ends[2] = {core.centre - core.along, core.centre + core.along};
    const double distances[2] = {stretch.distance(ends[0]), stretch.distance(ends[1])};
    for (int i = 0; i < 3; ++i) {
        if (i == stretch.axis) continue;
        const double from = ends[0][i] - distances[0] * outward[i], to = ends[1][i] - distances[1] * outward[i];
        const double inverse = 1.0 / (from - to);
        for (const int side : {0, 1}) {
            const double turn = side == 0 ? -1.0 : 1.0;
            const std::int32_t corner = (side << i) | ((stretch.sign < 0.0 ? 0 : 1) << stretch.axis);
            cut_by_side(turn * from - half[i], turn * to - half[i], turn * inverse, allowed, edge_number(3 - i - stretch.axis, corner),
                        stretch);
        }
    }
    return stretch;
}

enum class Ends : unsigned char { From, To, Either };

// After the end of the core that the point is at, or within kSnap of the core's length of, otherwise after the edge that cuts the core there.
std::uint64_t name_of(const Cut& cut, Ends ends) noexcept {
    if (ends != Ends::To && cut.t < 2.0 * kSnap - 1.0) return feature_name(FeatureKind::VertexOfFirst, 0, 0);
    if (ends != Ends::From && cut.t > 1.0 - 2.0 * kSnap) return feature_name(FeatureKind::VertexOfFirst, 1, 0);
    return feature_name(FeatureKind::Edges, 0, static_cast<std::uint32_t>(cut.edge));
}

}  // namespace

CollideStatus capsule_box(const PairFrame& pair, Workspace&, ManifoldSink& sink) {
    const Capsule& capsule = as<Capsule>(pair.first);
    const dvec3 half(as<Box>(pair.second).half_extents);
    const double half_segment = static_cast<double>(capsule.half_segment), radius = static_cast<double>(capsule.radius);
    const dvec3 axis_y{pair.rotation[0].y, pair.rotation[1].y, pair.rotation[2].y};
    const Core core{pair.to_second(dvec3{0.0}), half_segment * axis_y, 2.0 * half_segment};

    const double t = closest_parameter(core, half);
    const dvec3 nearest = core.at(t);
    const dvec3 out{excess(nearest.x, half.x), excess(nearest.y, half.y), excess(nearest.z, half.z)};
    const double distance = std::sqrt(glm::dot(out, out));
    if (!(distance - radius <= pair.margin)) return CollideStatus::Ok;

    const double box_size = 2.0 * std::max({half.x, half.y, half.z});
    const bool apart = distance > kTouching * box_size;
    const BoxAxis axis = apart ? BoxAxis{out * (1.0 / distance), distance} : deepest_axis(core, half, common_size(box_size, core.length));
    const double size = common_size(box_size, std::max(core.length, radius));
    // What counts as touching may be beside a face by as much.
    const FaceStretch stretch = stretch_over_face(core, half, axis.outward, kInsideTolerance * size + (apart ? 0.0 : kTouching * box_size));

    Patch patch;
    patch.normal = -(pair.rotation * axis.outward);
    const auto add = [&](double s, double separation, std::uint64_t name) {
        add_ball(patch, dvec3{0.0, s * half_segment, 0.0}, radius, separation, name);
    };
    const double low = stretch.distance(core.at(stretch.low.t)), high = stretch.distance(core.at(stretch.high.t));
    const double tolerance = kPointTolerance * size;
    const bool lost = std::min(low, high) > axis.separation + tolerance;  // the stretch has missed what is nearest, by rounding
    const bool has_low = !lost && low - radius <= pair.margin, has_high = !lost && high - radius <= pair.margin;
    const dvec3 across = glm::cross(axis.outward, core.along) * (stretch.high.t - stretch.low.t);
    if (has_low && has_high && stretch.low.t < stretch.high.t && glm::dot(across, across) > tolerance * tolerance) {
        add(stretch.low.t, low, name_of(stretch.low, Ends::From));
        add(stretch.high.t, high, name_of(stretch.high, Ends::To));
    } else if (has_high && !(has_low && low <= high)) {
        add(stretch.high.t, high, name_of(stretch.high, Ends::Either));
    } else if (has_low) {
        add(stretch.low.t, low, name_of(stretch.low, Ends::Either));
    } else {  // the nearest point stands in, or the lowest end of what reaches into the box
        const double rise = glm::dot(axis.outward, core.along);
        const double stand_in = apart || !(std::abs(rise) > tolerance) ? t : (rise > 0.0 ? -1.0 : 1.0);
        add(stand_in, axis.separation, name_of({stand_in, 0}, Ends::Either));
    }
    sink.add(patch);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
