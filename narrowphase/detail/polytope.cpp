#include <carom/narrowphase/detail/polytope.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

using HalfEdge = ConvexHull::HalfEdge;

void measure(Polytope& p) noexcept {
    p.lower = p.upper = p.vertices[0];
    for (const dvec3& v : p.vertices) {
        p.lower = glm::min(p.lower, v);
        p.upper = glm::max(p.upper, v);
    }
    const dvec3 extent = p.upper - p.lower;
    p.size = std::max({extent.x, extent.y, extent.z});
}

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

// Planes 0 and 1 are the faces, 2 + k stands on the edge from corner k. Pairs 0..2 join the upper face with the sides, 3..5 the sides
// with the lower face, so that pair k and k + 3 are one edge. `next` is set for the loops of the two faces only.
constexpr HalfEdge kTriangleEdges[12] = {{0, 2, 0}, {1, 0, 2}, {1, 4, 0}, {2, 0, 3}, {2, 0, 0}, {0, 0, 4},
                                         {0, 0, 2}, {1, 11, 1}, {1, 0, 3}, {2, 7, 1}, {2, 0, 4}, {0, 9, 1}};

}  // namespace

void load_box(Polytope& out, const dvec3& half, const dmat3& axes, const dvec3& origin) {
    const dvec3 x = half.x * axes[0], y = half.y * axes[1], z = half.z * axes[2];
    out.vertices.resize(8);
    for (std::size_t i = 0; i < 8; ++i) out.vertices[i] = origin + (i & 1 ? x : -x) + (i & 2 ? y : -y) + (i & 4 ? z : -z);
    out.face_count = 6;
    out.planes.resize(6);
    for (int f = 0; f < 6; ++f) {
        const int axis = f / 2;
        const dvec3 normal = f % 2 == 0 ? -axes[axis] : axes[axis];
        const auto index = static_cast<std::size_t>(f);
        out.planes[index] = {normal, half[axis] + glm::dot(normal, origin), kBoxTopology.first_edge[index], 4};
    }
    out.half_edges = kBoxTopology.half_edges;
    out.edge_name_count = 12;
    out.centre = origin;
    measure(out);
}

void load_hull_vertices(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin) {
    const auto vertices = hull.vertices();
    out.vertices.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) out.vertices[i] = origin + axes * dvec3(vertices[i]);
}

void load_hull_faces(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin) {
    const auto faces = hull.faces();
    out.half_edges = hull.edges();
    out.edge_name_count = out.edge_count();
    out.face_count = faces.size();
    out.planes.resize(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const ConvexHull::Face& face = faces[f];
        const dvec3 normal = axes * face.normal;
        double offset = face.offset + glm::dot(normal, origin);
        // Corners of a merged face may poke out of its fitted plane; the plane moves out to hold them all.
        if (face.edge_count > 3) {
            std::uint32_t e = face.first_edge;
            for (std::uint32_t k = 0; k < face.edge_count; ++k, e = out.half_edges[e].next) {
                offset = std::max(offset, glm::dot(normal, out.origin_of(e)));
            }
        }
        out.planes[f] = {normal, offset, face.first_edge, face.edge_count};
    }
    measure(out);
    dvec3 sum{0.0};
    for (const dvec3& v : out.vertices) sum += v;
    out.centre = sum / static_cast<double>(out.vertices.size());
}

bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners) {
    const dvec3 ab = corners[1] - corners[0], bc = corners[2] - corners[1], ca = corners[0] - corners[2];
    const double longest_sq = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
    const dvec3 cross = glm::cross(ab, -ca);
    const double area = std::sqrt(glm::dot(cross, cross));
    if (!(area > 1e-12 * longest_sq)) return false;
    const dvec3 normal = cross / area;

    out.vertices.assign(corners.begin(), corners.end());
    const double h0 = glm::dot(normal, corners[0]), h1 = glm::dot(normal, corners[1]), h2 = glm::dot(normal, corners[2]);
    out.face_count = 2;
    out.planes.resize(5);
    out.planes[0] = {normal, std::max({h0, h1, h2}), 0, 3};
    out.planes[1] = {-normal, -std::min({h0, h1, h2}), 7, 3};
    const dvec3 along[3] = {ab, bc, ca};
    for (std::size_t k = 0; k < 3; ++k) {
        const dvec3 side = glm::cross(along[k], normal);
        const dvec3 outward = side / std::sqrt(glm::dot(side, side));
        out.planes[2 + k] = {outward, glm::dot(outward, corners[k]), static_cast<std::uint32_t>(2 * k), 0};
    }
    out.half_edges = kTriangleEdges;
    out.edge_name_count = 3;
    out.centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    measure(out);
    return true;
}

std::uint32_t face_along(const Polytope& p, const dvec3& direction) noexcept {
    std::uint32_t best = 0;
    double reach = glm::dot(p.planes[0].normal, direction);
    for (std::uint32_t f = 1; f < p.face_count; ++f) {
        const double r = glm::dot(p.planes[f].normal, direction);
        if (r > reach) {
            reach = r;
            best = f;
        }
    }
    return best;
}

std::uint32_t vertex_along(const Polytope& p, const dvec3& direction) noexcept {
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < p.vertices.size(); ++i) {
        if (glm::dot(p.vertices[i], direction) > glm::dot(p.vertices[best], direction)) best = i;
    }
    return best;
}

double reach_along(const Polytope& p, const dvec3& direction) noexcept {
    double reach = glm::dot(p.vertices[0], direction);
    for (const dvec3& v : p.vertices) reach = std::max(reach, glm::dot(v, direction));
    return reach;
}

}  // namespace carom::detail
