#include <carom/collision/ray_cast.hpp>

#include <carom/collision/detail/ray_local.hpp>

#include <algorithm>
#include <cmath>
#include <memory>

namespace carom {
namespace {

/// Unit length; a power of two keeps the squares of the smallest and largest directions in range.
dvec3 unit(dvec3 v) noexcept {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (largest < 0x1p-300 || largest > 0x1p300) {
        int exponent = 0;
        static_cast<void>(std::frexp(largest, &exponent));
        v = {std::ldexp(v.x, -exponent), std::ldexp(v.y, -exponent), std::ldexp(v.z, -exponent)};
    }
    return v / std::sqrt(glm::dot(v, v));
}

bool is_valid(const Ray& ray) noexcept {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != dvec3{0.0} && ray.max_distance >= 0.0;
}

struct Cast {
    const LocalRay& ray;

    template <class Solid>
    std::optional<RayHit> operator()(const Solid& solid) const noexcept {
        return cast_local(solid, ray);
    }
    template <class Heavy>
    std::optional<RayHit> operator()(const std::shared_ptr<const Heavy>& heavy) const noexcept {
        return heavy ? cast_local(*heavy, ray) : std::nullopt;
    }
};

}  // namespace

Status validate(const Ray& ray) {
    constexpr const char* kWhere = "Ray";
    if (!is_finite(ray.origin)) {
        return Error{ErrorCode::NotFinite, "origin is not finite", kWhere};
    }
    if (!is_finite(ray.direction)) {
        return Error{ErrorCode::NotFinite, "direction is not finite", kWhere};
    }
    if (ray.direction == dvec3{0.0}) {
        return Error{ErrorCode::InvalidArgument, "direction is zero", kWhere};
    }
    if (!(ray.max_distance >= 0.0)) {
        return Error{ErrorCode::InvalidArgument, "max_distance is NaN or negative", kWhere};
    }
    return {};
}

std::optional<RayHit> cast_ray(const Shape& shape, const Ray& ray) {
    if (!is_valid(ray)) {
        return std::nullopt;
    }
    return std::visit(Cast{{ray.origin, unit(ray.direction), ray.max_distance}}, shape);
}

std::optional<RayHit> cast_ray(const Shape& shape, const Pose& pose, const Ray& ray) {
    if (!is_valid(ray) || !is_finite(pose)) {
        return std::nullopt;
    }
    const Ray local{inverse_transform_point(pose, ray.origin), rotate_inverse(pose.orientation, unit(ray.direction)),
                    ray.max_distance};
    std::optional<RayHit> hit = cast_ray(shape, local);
    if (hit) {
        hit->point = transform_point(pose, hit->point);
        hit->normal = rotate(pose.orientation, hit->normal);
    }
    return hit;
}

}  // namespace carom
