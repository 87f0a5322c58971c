#include <carom/collision/detail/orientation.hpp>
#include <carom/collision/detail/triangles_meet.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

using Corners2 = std::array<dvec2, 3>;

struct Sides {
    int of[3];
    [[nodiscard]] bool one_side() const noexcept {
        return (of[0] > 0 && of[1] > 0 && of[2] > 0) || (of[0] < 0 && of[1] < 0 && of[2] < 0);
    }
    [[nodiscard]] bool none_zero() const noexcept { return of[0] != 0 && of[1] != 0 && of[2] != 0; }
    [[nodiscard]] bool all_zero() const noexcept { return of[0] == 0 && of[1] == 0 && of[2] == 0; }
};

/// On which sides of the plane of `plane` the corners lie: zero for all of them where it has no plane.
Sides sides_of(const TriangleCorners& plane, const TriangleCorners& corners) noexcept {
    Sides out{};
    const FilteredCross normal(plane[1] - plane[0], plane[2] - plane[0]);
    for (std::size_t k = 0; k < 3; ++k) {
        out.of[k] = normal.side(corners[k] - plane[0]);
        if (out.of[k] == 0) out.of[k] = exact_orientation(plane[0], plane[1], plane[2], corners[k]);
    }
    return out;
}

bool same_sign(int x, int y, int z) noexcept { return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0); }

/// Whether an edge with ends on different sides of the triangle's plane, or one end in it, meets the triangle. An edge in the plane
/// needs no test: where it meets the triangle, another edge of one of the two does that has one end in the other's plane.
bool an_edge_meets(const TriangleCorners& edges, const Sides& sides, const TriangleCorners& triangle) noexcept {
    for (std::size_t j = 0; j < 3; ++j) {
        const std::size_t k = j == 2 ? 0 : j + 1;
        if (sides.of[j] * sides.of[k] > 0 || (sides.of[j] == 0 && sides.of[k] == 0)) continue;
        const dvec3 &p = edges[j], &q = edges[k];
        const dvec3 along = q - p, to[3] = {triangle[0] - p, triangle[1] - p, triangle[2] - p};
        int turn[3];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t next = i == 2 ? 0 : i + 1;
            turn[i] = FilteredCross(along, to[i]).side(to[next]);
            if (turn[i] == 0) turn[i] = exact_orientation(p, q, triangle[i], triangle[next]);
        }
        if (same_sign(turn[0], turn[1], turn[2])) return true;
    }
    return false;
}

/// Whether `p`, which is in line with a and b, lies between them.
bool is_between(const dvec2& p, const dvec2& a, const dvec2& b) noexcept {
    return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) && p.y <= std::max(a.y, b.y);
}

bool segments_meet(const dvec2& a, const dvec2& b, const dvec2& p, const dvec2& q) noexcept {
    const int ap = orientation(a, b, p), aq = orientation(a, b, q), pa = orientation(p, q, a), pb = orientation(p, q, b);
    if (ap * aq < 0 && pa * pb < 0) return true;
    return (ap == 0 && is_between(p, a, b)) || (aq == 0 && is_between(q, a, b)) || (pa == 0 && is_between(a, p, q)) ||
           (pb == 0 && is_between(b, p, q));
}

bool holds(const Corners2& triangle, const dvec2& p) noexcept {
    const int x = orientation(triangle[0], triangle[1], p), y = orientation(triangle[1], triangle[2], p),
              z = orientation(triangle[2], triangle[0], p);
    return orientation(triangle[0], triangle[1], triangle[2]) != 0 && same_sign(x, y, z);
}

bool flat_triangles_meet(const Corners2& a, const Corners2& b) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (segments_meet(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3])) return true;
        }
    }
    return holds(a, b[0]) || holds(b, a[0]);
}

/// Triangles in one plane, or without a plane of their own. In one plane they meet if and only if their shadows along all three axes
/// do, as the shadow along an axis that is not in the plane loses nothing.
bool triangles_in_plane_meet(const TriangleCorners& a, const TriangleCorners& b) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            if (orientation(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]) != 0) return false;  // two segments askew
        }
    }
    for (int axis = 0; axis < 3; ++axis) {
        const int x = (axis + 1) % 3, y = (axis + 2) % 3;
        const auto shadow = [&](const TriangleCorners& t) {
            return Corners2{dvec2{t[0][x], t[0][y]}, dvec2{t[1][x], t[1][y]}, dvec2{t[2][x], t[2][y]}};
        };
        if (!flat_triangles_meet(shadow(a), shadow(b))) return false;
    }
    return true;
}

/// The corner that has a side of its own, where none is in the plane.
std::size_t lone_corner(const Sides& sides) noexcept {
    if (sides.of[1] == sides.of[2]) return 0;
    return sides.of[0] == sides.of[2] ? 1 : 2;
}

/// Where the planes cut both triangles and hold no corner: their line of intersection leaves each triangle through the two edges at
/// its lone corner, and the two stretches overlap unless one ends before the other begins.
bool stretches_overlap(const TriangleCorners& a, const Sides& of_a, const TriangleCorners& b, const Sides& of_b) noexcept {
    const std::size_t i = lone_corner(of_a), j = lone_corner(of_b);
    // Turned so that each lone corner is above the other plane.
    const std::size_t step_a = of_b.of[j] > 0 ? 1 : 2, step_b = of_a.of[i] > 0 ? 1 : 2;
    const dvec3 &p = a[i], &q = a[(i + step_a) % 3], &r = a[(i + 3 - step_a) % 3];
    const dvec3 &u = b[j], &v = b[(j + step_b) % 3], &w = b[(j + 3 - step_b) % 3];
    return orientation(p, q, u, v) <= 0 && orientation(p, r, w, u) <= 0;
}

}  // namespace

bool triangles_meet(const TriangleCorners& a, const TriangleCorners& b) noexcept {
    // Of coincident meshes and of patches of one surface nearly all that meet have a corner in common, where no sign is cheap.
    for (const dvec3& p : a) {
        if (p == b[0] || p == b[1] || p == b[2]) return true;
    }
    const Sides of_b = sides_of(a, b);
    if (of_b.one_side()) return false;
    const Sides of_a = sides_of(b, a);
    if (of_a.one_side()) return false;
    if (of_a.none_zero() && of_b.none_zero()) return stretches_overlap(a, of_a, b, of_b);
    if (of_a.all_zero() && of_b.all_zero()) return triangles_in_plane_meet(a, b);
    return an_edge_meets(b, of_b, a) || an_edge_meets(a, of_a, b);
}

}  // namespace carom::detail
