#include <carom/narrowphase/detail/gjk.hpp>
#include <carom/narrowphase/detail/polytope_axis.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/polytope_search.hpp>
#include <carom/narrowphase/detail/segment.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

Segment segment_of(const Polytope::Edge& e) noexcept { return {e.from, e.from + e.direction}; }

// An arc of a triangle meets one of `a` where its two halves join: the plane through the edge, square to the triangle.
ContactAxis axis_of_side(const Polytope& a, const Polytope& triangle, const FaceSeparation& side) noexcept {
    const std::uint32_t number = triangle.face_count() + side.plane;
    const Polytope::Edge e = triangle.edge(side.plane);  // edge k stands below side k
    const dvec3 vertex = a.vertex(side.deepest);
    const Segment on_b = segment_of(e);
    return {AxisKind::Edges, -triangle.normal(number), side.separation, vertex, on_b.at(closest_parameter(on_b, vertex)), side.deepest, e.name};
}

// Whether the points that the axis itself names are closest points of the two, which lie on its two support planes then: no other points
// can be closer.
bool is_distance(const Polytope& a, const Polytope& b, const ContactAxis& axis) noexcept {
    switch (axis.kind) {
        case AxisKind::FaceOfA: return is_over_face(a, axis.feature_a, b.vertex(lowest(b, axis.normal).number));
        case AxisKind::FaceOfB: return is_over_face(b, axis.feature_b, a.vertex(lowest(a, -axis.normal).number));
        case AxisKind::Edges: {
            const dvec3 between = axis.on_b - axis.on_a;
            return glm::dot(between, between) <= axis.separation * axis.separation * (1.0 + kInsideTolerance);
        }
        case AxisKind::Distance: break;
    }
    return false;
}

bool is_inside(const Polytope& triangle, const dvec3& p, double by) noexcept {
    for (std::uint32_t side = 0; side < 3; ++side) {
        if (!(glm::dot(normal_of({&triangle.sides, 1}, side), p) - offset_of({&triangle.sides, 1}, side) <= -by)) return false;
    }
    return true;
}

}  // namespace

bool face_decides(const Polytope& a, const Polytope& triangle, ContactAxis& axis) noexcept {
    const std::uint32_t face = glm::dot(triangle.normal(0), a.centre) >= triangle.offset(0) ? 0 : 1;
    const dvec3 normal = triangle.normal(face);
    const double offset = triangle.offset(face), height = glm::dot(normal, a.centre) - offset;
    const Extreme low = lowest(a, normal);
    const double separation = low.value - offset, depth = std::max(0.0, -separation);
    const double room = depth + kTouching * a.size;  // more than what rounding does
    if (!(height > room)) return false;
    const dvec3 foot = a.vertex(low.number) - separation * normal;
    if (!is_inside(triangle, foot, room)) return false;
    const dvec3 below_middle = a.centre - height * normal;
    if (depth > 0.0 && !is_inside(triangle, foot + (2.0 * depth / (height + depth)) * (below_middle - foot), room)) return false;
    axis = {AxisKind::FaceOfB, -normal, separation, {}, {}, 0, face};
    return true;
}

bool passes_by(const Polytope& a, const Corners& triangle, double margin) noexcept {
    const dvec3 way = closest_on_triangle(triangle, a.centre).point - a.centre;
    const double reach = -lowest(a, -way).value;
    const double least = std::min({glm::dot(way, triangle[0]), glm::dot(way, triangle[1]), glm::dot(way, triangle[2])});
    return least - reach > (margin + kPointTolerance * a.size) * std::sqrt(glm::dot(way, way));
}

bool passes_by(const Polytope& a, const ConvexHull& hull, const dmat3& axes, const dvec3& origin, double margin) noexcept {
    const dvec3 way = (axes * hull.centre() + origin) - a.centre;
    const dvec3 extent = hull.local_bounds().upper - hull.local_bounds().lower;
    const double gap = (lowest(hull.point_bundles(), way * axes).value + glm::dot(way, origin)) + lowest(a, -way).value;
    return gap > (margin + kPointTolerance * std::max({a.size, extent.x, extent.y, extent.z})) * std::sqrt(glm::dot(way, way));
}

ContactAxis greatest_separation(const Polytope& a, const Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double enough) {
    const Separations best = find_separations(a, b, point_of_a, point_of_b, enough);
    ContactAxis axis;
    if (best.of_b.separation > best.of_a.separation) {
        axis = {AxisKind::FaceOfB, -b.normal(best.of_b.plane), best.of_b.separation, {}, {}, 0, best.of_b.plane};
    } else {
        axis = {AxisKind::FaceOfA, a.normal(best.of_a.plane), best.of_a.separation, {}, {}, best.of_a.plane, 0};
    }
    if (axis.separation > enough) return axis;
    const EdgePair& edges = best.edges;
    const double by_face = axis.separation + kFacePreference * common_size(a, b), needed = std::max(by_face, edges.separation);
    if (b.side_count > 0 && best.side_promise > needed) {
        const FaceSeparation side = best_side(b, a, needed);
        if (side.separation > needed) return axis_of_side(a, b, side);
    }
    if (edges.separation > by_face) {
        const Polytope::Edge e = a.edge(edges.a), f = b.edge(edges.b);
        const Segment on_a = segment_of(e), on_b = segment_of(f);
        const SegmentParameters closest = closest_parameters(on_a, on_b);
        axis = {AxisKind::Edges, edges.normal, edges.separation, on_a.at(closest.s), on_b.at(closest.t), e.name, f.name};
    }
    return axis;
}

bool find_axis(Polytope& a, Polytope& b, const dvec3& point_of_a, const dvec3& point_of_b, double margin, ContactAxis& axis) {
    if (b.side_count > 0 && face_decides(a, b, axis)) return axis.separation <= margin;
    const double touching = kTouching * common_size(a, b);
    // What is farther by `touching`, which is more than rounding, is farther for certain.
    axis = greatest_separation(a, b, point_of_a, point_of_b, margin + touching);
    if (axis.separation > margin) return false;
    if (axis.separation <= touching || is_distance(a, b, axis)) return true;
    const GjkResult r = gjk(list_vertices(a), list_vertices(b), margin);
    if (r.beyond) return false;
    if (r.converged) {
        if (r.distance > margin) return false;
        if (r.distance > touching) axis = {AxisKind::Distance, (r.on_b - r.on_a) / r.distance, r.distance, r.on_a, r.on_b, 0, 0};
    }
    return true;
}

}  // namespace carom::detail
