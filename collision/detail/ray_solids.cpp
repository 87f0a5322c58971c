// Lines against solids.
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/ray_solids.hpp>
#include <carom/collision/detail/widen.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::geo {
namespace {

/// What remains of a direction across an axis is zero below this part of its square: a line that drifts aside by 2^-100
/// of its length.
constexpr double kParallel = 0x1p-200;

/// The interval in which |from + t along| <= radius, of vectors in space or in the plane across an axis.
/// @param direction_sq  the square of the whole direction, against which `along` counts as zero.
std::optional<Chord> within_radius(const dvec3& from, const dvec3& along, double radius, double direction_sq) noexcept {
    const double along_sq = glm::dot(along, along);
    const double outside = glm::dot(from, from) - radius * radius;
    if (along_sq <= kParallel * direction_sq) {
        return outside <= 0.0 ? std::optional(Chord{}) : std::nullopt;
    }
    // From the point of closest approach: b² - 4ac would lose every digit for far origins.
    const double middle = -glm::dot(from, along) / along_sq;
    const dvec3 closest = from + middle * along;
    const double half_sq = radius * radius - glm::dot(closest, closest);
    if (!(half_sq >= 0.0)) {
        return std::nullopt;
    }
    const double half = std::sqrt(half_sq / along_sq);
    Chord chord;
    chord.enter = middle - half;
    chord.exit = middle + half;
    // An origin near the surface: the root there comes from the product of both, in which nothing cancels but what is
    // given.
    if (half > 0.5 * std::abs(middle)) {
        if (middle >= 0.0 && chord.exit > 0.0) {
            chord.enter = std::min(outside / (along_sq * chord.exit), chord.exit);
        } else if (middle < 0.0 && chord.enter < 0.0) {
            chord.exit = std::max(outside / (along_sq * chord.enter), chord.enter);
        }
    }
    return chord;
}

/// Cuts `chord` to low <= height + t rate <= high; the normals are those of the two ends.
/// @return false where nothing remains.
bool cut(Chord& chord, double to_low, double to_high, double rate, const dvec3& normal_low, const dvec3& normal_high) noexcept {
    if (rate == 0.0) {  // ±0: parallel
        return to_low <= 0.0 && to_high >= 0.0;
    }
    double first = to_low / rate;
    double last = to_high / rate;
    if (rate < 0.0) {
        std::swap(first, last);
    }
    if (first > chord.enter) {
        chord.enter = first;
        chord.normal_enter = rate > 0.0 ? normal_low : normal_high;
    }
    if (last < chord.exit) {
        chord.exit = last;
        chord.normal_exit = rate > 0.0 ? normal_high : normal_low;
    }
    return chord.enter <= chord.exit;
}

/// A line about an axis from a point: heights in lengths of `axis`, and what is across it.
struct AxisFrame {
    dvec3 axis;  ///< scaled by a power of two where it is so short or long that its square would lose its bits
    double top;  ///< the height of the axis as it was given: 1 but for such
    double height;
    double climb;
    dvec3 across;
    dvec3 drift;

    AxisFrame(const dvec3& from, const dvec3& direction, const dvec3& given) noexcept
        : axis(std::ldexp(1.0, -excess(largest(given))) * given),
          top(std::ldexp(1.0, excess(largest(given)))),
          height(glm::dot(from, axis) / glm::dot(axis, axis)),
          climb(glm::dot(direction, axis) / glm::dot(axis, axis)),
          across(from - height * axis),
          drift(direction - climb * axis) {}
};

/// The cylinder of `radius` about axis from `base`, without normals at its side.
std::optional<Chord> cylinder_chord(const AxisFrame& f, double radius, double direction_sq) noexcept {
    std::optional<Chord> chord = within_radius(f.across, f.drift, radius, direction_sq);
    if (!chord || !cut(*chord, -f.height, f.top - f.height, f.climb, -f.axis, f.axis)) {
        return std::nullopt;
    }
    return chord;
}

void widen(std::optional<Chord>& chord, const std::optional<Chord>& other) noexcept {
    if (!chord) {
        chord = other;
    } else if (other) {
        chord->enter = std::min(chord->enter, other->enter);
        chord->exit = std::max(chord->exit, other->exit);
    }
}

/// The next for a line parallel to the axis: of a slender cone the square of the slope underflows, or the slope itself.
Chord parallel_chord(const AxisFrame& f, double radius) noexcept {
    const double most = largest(f.across);
    const dvec3 across = most > 0.0 ? f.across / most : dvec3{0.0};  // of which squares do not underflow
    const double height = most > 0.0 ? most / radius * std::sqrt(glm::dot(across, across)) : 0.0;
    Chord chord;
    (f.climb > 0.0 ? chord.enter : chord.exit) = (height - f.height) / f.climb;
    return chord;
}

/// Where the line is in the infinite cone f.height >= 0, |across| <= radius height; `f` starts near the tip.
std::optional<Chord> cone_chord(const AxisFrame& f, double radius) noexcept {
    const double drift_sq = glm::dot(f.drift, f.drift);
    // Less than what rounding makes of the radius on the way: squares and products of so little may underflow in part.
    const bool parallel = drift_sq == 0.0 || largest(f.drift) <= 0x1p-60 * radius * std::abs(f.climb);
    if (parallel && f.climb != 0.0) return parallel_chord(f, radius);
    const double a = 0.0 + (drift_sq - radius * f.climb * (radius * f.climb));  // never -0
    const double b = glm::dot(f.across, f.drift) - radius * f.height * (radius * f.climb);
    const double c = glm::dot(f.across, f.across) - radius * f.height * (radius * f.height);
    const dvec3 at_tip = f.height * f.drift - f.climb * f.across;
    const dvec3 moment = glm::cross(f.across, f.drift);
    const double discriminant = radius * radius * glm::dot(at_tip, at_tip) - glm::dot(moment, moment);
    if (a > 0.0 && discriminant < 0.0) {
        return std::nullopt;
    }
    const double q = -(b + std::copysign(std::sqrt(std::max(0.0, discriminant)), b));
    double low = q == 0.0 ? 0.0 : q / a;
    double high = q == 0.0 ? 0.0 : c / q;
    if (low > high) {
        std::swap(low, high);
    }
    Chord chord;
    if (a > 0.0 || (a == 0.0 && q != 0.0)) {  // 0: parallel to the side, so that one root is infinite
        chord.enter = low;
        chord.exit = high;
    } else if (f.climb > 0.0) {  // steeper than the side: inside from one root on, in the other half of the double cone
                                 // to the other
        chord.enter = high;
    } else {
        chord.exit = low;
    }
    return chord;
}

/// Where the line `from` + t `d` is in a cone, its tip at the origin, with the normals. @param from  near the tip.
std::optional<Chord> whole_cone_chord(const dvec3& from, const dvec3& d, const dvec3& axis, double radius) noexcept {
    const AxisFrame f(from, d, axis);
    const double slope = radius / f.top;
    std::optional<Chord> chord = cone_chord(f, slope);
    if (!chord || !cut(*chord, -f.height, f.top - f.height, f.climb, -f.axis, f.axis)) {
        return std::nullopt;
    }
    const dvec3 back = slope / glm::dot(f.axis, f.axis) * f.axis;
    const auto side_normal = [&](double t) {  // the gradient of |across| - radius height; at the tip, against the axis
        const dvec3 across = f.across + t * f.drift;
        const double distance = std::sqrt(glm::dot(across, across));
        return (distance > 0.0 ? across / distance : dvec3{0.0}) - back;
    };
    chord->normal_enter = chord->normal_enter == dvec3{0.0} ? side_normal(chord->enter) : chord->normal_enter;
    chord->normal_exit = chord->normal_exit == dvec3{0.0} ? side_normal(chord->exit) : chord->normal_exit;
    return chord;
}

/// The same for one that is next to flat, in units in which squares do not overflow; no flatter than 2^-400 of `size`, the largest
/// of the lengths.
std::optional<Chord> flat_cone_chord(const dvec3& from, const dvec3& d, const dvec3& axis, double radius, double size) noexcept {
    const double length_unit = std::ldexp(1.0, std::ilogb(size));
    const double direction_unit = std::ldexp(1.0, std::ilogb(largest(d)));
    const int thin = std::max(std::ilogb(largest(axis)) - std::ilogb(size), -400) - std::ilogb(largest(axis));
    const dvec3 scaled{std::ldexp(axis.x, thin), std::ldexp(axis.y, thin), std::ldexp(axis.z, thin)};
    std::optional<Chord> chord = whole_cone_chord(from / length_unit, d / direction_unit, scaled, radius / length_unit);
    if (chord) {
        chord->enter *= length_unit / direction_unit;
        chord->exit *= length_unit / direction_unit;
    }
    return chord;
}

}  // namespace

std::optional<Chord> intersect(const Sphere<double>& sphere, const Line& line) noexcept {
    const dvec3 from = line.origin - sphere.center;
    std::optional<Chord> chord = within_radius(from, line.direction, sphere.radius, 0.0);
    if (chord) {
        chord->normal_enter = from + chord->enter * line.direction;
        chord->normal_exit = from + chord->exit * line.direction;
    }
    return chord;
}

std::optional<Chord> intersect(const Aabb<double>& box, const Line& line) noexcept {
    Chord chord;
    for (int k = 0; k < 3; ++k) {
        dvec3 normal{0.0};
        normal[k] = 1.0;
        if (!cut(chord, box.lower[k] - line.origin[k], box.upper[k] - line.origin[k], line.direction[k], -normal, normal)) {
            return std::nullopt;
        }
    }
    return chord;
}

std::optional<Chord> intersect(const Obb<double>& box, const Line& line) noexcept {
    const dvec3 from = line.origin - box.center;
    Chord chord;
    for (int k = 0; k < 3; ++k) {
        const dvec3& axis = box.axes[k];
        const double at = glm::dot(axis, from);
        const double half = box.half_extents[k];
        if (!cut(chord, -half - at, half - at, glm::dot(axis, line.direction), -axis, axis)) {
            return std::nullopt;
        }
    }
    return chord;
}

std::optional<Chord> intersect(const Capsule<double>& capsule, const Line& line) noexcept {
    const double direction_sq = glm::dot(line.direction, line.direction);
    const dvec3 axis = capsule.axis.b - capsule.axis.a;
    const double axis_sq = glm::dot(axis, axis);
    const dvec3 from = line.origin - capsule.axis.a;
    std::optional<Chord> chord = within_radius(from, line.direction, capsule.radius, 0.0);
    if (axis_sq > 0.0) {
        widen(chord, within_radius(line.origin - capsule.axis.b, line.direction, capsule.radius, 0.0));
        widen(chord, cylinder_chord({from, line.direction, axis}, capsule.radius, direction_sq));
    }
    if (!chord) {
        return std::nullopt;
    }
    const auto normal_at = [&](double t) {
        const dvec3 point = from + t * line.direction;
        const double along = axis_sq > 0.0 ? std::clamp(glm::dot(point, axis) / axis_sq, 0.0, 1.0) : 0.0;
        return point - along * axis;
    };
    chord->normal_enter = normal_at(chord->enter);
    chord->normal_exit = normal_at(chord->exit);
    return chord;
}

std::optional<Chord> intersect(const Cylinder<double>& cylinder, const Line& line) noexcept {
    if (cylinder.axis.a == cylinder.axis.b) {
        return std::nullopt;  // scaled away
    }
    const AxisFrame f(line.origin - cylinder.axis.a, line.direction, cylinder.axis.b - cylinder.axis.a);
    std::optional<Chord> chord = cylinder_chord(f, cylinder.radius, glm::dot(line.direction, line.direction));
    if (chord) {
        chord->normal_enter = chord->normal_enter == dvec3{0.0} ? f.across + chord->enter * f.drift : chord->normal_enter;
        chord->normal_exit = chord->normal_exit == dvec3{0.0} ? f.across + chord->exit * f.drift : chord->normal_exit;
    }
    return chord;
}

std::optional<Chord> intersect(const Cone<double>& cone, const Line& line) noexcept {
    const dvec3& d = line.direction;
    const dvec3 axis = cone.base_center - cone.tip;
    if (axis == dvec3{0.0}) {
        return std::nullopt;  // scaled away
    }
    dvec3 from = line.origin - cone.tip;
    const double approach = -glm::dot(from, d) / glm::dot(d, d);
    from += approach * d;
    const double size = std::max(largest(from), cone.radius);
    std::optional<Chord> chord =
        largest(axis) < 0x1p-100 * size ? flat_cone_chord(from, d, axis, cone.radius, size) : whole_cone_chord(from, d, axis, cone.radius);
    if (chord) {
        chord->enter += approach;
        chord->exit += approach;
    }
    return chord;
}

std::optional<Chord> intersect(const Plane<double>& plane, const Line& line) noexcept {
    const double below = -accurate_dot(plane.normal, line.origin, plane.offset);
    const double rate = accurate_dot(plane.normal, line.direction, 0.0);
    Chord chord;
    if (rate > 0.0) {
        chord.exit = below / rate;
        chord.normal_exit = plane.normal;
    } else if (rate < 0.0) {
        chord.enter = below / rate;
        chord.normal_enter = plane.normal;
    } else if (below < 0.0) {
        return std::nullopt;
    }
    return chord;
}

}  // namespace carom::geo
