#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

struct FaceSeparation {
    double separation = -std::numeric_limits<double>::infinity();
    std::uint32_t face = 0;
    dvec3 deepest{0.0};  // the vertex of the other polytope farthest below the face; without such a face, any point of it
};

double height_over(const Polytope::Face& plane, const dvec3& p) noexcept { return glm::dot(plane.normal, p) - plane.offset; }

// Raises `best` to what plane `f` achieves against the vertices of the other polytope, if that is better.
// @return the vertex that lies lowest over the plane.
const dvec3& try_plane(std::span<const Polytope::Face> planes, std::uint32_t f, const Polytope& other, FaceSeparation& best) noexcept {
    const dvec3& n = planes[f].normal;
    const dvec3* lowest = &other.vertices[0];
    double least = glm::dot(n, *lowest);
    for (const dvec3& v : other.vertices) {
        const double h = glm::dot(n, v);
        if (h < least) {
            least = h;
            lowest = &v;
        }
    }
    if (least - planes[f].offset > best.separation) best = {least - planes[f].offset, f, *lowest};
    return *lowest;
}

// The plane among `planes` that separates best, if any does better than `floor`. Any point of `other` bounds each plane from above:
// `point` does, and the vertex that the plane before met. The most promising plane comes first.
FaceSeparation best_plane(std::span<const Polytope::Face> planes, const Polytope& other, const dvec3& point, double floor) noexcept {
    FaceSeparation best;
    best.separation = floor;
    best.deepest = point;
    std::uint32_t first = 0;
    double promise = -std::numeric_limits<double>::infinity();
    for (std::uint32_t f = 0; f < planes.size(); ++f) {
        const double bound = height_over(planes[f], point);
        if (bound > promise) {
            promise = bound;
            first = f;
        }
    }
    if (!(promise > floor)) return best;
    dvec3 last = try_plane(planes, first, other, best);
    for (std::uint32_t f = 0; f < planes.size(); ++f) {
        if (f == first || height_over(planes[f], last) <= best.separation || height_over(planes[f], point) <= best.separation) continue;
        last = try_plane(planes, f, other, best);
    }
    if (best.separation == floor) best.deepest = last;
    return best;
}

// The edges of `of` between whose faces a normal may separate better than `floor`. `points` lie in the other polytope; one of them
// that both faces of an edge have below `floor` rules the edge out.
void edges_that_may_win(const Polytope& of, const std::array<dvec3, 2>& points, double floor, std::vector<unsigned char>& above,
                        std::vector<Polytope::Edge>& out) {
    above.resize(of.planes.size());  // of each plane: bit i where point i is over `floor`
    for (std::size_t f = 0; f < of.planes.size(); ++f) {
        const bool a = height_over(of.planes[f], points[0]) > floor, b = height_over(of.planes[f], points[1]) > floor;
        above[f] = static_cast<unsigned char>((a ? 1 : 0) | (b ? 2 : 0));
    }
    out.clear();
    for (std::uint32_t k = 0; k < of.edge_count(); ++k) {
        if ((above[of.half_edges[2 * k].face] | above[of.half_edges[2 * k + 1].face]) == 3) out.push_back(of.edge(k));
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
    edges_that_may_win(a, {point_of_b, of_a.deepest}, floor, lists.above, lists.of_a);
    edges_that_may_win(b, {point_of_a, of_b.deepest}, floor, lists.above, lists.of_b);
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
