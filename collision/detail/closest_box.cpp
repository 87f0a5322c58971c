#include <carom/collision/detail/closest_box.hpp>

#include <algorithm>

namespace carom::geo::detail {
namespace {

// Corner k of a box at the origin: bit i of k chooses the side on axis i.
dvec3 corner(const dvec3& h, int k) noexcept { return {(k & 1) != 0 ? h.x : -h.x, (k & 2) != 0 ? h.y : -h.y, (k & 4) != 0 ? h.z : -h.z}; }

// Edge k of 12: along axis k / 4, from the corner that has that axis' bit clear.
Segment<double> edge(const dvec3& h, int k) noexcept {
    const int axis = k / 4, low = (k & 1) << ((axis + 1) % 3), high = ((k >> 1) & 1) << ((axis + 2) % 3);
    const int first = low | high;
    return {corner(h, first), corner(h, first | (1 << axis))};
}

// Half the derivative along `d` of the squared distance of p from the box.
double slope(const dvec3& p, const dvec3& d, const dvec3& h) noexcept { return glm::dot(d, p - clamp_to(h, p)); }

// The middle of the part of the segment a + t d, 0 <= t <= 1, inside the box; false if that is empty to rounding.
bool middle_inside(const dvec3& a, const dvec3& d, const dvec3& h, dvec3& middle) noexcept {
    double enter = 0.0, leave = 1.0;
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0.0) {
            if (std::fabs(a[i]) > h[i]) return false;
            continue;
        }
        const double t0 = (-h[i] - a[i]) / d[i], t1 = (h[i] - a[i]) / d[i];
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    if (!(enter <= leave)) return false;
    middle = a + (0.5 * (enter + leave)) * d;
    return clamp_to(h, middle) == middle;
}

template <class BoxA, class BoxB>
Nearest closest_by_edges(const BoxA& a, const BoxB& b) noexcept {
    const dvec3 inside = to_local(b, a.center);
    if (clamp_to(half_extents(b), inside) == inside) return {a.center, a.center, 0.0};
    Nearest best = closest(a.center, b);
    for (int k = 0; k < 12 && best.sq > 0.0; ++k) {
        const Segment<double> of_a = edge(half_extents(a), k);
        keep_nearer(best, closest(Segment<double>{to_world(a, of_a.a), to_world(a, of_a.b)}, b));
    }
    for (int k = 0; k < 12 && best.sq > 0.0; ++k) {
        const Segment<double> of_b = edge(half_extents(b), k);
        keep_nearer(best, swapped(closest(Segment<double>{to_world(b, of_b.a), to_world(b, of_b.b)}, a)));
    }
    return best;
}

}  // namespace

Nearest closest_local(const Segment<double>& s, const dvec3& h) noexcept {
    const dvec3 d = s.b - s.a;
    dvec3 x{0.0};
    if (middle_inside(s.a, d, h, x)) return {x, x, 0.0};
    const auto at = [&](const dvec3& p) { return nearest(p, clamp_to(h, p)); };
    double low = 0.0, low_slope = slope(s.a, d, h);
    if (low_slope >= 0.0) return at(s.a);
    double high = 1.0, high_slope = slope(s.b, d, h);
    if (high_slope <= 0.0) return at(s.b);
    // Between the planes of the box the slope is linear: the two planes around its root are what is needed, in no order.
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0.0) continue;
        for (const double plane : {-h[i], h[i]}) {
            const double t = (plane - s.a[i]) / d[i];
            if (!(t > low && t < high)) continue;
            const double g = slope(s.a + t * d, d, h);
            if (g < 0.0) {
                low = t, low_slope = g;
            } else {
                high = t, high_slope = g;
            }
        }
    }
    const double t = low + (high - low) * (low_slope / (low_slope - high_slope));
    return at(s.a + t * d);
}

Nearest closest_local(const Triangle<double>& t, const dvec3& h, double slack) noexcept {
    const TriangleFrame frame(t);
    Nearest best = closest_local(frame.edge(0), h);
    for (int k = 1; k < 3 && best.sq > 0.0; ++k) keep_nearer(best, closest_local(frame.edge(k), h));
    if (best.sq == 0.0) return best;
    double height[8];
    int nearest_corner = 0;
    for (int k = 0; k < 8; ++k) {
        height[k] = glm::dot(corner(h, k) - frame.corner(), frame.normal());
        if (std::fabs(height[k]) < std::fabs(height[nearest_corner])) nearest_corner = k;
    }
    // Where the face is nearer than its edges, the box lies on one side of its plane, and the corner next to the plane decides.
    const dvec3 p = corner(h, nearest_corner);
    Nearest other = swapped(best);
    dvec3 foot{0.0};
    if (frame.project(p, foot)) keep_nearer(other, nearest(p, foot));
    for (int k = 0; k < 12 && other.sq > 0.0; ++k) {
        const int axis = k / 4, first = ((k & 1) << ((axis + 1) % 3)) | (((k >> 1) & 1) << ((axis + 2) % 3));
        const int second = first | (1 << axis);
        offer_crossing(corner(h, first), corner(h, second), height[first], height[second], frame, slack, other);
    }
    return swapped(other);
}

Nearest closest(const Obb<double>& a, const Obb<double>& b) noexcept { return closest_by_edges(a, b); }
Nearest closest(const AlignedBox& a, const Obb<double>& b) noexcept { return closest_by_edges(a, b); }

Nearest closest(const AlignedBox& a, const AlignedBox& b) noexcept {
    Nearest n;
    for (int i = 0; i < 3; ++i) {
        const double low_a = a.center[i] - a.half[i], high_a = a.center[i] + a.half[i];
        const double low_b = b.center[i] - b.half[i], high_b = b.center[i] + b.half[i];
        if (high_a < low_b) {
            n.a[i] = high_a, n.b[i] = low_b;
        } else if (high_b < low_a) {
            n.a[i] = low_a, n.b[i] = high_b;
        } else {
            n.a[i] = n.b[i] = 0.5 * (std::max(low_a, low_b) + std::min(high_a, high_b));
        }
    }
    n.sq = nearest(n.a, n.b).sq;
    return n;
}

}  // namespace carom::geo::detail
