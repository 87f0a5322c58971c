#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

struct FaceSeparation {
    double separation = -std::numeric_limits<double>::infinity();
    std::uint32_t face = 0;
};

FaceSeparation best_face(const Polytope& of, const Polytope& other) noexcept {
    FaceSeparation best;
    for (std::uint32_t f = 0; f < of.faces.size(); ++f) {
        const Polytope::Face& face = of.faces[f];
        double least = std::numeric_limits<double>::infinity();
        for (const dvec3& v : other.vertices) least = std::min(least, glm::dot(face.normal, v));
        if (least - face.offset > best.separation) best = {least - face.offset, f};
    }
    return best;
}

// Edges of `of` whose bounds come within `reach` of those of `other`, and that come up to `height` along `up`.
void edges_near(const Polytope& of, const Polytope& other, double reach, const dvec3& up, double height,
                std::vector<std::uint32_t>& out) {
    const dvec3 lower = other.lower - dvec3{reach}, upper = other.upper + dvec3{reach};
    out.clear();
    for (std::uint32_t e = 0; e < of.edges.size(); ++e) {
        const dvec3 &p = of.vertices[of.edges[e].from], &q = of.vertices[of.edges[e].to];
        if (glm::dot(p, up) < height && glm::dot(q, up) < height) continue;
        const dvec3 low = glm::min(p, q), high = glm::max(p, q);
        if (low.x <= upper.x && low.y <= upper.y && low.z <= upper.z && high.x >= lower.x && high.y >= lower.y && high.z >= lower.z) {
            out.push_back(e);
        }
    }
}

// Whether the arc of edge `e` crosses the arc of edge `f`, seen from the other side, on the sphere of normals: only then do the two
// edges make a face of the Minkowski difference (Gregorius 2013).
bool arcs_cross(const Polytope::Edge& e, const Polytope::Edge& f) noexcept {
    const double cba = -glm::dot(f.left, e.direction), dba = -glm::dot(f.right, e.direction);
    if (!(cba * dba < 0.0)) return false;
    const double adc = glm::dot(e.left, f.direction), bdc = glm::dot(e.right, f.direction);
    return adc * bdc < 0.0 && cba * bdc > 0.0;
}

double axis_support(const Polytope& p, const dvec3& direction) noexcept {
    double reach = glm::dot(p.vertices[0], direction);
    for (const dvec3& v : p.vertices) reach = std::max(reach, glm::dot(v, direction));
    return reach;
}

struct EdgePair {
    double separation = -std::numeric_limits<double>::infinity();
    dvec3 normal{0.0};
    std::uint32_t a = 0, b = 0;
};

EdgePair best_edges(const Polytope& a, const Polytope& b, const EdgeLists& lists) noexcept {
    EdgePair best;
    for (const std::uint32_t j : lists.of_b) {
        const Polytope::Edge& f = b.edges[j];
        const double ff = glm::dot(f.direction, f.direction);
        for (const std::uint32_t i : lists.of_a) {
            const Polytope::Edge& e = a.edges[i];
            if (!arcs_cross(e, f)) continue;
            const dvec3 cross = glm::cross(e.direction, f.direction);
            const double length_sq = glm::dot(cross, cross);
            if (!(length_sq > kParallelSine * kParallelSine * glm::dot(e.direction, e.direction) * ff)) continue;
            const double turn = glm::dot(cross, e.left + e.right) < 0.0 ? -1.0 : 1.0;
            const dvec3 normal = cross * (turn / std::sqrt(length_sq));
            const double s = glm::dot(normal, b.vertices[f.from] - a.vertices[e.from]);
            if (s > best.separation) best = {s, normal, i, j};
        }
    }
    return best;
}

}  // namespace

ContactAxis least_depth_axis(const Polytope& a, const Polytope& b, double reach, EdgeLists& lists) {
    const FaceSeparation of_a = best_face(a, b), of_b = best_face(b, a);
    ContactAxis axis;
    if (of_b.separation > of_a.separation) {
        axis = {AxisKind::FaceOfB, -b.faces[of_b.face].normal, of_b.separation, {}, {}, 0, of_b.face};
    } else {
        axis = {AxisKind::FaceOfA, a.faces[of_a.face].normal, of_a.separation, {}, {}, of_a.face, 0};
    }
    const double near = std::max(reach, -axis.separation) * (1.0 + 1e-9);
    // Along the face's normal the shapes share a slab as thick as the depth; edges that touch come within reach of it.
    const bool of_face_a = axis.kind == AxisKind::FaceOfA;
    const double top_a = of_face_a ? a.faces[axis.feature_a].offset : axis_support(a, axis.normal);
    const double top_b = of_face_a ? axis_support(b, -axis.normal) : b.faces[axis.feature_b].offset;
    edges_near(a, b, near, axis.normal, -top_b - near, lists.of_a);
    edges_near(b, a, near, -axis.normal, -top_a - near, lists.of_b);
    const EdgePair edges = best_edges(a, b, lists);
    if (edges.separation > axis.separation + kFacePreference * std::max(a.size, b.size)) {
        const Polytope::Edge &e = a.edges[edges.a], &f = b.edges[edges.b];
        const Segment on_a{a.vertices[e.from], a.vertices[e.to]}, on_b{b.vertices[f.from], b.vertices[f.to]};
        const SegmentParameters closest = closest_parameters(on_a, on_b);
        axis = {AxisKind::Edges, edges.normal, edges.separation, on_a.at(closest.s), on_b.at(closest.t), e.name, f.name};
    }
    return axis;
}

bool find_axis(const Polytope& a, const Polytope& b, const GjkResult& r, double margin, EdgeLists& lists, ContactAxis& axis) {
    const double size = std::max(a.size, b.size);
    if (r.converged) {
        if (r.distance > margin) return false;
        if (r.distance > kTouching * size) {
            axis = {AxisKind::Distance, (r.on_b - r.on_a) / r.distance, r.distance, r.on_a, r.on_b, 0, 0};
            return true;
        }
    }
    // Without an answer from GJK every axis within its upper bound counts.
    axis = least_depth_axis(a, b, r.converged ? kTouching * size : r.distance, lists);
    return axis.separation <= margin;
}

}  // namespace carom::detail
