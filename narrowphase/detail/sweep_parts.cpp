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

/// Squares of shorter motions, times those of the least radius, underflow; below these lengths segments and faces are less than growth hides.
constexpr double kShortMotion = 1e-60;
constexpr double kShortSegment = 1e-100;
constexpr double kShortFace = 1e-69;

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

SweepPart sweep_point(const SweepPath& path, const dvec3& q) noexcept {
    const Within w = within(q, path.motion, path.radius);
    if (!(w.from <= 1.0 && w.to >= 0.0)) return {};
    const double t = std::max(w.from * kRounded, 0.0);
    return contact(t, q - t * path.motion, path, path.motion);
}

SweepPart sweep_segment(const SweepPath& path, const dvec3& q, const dvec3& u) noexcept {
    const double uu = glm::dot(u, u);
    if (!(uu > kShortSegment * kShortSegment)) return sweep_point(path, q);
    // Round the axis: the components across it, turned by a right angle.
    const double length = std::sqrt(uu);
    const dvec3 along = u / length;
    const Within w = within(glm::cross(q, along), glm::cross(path.motion, along), path.radius);
    if (!(w.from <= 1.0 && w.to >= 0.0)) return {};
    const double t = std::max(w.from * kRounded, 0.0);
    const double s = glm::dot(t * path.motion - q, along);
    if (s >= 0.0 && s <= length) return contact(t, q + s * along - t * path.motion, path, path.motion);
    // Grown, so that what enters the round past an end and sinks on its way in does not slip between the two by rounding.
    SweepPath ends = path;
    ends.radius += kGrowth * path.size;
    return earlier(sweep_point(ends, q), sweep_point(ends, q + u));
}

bool is_needle(const SweepPath& path, const dvec3& u, const dvec3& v) noexcept {
    const double twice = glm::length(glm::cross(u, v)), a = glm::length(u), b = glm::length(v);
    if (std::max(a, b) < kShortFace) return true;
    return !(kGrowth * path.size * (a * b) * std::max(a, b) < twice * twice);
}

double face_slack(const SweepPath& path, const dvec3& u, const dvec3& v) noexcept {
    return kGrowth * (glm::length(u) * glm::length(v) / glm::length(glm::cross(u, v))) * path.size;
}

double rim_growth(const SweepPath& path, const dvec3& u, const dvec3& v) noexcept {
    if (!is_needle(path, u, v)) return 2.0 * face_slack(path, u, v);
    const double longest = std::max(glm::length(u), glm::length(v));
    const double rounding = kGrowth * std::min(glm::length(u), glm::length(v));
    return longest > 0.0 ? glm::length(glm::cross(u, v)) / longest + rounding : 0.0;
}

SweepPart sweep_face(const SweepPath& path, const dvec3& q, const dvec3& u, const dvec3& v, FaceKind kind) noexcept {
    const dvec3 area = glm::cross(u, v);
    const double twice = glm::length(area);
    if (is_needle(path, u, v)) return {};
    // Half of it, which is enough: what enters beside the face below this height, and what rounding adds, the rim is to hold.
    const double slack = face_slack(path, u, v), radius = path.radius + 0.5 * slack;
    dvec3 n = area / twice;
    double height = -glm::dot(n, q);  // of the moving point over the face
    if (height < 0.0) n = -n, height = -height;
    const double fall = -glm::dot(n, path.motion);
    double t = 0.0;
    if (height > radius) {
        if (!(fall > 0.0)) return {};
        t = (height - radius) / fall * kRounded;
        if (!(t <= 1.0)) return {};
    }
    const dvec3 p = t * path.motion - q;
    const double r = glm::dot(glm::cross(p, v), area), s = glm::dot(glm::cross(u, p), area);
    const double whole = twice * twice, rim_r = slack * twice * glm::length(v), rim_s = slack * twice * glm::length(u);
    const bool inside = r >= -rim_r && s >= -rim_s &&
                        (kind == FaceKind::Triangle ? r + s <= whole + rim_r + rim_s : r <= whole + rim_r && s <= whole + rim_s);
    return inside ? SweepPart{t, -n} : SweepPart{};
}

SweepPart sweep_box(const SweepPath& path, const dvec3& lower, const dvec3& upper) noexcept {
    const dvec3& d = path.motion;
    // Times at which the point crosses the planes of the faces, in order; between them the squared distance is quadratic.
    std::array<double, 8> time{0.0};
    std::size_t count = 1;
    std::array<double, 3> entered{-1.0, -1.0, -1.0};
    for (int k = 0; k < 3; ++k) {
        if (std::min(0.0, d[k]) > upper[k] + path.radius || std::max(0.0, d[k]) < lower[k] - path.radius) return {};
        if (d[k] == 0.0) continue;
        entered[static_cast<std::size_t>(k)] = (d[k] > 0.0 ? lower[k] : upper[k]) / d[k];
        for (const double plane : {lower[k], upper[k]}) {
            const double t = plane / d[k];
            if (!(t > 0.0 && t < 1.0)) continue;
            std::size_t at = count++;
            for (; at > 0 && time[at - 1] > t; --at) time[at] = time[at - 1];
            time[at] = t;
        }
    }
    time[count] = 1.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double middle = 0.5 * (time[i] + time[i + 1]);
        dvec3 q{0.0}, along{0.0};
        for (int k = 0; k < 3; ++k) {
            const double at = middle * d[k];
            if (at >= lower[k] && at <= upper[k]) continue;
            q[k] = at < lower[k] ? lower[k] : upper[k];
            along[k] = d[k];
        }
        const Within w = within(q, along, path.radius);
        if (!(w.from <= time[i + 1] && w.to >= time[i])) continue;
        const double t = std::max({w.from, time[i], 0.0}) * kRounded;
        const dvec3 p = t * d;
        const auto last = std::max_element(entered.begin(), entered.end()) - entered.begin();
        dvec3 face{0.0};
        face[static_cast<int>(last)] = d[static_cast<int>(last)];
        return contact(t, glm::clamp(p, lower, upper) - p, path, face);
    }
    return {};
}

}  // namespace carom::detail
