// What must hold for any ray and any primitive: judged by exact rationals, for the fuzzer and for tests.
//
//   EXPECT_EQ(test::ray_primitives_fault(bytes), "");
#pragma once

#include <support/exact_ray.hpp>
#include <support/query_cases.hpp>

#include <cmath>
#include <string>

namespace carom::test {

/// The k of each primitive in ray_primitives.hpp.
template <template <class> class Shape>
inline constexpr double kRayBound = 4.0;
template <>
inline constexpr double kRayBound<geo::Aabb> = 2.0;
template <>
inline constexpr double kRayBound<geo::Cylinder> = 8.0;
template <>
inline constexpr double kRayBound<geo::Cone> = 8.0;

template <class T>
[[nodiscard]] bool is_unit(const geo::Vec3<T>& v) {
    const dvec3 n(v);
    return std::abs(glm::dot(n, n) - 1.0) <= 8.0 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// What is wrong with the hit of a ray, whatever was hit.
template <class Hit, class T>
[[nodiscard]] std::string hit_fault(const Hit& hit, const geo::Ray<T>& ray) {
    if (!std::isfinite(hit.t) || !(hit.t >= ray.t_min && hit.t <= ray.t_max)) return "the hit is not one of the ray";
    if (!is_unit(hit.normal)) return "the hit's normal is not of unit length";
    return "";
}

template <template <class> class Shape, class T>
[[nodiscard]] std::string solid_fault(const Shape<T>& shape, const geo::Ray<T>& ray) {
    const std::optional<geo::RayInterval<T>> inside = geo::ray_interval(shape, ray);
    std::string fault = exact::fault(shape, ray, inside, kRayBound<Shape>);
    const std::optional<geo::RayHit<T>> hit = geo::cast_ray(shape, ray);
    if (!fault.empty()) return fault;
    if (inside && std::isfinite(inside->t_enter) && !is_unit(inside->normal_enter))
        return "the entry's normal is not of unit length";
    if (inside && std::isfinite(inside->t_exit) && !is_unit(inside->normal_exit))
        return "the exit's normal is not of unit length";
    const bool starts = inside && std::isfinite(std::max(inside->t_enter, ray.t_min));
    if (hit.has_value() != starts) return "hit and interval differ";
    if (hit && hit->t != std::max(inside->t_enter, ray.t_min)) return "the hit is not the interval's start";
    return hit ? hit_fault(*hit, ray) : "";
}

template <class Given, class Hit, class T>
[[nodiscard]] std::string flat_fault(const Given& given, const std::optional<Hit>& hit, const geo::Ray<T>& ray) {
    const std::string fault = exact::surface_fault(given, ray, hit ? std::optional(hit->t) : std::nullopt, 4.0);
    return fault.empty() && hit ? hit_fault(*hit, ray) : fault;
}

template <class Shape, class T>
[[nodiscard]] std::optional<geo::Ray<T>> ray_for(const Shape& shape, Draw<T>& draw) {
    const Points<T> points = anchors(shape);
    for (const geo::Vec3<T>& p : points) {
        if (!is_finite(p)) return std::nullopt;
    }
    const geo::Ray<T> ray = draw.ray_at(points);
    return is_finite(ray.origin) && is_finite(ray.direction) ? std::optional(ray) : std::nullopt;
}

template <class T>
[[nodiscard]] std::string ray_primitive_fault(int which, Draw<T>& draw) {
    const auto solid = [&](const auto& shape) {
        const auto ray = ray_for(shape, draw);
        return ray ? solid_fault(shape, *ray) : "";
    };
    const auto flat = [&](const auto& shape) {
        const auto ray = ray_for(shape, draw);
        return ray ? flat_fault(shape, geo::cast_ray(shape, *ray), *ray) : "";
    };
    switch (which) {
        case 0:
            return solid(draw.sphere());
        case 1:
            return solid(draw.aabb());
        case 2:
            return solid(draw.obb());
        case 3:
            return solid(draw.capsule());
        case 4:
            return solid(draw.cylinder());
        case 5:
            return solid(draw.cone());
        case 6:
            return flat(draw.disc());
        case 7:
            return flat(draw.triangle());
        case 8: {
            const geo::Plane<T> plane = draw.plane();
            const auto ray = ray_for(plane, draw);
            return ray ? exact::fault(plane, *ray, geo::cast_ray(plane, *ray), kRayBound<geo::Plane>) : "";
        }
        default: {
            const Points<T> corners = draw.polygon();
            const std::span<const geo::Vec3<T>> polygon(corners);
            const bool has_area =
                exact::sign(exact::length_sq(exact::Figure<std::span<const geo::Vec3<T>>>(polygon).normal)) > 0;
            const geo::Ray<T> ray = draw.ray_at(polygon);
            const auto hit = geo::cast_ray_polygon(polygon, ray);
            return has_area ? flat_fault(polygon, hit, ray) : hit ? "a polygon without area is hit" : "";
        }
    }
}

inline constexpr int kRayPrimitives = 10;

/// What is wrong with the answers for the scenes that `bytes` describe, or nothing. The first byte chooses primitive
/// and precision.
[[nodiscard]] inline std::string ray_primitives_fault(std::span<const std::uint8_t> bytes) {
    if (bytes.empty()) return "";
    const int which = bytes[0] % (2 * kRayPrimitives);
    const std::span<const std::uint8_t> rest = bytes.subspan(1);
    if (which < kRayPrimitives) {
        Draw<float> draw(rest);
        return ray_primitive_fault(which, draw);
    }
    Draw<double> draw(rest);
    return ray_primitive_fault(which - kRayPrimitives, draw);
}

}  // namespace carom::test
