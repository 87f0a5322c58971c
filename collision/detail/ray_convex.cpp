// Rays against sphere, box, capsule, half-space and hull.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/detail/ray_local.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The entry of a ray into a ball about the origin that its own origin is outside of.
struct BallEntry {
    double distance = 0.0;
    dvec3 normal{0.0};
};

/// From the point of closest approach, as b² - 4ac would lose every digit for far origins (Haines, Günther, Akenine-Möller, in
/// Ray Tracing Gems, 2019, ch. 7). A second step of the approach removes the rounding of the first.
std::optional<BallEntry> enter_ball(const dvec3& origin, const dvec3& direction, double radius) noexcept {
    const double coarse = -glm::dot(origin, direction);
    dvec3 closest = origin + coarse * direction;
    const double fine = -glm::dot(closest, direction);
    closest += fine * direction;
    const double approach = coarse + fine;
    const double half_chord_sq = radius * radius - glm::dot(closest, closest);
    if (!(approach >= 0.0 && half_chord_sq >= 0.0)) {
        return std::nullopt;
    }
    const double half_chord = std::sqrt(half_chord_sq);
    // An origin outside that approaches is outside by rounding at worst, so that 0 is the nearest answer.
    return BallEntry{std::max(0.0, approach - half_chord), glm::normalize(closest - half_chord * direction)};
}

/// A hit so far off that its point overflows is none.
std::optional<RayHit> within(const LocalRay& ray, const RayHit& hit) noexcept {
    if (hit.distance <= ray.max_distance && is_finite(hit.distance) && is_finite(hit.point)) {
        return hit;
    }
    return std::nullopt;
}

}  // namespace

double free_distance(const LocalRay& ray, const dvec3& center, double radius) noexcept {
    return std::max(0.0, glm::dot(center - ray.origin, ray.direction) - 2.0 * radius);
}

std::optional<RayHit> cast_local(const Sphere& sphere, const LocalRay& ray) noexcept {
    const auto radius = static_cast<double>(sphere.radius);
    if (glm::dot(ray.origin, ray.origin) <= radius * radius) {
        return hit_from_inside(ray);
    }
    const std::optional<BallEntry> entry = enter_ball(ray.origin, ray.direction, radius);
    if (!entry) {
        return std::nullopt;
    }
    return within(ray, {entry->distance, radius * entry->normal, entry->normal, 0});
}

std::optional<RayHit> cast_local(const Box& box, const LocalRay& ray) noexcept {
    const dvec3 half(box.half_extents);
    double enter = -kInfinity;
    double leave = kInfinity;
    int face = 0;
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
        const double o = ray.origin[k];
        const double d = ray.direction[k];
        const bool between = std::abs(o) <= half[k];
        inside = inside && between;
        if (d == 0.0) {  // ±0: parallel to the slab
            if (!between) {
                return std::nullopt;
            }
            continue;
        }
        // Divided, not multiplied by a reciprocal: a small d would make that infinite, and 0 * infinity is NaN.
        const double first = ((d > 0.0 ? -half[k] : half[k]) - o) / d;
        const double last = ((d > 0.0 ? half[k] : -half[k]) - o) / d;
        if (first > enter) {
            enter = first;
            face = k;
        }
        leave = std::min(leave, last);
    }
    if (inside) {
        return hit_from_inside(ray);
    }
    if (!(enter >= 0.0 && enter <= leave)) {
        return std::nullopt;
    }
    dvec3 point = glm::clamp(ray.origin + enter * ray.direction, -half, half);
    dvec3 normal{0.0};
    normal[face] = ray.direction[face] > 0.0 ? -1.0 : 1.0;
    point[face] = normal[face] * half[face];
    return within(ray, {enter, point, normal, 0});
}

// A ray first enters the infinite cylinder. If it does so beside the segment, that is the entry; if beyond an end, only that end's
// ball can be entered, because between the ends the capsule fills the cylinder.
std::optional<RayHit> cast_local(const Capsule& capsule, const LocalRay& ray) noexcept {
    const auto radius = static_cast<double>(capsule.radius);
    const auto end = static_cast<double>(capsule.half_segment);
    const dvec3 from_axis = ray.origin - dvec3{0.0, std::clamp(ray.origin.y, -end, end), 0.0};
    if (glm::dot(from_axis, from_axis) <= radius * radius) {
        return hit_from_inside(ray);
    }
    const double skipped = free_distance(ray, dvec3{0.0}, radius + end);
    const dvec3 origin = ray.origin + skipped * ray.direction;
    const dvec3& direction = ray.direction;

    const dvec2 o{origin.x, origin.z};
    const dvec2 d{direction.x, direction.z};
    const double slope_sq = glm::dot(d, d);
    double cap = direction.y > 0.0 ? -end : end;  // where a ray along the axis comes from
    if (slope_sq > 1e-200) {                      // below, the ray drifts sideways by less than 1e-100 of its length
        const double approach = -glm::dot(o, d) / slope_sq;
        const dvec2 closest = o + approach * d;
        const double half_chord_sq = radius * radius - glm::dot(closest, closest);
        if (!(half_chord_sq >= 0.0)) {
            return std::nullopt;
        }
        const double half_chord = std::sqrt(half_chord_sq / slope_sq);
        const double enter = approach - half_chord;
        const double height = origin.y + enter * direction.y;
        if (std::abs(height) <= end) {
            // Beside the segment the origin is outside the cylinder, so that the sign of the approach decides; beyond an end
            // it may be inside, and an entry behind it means that the ray has left the capsule.
            if (std::abs(origin.y) <= end ? approach < 0.0 : enter < 0.0) {
                return std::nullopt;
            }
            const dvec2 out = glm::normalize(closest - half_chord * d);
            return within(ray, {skipped + std::max(0.0, enter), {radius * out.x, height, radius * out.y}, {out.x, 0.0, out.y}, 0});
        }
        cap = height > 0.0 ? end : -end;
    }
    const dvec3 center{0.0, cap, 0.0};
    const std::optional<BallEntry> entry = enter_ball(origin - center, direction, radius);
    if (!entry) {
        return std::nullopt;
    }
    return within(ray, {skipped + entry->distance, center + radius * entry->normal, entry->normal, 0});
}

std::optional<RayHit> cast_local(const Plane& plane, const LocalRay& ray) noexcept {
    const dvec3 normal(plane.normal);
    const auto offset = static_cast<double>(plane.offset);
    const double above = glm::dot(normal, ray.origin) - offset;
    if (above <= 0.0) {
        return hit_from_inside(ray);
    }
    const double rate = glm::dot(normal, ray.direction);
    if (!(rate < 0.0)) {
        return std::nullopt;
    }
    const double distance = above / -rate;
    const double normal_sq = glm::dot(normal, normal);  // 1 to 1e-5 only
    dvec3 point = ray.origin + distance * ray.direction;
    point -= ((glm::dot(normal, point) - offset) / normal_sq) * normal;
    return within(ray, {distance, point, normal / std::sqrt(normal_sq), 0});
}

// Clipping against every face (Cyrus and Beck 1978).
std::optional<RayHit> cast_local(const ConvexHull& hull, const LocalRay& ray) noexcept {
    double enter = -kInfinity;
    double leave = kInfinity;
    bool inside = true;
    const ConvexHull::Face* entered = nullptr;
    for (const ConvexHull::Face& face : hull.faces()) {
        const double above = glm::dot(face.normal, ray.origin) - face.offset;
        const double rate = glm::dot(face.normal, ray.direction);
        inside = inside && above <= 0.0;
        if (rate < 0.0) {
            const double t = above / -rate;
            if (t > enter) {
                enter = t;
                entered = &face;
            }
        } else if (rate > 0.0) {
            leave = std::min(leave, -above / rate);
        } else if (!(above <= 0.0)) {
            return std::nullopt;
        }
    }
    if (inside) {
        return hit_from_inside(ray);
    }
    if (entered == nullptr || !(enter >= 0.0 && enter <= leave)) {
        return std::nullopt;
    }
    dvec3 point = ray.origin + enter * ray.direction;
    point -= (glm::dot(entered->normal, point) - entered->offset) * entered->normal;
    return within(ray, {enter, point, entered->normal, 0});
}

}  // namespace carom
