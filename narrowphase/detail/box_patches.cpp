#include <carom/core/simd_targets.hpp>
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/narrowphase/detail/box_patches.cpp>
#include <hwy/foreach_target.h>

#include <carom/core/lanes.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/box_outline_lanes.hpp>
#include <carom/narrowphase/detail/box_reduce_lanes.hpp>
#include <carom/narrowphase/detail/narrow_lanes.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

/// Which of three axes, a lane, and things in the order (it, the next, the one after).
struct Axis {
    Mask is_0, is_1;

    HWY_INLINE Floats3 cycled(Floats x, Floats y, Floats z) const {
        return {select(is_0, x, select(is_1, y, z)), select(is_0, y, select(is_1, z, x)), select(is_0, z, select(is_1, x, y))};
    }
    HWY_INLINE Floats3 cycled(const Floats3& v) const { return cycled(v.x, v.y, v.z); }
    /// Undoes cycled().
    HWY_INLINE Floats3 restored(const Floats3& v) const {
        return {select(is_0, v.x, select(is_1, v.z, v.y)), select(is_0, v.y, select(is_1, v.x, v.z)),
                select(is_0, v.z, select(is_1, v.y, v.x))};
    }
    HWY_INLINE Ints number() const { return select(is_0, Ints(0), select(is_1, Ints(1), Ints(2))); }
};

/// The axis along which `v` is longest; the first of equals.
HWY_INLINE Axis longest(const Floats3& v) {
    const Floats x = abs(v.x), y = abs(v.y), z = abs(v.z);
    const Mask is_2 = z > max(x, y);
    const Mask is_1 = (!is_2) & (y > x);
    return {(!is_2) & (!is_1), is_1};
}

HWY_INLINE Floats with_sign(Floats magnitude, Floats sign) { return select(sign < Floats(0.0f), -magnitude, magnitude); }

struct Pair {
    Floats3 half_a, half_b, offset;
    Floats3 column[3];  ///< axes of B along A's
    Floats margin;
};

HWY_INLINE Pair read_pair(const BoxPairBlock& in, std::size_t at) {
    const auto three = [at](const BoxPairBlock::Column* b) { return Floats3{load(b[0] + at), load(b[1] + at), load(b[2] + at)}; };
    const auto column = [&in, at](int j) {
        return Floats3{load(in.rotation[0][j] + at), load(in.rotation[1][j] + at), load(in.rotation[2][j] + at)};
    };
    return {three(in.half_a), three(in.half_b), three(in.offset), {column(0), column(1), column(2)}, load(in.margin + at)};
}

/// The edges of an edge axis, a lane; nothing where a face decides.
struct EdgeAxis {
    Mask any;
    Mask i[3], j[3];
    Floats3 direction_b;
    Floats3 cross;  ///< e_i x direction_b
    Floats length;  ///< of it
};

HWY_INLINE EdgeAxis edge_axis(const Pair& p, Ints code) {
    const Mask any_edge = code > Ints(kFirstEdge - 1);
    const Mask i0 = any_edge & (code < Ints(kFirstEdge + 3)), i2 = code > Ints(kFirstEdge + 5);
    const Mask i1 = any_edge & (!i0) & (!i2);
    const Mask j0 = (code == Ints(kFirstEdge)) | (code == Ints(kFirstEdge + 3)) | (code == Ints(kFirstEdge + 6));
    const Mask j1 = (code == Ints(kFirstEdge + 1)) | (code == Ints(kFirstEdge + 4)) | (code == Ints(kFirstEdge + 7));
    const Mask j2 = any_edge & (!j0) & (!j1);
    const Floats3 b = select(j0, p.column[0], select(j1, p.column[1], p.column[2]));
    const Floats zero(0.0f);
    const Floats3 cross_0{zero, -b.z, b.y}, cross_1{b.z, zero, -b.x}, cross_2{-b.y, b.x, zero};
    const Floats3 product = select(i0, cross_0, select(i1, cross_1, cross_2));
    return {any_edge, {i0, i1, i2}, {j0, j1, j2}, b, product, sqrt(dot(product, product))};
}

/// @return the unit normal from A to B; either way round where the centres coincide along it.
HWY_INLINE Floats3 contact_normal(const Pair& p, Ints code, const EdgeAxis& edges) {
    const Floats zero(0.0f), one(1.0f);
    Floats3 n = edges.cross * select(edges.any, one / edges.length, zero);
    const Floats3 units[3] = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) {
        n = select(code == Ints(k), units[k], n);
        n = select(code == Ints(kFirstFaceOfB + k), p.column[k], n);
    }
    const Mask backward = dot(n, p.offset) < zero;
    return select(backward, -n, n);
}

/// A face of each box, seen along the normal. Coordinates (s, t) are those of A's face: it is the square of half side 1.
struct Faces {
    Axis axis_a, axis_b;
    Floats3 normal;                     ///< in A's axes from its face's on, as all of this
    Floats3 across_u, across_w;         ///< with the normal a right-handed basis; across_w has no component along A's axis p
    Floats pu, qu, qw;                  ///< A's half edges p = (pu, 0) and q = (qu, qw) in the basis
    Floats height, height_p, height_q;  ///< of A's face along the normal: height + s height_p + t height_q
    Floats cu, cw;                      ///< centre of A's face in the basis
    Floats3 centre, edge_p, edge_q;     ///< of B's face: s, t and separation from A's
};

HWY_INLINE Faces make_faces(const Pair& p, const Floats3& n, const Floats3& n_b) {
    const Axis axis_a = longest(n), axis_b = longest(n_b);
    const Floats3 normal = axis_a.cycled(n);
    const Floats3 half = axis_a.cycled(p.half_a);
    // Of A's axis p, what is across the normal; |normal.x| is at least 1/sqrt(3).
    const Floats length = sqrt(normal.x * normal.x + normal.z * normal.z);
    const Floats inverse = Floats(1.0f) / length;
    const Floats3 across_u{-(normal.y * normal.x) * inverse, length, -(normal.y * normal.z) * inverse};
    const Floats3 across_w{-normal.z * inverse, Floats(0.0f), normal.x * inverse};
    const Floats out = with_sign(half.x, normal.x);
    const Floats pu = half.y * across_u.y, qu = half.z * across_u.z, qw = half.z * across_w.z;
    const Floats cu = out * across_u.x, cw = out * across_w.x;
    const Floats height = out * normal.x, height_p = half.y * normal.y, height_q = half.z * normal.z;

    // B's axes and centre in the basis, its face's first.
    const Floats inverse_pu = Floats(1.0f) / pu, inverse_qw = Floats(1.0f) / qw;
    const auto seen = [&](const Floats3& v) {  // (s, t, height over A's face) of a direction
        const Floats3 c = axis_a.cycled(v);
        const Floats u = dot(c, across_u), w = c.x * across_w.x + c.z * across_w.z;
        const Floats t = w * inverse_qw;
        const Floats s = (u - t * qu) * inverse_pu;
        return Floats3{s, t, dot(c, normal) - (s * height_p + t * height_q)};
    };
    const Floats3 of_0 = axis_b.cycled(p.column[0].x, p.column[1].x, p.column[2].x);
    const Floats3 of_1 = axis_b.cycled(p.column[0].y, p.column[1].y, p.column[2].y);
    const Floats3 of_2 = axis_b.cycled(p.column[0].z, p.column[1].z, p.column[2].z);
    const Floats3 half_b = axis_b.cycled(p.half_b);
    const Floats in = with_sign(half_b.x, -axis_b.cycled(n_b).x);
    const Floats3 b_face{of_0.x, of_1.x, of_2.x}, b_p{of_0.y, of_1.y, of_2.y}, b_q{of_0.z, of_1.z, of_2.z};
    // From the centre of A's face to that of B's.
    const Floats3 outward = axis_a.restored({out, Floats(0.0f), Floats(0.0f)});
    const Floats3 centre = seen((p.offset - outward) + in * b_face);
    const Floats3 edge_p = seen(half_b.y * b_p), edge_q = seen(half_b.z * b_q);
    return {axis_a, axis_b, normal, across_u, across_w, pu, qu, qw, height, height_p, height_q, cu, cw, centre, edge_p, edge_q};
}

constexpr float kCornerP[4] = {1.0f, -1.0f, -1.0f, 1.0f};
constexpr float kCornerQ[4] = {1.0f, 1.0f, -1.0f, -1.0f};

/// The corners of what the two faces share. Each edge of either, walked one way round, starts within the other face once at most: at its
/// own corner, or where it crosses the other's outline. Where it leaves instead, the edge that it crosses starts within its face. So all
/// corners are eight starts.
HWY_INLINE void add_face_points(const Faces& f, Mask wanted, Floats margin, WideCandidates& out) {
    const auto add = [&](Floats s, Floats t, Floats separation, const Start& start, Ints corner, Ints crossing)
        __attribute__((always_inline)) {
        const Mask valid = start.any & wanted & (separation <= margin);
        if (any(valid)) out.add(s * f.pu + t * f.qu, t * f.qw, separation, valid, select(start.corner, corner, crossing));
    };
    const Outline b(f.centre, f.edge_p, f.edge_q);
    add_starts_of_b(b, add);
    add_starts_of_a(b, add);
}

/// Where the two edges of an edge axis cross, seen along the normal; no point where they do so beyond their ends.
HWY_INLINE WidePoint edge_point(const Pair& p, const EdgeAxis& edges, const Floats3& n, const Floats3& n_b, Floats separation,
                                Floats tolerance, const Faces& f) {
    const Floats zero(0.0f);
    const Floats3 corner_a{select(edges.i[0], zero, with_sign(p.half_a.x, n.x)), select(edges.i[1], zero, with_sign(p.half_a.y, n.y)),
                           select(edges.i[2], zero, with_sign(p.half_a.z, n.z))};
    const Floats3 corner_b{select(edges.j[0], zero, with_sign(p.half_b.x, -n_b.x)), select(edges.j[1], zero, with_sign(p.half_b.y, -n_b.y)),
                           select(edges.j[2], zero, with_sign(p.half_b.z, -n_b.z))};
    const Floats3 middle_b = p.offset + (corner_b.x * p.column[0] + (corner_b.y * p.column[1] + corner_b.z * p.column[2]));
    const Floats3 between = middle_b - corner_a;
    const Floats one(1.0f);
    const Floats3 direction_a{select(edges.i[0], one, zero), select(edges.i[1], one, zero), select(edges.i[2], one, zero)};
    const Floats half_a = dot(direction_a, p.half_a);
    const Floats half_b = select(edges.j[0], p.half_b.x, select(edges.j[1], p.half_b.y, p.half_b.z));
    // The plane through either edge and the normal cuts the other edge where the lines cross; n . (e_i x e_j) is the length, or less it.
    const Floats scale = one / with_sign(edges.length, dot(n, edges.cross));
    const Floats s = dot(between, cross(edges.direction_b, n)) * scale, t = dot(between, cross(direction_a, n)) * scale;
    // Edges that are apart may cross beyond their ends. What decides then is an end, and so the distance.
    const Mask cross_within = edges.any & (abs(s) <= half_a + tolerance) & (abs(t) <= half_b + tolerance);
    const Floats3 point = Floats(0.5f) * ((corner_a + s * direction_a) + (middle_b + t * edges.direction_b));
    const Floats3 cycled = f.axis_a.cycled(point);
    return select(cross_within, {dot(cycled, f.across_u) - f.cu, dot(cycled, f.across_w) - f.cw, separation, Ints(kEdges)}, no_point());
}

/// The corner of a face, whose half edges are p and q about `centre`, that a point lies at; -1 for none.
HWY_INLINE Ints corner_near(Floats u, Floats w, const Floats (&corner_u)[4], const Floats (&corner_w)[4], Floats distance_sq) {
    Ints found(-1);
#pragma GCC unroll 4
    for (int k = 3; k >= 0; --k) {
        const Floats du = corner_u[k] - u, dw = corner_w[k] - w;
        found = select(du * du + dw * dw < distance_sq, Ints(k), found);
    }
    return found;
}

template <int count>
HWY_INLINE void write_points(const Pair& p, const Faces& f, const WidePoint (&points)[count], BoxPatchBundle& out, int lane) {
    Floats a_u[4], a_w[4], b_u[4], b_w[4];
#pragma GCC unroll 4
    for (int k = 0; k < 4; ++k) {
        const Floats along_p(kCornerP[k]), along_q(kCornerQ[k]);
        a_u[k] = along_p * f.pu + along_q * f.qu;
        a_w[k] = along_q * f.qw;
        const Floats s = f.centre.x + (along_p * f.edge_p.x + along_q * f.edge_q.x);
        const Floats t = f.centre.y + (along_p * f.edge_p.y + along_q * f.edge_q.y);
        b_u[k] = s * f.pu + t * f.qu;
        b_w[k] = t * f.qw;
    }
    const Floats3 half_a = f.axis_a.cycled(p.half_a), half_b = f.axis_b.cycled(p.half_b);
    const Floats snap = Floats(static_cast<float>(2.0 * kSnap)) * min(min(half_a.y, half_a.z), min(half_b.y, half_b.z));
    const Floats inverse_pu = Floats(1.0f) / f.pu, inverse_qw = Floats(1.0f) / f.qw;
#pragma GCC unroll 4
    for (std::size_t k = 0; k < count; ++k) {
        const WidePoint& point = points[k];
        const Floats t = point.w * inverse_qw;
        const Floats s = (point.u - t * f.qu) * inverse_pu;
        const Floats height = f.height + (s * f.height_p + t * f.height_q) + Floats(0.5f) * point.separation;
        const Floats3 position = ((f.cu + point.u) * f.across_u + (f.cw + point.w) * f.across_w) + height * f.normal;
        const Floats3 along_a = f.axis_a.restored(position);
        BoxPatchBundle::Point& to = out.points[k];
        store(along_a.x, to.position[0].lane + lane);
        store(along_a.y, to.position[1].lane + lane);
        store(along_a.z, to.position[2].lane + lane);
        store(point.separation, to.separation.lane + lane);
        store(point.code, to.candidate.lane + lane);
        store(corner_near(point.u, point.w, a_u, a_w, snap * snap), to.corner_a.lane + lane);
        store(corner_near(point.u, point.w, b_u, b_w, snap * snap), to.corner_b.lane + lane);
    }
}

HWY_INLINE Floats point_tolerance(const Pair& p) {
    const Floats3 a = p.half_a, b = p.half_b;
    return Floats(kWidePointTolerance) * max(max(max(a.x, a.y), a.z), max(max(b.x, b.y), b.z));
}

HWY_INLINE void write_directions(const Floats3& n, const Floats3& n_b, const Faces& f, BoxPatchBundle& out, int lane) {
    store(n.x, out.normal[0].lane + lane);
    store(n.y, out.normal[1].lane + lane);
    store(n.z, out.normal[2].lane + lane);
    store(n_b.x, out.normal_b[0].lane + lane);
    store(n_b.y, out.normal_b[1].lane + lane);
    store(n_b.z, out.normal_b[2].lane + lane);
    store(f.axis_a.number(), out.face_a.lane + lane);
    store(f.axis_b.number(), out.face_b.lane + lane);
}

/// A pair seen along its normal.
struct Seen {
    Pair p;
    EdgeAxis edges;
    Floats3 n, n_b;  ///< along A's axes and B's
    Faces f;
    Floats separation, tolerance;

    HWY_INLINE WidePoint edge_crossing() const { return edge_point(p, edges, n, n_b, separation, tolerance, f); }
};
HWY_INLINE Seen look(const BoxPairBlock& in, std::size_t at) {
    const Pair p = read_pair(in, at);
    const Ints code = load(in.code + at);
    const EdgeAxis edges = edge_axis(p, code);
    const Floats3 n = contact_normal(p, code, edges);
    const Floats3 n_b{dot(n, p.column[0]), dot(n, p.column[1]), dot(n, p.column[2])};
    return {p, edges, n, n_b, make_faces(p, n, n_b), load(in.separation + at), point_tolerance(p)};
}

void build_patch(const BoxPairBlock& in, std::size_t at, BoxPatchBundle& out, int lane) {
    const Seen seen = look(in, at);
    const auto& [p, edges, n, n_b, f, separation, tolerance] = seen;

    // Boxes that cross edges share points of their faces only where those face the normal: see share_points().
    const Floats facing_a = abs(f.normal.x), facing_b = abs(f.axis_b.cycled(n_b).x);
    const Mask square = max(facing_a, facing_b) > Floats(static_cast<float>(kSquareCosine));
    const Mask share = (!edges.any) | square | (min(facing_a, facing_b) > Floats(static_cast<float>(kFacingCosine)));
    WideCandidates candidates;
    add_face_points(f, share, p.margin, candidates);
    if (any(edges.any)) {
        const WidePoint point = seen.edge_crossing();
        candidates.add(point.u, point.w, point.separation, exists(point), point.code);
    }

    const Floats one(1.0f), slant(0.381966f), zero(0.0f);  // see outline_start()
    const Mask is_1 = f.axis_a.is_1;
    const Floats3 start{zero, select(is_1, slant, one), select(is_1, one, slant)};
    const Floats overlook = in.steady ? Floats(static_cast<float>(kSteadyCap / static_cast<double>(kWidePointTolerance))) * tolerance : zero;
    const WideChoice chosen = choose_points(candidates, {tolerance, overlook}, dot(start, f.across_u), start.z * f.across_w.z);
    write_points<4>(p, f, chosen.points, out, lane);
    // Where the corner that is nearest along the axis lies beside the other's face, all points that are left are farther apart than the
    // boxes may be.
    const Mask reaches = chosen.lowest <= separation + tolerance;
    store(select(reaches, chosen.count, Ints(0)), out.count.lane + lane);
    write_directions(n, n_b, f, out, lane);
}

void build_patch_of_edges(const BoxPairBlock& in, std::size_t at, BoxPatchBundle& out, int lane) {
    const Seen seen = look(in, at);
    const WidePoint point[1] = {seen.edge_crossing()};
    write_points<1>(seen.p, seen.f, point, out, lane);
    store(select(exists(point[0]), Ints(1), Ints(0)), out.count.lane + lane);
    write_directions(seen.n, seen.n_b, seen.f, out, lane);
}

void BuildPatch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, int lanes) {
    for (int lane = 0; lane < lanes; lane += kLanes)
        build_patch(block, bundle * kBundleWidth + static_cast<std::size_t>(lane), patch, lane);
}
void BuildEdgePatch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, int lanes) {
    for (int lane = 0; lane < lanes; lane += kLanes)
        build_patch_of_edges(block, bundle * kBundleWidth + static_cast<std::size_t>(lane), patch, lane);
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace carom::detail {
HWY_EXPORT(BuildPatch);
void build_box_patch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(BuildPatch)(block, bundle, patch, 1);
    HWY_DYNAMIC_DISPATCH(BuildPatch)(block, bundle, patch, kBundleWidth);
}
HWY_EXPORT(BuildEdgePatch);
void build_edge_patch(const BoxPairBlock& block, std::size_t bundle, BoxPatchBundle& patch, BoxLanes lanes) {
    if (lanes == BoxLanes::First) return CAROM_NARROW_DISPATCH(BuildEdgePatch)(block, bundle, patch, 1);
    HWY_DYNAMIC_DISPATCH(BuildEdgePatch)(block, bundle, patch, kBundleWidth);
}
}  // namespace carom::detail
#endif
