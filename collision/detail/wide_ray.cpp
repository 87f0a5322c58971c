#include <carom/collision/detail/wide_ray.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace carom {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The largest distance along an axis from `origin` to the tree's box.
float reach_of(const WideBvh& tree, const float* origin) noexcept {
    float reach = 0.0f;
    for (int k = 0; k < 3; ++k) {
        reach = std::max(reach, std::max(std::abs(tree.lower[k] - origin[k]), std::abs(tree.upper[k] - origin[k])));
    }
    return reach;
}

/// Sets all but bounds and units. @param d  largest component in [1, 2).
void set_up(const float* origin, const float* d, std::int32_t z, float reach, WideRay& out) noexcept {
    const float largest = std::max({std::abs(origin[0]), std::abs(origin[1]), std::abs(origin[2])});
    const float pad = WideRay::kPad * (reach + largest);
    out.image_error = 0.5f * pad;
    for (int k = 0; k < 3; ++k) {
        const float component = std::copysign(std::max(std::abs(d[k]), WideRay::kLeastComponent), d[k]);
        const float inverse = 1.0f / component;
        const float side = std::copysign(pad, component);
        out.origin[k] = origin[k];
        out.inverse[k] = inverse;
        out.near[k] = -(origin[k] + side) * inverse;
        out.far[k] = -(origin[k] - side) * inverse;
        out.back[k] = std::signbit(component) ? 1 : 0;
    }
    const std::int32_t x = z == 2 ? 0 : z + 1;
    const std::int32_t y = x == 2 ? 0 : x + 1;
    out.axis[0] = x, out.axis[1] = y, out.axis[2] = z;
    out.depth = out.inverse[z];
    out.shear[0] = d[x] * out.depth;
    out.shear[1] = d[y] * out.depth;
}

/// The larger float of the two around x, or x.
float round_up(double x) noexcept {
    if (x > static_cast<double>(std::numeric_limits<float>::max())) return kInfinity;
    const float rounded = static_cast<float>(x);
    return static_cast<double>(rounded) < x ? std::nextafter(rounded, kInfinity) : rounded;
}

/// The last float t >= 0 where `holds(t)`, which holds at 0 and up to there. @param guess  >= 0; the nearer, the faster.
template <class Holds>
float last_where(float guess, Holds&& holds) noexcept {
    constexpr auto kEnd = std::bit_cast<std::uint32_t>(kInfinity);
    const auto holds_at = [&](std::uint32_t bits) { return holds(std::bit_cast<float>(bits)); };
    // Floats >= +0 are in the order of their bits. First a bracket round the guess, in steps that double.
    std::uint32_t yes = std::bit_cast<std::uint32_t>(guess), no = yes;
    std::uint32_t step = 1;
    if (holds_at(yes)) {
        for (; yes < kEnd; step *= 2) {
            no = kEnd - yes > step ? yes + step : kEnd;
            if (!holds_at(no)) break;
            yes = no;
        }
        if (yes == kEnd) return kInfinity;
    } else {
        for (;; step *= 2) {
            yes = no > step ? no - step : 0;
            if (yes == 0 || holds_at(yes)) break;
            no = yes;
        }
    }
    while (no - yes > 1) {
        const std::uint32_t middle = yes + (no - yes) / 2;
        (holds_at(middle) ? yes : no) = middle;
    }
    return std::bit_cast<float>(yes);
}

}  // namespace

bool prepare(const WideBvh& tree, const geo::Ray<double>& ray, WideRay& out) noexcept {
    const dvec3 size = glm::abs(ray.direction);
    const double largest = std::max({size.x, size.y, size.z});
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || largest == 0.0 || !(ray.t_min <= ray.t_max)) return false;
    int exponent = 0;
    static_cast<void>(std::frexp(largest, &exponent));
    const dvec3 d{std::ldexp(ray.direction.x, 1 - exponent), std::ldexp(ray.direction.y, 1 - exponent),
                  std::ldexp(ray.direction.z, 1 - exponent)};
    const double scale = static_cast<double>(tree.scale);
    out.unit = std::ldexp(1.0 / scale, 1 - exponent);
    double t_min = ray.t_min / out.unit;
    double t_max = ray.t_max / out.unit;

    // Where the line is nearest to the ball round the mesh.
    const dvec3 lower(tree.lower);
    const dvec3 upper(tree.upper);
    const dvec3 center = 0.5 * (lower + upper);
    const double radius = 1.0001 * glm::length(upper - center);
    const dvec3 from = scale * ray.origin;
    const dvec3 to_center = center - from;
    const double length_sq = glm::dot(d, d);
    const double middle = glm::dot(to_center, d) / length_sq;
    const double rounding = 0x1p-49 * (glm::length(to_center) + glm::length(from));
    const dvec3 aside = to_center - middle * d;
    if (!(glm::dot(aside, aside) <= (radius + rounding) * (radius + rounding))) return false;
    const double half = (radius + rounding) / std::sqrt(length_sq);
    // Nothing is hit outside middle -+ half. Working from the beginning of that keeps rounding to the size of the mesh. It does not
    // depend on the ray's interval, so that a ray cut to where it hit hits there again.
    const bool far = glm::length(to_center) > static_cast<double>(WideBvh::kFar) * radius;
    out.moved = t_min < 0.0 || (far && middle - half > 0.0) ? middle - half : 0.0;
    t_min -= out.moved;
    t_max -= out.moved;
    if (!(t_max >= 0.0) || t_min > middle + half - out.moved) return false;
    const dvec3 start = from + out.moved * d;
    const float origin[3] = {static_cast<float>(start.x), static_cast<float>(start.y), static_cast<float>(start.z)};
    const float direction[3] = {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
    const std::int32_t z = largest_axis(std::abs(direction[0]), std::abs(direction[1]), std::abs(direction[2]));
    set_up(origin, direction, z, reach_of(tree, origin), out);
    out.t_min = std::max(static_cast<float>(t_min), 0.0f) + 0.0f;  // -0 becomes +0
    out.t_max = round_up(t_max);
    return true;
}

float WideRay::own_t(double t) const noexcept { return round_up(t / unit - moved); }

bool prepare_unusual(const WideBvh& tree, const geo::Ray<float>& ray, WideRay& out) noexcept {
    if (!(ray.t_min <= ray.t_max)) return false;
    // Wider by one float on either side, for what is rounded to a bound; then exactly what is.
    const float before = ray.t_min == 0.0f ? 0.0f : std::nextafter(ray.t_min, -kInfinity);
    const float after = std::nextafter(ray.t_max, kInfinity);
    const geo::Ray<double> wide{dvec3(ray.origin), dvec3(ray.direction), static_cast<double>(before), static_cast<double>(after)};
    if (!prepare(tree, wide, out)) return false;
    if (out.caller_t(0.0f) > ray.t_max) return false;
    out.t_max = last_where(out.t_max, [&](float t) { return out.caller_t(t) <= ray.t_max; });
    if (out.caller_t(0.0f) >= ray.t_min) {
        out.t_min = 0.0f;
    } else {
        out.t_min = std::nextafter(last_where(out.t_min, [&](float t) { return out.caller_t(t) < ray.t_min; }), kInfinity);
    }
    return out.t_min <= out.t_max;
}

bool prepare(const WideBvh& tree, const geo::Ray<float>& ray, WideRay& out) noexcept {
    const float* o = &ray.origin.x;
    const float* d = &ray.direction.x;
    const std::int32_t z = largest_axis(std::abs(d[0]), std::abs(d[1]), std::abs(d[2]));
    const std::uint32_t exponent = (std::bit_cast<std::uint32_t>(d[z]) >> 23) & 0xffu;
    const float reach = reach_of(tree, o);
    if (!is_usual(tree, ray, reach, exponent) || !is_finite(ray.origin) || !is_finite(ray.direction)) return prepare_unusual(tree, ray, out);
    const UnitBinade binade(exponent);
    const float direction[3] = {d[0] * binade.shrink, d[1] * binade.shrink, d[2] * binade.shrink};
    set_up(o, direction, z, reach, out);
    set_bounds(ray, binade, out);
    return true;
}

}  // namespace carom
