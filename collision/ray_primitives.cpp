#include <carom/collision/detail/ray_solids.hpp>
#include <carom/collision/detail/ray_surfaces.hpp>
#include <carom/collision/detail/widen.hpp>
#include <carom/collision/ray_primitives.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace carom::geo {
namespace {

// ------------------------------------------------------------------------------------- what is refused, besides NaN
// and infinity

bool is_valid(const Sphere<double>& s) { return s.radius >= 0.0; }
bool is_valid(const Aabb<double>& b) { return glm::all(glm::lessThanEqual(b.lower, b.upper)); }
bool is_valid(const Obb<double>& b) { return glm::all(glm::greaterThanEqual(b.half_extents, dvec3{0.0})); }
bool is_valid(const Capsule<double>& c) { return c.radius >= 0.0; }
bool is_valid(const Cylinder<double>& c) { return c.radius > 0.0 && c.axis.a != c.axis.b; }
bool is_valid(const Cone<double>& c) { return c.radius > 0.0 && c.tip != c.base_center; }
bool is_valid(const Plane<double>& p) { return p.normal != dvec3{0.0}; }
bool is_valid(const Disc<double>& d) { return d.normal != dvec3{0.0} && d.radius >= 0.0; }
bool is_valid(const Triangle<double>&) { return true; }

template <class T>
bool is_valid(const Ray<T>& ray) {
    return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3<T>{T(0)} &&
           ray.t_min <= ray.t_max;
}

// ------------------------------------------------------------------ every float as a double, every double in the range
// of squares

/// Which of a shape's numbers are lengths: a bit for each.
template <template <class> class Shape>
inline constexpr unsigned kLengths = ~0u;
template <>
inline constexpr unsigned kLengths<Obb> = 0b111'111u;
template <>
inline constexpr unsigned kLengths<Plane> = 0b1'000u;
template <>
inline constexpr unsigned kLengths<Disc> = 0b1'000'111u;

template <class Shape>
void balance_normal(Shape&) {}
void balance_normal(Disc<double>& disc) { disc.normal *= std::ldexp(1.0, -excess(largest(disc.normal))); }
void balance_normal(Plane<double>& plane) { plane = balanced(plane); }

/// A ray's line with its lengths, and those of what it meets, scaled by powers of two; t is exact up to a power of two.
struct ScaledLine {
    Line line;
    double length_scale = 1.0;
    int t_exponent = 0;

    template <class T>
    ScaledLine(const Ray<T>& ray, double shape_size) : line{dvec3(ray.origin), dvec3(ray.direction)} {
        const int length = excess(std::max(shape_size, largest(line.origin)));
        const int direction = excess(largest(line.direction));
        if (length != 0 || direction != 0) [[unlikely]] {
            length_scale = std::ldexp(1.0, -length);
            t_exponent = length - direction;
            line.origin *= length_scale;
            line.direction *= std::ldexp(1.0, -direction);
        }
    }
    [[nodiscard]] double t(double scaled) const { return t_exponent == 0 ? scaled : std::ldexp(scaled, t_exponent); }
};

template <template <class> class Shape, class T>
struct Scene {
    Shape<double> shape;
    ScaledLine scaled;
};

/// @return nothing where the ray or the shape is refused.
template <template <class> class Shape, class T>
std::optional<Scene<Shape, T>> prepare(const Shape<T>& given, const Ray<T>& ray) {
    Shape<double> shape = widened(given);
    auto wide = std::bit_cast<Scalars<Shape, double>>(shape);
    if (!is_valid(ray) || !std::ranges::all_of(wide, [](double x) { return is_finite(x); }) || !is_valid(shape)) {
        return std::nullopt;
    }
    balance_normal(shape);
    wide = std::bit_cast<Scalars<Shape, double>>(shape);
    const auto is_length = [](std::size_t i) { return (kLengths<Shape> >> i & 1u) != 0; };
    double size = 0.0;
    for (std::size_t i = 0; i < wide.size(); ++i) {
        size = is_length(i) ? std::max(size, std::abs(wide[i])) : size;
    }
    const ScaledLine scaled(ray, size);
    if (scaled.length_scale != 1.0) [[unlikely]] {
        for (std::size_t i = 0; i < wide.size(); ++i) {
            wide[i] *= is_length(i) ? scaled.length_scale : 1.0;
        }
        shape = std::bit_cast<Shape<double>>(wide);
    }
    return Scene<Shape, T>{shape, scaled};
}

// ----------------------------------------------------------------------------------------------------------------------
// results

dvec3 unit(const dvec3& v) {
    const dvec3 scaled = v * std::ldexp(1.0, -excess(largest(v)));
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

/// `v` of unit length, or `otherwise` where it is zero.
dvec3 unit_or(const dvec3& v, const dvec3& otherwise) { return v == dvec3{0.0} ? otherwise : unit(v); }

template <class T>
constexpr double kLargest = static_cast<double>(std::numeric_limits<T>::max());

template <template <class> class Shape, class T>
std::optional<RayInterval<T>> interval(const Shape<T>& shape, const Ray<T>& ray) {
    const auto scene = prepare(shape, ray);
    if (!scene) {
        return std::nullopt;
    }
    const std::optional<Chord> chord = intersect(scene->shape, scene->scaled.line);
    if (!chord) {
        return std::nullopt;
    }
    const double enter = scene->scaled.t(chord->enter);
    const double exit = scene->scaled.t(chord->exit);
    const bool starts = enter <= static_cast<double>(ray.t_max) && enter <= kLargest<T>;
    if (!starts || !(exit >= static_cast<double>(ray.t_min)) || !(exit >= -kLargest<T>)) {
        return std::nullopt;
    }
    // An interval that begins or ends at the wrong infinity has no points.
    if (ray.t_min > std::numeric_limits<T>::max() || ray.t_max < std::numeric_limits<T>::lowest()) {
        return std::nullopt;
    }
    // A point has no outside: its normals are along the ray.
    const dvec3 along = unit(scene->scaled.line.direction);
    RayInterval<T> result;
    result.t_enter = static_cast<T>(enter);
    result.t_exit = static_cast<T>(exit);
    result.normal_enter = is_finite(result.t_enter) ? Vec3<T>(unit_or(chord->normal_enter, -along)) : Vec3<T>{T(0)};
    result.normal_exit = is_finite(result.t_exit) ? Vec3<T>(unit_or(chord->normal_exit, along)) : Vec3<T>{T(0)};
    return result;
}

template <class T>
Vec3<T> against(const Ray<T>& ray) {
    return Vec3<T>(-unit(dvec3(ray.direction)));
}

template <class Shape, class T>
std::optional<RayHit<T>> first_hit(const Shape& shape, const Ray<T>& ray) {
    const std::optional<RayInterval<T>> inside = interval(shape, ray);
    if (!inside) {
        return std::nullopt;
    }
    if (inside->t_enter > ray.t_min) {
        return RayHit<T>{inside->t_enter, inside->normal_enter};
    }
    return is_finite(ray.t_min) ? std::optional(RayHit<T>{ray.t_min, against(ray)}) : std::nullopt;
}

/// The crossing of a surface as a hit, with its normal turned against the ray.
template <class T>
std::optional<TriangleHit<T>> surface_hit(const std::optional<Crossing>& crossing, const ScaledLine& scaled,
                                          const Ray<T>& ray) {
    if (!crossing) {
        return std::nullopt;
    }
    const double t = scaled.t(crossing->t);
    const bool within = t >= static_cast<double>(ray.t_min) && t <= static_cast<double>(ray.t_max);
    if (!within || !(std::abs(t) <= kLargest<T>)) {
        return std::nullopt;
    }
    const dvec3 back = -unit(scaled.line.direction);
    const dvec3 normal = unit_or(crossing->normal, back);
    return TriangleHit<T>{static_cast<T>(t), Vec3<T>(glm::dot(normal, back) < 0.0 ? -normal : normal),
                          Vec3<T>(crossing->weights)};
}

template <class T>
std::optional<RayHit<T>> without_weights(const std::optional<TriangleHit<T>>& hit) {
    return hit ? std::optional(RayHit<T>{hit->t, hit->normal}) : std::nullopt;
}

template <class Shape, class T>
std::optional<TriangleHit<T>> surface_cast(const Shape& shape, const Ray<T>& ray) {
    const auto scene = prepare(shape, ray);
    return scene ? surface_hit(cross(scene->shape, scene->scaled.line), scene->scaled, ray) : std::nullopt;
}

}  // namespace

template <class T>
std::optional<RayHit<T>> cast_ray(const Plane<T>& plane, const Ray<T>& ray) noexcept {
    return without_weights(surface_cast(plane, ray));
}

template <class T>
std::optional<RayHit<T>> cast_ray(const Disc<T>& disc, const Ray<T>& ray) noexcept {
    return without_weights(surface_cast(disc, ray));
}

template <class T>
std::optional<TriangleHit<T>> cast_ray(const Triangle<T>& triangle, const Ray<T>& ray) noexcept {
    return surface_cast(triangle, ray);
}

template <class T>
std::optional<RayHit<T>> cast_ray_polygon(std::span<const Vec3<T>> corners, const Ray<T>& ray) noexcept {
    double size = 0.0;
    bool finite = true;
    for (const Vec3<T>& corner : corners) {
        finite = finite && is_finite(corner);
        size = std::max(size, largest(dvec3(corner)));
    }
    if (corners.size() < 3 || !finite || !is_valid(ray)) {
        return std::nullopt;
    }
    const ScaledLine scaled(ray, size);
    return without_weights(surface_hit(cross(corners, scaled.length_scale, scaled.line), scaled, ray));
}

#define CAROM_SOLID(Shape)                                                                                    \
    template <class T>                                                                                        \
    std::optional<RayInterval<T>> ray_interval(const Shape<T>& solid, const Ray<T>& ray) noexcept {           \
        return interval(solid, ray);                                                                          \
    }                                                                                                         \
    template std::optional<RayInterval<float>> ray_interval(const Shape<float>&, const Ray<float>&) noexcept; \
    template std::optional<RayInterval<double>> ray_interval(const Shape<double>&, const Ray<double>&) noexcept;
#define CAROM_CAST(Shape)                                                                  \
    template <class T>                                                                     \
    std::optional<RayHit<T>> cast_ray(const Shape<T>& solid, const Ray<T>& ray) noexcept { \
        return first_hit(solid, ray);                                                      \
    }                                                                                      \
    CAROM_INSTANCES(Shape, RayHit)
#define CAROM_INSTANCES(Shape, Hit)                                                               \
    template std::optional<Hit<float>> cast_ray(const Shape<float>&, const Ray<float>&) noexcept; \
    template std::optional<Hit<double>> cast_ray(const Shape<double>&, const Ray<double>&) noexcept;

CAROM_SOLID(Sphere)
CAROM_SOLID(Aabb)
CAROM_SOLID(Obb)
CAROM_SOLID(Capsule)
CAROM_SOLID(Cylinder)
CAROM_SOLID(Cone)
CAROM_SOLID(Plane)
CAROM_CAST(Sphere)
CAROM_CAST(Aabb)
CAROM_CAST(Obb)
CAROM_CAST(Capsule)
CAROM_CAST(Cylinder)
CAROM_CAST(Cone)
CAROM_INSTANCES(Plane, RayHit)
CAROM_INSTANCES(Disc, RayHit)
CAROM_INSTANCES(Triangle, TriangleHit)
#undef CAROM_INSTANCES
#undef CAROM_CAST
#undef CAROM_SOLID
template std::optional<RayHit<float>> cast_ray_polygon(std::span<const Vec3<float>>, const Ray<float>&) noexcept;
template std::optional<RayHit<double>> cast_ray_polygon(std::span<const Vec3<double>>, const Ray<double>&) noexcept;

}  // namespace carom::geo
