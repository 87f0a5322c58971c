// Rays against cylinder and cone: the chords of ray_solids.hpp, from a point near the solid.
#include <carom/collision/detail/ray_local.hpp>
#include <carom/collision/detail/ray_solids.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// The solid's section through its axis: the discs' radii at -h and h.
struct Section {
    double lower = 0.0, upper = 0.0, h = 0.0;

    [[nodiscard]] double radius_at(double y) const noexcept { return 0.5 * (lower + upper + (upper - lower) * (y / h)); }
    [[nodiscard]] double reach() const noexcept { return lower + h; }
};

// Whether the normal is that of a flat end: it has no part across the axis.
bool is_flat(const dvec3& normal) noexcept { return normal.x == 0.0 && normal.z == 0.0; }

// The surface point nearest to `p`, which is on the surface but for rounding.
dvec3 on_surface(const Section& s, const dvec3& p, const dvec3& normal) noexcept {
    if (is_flat(normal) && s.upper > 0.0) return {p.x, normal.y > 0.0 ? s.h : -s.h, p.z};
    if (is_flat(normal)) return normal.y > 0.0 ? dvec3{0.0, s.h, 0.0} : dvec3{p.x, -s.h, p.z};
    const double y = std::clamp(p.y, -s.h, s.h);
    const double across = std::sqrt(p.x * p.x + p.z * p.z);
    const double scale = across > 0.0 ? s.radius_at(y) / across : 0.0;
    return {p.x * scale, y, p.z * scale};
}

template <class Solid>
std::optional<RayHit> cast_turned(const Section& s, const Solid& solid, const LocalRay& ray) noexcept {
    const dvec3& o = ray.origin;
    if (std::abs(o.y) <= s.h) {
        const double radius = s.radius_at(o.y);
        if (o.x * o.x + o.z * o.z <= radius * radius) return hit_from_inside(ray);
    }
    const double skipped = free_distance(ray, dvec3{0.0}, s.reach());
    const dvec3 origin = o + skipped * ray.direction;
    const std::optional<geo::Chord> chord = geo::intersect(solid, {origin, ray.direction});
    // The origin is outside, so that a chord with a part ahead lies ahead but for rounding.
    if (!chord || !(chord->exit >= 0.0) || (chord->enter < 0.0 && !(chord->exit > -chord->enter))) return std::nullopt;
    const double enter = std::max(0.0, chord->enter);
    const double length = glm::length(chord->normal_enter);
    const dvec3 normal = length > 0.0 ? chord->normal_enter / length : -ray.direction;
    const RayHit hit{skipped + enter, on_surface(s, origin + enter * ray.direction, normal), normal, 0};
    if (!(hit.distance <= ray.max_distance) || !is_finite(hit.distance) || !is_finite(hit.point)) return std::nullopt;
    return hit;
}

}  // namespace

std::optional<RayHit> cast_local(const Cylinder& cylinder, const LocalRay& ray) noexcept {
    const auto r = static_cast<double>(cylinder.radius);
    const auto h = static_cast<double>(cylinder.half_height);
    return cast_turned({r, r, h}, geo::Cylinder<double>{{{0.0, -h, 0.0}, {0.0, h, 0.0}}, r}, ray);
}

std::optional<RayHit> cast_local(const Cone& cone, const LocalRay& ray) noexcept {
    const auto r = static_cast<double>(cone.radius);
    const auto h = static_cast<double>(cone.half_height);
    return cast_turned({r, 0.0, h}, geo::Cone<double>{{0.0, h, 0.0}, {0.0, -h, 0.0}, r}, ray);
}

}  // namespace carom
