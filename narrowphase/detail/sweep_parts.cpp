#include <carom/narrowphase/detail/sweep_parts.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

/// The times at which |d t - q| <= radius; empty where to < from.
struct Within {
    double from = kNoContact;
    double to = -1.0;
};

dvec3 times_power(const dvec3& v, int exponent) noexcept {
    return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

Within within_usual(const dvec3& q, const dvec3& d, double radius) noexcept {
    constexpr double kEver = std::numeric_limits<double>::infinity();
    const double dd = glm::dot(d, d);
    const double away = glm::length(q);
    if (!(dd > 0.0)) return away <= radius ? Within{-kEver, kEver} : Within{};
    const dvec3 aside = glm::cross(q, d);
    const double room = radius * radius * dd - glm::dot(aside, aside);
    if (!(room >= 0.0)) return {};
    const double along = glm::dot(q, d), root = std::sqrt(room);
    const double product = (away - radius) * (away + radius);  // of the two times, times dd
    if (along > 0.0) return {product / (along + root), (along + root) / dd};
    if (along < 0.0) return {(along - root) / dd, product / (along - root)};
    return {-root / dd, root / dd};
}

Within within(const dvec3& q, const dvec3& d, double radius) noexcept {
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    if (largest >= kShortMotion || largest == 0.0) return within_usual(q, d, radius);
    const int exponent = std::ilogb(largest);
    const Within scaled = within_usual(q, times_power(d, -exponent), radius);
    return scaled.to < scaled.from ? Within{} : Within{std::ldexp(scaled.from, -exponent), std::ldexp(scaled.to, -exponent)};
}

/// @param gap  from the moving point to the part at t; @param otherwise  the normal where the two coincide, to within rounding.
SweepPart contact(double t, const dvec3& gap, const SweepPath& path, const dvec3& otherwise) noexcept {
    const double length = glm::length(gap);
    const double whole = glm::length(otherwise);
    if (length > 1e-9 * path.size) return {t, gap / length};
    return {t, whole > 0.0 ? otherwise / whole : dvec3{0.0}};
}

}  // namespace

SweepPart sweep_point(const SweepPath& path, const dvec3& q, double first) noexcept {
    const Within w = within(q, path.motion, path.radius);
    if (!(w.from <= 1.0 && w.to >= 0.0)) return {};
    const double t = std::max(w.from * kRounded, 0.0);
    if (!(t < first)) return {};
    return contact(t, q - t * path.motion, path, path.motion);
}

SweepPart sweep_segment(const SweepPath& path, const dvec3& q, const dvec3& u, double first) noexcept {
    const double uu = glm::dot(u, u);
    if (!(uu > kShortSegment * kShortSegment)) return sweep_point(path, q, first);
    // Round the axis: the components across it, turned by a right angle.
    const double length = std::sqrt(uu);
    const dvec3 along = u / length;
    const Within w = within(glm::cross(q, along), glm::cross(path.motion, along), path.radius);
    if (!(w.from <= 1.0 && w.to >= 0.0)) return {};
    const double t = std::max(w.from * kRounded, 0.0);
    const double s = glm::dot(t * path.motion - q, along);
    if (s >= 0.0 && s <= length) return t < first ? contact(t, q + s * along - t * path.motion, path, path.motion) : SweepPart{};
    // Grown, so that what enters the round past an end and sinks on its way in does not slip between the two by rounding.
    SweepPath ends = path;
    ends.radius += kGrowth * path.size;
    const SweepPart near = sweep_point(ends, q, first);
    return earlier(near, sweep_point(ends, q + u, std::min(near.t, first)));
}

SweepFace::SweepFace(const SweepPath& path, const dvec3& corner, const dvec3& side_u, const dvec3& side_v) noexcept
    : q(corner),
      u(side_u),
      v(side_v),
      area(glm::cross(u, v)),
      length_u(glm::length(u)),
      length_v(glm::length(v)),
      twice(glm::length(area)) {
    const double product = length_u * length_v, longest = std::max(length_u, length_v);
    needle = longest < kShortFace || !(kGrowth * path.size * product * longest < twice * twice);
    slack = needle ? 0.0 : kGrowth * (product / twice) * path.size;
}

double SweepFace::rim_growth() const noexcept {
    if (!needle) return 2.0 * slack;
    const double longest = std::max(length_u, length_v), rounding = kGrowth * std::min(length_u, length_v);
    return longest > 0.0 ? twice / longest + rounding : 0.0;
}

SweepPart sweep_face(const SweepPath& path, const SweepFace& face, FaceKind kind) noexcept {
    if (face.needle) return {};
    // Half of it, which is enough: what enters beside the face below this height, and what rounding adds, the rim is to hold.
    const double radius = path.radius + 0.5 * face.slack;
    dvec3 n = face.area / face.twice;
    double height = -glm::dot(n, face.q);  // of the moving point over the face
    if (height < 0.0) n = -n, height = -height;
    const double fall = -glm::dot(n, path.motion);
    double t = 0.0;
    if (height > radius) {
        if (!(fall > 0.0)) return {};
        t = (height - radius) / fall * kRounded;
        if (!(t <= 1.0)) return {};
    }
    const dvec3 p = t * path.motion - face.q;
    const double r = glm::dot(glm::cross(p, face.v), face.area), s = glm::dot(glm::cross(face.u, p), face.area);
    const double whole = face.twice * face.twice, margin = face.slack * face.twice;
    const double rim_r = margin * face.length_v, rim_s = margin * face.length_u;
    const bool inside = r >= -rim_r && s >= -rim_s &&
                        (kind == FaceKind::Triangle ? r + s <= whole + rim_r + rim_s : r <= whole + rim_r && s <= whole + rim_s);
    return inside ? SweepPart{t, -n} : SweepPart{};
}

namespace {

/// Along one axis of a box: the planes of the two faces, and when the point crosses them. Motions that the least growth hides are none.
struct Slab {
    double near = 0.0, speed = 0.0;
    double in = 0.0, out = 0.0;          ///< it is between the two from..to
    double reaches = 0.0, leaves = 0.0;  ///< the same for the planes moved outward by the radius
};

Slab slab_of(double d, double lower, double upper, double radius) noexcept {
    constexpr double kEver = std::numeric_limits<double>::infinity();
    if (!(std::abs(d) > kHiddenSpeed)) {
        const bool inside = lower <= 0.0 && upper >= 0.0, grown = lower <= radius && upper >= -radius;
        return {lower > 0.0 ? lower : upper, 0.0, inside ? -kEver : kEver, kEver, grown ? -kEver : kEver, kEver};
    }
    const double inverse = 1.0 / d, near = d > 0.0 ? lower : upper, far = d > 0.0 ? upper : lower, around = radius * std::abs(inverse);
    const double in = near * inverse, out = far * inverse;
    return {near, d, in, out, in - around, out + around};
}

/// @return the normal, as long as it comes out, of the face whose plane the point crosses last on its way in.
dvec3 last_face(const std::array<Slab, 3>& slabs) noexcept {
    dvec3 face{0.0};
    double last = -1.0;
    for (int k = 0; k < 3; ++k) {
        const Slab& slab = slabs[static_cast<std::size_t>(k)];
        if (slab.speed == 0.0 || !(slab.in > last)) continue;
        last = slab.in;
        face = dvec3{0.0};
        face[k] = slab.speed;
    }
    return face;
}

/// A point that is outside of a box and comes to within a radius of it: piece by piece between the planes that it crosses, since in each its squared distance is
/// quadratic. Times are right to two roundings, so what is counted in the wrong piece is within two of a plane.
/// @param slabs  all of them are reached before `to`. @param from  when the last of them is, or 0.
SweepPart sweep_pieces(const SweepPath& path, const std::array<Slab, 3>& slabs, const dvec3& lower, const dvec3& upper, double from,
                       double to) noexcept {
    for (;;) {
        double end = to;
        dvec3 q{0.0}, along{0.0};
        for (int k = 0; k < 3; ++k) {
            const Slab& slab = slabs[static_cast<std::size_t>(k)];
            const bool before = slab.in > from, inside = !before && slab.out > from;
            if (before) end = std::min(end, slab.in);
            if (inside) {
                end = std::min(end, slab.out);
                continue;
            }
            q[k] = before ? slab.near : slab.speed > 0.0 ? upper[k] : lower[k];
            along[k] = slab.speed;
        }
        const Within w = within(q, along, path.radius);
        if (w.from <= end && w.to >= from) {
            const double t = std::max(w.from, from) * kRounded;
            const dvec3 p = t * path.motion;
            return contact(t, glm::clamp(p, lower, upper) - p, path, last_face(slabs));
        }
        if (!(end < to)) return {};
        from = end;
    }
}

}  // namespace

SweepPart sweep_box(const SweepPath& path, const dvec3& lower, const dvec3& upper) noexcept {
    const dvec3& d = path.motion;
    const std::array<Slab, 3> slabs{slab_of(d.x, lower.x, upper.x, path.radius), slab_of(d.y, lower.y, upper.y, path.radius),
                                    slab_of(d.z, lower.z, upper.z, path.radius)};
    const double reaches = std::max({slabs[0].reaches, slabs[1].reaches, slabs[2].reaches});
    const double leaves = std::min({1.0, slabs[0].leaves, slabs[1].leaves, slabs[2].leaves}) * (2.0 - kRounded);
    const double from = std::max(0.0, reaches * kRounded);
    // A corner of the box with its sides moved outward is farther from the grown box than rounding may move a time.
    if (!(from <= leaves)) return {};
    if (reaches > 0.0) {  // straight onto a face, where the two are the same
        const std::size_t k = reaches == slabs[0].reaches ? 0 : reaches == slabs[1].reaches ? 1 : 2;
        const Slab &i = slabs[(k + 1) % 3], &j = slabs[(k + 2) % 3];
        if (i.in <= reaches && i.out >= reaches && j.in <= reaches && j.out >= reaches) {
            SweepPart face{from, dvec3{0.0}};
            face.normal[static_cast<int>(k)] = slabs[k].speed > 0.0 ? 1.0 : -1.0;
            return face;
        }
    }
    return sweep_pieces(path, slabs, lower, upper, from, std::min(leaves, 1.0));
}

}  // namespace carom::detail
