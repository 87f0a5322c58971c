// Many triangles against one ray or one point, in float with a bound on its rounding.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/detail/batch_triangles.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/detail/batch_kernels.hpp>
#include <carom/core/lanes.hpp>

#include <limits>

#include <carom/collision/detail/record_lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::geo::detail::HWY_NAMESPACE {
namespace {

constexpr float kEps = 0x1p-23f;

Floats3 splat(const vec3& v) { return {v.x, v.y, v.z}; }
Floats sum_of_sizes(const Floats3& v) { return (abs(v.x) + abs(v.y)) + abs(v.z); }
Floats length_sq(const Floats3& v) { return dot(v, v); }

// Moller and Trumbore (JGT 1997), whose four triple products err by less than 8 eps of the product of their vectors' sizes, one
// rounding of each vector's own included.
std::size_t ray_triangles(const Ray<float>& ray, std::span<const Triangle<float>> triangles, float* t, std::int32_t* unclear) {
    const Floats3 origin = splat(ray.origin), direction = splat(ray.direction);
    const Floats along = sum_of_sizes(direction), infinity = std::numeric_limits<float>::infinity();
    const Floats t_min = ray.t_min, t_max = ray.t_max;
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < triangles.size(); i += static_cast<std::size_t>(kLanes)) {
        Floats x[9];
        load_records<9>(&triangles.data()->a.x, i, triangles.size(), x);
        const Floats3 a{x[0], x[1], x[2]};
        const Floats3 e1 = Floats3{x[3], x[4], x[5]} - a, e2 = Floats3{x[6], x[7], x[8]} - a, s = origin - a;
        const Floats size1 = sum_of_sizes(e1), size2 = sum_of_sizes(e2), far = sum_of_sizes(s);
        const Floats3 p = cross(direction, e2), q = cross(s, e1);
        const Floats sign = copy_sign(1.0f, dot(e1, p));
        const Floats det = abs(dot(e1, p)), u = dot(s, p) * sign, v = dot(direction, q) * sign, w = det - u - v;
        const Floats det_error = 8.0f * kEps * (size1 * size2) * along;
        const Floats u_error = 8.0f * kEps * (far * size2) * along, v_error = 8.0f * kEps * (far * size1) * along;
        // The third weight's rounding is within a sixteenth of the others' bounds.
        const Floats w_error = 1.125f * (det_error + u_error + v_error);
        const Floats at = dot(e2, q) * sign / det;
        // The distance errs by 8 eps (far + |at| along) size1 size2 / det, where the last is at most 64 / along.
        const Mask steep = 64.0f * det > (size1 * size2) * along;
        const Floats at_error = 520.0f * kEps * (far / along + abs(at));
        const Mask outside = (u < -u_error) | (v < -v_error) | (w < -w_error);
        const Mask beyond = (at < t_min - at_error) | (at > t_max + at_error);
        const Mask miss = outside | beyond;
        const Mask inside = (u > u_error) & (v > v_error) & (w > w_error);
        const Mask hit = inside & (at > t_min + at_error) & (at < t_max - at_error);
        const Floats size = far + size1 + size2;
        const Mask sized = (size < 0x1p20f) & (size > 0x1p-20f) & (along < 0x1p20f) & (along > 0x1p-20f);
        // Small triangles' products would underflow; their errors are measured against the smallest that may occur.
        const Mask whole = (size1 > 0x1p-36f) & (size2 > 0x1p-36f) & (far > 0x1p-36f);
        store_some(select(hit, at, infinity), triangles.size() - i, t + i);
        unsure += note_unclear(!(sized & whole & steep & (hit | miss)), i, triangles.size(), unclear + unsure);
    }
    return unsure;
}

// A point of a triangle and its squared distance from the point that is asked for.
struct Candidate {
    Floats3 point;
    Floats sq;
};

void keep_nearer(Candidate& best, const Floats3& point, const Floats3& p, Mask counts) {
    const Floats sq = length_sq(p - point);
    const Mask nearer = counts & (sq < best.sq);
    best = {select(nearer, point, best.point), select(nearer, sq, best.sq)};
}

Floats3 closest_on_edge(const Floats3& from, const Floats3& along, const Floats3& to, const Floats3& p) {
    const Floats t = dot(p - from, along) / length_sq(along);  // NaN for an edge of no length, which clamps to 0
    const Floats3 inner = from + clamp(t, 0.0f, 1.0f) * along;
    return select(t >= 1.0f, to, inner);
}

// As TriangleFrame::closest (closest_features.cpp): the longest edge projected out first, every candidate measured.
Candidate closest_on(const Floats3& a, const Floats3& b, const Floats3& c, const Floats3& p) {
    const Floats ab = length_sq(b - a), bc = length_sq(c - b), ca = length_sq(a - c);
    const Mask first = (ab >= bc) & (ab >= ca), second = (!first) & (bc >= ca);
    const Floats3 corner = select(first, a, select(second, b, c));
    const Floats3 end = select(first, b, select(second, c, a));
    const Floats3 apex = select(first, c, select(second, a, b));
    const Floats3 base = end - corner, side = apex - corner, w = p - corner;
    const Floats base_sq = length_sq(base);
    const Floats3 height = side - (dot(side, base) / base_sq) * base;
    const Floats3 across = w - (dot(w, base) / base_sq) * base;
    const Floats s = dot(across, height) / length_sq(height);
    const Floats t = dot(w - s * side, base) / base_sq;
    const Floats3 foot = corner + (s * side + t * base);
    Candidate best{closest_on_edge(corner, base, end, p), 0.0f};
    best.sq = length_sq(p - best.point);
    keep_nearer(best, foot, p, (s >= 0.0f) & (t >= 0.0f) & (s + t <= 1.0f));
    keep_nearer(best, closest_on_edge(end, apex - end, apex, p), p, first_lanes(kLanes));
    keep_nearer(best, closest_on_edge(apex, corner - apex, corner, p), p, first_lanes(kLanes));
    return best;
}

std::size_t point_triangles(const Vec3<float>& point, std::span<const Triangle<float>> triangles, ClosestPoints<float>* closest,
                            std::int32_t* unclear) {
    const Floats3 p = splat(point);
    const Floats3 zero{0.0f, 0.0f, 0.0f};
    std::size_t unsure = 0;
    for (std::size_t i = 0; i < triangles.size(); i += static_cast<std::size_t>(kLanes)) {
        Floats x[9];
        load_records<9>(&triangles.data()->a.x, i, triangles.size(), x);
        // Relative to the point, so that what is lost is relative to the pair.
        const Floats3 a = Floats3{x[0], x[1], x[2]} - p, b = Floats3{x[3], x[4], x[5]} - p, c = Floats3{x[6], x[7], x[8]} - p;
        const Candidate best = closest_on(a, b, c, zero);
        const Floats size = (sum_of_sizes(a) + sum_of_sizes(b)) + sum_of_sizes(c);
        const Mask sized = (size < 0x1p30f) & (size > 0x1p-28f);
        FloatBundle lanes[4];
        store(p.x + best.point.x, lanes[0].lane);
        store(p.y + best.point.y, lanes[1].lane);
        store(p.z + best.point.z, lanes[2].lane);
        store(best.sq, lanes[3].lane);
        for (std::size_t l = 0; l < static_cast<std::size_t>(kLanes) && i + l < triangles.size(); ++l) {
            closest[i + l] = {point, {lanes[0].lane[l], lanes[1].lane[l], lanes[2].lane[l]}, lanes[3].lane[l]};
        }
        unsure += note_unclear(!sized, i, triangles.size(), unclear + unsure);
    }
    return unsure;
}

}  // namespace
}  // namespace carom::geo::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::geo::detail {

HWY_EXPORT(ray_triangles);
HWY_EXPORT(point_triangles);

std::size_t ray_triangles(const Ray<float>& ray, std::span<const Triangle<float>> triangles, float* t, std::int32_t* unclear) {
    return HWY_DYNAMIC_DISPATCH(ray_triangles)(ray, triangles, t, unclear);
}
std::size_t point_triangles(const Vec3<float>& point, std::span<const Triangle<float>> triangles, ClosestPoints<float>* closest,
                            std::int32_t* unclear) {
    return HWY_DYNAMIC_DISPATCH(point_triangles)(point, triangles, closest, unclear);
}

}  // namespace carom::geo::detail

#endif
