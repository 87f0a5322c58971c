#include <carom/narrowphase/detail/box_face_patch.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/reduce.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

namespace carom::detail {
namespace {

// The pair as the reference box sees it.
struct ReferenceView {
    const double* half;        // of the reference box
    const double* other_half;
    double axes[3][3];         // [x][y]: component along reference axis x of the other's axis y
    double centre[3];          // of the other box
    int face = 0;              // reference axis
    double side = 1.0;         // on which side of it the face is
};

ReferenceView view_from(const BoxPair& p, const BoxAxis& axis) noexcept {
    ReferenceView v;
    const bool of_a = axis.of_b < 0;
    v.half = of_a ? p.a : p.b;
    v.other_half = of_a ? p.b : p.a;
    v.face = of_a ? axis.of_a : axis.of_b;
    for (int x = 0; x < 3; ++x) {
        for (int y = 0; y < 3; ++y) v.axes[x][y] = of_a ? p.axes[x][y] : p.axes[y][x];
        v.centre[x] = of_a ? p.offset_a[x] : -p.offset_b[x];
    }
    // With the centres in one plane A's face looks along its axis, and B's against its own: the normal is then the axis either way.
    v.side = of_a ? (v.centre[v.face] < 0.0 ? -1.0 : 1.0) : (v.centre[v.face] > 0.0 ? 1.0 : -1.0);
    return v;
}

// A point over the reference face: coordinates along its sides, height over it, and what it is.
struct FacePoint {
    double u, w, separation;
    int corner;        // of the other box's face, 0..3; -1 if none
    int edge;          // of the other box's face
    int side;          // of the rectangle: 0 u+, 1 u-, 2 w+, 3 w-; -1 if none
};

struct FacePoints {
    std::array<FacePoint, 24> items;  // left uninitialised: 4 + 4 corners and at most 16 crossings are written before they are read
    std::size_t count = 0;
    void add(const FacePoint& p) noexcept { items[count++] = p; }
};

// The nearest face of the other box: a parallelogram over the rectangle. Corners run round it; edge k goes from corner k to k + 1.
struct Quad {
    int face = 0;
    double sign = 1.0;
    double u[4], w[4], h[4];
    double pu, pw, ph, qu, qw, qh;  // half edges along the axes face + 1 and face + 2
    double cu, cw, ch;              // centre
};

constexpr double kCornerP[4] = {1.0, -1.0, -1.0, 1.0};
constexpr double kCornerQ[4] = {1.0, 1.0, -1.0, -1.0};

Quad nearest_face(const ReferenceView& v) noexcept {
    Quad q;
    const double* along = v.axes[v.face];
    const double s0 = std::abs(along[0]), s1 = std::abs(along[1]), s2 = std::abs(along[2]);
    q.face = s0 >= s1 ? (s0 >= s2 ? 0 : 2) : (s1 >= s2 ? 1 : 2);
    q.sign = v.side * along[q.face] > 0.0 ? -1.0 : 1.0;
    const int u = (v.face + 1) % 3, w = (v.face + 2) % 3, p = (q.face + 1) % 3, r = (q.face + 2) % 3;
    const double out = q.sign * v.other_half[q.face], hp = v.other_half[p], hq = v.other_half[r];
    q.cu = v.centre[u] + out * v.axes[u][q.face];
    q.cw = v.centre[w] + out * v.axes[w][q.face];
    q.ch = v.side * (v.centre[v.face] + out * along[q.face]) - v.half[v.face];
    q.pu = hp * v.axes[u][p], q.pw = hp * v.axes[w][p], q.ph = v.side * hp * along[p];
    q.qu = hq * v.axes[u][r], q.qw = hq * v.axes[w][r], q.qh = v.side * hq * along[r];
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        q.u[k] = q.cu + kCornerP[k] * q.pu + kCornerQ[k] * q.qu;
        q.w[k] = q.cw + kCornerP[k] * q.pw + kCornerQ[k] * q.qw;
        q.h[k] = q.ch + kCornerP[k] * q.ph + kCornerQ[k] * q.qh;
    }
    return q;
}

// Which corners of the quad are beyond which side of the rectangle: bit k of sides[s] for corner k.
struct Beyond {
    unsigned sides[4] = {0, 0, 0, 0};
    [[nodiscard]] bool none() const noexcept { return (sides[0] | sides[1] | sides[2] | sides[3]) == 0; }
};

Beyond corners_beyond(const Quad& q, double hu, double hw) noexcept {
    Beyond b;
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        b.sides[0] |= (q.u[k] > hu ? 1u : 0u) << k;
        b.sides[1] |= (q.u[k] < -hu ? 1u : 0u) << k;
        b.sides[2] |= (q.w[k] > hw ? 1u : 0u) << k;
        b.sides[3] |= (q.w[k] < -hw ? 1u : 0u) << k;
    }
    return b;
}

void add_quad_corners(const Quad& q, double hu, double hw, double margin, FacePoints& points) noexcept {
    for (int k = 0; k < 4; ++k) {
        if (std::abs(q.u[k]) <= hu && std::abs(q.w[k]) <= hw && q.h[k] <= margin) points.add({q.u[k], q.w[k], q.h[k], k, -1, -1});
    }
}

// Corners of the rectangle, in the coordinates of the parallelogram.
void add_rectangle_corners(const Quad& q, double hu, double hw, double margin, FacePoints& points) noexcept {
    const double determinant = q.pu * q.qw - q.pw * q.qu;
    if (determinant == 0.0) return;  // the other face stands on edge
    const double inverse = 1.0 / determinant;
    constexpr double kInside = 1.0 + kInsideTolerance;
    for (int k = 0; k < 4; ++k) {
        const double u = kCornerP[k] * hu, w = kCornerQ[k] * hw;
        const double s = ((u - q.cu) * q.qw - (w - q.cw) * q.qu) * inverse, t = (q.pu * (w - q.cw) - q.pw * (u - q.cu)) * inverse;
        if (!(std::abs(s) <= kInside && std::abs(t) <= kInside)) continue;
        const double h = q.ch + s * q.ph + t * q.qh;
        if (h <= margin) points.add({u, w, h, -1, -1, k});
    }
}

void add_crossings(const Quad& q, const Beyond& beyond, double hu, double hw, double margin, FacePoints& points) noexcept {
    for (int side = 0; side < 4; ++side) {
        const unsigned mask = beyond.sides[side];
        const unsigned crossed = mask ^ (((mask >> 1) | (mask << 3)) & 15u);  // bit k: edge k passes the side
        if (crossed == 0) continue;
        const bool is_u = side < 2;
        const double limit = is_u ? hu : hw, other_limit = is_u ? hw : hu;
        const double line = side & 1 ? -limit : limit;
        const double *x = is_u ? q.u : q.w, *y = is_u ? q.w : q.u;
        for (int k = 0; k < 4; ++k) {
            if ((crossed >> k & 1u) == 0) continue;
            const int n = (k + 1) & 3;
            const double t = (x[k] - line) / (x[k] - x[n]);
            const double along = y[k] + t * (y[n] - y[k]);
            const double h = q.h[k] + t * (q.h[n] - q.h[k]);
            // A crossing next to a corner of the rectangle may round to either side of it: closed by the tolerance.
            if (std::abs(along) > other_limit * (1.0 + kInsideTolerance) || h > margin) continue;
            points.add({is_u ? line : along, is_u ? along : line, h, -1, k, side});
        }
    }
}

// Vertex and edge numbers of a box: bit k of a vertex is set on the positive side of axis k; edge 4 * axis + signs of the next two.
std::uint32_t vertex_number(int axis, double side, double along_1, double along_2) noexcept {
    return (side > 0.0 ? 1u << axis : 0u) | (along_1 > 0.0 ? 1u << ((axis + 1) % 3) : 0u) | (along_2 > 0.0 ? 1u << ((axis + 2) % 3) : 0u);
}
std::uint32_t edge_number(int axis, std::uint32_t vertex) noexcept {
    return 4u * static_cast<std::uint32_t>(axis) + ((vertex >> ((axis + 1) % 3)) & 1u) + 2u * ((vertex >> ((axis + 2) % 3)) & 1u);
}

// Names a point after a corner of B, or else of A, within `snap` of it; otherwise after the two edges. See steady_name().
std::uint64_t name_of(const FacePoint& p, const ReferenceView& v, const Quad& q, double snap, bool reference_is_a) noexcept {
    const double hu = v.half[(v.face + 1) % 3], hw = v.half[(v.face + 2) % 3];
    int corner = p.corner;
    for (int k = 0; corner < 0 && k < 4; ++k) {
        if (std::abs(q.u[k] - p.u) < snap && std::abs(q.w[k] - p.w) < snap) corner = k;
    }
    const bool at_reference = std::abs(std::abs(p.u) - hu) < snap && std::abs(std::abs(p.w) - hw) < snap;
    const std::uint32_t reference_vertex = vertex_number(v.face, v.side, p.u, p.w);
    const auto other_vertex = [&](int k) { return vertex_number(q.face, q.sign, kCornerP[k], kCornerQ[k]); };
    const auto name_a = [](std::uint32_t vertex) { return feature_name(FeatureKind::VertexOfFirst, vertex, 0); };
    const auto name_b = [](std::uint32_t vertex) { return feature_name(FeatureKind::VertexOfSecond, 0, vertex); };
    if (reference_is_a) {
        if (corner >= 0) return name_b(other_vertex(corner));
        if (at_reference) return name_a(reference_vertex);
    } else {
        if (at_reference) return name_b(reference_vertex);
        if (corner >= 0) return name_a(other_vertex(corner));
    }
    // Sides u+ and u- run along w, and the other way round; edges 0 and 2 of the quad run along its first axis.
    const std::uint32_t reference_edge = edge_number(p.side < 2 ? (v.face + 2) % 3 : (v.face + 1) % 3, reference_vertex);
    const std::uint32_t other_edge = edge_number((q.face + 1 + (p.edge & 1)) % 3, other_vertex(p.edge));
    return reference_is_a ? feature_name(FeatureKind::Edges, reference_edge, other_edge)
                          : feature_name(FeatureKind::Edges, other_edge, reference_edge);
}

}  // namespace

void build_box_face_patch(const BoxPair& p, const BoxAxis& axis, double margin, Patch& patch) noexcept {
    const bool of_a = axis.of_b < 0;
    const ReferenceView v = view_from(p, axis);
    const Quad quad = nearest_face(v);
    const int iu = (v.face + 1) % 3, iw = (v.face + 2) % 3;
    const double hu = v.half[iu], hw = v.half[iw];
    const double size = std::max({p.a[0], p.a[1], p.a[2], p.b[0], p.b[1], p.b[2]});

    FacePoints points;
    const Beyond beyond = corners_beyond(quad, hu, hw);
    add_quad_corners(quad, hu, hw, margin, points);
    if (!beyond.none()) {  // otherwise the whole of the other face is over this one
        add_rectangle_corners(quad, hu, hw, margin, points);
        add_crossings(quad, beyond, hu, hw, margin, points);
    }
    // The axis of the face, seen from A.
    const double direction = of_a ? v.side : -v.side;
    for (int i = 0; i < 3; ++i) patch.normal[i] = direction * (of_a ? (i == v.face ? 1.0 : 0.0) : p.axes[i][v.face]);
    const dvec3 begin = outline_start(patch.normal);
    const auto along = [&](int i) { return of_a ? begin[i] : begin.x * p.axes[0][i] + begin.y * p.axes[1][i] + begin.z * p.axes[2][i]; };
    Chosen chosen;
    const int count = reduce_points(std::span<const FacePoint>(points.items.data(), points.count), kPointTolerance * size,
                                    {along(iu), along(iw)}, chosen);
    const int ip = (quad.face + 1) % 3, iq = (quad.face + 2) % 3;
    const double snap = kSnap * 2.0 * std::min({hu, hw, v.other_half[ip], v.other_half[iq]});
    for (int i = 0; i < count; ++i) {
        const FacePoint& point = points.items[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
        double local[3];
        local[v.face] = v.side * (v.half[v.face] + 0.5 * point.separation);
        local[iu] = point.u;
        local[iw] = point.w;
        dvec3 position{local[0], local[1], local[2]};
        if (!of_a) {
            for (int k = 0; k < 3; ++k) {
                position[k] = p.offset_a[k] + p.axes[k][0] * local[0] + p.axes[k][1] * local[1] + p.axes[k][2] * local[2];
            }
        }
        patch.add(position, point.separation, name_of(point, v, quad, snap, of_a));
    }
}

}  // namespace carom::detail
