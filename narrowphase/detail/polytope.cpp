#include <carom/collision/convex_hull.hpp>
#include <carom/narrowphase/detail/polytope.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

void measure(Polytope& p) noexcept {
    p.lower = p.upper = p.vertices[0];
    for (const dvec3& v : p.vertices) {
        p.lower = glm::min(p.lower, v);
        p.upper = glm::max(p.upper, v);
    }
    const dvec3 extent = p.upper - p.lower;
    p.size = std::max({extent.x, extent.y, extent.z});
}

struct BoxEdge {
    std::uint32_t from, to, left, right;
};

// Vertex bits: 1 = +x, 2 = +y, 4 = +z. Faces: 2 k on the negative side of axis k, 2 k + 1 on the positive one.
constexpr std::uint32_t kBoxLoops[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

struct BoxTopology {
    BoxEdge edges[12]{};
    std::uint32_t loop_edge[24]{};
};

constexpr BoxTopology make_box_topology() {
    BoxTopology t{};
    std::uint32_t count = 0;
    for (std::uint32_t f = 0; f < 6; ++f) {
        for (std::uint32_t c = 0; c < 4; ++c) {
            const std::uint32_t from = kBoxLoops[f][c], to = kBoxLoops[f][(c + 1) % 4];
            std::uint32_t e = 0;
            while (e < count && !(t.edges[e].from == to && t.edges[e].to == from)) ++e;
            if (e == count) {
                t.edges[count++] = {from, to, f, f};
            } else {
                t.edges[e].right = f;
            }
            t.loop_edge[f * 4 + c] = e;
        }
    }
    return t;
}

constexpr BoxTopology kBoxTopology = make_box_topology();

}  // namespace

void load_box(Polytope& out, const dvec3& half, const dmat3& axes, const dvec3& origin) {
    out.vertices.resize(8);
    for (std::size_t i = 0; i < 8; ++i) {
        const dvec3 corner{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        out.vertices[i] = origin + axes * corner;
    }
    out.faces.resize(6);
    for (int f = 0; f < 6; ++f) {
        const int axis = f / 2;
        const dvec3 normal = f % 2 == 0 ? -axes[axis] : axes[axis];
        out.faces[static_cast<std::size_t>(f)] = {normal, half[axis] + glm::dot(normal, origin), static_cast<std::uint32_t>(4 * f), 4};
    }
    out.loop.assign(&kBoxLoops[0][0], &kBoxLoops[0][0] + 24);
    out.loop_edge.assign(kBoxTopology.loop_edge, kBoxTopology.loop_edge + 24);
    out.edges.resize(12);
    for (std::uint32_t e = 0; e < 12; ++e) {
        const BoxEdge& edge = kBoxTopology.edges[e];
        out.edges[e] = {edge.from, edge.to, out.vertices[edge.to] - out.vertices[edge.from], out.faces[edge.left].normal,
                        out.faces[edge.right].normal, e};
    }
    measure(out);
}

void load_hull_vertices(Polytope& out, const ConvexHull& hull, const dmat3& axes, const dvec3& origin) {
    const auto vertices = hull.vertices();
    out.vertices.resize(vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) out.vertices[i] = origin + axes * dvec3(vertices[i]);
    measure(out);
}

void load_hull_faces(Polytope& out, const ConvexHull& hull, const dmat3& axes) {
    const auto faces = hull.faces();
    const auto edges = hull.edges();
    out.faces.resize(faces.size());
    out.loop.clear();
    out.loop_edge.clear();
    for (std::size_t f = 0; f < faces.size(); ++f) {
        const dvec3 normal = axes * faces[f].normal;
        const auto first = static_cast<std::uint32_t>(out.loop.size());
        // Corners of a merged face may poke out of its fitted plane; the plane moves out to hold them all.
        double offset = glm::dot(normal, out.vertices[edges[faces[f].first_edge].origin]);
        std::uint32_t e = faces[f].first_edge;
        for (std::uint32_t k = 0; k < faces[f].edge_count; ++k, e = edges[e].next) {
            out.loop.push_back(edges[e].origin);
            out.loop_edge.push_back(e / 2);
            offset = std::max(offset, glm::dot(normal, out.vertices[edges[e].origin]));
        }
        out.faces[f] = {normal, offset, first, faces[f].edge_count};
    }
    out.edges.resize(edges.size() / 2);
    for (std::uint32_t e = 0; e < out.edges.size(); ++e) {
        const ConvexHull::HalfEdge &half = edges[2 * e], &twin = edges[ConvexHull::twin(2 * e)];
        out.edges[e] = {half.origin, twin.origin, out.vertices[twin.origin] - out.vertices[half.origin],
                        out.faces[half.face].normal, out.faces[twin.face].normal, e};
    }
}

bool load_triangle(Polytope& out, const std::array<dvec3, 3>& corners) {
    const dvec3 ab = corners[1] - corners[0], bc = corners[2] - corners[1], ca = corners[0] - corners[2];
    const double longest_sq = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
    const dvec3 cross = glm::cross(ab, -ca);
    const double area = std::sqrt(glm::dot(cross, cross));
    if (!(area > 1e-12 * longest_sq)) return false;
    const dvec3 normal = cross / area;

    out.vertices.assign(corners.begin(), corners.end());
    const double top = std::max({glm::dot(normal, corners[0]), glm::dot(normal, corners[1]), glm::dot(normal, corners[2])});
    const double bottom = std::min({glm::dot(normal, corners[0]), glm::dot(normal, corners[1]), glm::dot(normal, corners[2])});
    out.faces.assign({{normal, top, 0, 3}, {-normal, -bottom, 3, 3}});
    out.loop.assign({0, 1, 2, 0, 2, 1});
    out.loop_edge.assign({0, 1, 2, 2, 1, 0});
    out.edges.clear();
    for (std::uint32_t e = 0; e < 3; ++e) {
        const std::uint32_t to = (e + 1) % 3;
        const dvec3 d = corners[to] - corners[e];
        const dvec3 side = glm::cross(d, normal);
        const dvec3 outward = side / std::sqrt(glm::dot(side, side));
        out.edges.push_back({e, to, d, normal, outward, e});
        out.edges.push_back({e, to, d, outward, -normal, e});
    }
    measure(out);
    return true;
}

std::uint32_t face_along(const Polytope& p, const dvec3& direction) noexcept {
    std::uint32_t best = 0;
    double reach = glm::dot(p.faces[0].normal, direction);
    for (std::uint32_t f = 1; f < p.faces.size(); ++f) {
        const double r = glm::dot(p.faces[f].normal, direction);
        if (r > reach) {
            reach = r;
            best = f;
        }
    }
    return best;
}

}  // namespace carom::detail
