#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/collision/bvh_sweep.cpp>
#include <hwy/foreach_target.h>

#include <carom/collision/bvh_sweep.hpp>
#include <carom/collision/detail/ball_path.hpp>
#include <carom/collision/detail/wide_bvh.hpp>
#include <carom/collision/detail/wide_ray.hpp>
#include <carom/collision/detail/wide_traverse.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace carom::HWY_NAMESPACE {
namespace {

/// @return as bits, the triangles of a leaf whose boxes the ray meets: slabs as for nodes.
HWY_INLINE unsigned meet_triangles(const WideLeaf& leaf, const WideRay& ray, const SlabLanes& slabs) {
    Table16 table[3];
    for (int k = 0; k < 3; ++k) {
        for (int part = 0; part < kParts; ++part) table[k].set(part, load(leaf.vertex[k] + part * kLanes));
    }
    unsigned met = 0;
    for (int at = 0; at < kWidth && static_cast<std::uint32_t>(at) < leaf.triangle_count; at += kLanes) {
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        Floats near(ray.t_min), far(ray.t_max);
        for (int k = 0; k < 3; ++k) {
            const Floats pa = a(table[k]), pb = b(table[k]), pc = c(table[k]);
            const Floats low = min(min(pa, pb), pc), high = max(max(pa, pb), pc);
            const bool back = slabs.back[k] != 0;
            near = max(near, multiply_add(back ? high : low, slabs.inverse[k], slabs.near[k]));
            far = min(far, multiply_add(back ? low : high, slabs.inverse[k], slabs.far[k]));
        }
        met |= bits(near <= far) << at;
    }
    return met & ((1u << leaf.triangle_count) - 1u);
}

/// A ball about the ray's origin at 0.
struct BallLanes {
    Floats3 from, way;
    Floats radius;

    HWY_INLINE BallLanes(const WideRay& ray, const BallPath& ball)
        : from{ray.origin[0], ray.origin[1], ray.origin[2]}, way{ball.way[0], ball.way[1], ball.way[2]}, radius(ball.radius) {}
};

/// Triangles about the ball's start.
struct TrianglesAhead {
    Floats3 a, ab, ac;
    Floats ab_ab, ab_ac, ac_ac;

    HWY_INLINE TrianglesAhead(const Floats3& at_a, const Floats3& at_b, const Floats3& at_c, const Floats3& from)
        : a(at_a - from), ab(at_b - at_a), ac(at_c - at_a), ab_ab(dot(ab, ab)), ab_ac(dot(ab, ac)), ac_ac(dot(ac, ac)) {}

    /// The way to p from the nearest point (Ericson, Real-Time Collision Detection, 2005, sec. 5.1.5), or about.
    HWY_INLINE Floats3 way_to(const Floats3& p) const {
        const Floats zero(0.0f), one(1.0f);
        const Floats3 ap = p - a;
        const Floats d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = d1 - ab_ab, d4 = d2 - ab_ac, d5 = d1 - ab_ac, d6 = d2 - ac_ac;
        const Floats of_a = d3 * d6 - d5 * d4, of_b = d5 * d2 - d1 * d6, of_c = d1 * d4 - d3 * d2, to_c = d4 - d3, to_b = d5 - d6;
        const Mask on_ab = (of_c <= zero) & (d1 >= zero) & (d3 <= zero), on_ac = (of_b <= zero) & (d2 >= zero) & (d6 <= zero),
                   on_bc = (of_a <= zero) & (to_c >= zero) & (to_b >= zero);
        const Mask at_a = (d1 <= zero) & (d2 <= zero), at_b = (d3 >= zero) & (d4 <= d3), at_c = (d6 >= zero) & (d5 <= d6);
        // The weights of b and c, times the whole.
        const Floats b = select(on_ab, d1, select(on_ac, zero, select(on_bc, to_b, of_b)));
        const Floats c = select(on_ab, zero, select(on_ac, d2, select(on_bc, to_c, of_c)));
        const Floats share = one / select(on_ab, ab_ab, select(on_ac, ac_ac, select(on_bc, to_c + to_b, of_a + of_b + of_c)));
        const Floats of_ab = select(at_a | at_c, zero, select(at_b, one, b * share));
        const Floats of_ac = select(at_a | at_b, zero, select(at_c, one, c * share));
        return ap - ab * of_ab - ac * of_ac;
    }
    /// A way across the face, towards the ball's start.
    HWY_INLINE Floats3 face() const {
        const Floats3 n = cross(ab, ac);
        return select(dot(n, a) > Floats(0.0f), -n, n);
    }
    /// @param n  any way. @param t  before which they do not meet. @return a time no less before which they do not either: where the plane across n
    /// parts them at t, when it ceases to. See detail/ball_path.hpp.
    HWY_INLINE Floats met(const BallLanes& ball, const Floats3& n, Floats t) const {
        const Floats zero(0.0f), square = dot(n, n);
        const Floats most = dot(n, a) + max(max(dot(n, ab), dot(n, ac)), zero);
        const Floats gap = -most - ball.radius * sqrt(square), closing = -dot(n, ball.way);
        const Floats next = select(closing > zero, gap / closing, Floats(std::numeric_limits<float>::infinity()));
        return select((gap > closing * t) & (square > Floats(BallPath::kLeastSquare)), max(t, next), t);
    }
};

/// As meet_triangles(), without those that the ball is proved not to meet by ray.t_max.
/// @param first  receives a time before which it does not meet each of those, 16 floats.
HWY_INLINE unsigned meet_ball(const WideLeaf& leaf, const WideRay& ray, const SlabLanes& slabs, const BallLanes& ball, float* first) {
    constexpr int kMostPlanes = 2;  // after the face's; each takes its time, and what is left is judged one by one
    Table16 table[3];
    for (int k = 0; k < 3; ++k) {
        for (int part = 0; part < kParts; ++part) table[k].set(part, load(leaf.vertex[k] + part * kLanes));
    }
    unsigned met = 0;
    const Floats last(ray.t_max);
    for (int at = 0; at < kWidth && static_cast<std::uint32_t>(at) < leaf.triangle_count; at += kLanes) {
        const Picks a(leaf.corner[0] + at), b(leaf.corner[1] + at), c(leaf.corner[2] + at);
        const Floats3 pa{a(table[0]), a(table[1]), a(table[2])}, pb{b(table[0]), b(table[1]), b(table[2])},
            pc{c(table[0]), c(table[1]), c(table[2])};
        Floats near(ray.t_min), far(last);
        const auto slab = [&](int k, Floats x, Floats y, Floats z) HWY_ATTR {
            const Floats low = min(min(x, y), z), high = max(max(x, y), z);
            const bool back = slabs.back[k] != 0;
            near = max(near, multiply_add(back ? high : low, slabs.inverse[k], slabs.near[k]));
            far = min(far, multiply_add(back ? low : high, slabs.inverse[k], slabs.far[k]));
        };
        slab(0, pa.x, pb.x, pc.x), slab(1, pa.y, pb.y, pc.y), slab(2, pa.z, pb.z, pc.z);
        Mask meets = near <= far;
        if (none(meets)) continue;
        const TrianglesAhead triangles(pa, pb, pc, ball.from);
        near = triangles.met(ball, triangles.face(), near);
        meets = meets & (near <= last);
        for (int plane = 0; plane < kMostPlanes && any(meets); ++plane) {
            const Floats next = triangles.met(ball, triangles.way_to(ball.way * near), near);
            const bool further = any(meets & (next > near));
            near = next;
            meets = meets & (near <= last);
            if (!further) break;
        }
        store(near, first + at);
        met |= bits(meets) << at;
    }
    return met & ((1u << leaf.triangle_count) - 1u);
}

/// @return a triangle's corners; false where they may not be the mesh's: vertices at one place are one in a leaf, whatever the signs of its zeros.
HWY_INLINE bool corners_of(const WideLeaf& leaf, int triangle, vec3* corners) {
    bool usual = true;
    for (int corner = 0; corner < 3; ++corner) {
        const int at = leaf.corner[corner][triangle];
        corners[corner] = {leaf.vertex[0][at], leaf.vertex[1][at], leaf.vertex[2][at]};
        usual = usual & (corners[corner].x != 0.0f) & (corners[corner].y != 0.0f) & (corners[corner].z != 0.0f);
    }
    return usual;
}

void visit_along_ball(const WideBvh& tree, WideRay& ray, const BallPath& path, BallVisit visit) {
    const SlabLanes slabs(ray);
    const BallLanes ball(ray, path);
    const bool same = tree.lossless && tree.scale == 1.0f;
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        alignas(64) float first[kWidth];
        for (unsigned rest = meet_ball(leaf, ray, slabs, ball, first); rest != 0;) {
            int next = std::countr_zero(rest);
            for (unsigned others = rest & (rest - 1); others != 0; others &= others - 1) {
                const int other = std::countr_zero(others);
                next = first[other] < first[next] ? other : next;
            }
            if (first[next] > ray.t_max) break;
            rest &= ~(1u << next);
            vec3 corners[3];
            const bool usual = corners_of(leaf, next, corners) && same;
            const float t = ray.own_t(visit(leaf.triangle[next], usual ? corners : nullptr));
            ray.t_max = t < ray.t_max ? t : ray.t_max;
        }
        return ray.t_max >= 0.0f;
    });
}

void visit_along(const WideBvh& tree, WideRay& ray, SweepVisit visit) {
    const SlabLanes slabs(ray);
    traverse(tree, ray, [&](const WideLeaf& leaf) HWY_ATTR {
        for (unsigned rest = meet_triangles(leaf, ray, slabs); rest != 0; rest &= rest - 1) {
            const float t = ray.own_t(visit(leaf.triangle[std::countr_zero(rest)]));
            ray.t_max = t < ray.t_max ? t : ray.t_max;
        }
        return ray.t_max >= 0.0f;
    });
}

}  // namespace
}  // namespace carom::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom {
namespace {

HWY_EXPORT(visit_along);
HWY_EXPORT(visit_along_ball);

/// Sets what slabs and planes read. As in wide_ray.hpp, with the pads larger by the box, and what rounding then does to them.
/// @return false where a float of the tree's coordinates cannot hold the path.
bool prepare_box(const WideBvh& tree, const geo::Ray<double>& ray, const dvec3& half, WideRay& out, BallPath& ball) noexcept {
    const double scale = static_cast<double>(tree.scale);
    const double largest = std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
    const int exponent = largest > 0.0 ? std::ilogb(largest) : 0;
    out.unit = std::ldexp(1.0 / scale, -exponent);
    out.moved = 0.0;
    const double widest = std::max({half.x, half.y, half.z}) * scale;
    double reach = 0.0, distance = 0.0;
    for (int k = 0; k < 3; ++k) {
        const double from = ray.origin[k] * scale;
        reach = std::max({reach, std::abs(static_cast<double>(tree.lower[k]) - from), std::abs(static_cast<double>(tree.upper[k]) - from)});
        distance = std::max(distance, std::abs(from));
    }
    const double rounding = 2.0 * static_cast<double>(WideRay::kPad) * (reach + distance + widest);
    if (!(rounding < 1e18)) return false;
    for (int k = 0; k < 3; ++k) {
        const float origin = static_cast<float>(ray.origin[k] * scale);
        const float d = static_cast<float>(std::ldexp(ray.direction[k], -exponent));
        const float component = std::copysign(std::max(std::abs(d), WideRay::kLeastComponent), d);
        const float side = std::copysign(static_cast<float>(half[k] * scale + rounding), component);
        out.origin[k] = origin;
        out.inverse[k] = 1.0f / component;
        out.near[k] = -(origin + side) * out.inverse[k];
        out.far[k] = -(origin - side) * out.inverse[k];
        out.back[k] = std::signbit(component) ? 1 : 0;
        ball.way[k] = d;
    }
    ball.radius = static_cast<float>(widest + rounding);
    out.t_min = 0.0f;
    out.t_max = largest > 0.0 ? out.own_t(ray.t_max) : 0.0f;
    return true;
}

}  // namespace

void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, const dvec3& half, SweepVisit visit) {
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || !is_finite(half) || !(ray.t_max >= 0.0)) return;
    if (!(half.x >= 0.0 && half.y >= 0.0 && half.z >= 0.0)) return;
    WideRay wide;
    BallPath unused;
    if (prepare_box(bvh.wide(), ray, half, wide, unused)) {
        HWY_DYNAMIC_DISPATCH(visit_along)(bvh.wide(), wide, visit);
        return;
    }
    for (std::uint32_t i = 0; i < bvh.triangle_count(); ++i) visit(i);  // so far away or so large that floats cannot tell
}

void triangles_along(const StaticBvh& bvh, const geo::Ray<double>& ray, double radius, BallVisit visit) {
    if (!is_finite(ray.origin) || !is_finite(ray.direction) || !std::isfinite(radius) || !(ray.t_max >= 0.0) || !(radius >= 0.0)) return;
    WideRay wide;
    BallPath ball;
    if (prepare_box(bvh.wide(), ray, dvec3{radius}, wide, ball) && ball.radius >= BallPath::kLeastRadius) {
        HWY_DYNAMIC_DISPATCH(visit_along_ball)(bvh.wide(), wide, ball, visit);
        return;
    }
    for (std::uint32_t i = 0; i < bvh.triangle_count(); ++i) visit(i, nullptr);
}

}  // namespace carom
#endif
