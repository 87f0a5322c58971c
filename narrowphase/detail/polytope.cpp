#include <carom/narrowphase/detail/polytope.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

using Face = ConvexHull::Face;
using HalfEdge = ConvexHull::HalfEdge;

// Vertex bits: 1 = +x, 2 = +y, 4 = +z. Faces: 2 k on the negative side of axis k, 2 k + 1 on the positive one.
constexpr std::uint32_t kBoxLoops[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

struct BoxTopology {
    HalfEdge half_edges[24];
    std::uint32_t first_edge[6];
};

// Pairs each side of a loop with the side of another loop that runs the other way.
constexpr BoxTopology make_box_topology() {
    BoxTopology t{};
    std::uint32_t index[6][4]{};
    std::uint32_t count = 0;
    for (std::uint32_t f = 0; f < 6; ++f) {
        for (std::uint32_t c = 0; c < 4; ++c) {
            const std::uint32_t from = kBoxLoops[f][c], to = kBoxLoops[f][(c + 1) % 4];
            if (from > to) continue;
            for (std::uint32_t g = 0; g < 6; ++g) {
                for (std::uint32_t d = 0; d < 4; ++d) {
                    if (kBoxLoops[g][d] != to || kBoxLoops[g][(d + 1) % 4] != from) continue;
                    index[f][c] = count++;
                    index[g][d] = count++;
                }
            }
        }
    }
    for (std::uint32_t f = 0; f < 6; ++f) {
        t.first_edge[f] = index[f][0];
        for (std::uint32_t c = 0; c < 4; ++c) t.half_edges[index[f][c]] = {kBoxLoops[f][c], index[f][(c + 1) % 4], f};
    }
    return t;
}

constexpr BoxTopology kBoxTopology = make_box_topology();

std::span<const Face> box_loops() {
    static const std::array<Face, 6> loops = [] {
        std::array<Face, 6> made;
        for (std::size_t f = 0; f < 6; ++f) made[f] = {dvec3{0.0}, 0.0, kBoxTopology.first_edge[f], 4};
        return made;
    }();
    return loops;
}

// Planes 0 and 1 are the faces, 2 + k stands on the edge from corner k. Pairs 0..2 join the upper face with the sides, 3..5 the sides
// with the lower face, so that pair k and k + 3 are one edge. `next` is set for the loops of the two faces only.
constexpr HalfEdge kTriangleEdges[12] = {{0, 2, 0}, {1, 0, 2}, {1, 4, 0}, {2, 0, 3}, {2, 0, 0}, {0, 0, 4},
                                         {0, 0, 2}, {1, 11, 1}, {1, 0, 3}, {2, 7, 1}, {2, 0, 4}, {0, 9, 1}};

std::span<const Face> triangle_loops() {
    static const std::array<Face, 2> loops{Face{dvec3{0.0}, 0.0, 0, 3}, Face{dvec3{0.0}, 0.0, 7, 3}};
    return loops;
}

// Shows and moves what `points` and `planes` show.
void move_to(Polytope& out, const dmat3& axes, const dvec3& origin) {
    out.own_points.resize(out.points.size());
    out.own_planes.resize(out.planes.size());
    place_polytope(out.points, out.planes, axes, origin, out.own_points.data(), out.own_planes.data());
    out.points = out.own_points;
    out.planes = out.own_planes;
    out.centre = axes * out.centre + origin;
}

}  // namespace

void load_box(Polytope& out, const dvec3& half) {
    out.own_points.resize(1);
    out.own_planes.resize(1);
    for (std::size_t i = 0; i < 8; ++i) {
        set_point(out.own_points[0], i, {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
    }
    for (int f = 0; f < 6; ++f) {
        dvec3 normal{0.0};
        normal[f / 2] = f % 2 == 0 ? -1.0 : 1.0;
        set_plane(out.own_planes[0], static_cast<std::size_t>(f), normal, half[f / 2]);
    }
    end_planes(out.own_planes[0], 6);
    out.points = out.own_points;
    out.planes = out.own_planes;
    out.loops = box_loops();
    out.half_edges = kBoxTopology.half_edges;
    out.vertex_count = 8;
    out.edge_name_count = 12;
    out.side_count = 0;
    out.centre = dvec3{0.0};
    out.size = 2.0 * std::max({half.x, half.y, half.z});
    out.listed.clear();
}

void load_box(Polytope& out, const dvec3& half, const dmat3& axes, const dvec3& origin) {
    load_box(out, half);
    move_to(out, axes, origin);
}

void load_hull(Polytope& out, const ConvexHull& hull) {
    out.points = hull.point_bundles();
    out.planes = hull.plane_bundles();
    out.loops = hull.faces();
    out.half_edges = hull.edges();
    out.vertex_count = static_cast<std::uint32_t>(hull.vertices().size());
    out.edge_name_count = out.edge_count();
    out.side_count = 0;
    out.centre = hull.centre();
    const dvec3 extent = hull.local_bounds().upper - hull.local_bounds().lower;
    out.size = std::max({extent.x, extent.y, extent.z});
    out.listed.clear();
}

void load_hull(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin) {
    load_hull(out, hull);
    move_to(out, axes, origin);
}

bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners) {
    const dvec3 ab = corners[1] - corners[0], bc = corners[2] - corners[1], ca = corners[0] - corners[2];
    const double longest_sq = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
    const dvec3 cross = glm::cross(ab, -ca);
    const double area = std::sqrt(glm::dot(cross, cross));
    if (!(area > 1e-12 * longest_sq)) return false;
    const dvec3 normal = cross / area;

    out.own_points.resize(1);
    out.own_planes.resize(1);
    for (std::size_t i = 0; i < 8; ++i) set_point(out.own_points[0], i, corners[std::min<std::size_t>(i, 2)]);
    const double h0 = glm::dot(normal, corners[0]), h1 = glm::dot(normal, corners[1]), h2 = glm::dot(normal, corners[2]);
    set_plane(out.own_planes[0], 0, normal, std::max({h0, h1, h2}));
    set_plane(out.own_planes[0], 1, -normal, -std::min({h0, h1, h2}));
    end_planes(out.own_planes[0], 2);
    const dvec3 along[3] = {ab, bc, ca};
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 side = glm::cross(along[k], normal);
        const dvec3 outward = side / std::sqrt(glm::dot(side, side));
        set_plane(out.sides, k, outward, glm::dot(outward, corners[k]));
    }
    end_planes(out.sides, 3);
    out.points = out.own_points;
    out.planes = out.own_planes;
    out.loops = triangle_loops();
    out.half_edges = kTriangleEdges;
    out.vertex_count = 3;
    out.edge_name_count = 3;
    out.side_count = 3;
    out.centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    const dvec3 extent = glm::max(glm::max(corners[0], corners[1]), corners[2]) - glm::min(glm::min(corners[0], corners[1]), corners[2]);
    out.size = std::max({extent.x, extent.y, extent.z});
    out.listed.clear();
    return true;
}

bool is_over_face(const Polytope& polytope, std::uint32_t face, const dvec3& p) noexcept {
    const dvec3 normal = polytope.normal(face);
    std::uint32_t e = polytope.loops[face].first_edge;
    for (std::uint32_t k = 0; k < polytope.loops[face].edge_count; ++k) {
        const dvec3 from = polytope.origin_of(e);
        e = polytope.half_edges[e].next;
        if (!(glm::dot(glm::cross(polytope.origin_of(e) - from, normal), p - from) < 0.0)) return false;
    }
    return true;
}

std::span<const dvec3> list_vertices(Polytope& p) {
    if (p.listed.empty()) {
        for (std::uint32_t i = 0; i < p.vertex_count; ++i) p.listed.push_back(p.vertex(i));
    }
    return p.listed;
}

}  // namespace carom::detail
