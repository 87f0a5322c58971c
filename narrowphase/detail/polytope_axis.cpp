#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

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

// The plane among `planes` that separates best, if any does better than `floor`. `point` lies in `other`, and bounds each from above.
FaceSeparation best_plane(std::span<const Polytope::Face> planes, const Polytope& other, const dvec3& point, double floor) noexcept {
    FaceSeparation best;
    best.separation = floor;
    for (std::uint32_t f = 0; f < planes.size(); ++f) {
        const Polytope::Face& face = planes[f];
        if (glm::dot(face.normal, point) - face.offset <= best.separation) continue;
        double least = std::numeric_limits<double>::infinity();
        for (const dvec3& v : other.vertices) least = std::min(least, glm::dot(face.normal, v));
        if (least - face.offset > best.separation) best = {least - face.offset, f};
    }
    return best;
}

// The edges of `of` between whose faces a normal may separate better than `floor`; `point` lies in the other polytope.
void edges_that_may_win(const Polytope& of, const dvec3& point, double floor, std::vector<Polytope::Edge>& out) {
    out.clear();
    const auto may_win = [&](std::uint32_t plane) { return glm::dot(of.planes[plane].normal, point) - of.planes[plane].offset > floor; };
    for (std::uint32_t k = 0; k < of.edge_count(); ++k) {
        if (may_win(of.half_edges[2 * k].face) || may_win(of.half_edges[2 * k + 1].face)) out.push_back(of.edge(k));
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

struct EdgePair {
    double separation = -std::numeric_limits<double>::infinity();
    dvec3 normal{0.0};
    const Polytope::Edge* a = nullptr;
    const Polytope::Edge* b = nullptr;
};

EdgePair best_edges(const EdgeLists& lists) noexcept {
    EdgePair best;
    for (const Polytope::Edge& f : lists.of_b) {
        for (const Polytope::Edge& e : lists.of_a) {
            if (!arcs_cross(e, f)) continue;
            const dvec3 cross = glm::cross(e.direction, f.direction);
            const double length_sq = glm::dot(cross, cross);
            const double sides = glm::dot(e.direction, e.direction) * glm::dot(f.direction, f.direction);
            if (!(length_sq > kParallelSine * kParallelSine * sides)) continue;
            const double turn = glm::dot(cross, e.left + e.right) < 0.0 ? -1.0 : 1.0;
            const dvec3 normal = cross * (turn / std::sqrt(length_sq));
            const double s = glm::dot(normal, f.from - e.from);
            if (s > best.separation) best = {s, normal, &e, &f};
        }
    }
    return best;
}

}  // namespace

ContactAxis greatest_separation(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b,
                                EdgeLists& lists) {
    const FaceSeparation of_a = best_plane(a.faces(), b, point_of_b, -std::numeric_limits<double>::infinity());
    const FaceSeparation of_b = best_plane(b.faces(), a, point_of_a, of_a.separation);
    ContactAxis axis;
    if (of_b.separation > of_a.separation) {
        axis = {AxisKind::FaceOfB, -b.planes[of_b.face].normal, of_b.separation, {}, {}, 0, of_b.face};
    } else {
        axis = {AxisKind::FaceOfA, a.planes[of_a.face].normal, of_a.separation, {}, {}, of_a.face, 0};
    }
    // Below zero the bound holds for every normal of an arc; above, the arc of a sharp edge may do better than both its ends.
    const double floor = std::min(0.0, axis.separation);
    edges_that_may_win(a, point_of_b, floor, lists.of_a);
    edges_that_may_win(b, point_of_a, floor, lists.of_b);
    const EdgePair edges = best_edges(lists);
    const double needed = axis.separation + kFacePreference * std::max(a.size, b.size);
    const FaceSeparation side = best_plane(b.sides(), a, point_of_a, std::max(needed, edges.separation));
    if (side.separation > std::max(needed, edges.separation)) {
        // An arc of b meets one of a where its two halves join: the plane through the edge, square to the triangle.
        const Polytope::Edge e = b.edge(b.sides()[side.face].first_edge / 2);
        const dvec3 normal = -b.sides()[side.face].normal;
        const std::uint32_t vertex = vertex_along(a, normal);
        const Segment on_b{e.from, e.from + e.direction};
        const dvec3 touch = on_b.at(closest_parameter(on_b, a.vertices[vertex]));
        axis = {AxisKind::Edges, normal, side.separation, a.vertices[vertex], touch, vertex, e.name};
    } else if (edges.separation > needed) {
        const Segment on_a{edges.a->from, edges.a->from + edges.a->direction}, on_b{edges.b->from, edges.b->from + edges.b->direction};
        const SegmentParameters closest = closest_parameters(on_a, on_b);
        axis = {AxisKind::Edges, edges.normal, edges.separation, on_a.at(closest.s), on_b.at(closest.t), edges.a->name, edges.b->name};
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
    axis = greatest_separation(a, b, a.centre, b.centre, lists);
    return axis.separation <= margin;
}

}  // namespace carom::detail
