#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/polytope_lanes.hpp>
#include <carom/narrowphase/detail/segment_polytope.hpp>
#include <carom/narrowphase/detail/tolerances.hpp>

#include <algorithm>
#include <limits>

namespace carom::detail {
namespace {

// The face that separates the segment best, with the segment's end over it.
ContactAxis face_axis(const Segment& s, const Polytope& p) noexcept {
    const Extreme face = highest_face(p, s.from, s.to);
    const dvec3 normal = p.normal(face.number);
    const dvec3& end = glm::dot(normal, s.from) <= glm::dot(normal, s.to) ? s.from : s.to;
    return {AxisKind::FaceOfB, -normal, face.value, end, end - face.value * normal, 0, face.number};
}

// Planes square to a triangle, through a side or along the segment, where they do better than the face. With a segment square to the
// triangle, or in its plane, they are all that its edges have to offer: they are at the ends of the edges' arcs then.
void try_sides(const Segment& s, const Polytope& triangle, ContactAxis& axis) {
    const dvec3 d = s.to - s.from, across = glm::cross(d, triangle.normal(0));
    const double needed = axis.separation + kFacePreference * common_size(triangle.size, std::sqrt(glm::dot(d, d)));
    for (std::uint32_t k = 0; k < triangle.side_count; ++k) {
        const dvec3 outward = triangle.normal(triangle.face_count() + k);
        const double offset = offset_of({&triangle.sides, 1}, k), from = glm::dot(outward, s.from) - offset, to = glm::dot(outward, s.to) - offset;
        const double separation = std::min(from, to);
        if (!(separation > axis.separation && separation > needed)) continue;
        const Polytope::Edge e = triangle.edge(k);  // which stands below side k
        const Segment edge{e.from, e.from + e.direction};
        const dvec3& end = from <= to ? s.from : s.to;
        axis = {AxisKind::Edges, -outward, separation, end, edge.at(closest_parameter(edge, end)), 0, e.name};
    }
    const double length = std::sqrt(glm::dot(across, across));
    if (!(length > kParallelSine * std::sqrt(glm::dot(d, d)))) return;
    for (const dvec3& inward : {across / length, across / -length}) {
        const Extreme nearest = lowest(triangle, inward);
        const double separation = nearest.value - std::max(glm::dot(inward, s.from), glm::dot(inward, s.to));
        if (!(separation > axis.separation && separation > needed)) continue;
        const dvec3 corner = triangle.vertex(nearest.number);
        axis = {AxisKind::Edges, inward, separation, s.at(closest_parameter(s, corner)), corner, 0, triangle.edge(nearest.number).name};
    }
}

// An edge that the segment crosses, where it does better than the face: the plane square to the segment passes between the normals of the
// edge's two faces.
void try_edges(const Segment& s, const Polytope& p, std::vector<std::uint32_t>& edges, ContactAxis& axis) {
    const dvec3 d = s.to - s.from;
    const double needed = axis.separation + kFacePreference * common_size(p.size, std::sqrt(glm::dot(d, d)));
    const dvec3 ends[2] = {s.from, s.to};
    list_edges_above_both(p, ends, std::min(0.0, axis.separation), edges);
    for (const std::uint32_t k : edges) {
        const Polytope::Edge e = p.edge(k);
        if (!(glm::dot(e.left, d) * glm::dot(e.right, d) < 0.0)) continue;
        const dvec3 cross = glm::cross(d, e.direction);
        const double length_sq = glm::dot(cross, cross);
        if (!(length_sq > kParallelSine * kParallelSine * glm::dot(d, d) * glm::dot(e.direction, e.direction))) continue;
        const dvec3 outward = cross * ((glm::dot(cross, e.left + e.right) < 0.0 ? -1.0 : 1.0) / std::sqrt(length_sq));
        const double separation = glm::dot(outward, s.from - e.from);
        if (separation > axis.separation && separation > needed) {
            const Segment edge{e.from, e.from + e.direction};
            const SegmentParameters closest = closest_parameters(s, edge);
            axis = {AxisKind::Edges, -outward, separation, s.at(closest.s), edge.at(closest.t), 0, e.name};
        }
    }
}

// The two points that are closest so far.
struct ClosestPoints {
    dvec3 on_a{0.0}, on_b{0.0};
    double distance_sq = std::numeric_limits<double>::infinity();

    void offer(const dvec3& a, const dvec3& b) noexcept {
        const double sq = glm::dot(b - a, b - a);
        if (!(sq < distance_sq)) return;
        *this = {a, b, sq};
    }
    void offer_edge(const Segment& s, const Polytope& p, std::uint32_t edge) noexcept {
        const Segment other{p.origin_of(2 * edge), p.origin_of(2 * edge + 1)};
        const SegmentParameters closest = closest_parameters(s, other);
        offer(s.at(closest.s), other.at(closest.t));
    }
    [[nodiscard]] ContactAxis axis() const noexcept {
        const double distance = std::sqrt(distance_sq);
        return {AxisKind::Distance, (on_b - on_a) / distance, distance, on_a, on_b, 0, 0};
    }
};

// The closest points where the polytope's lies on an edge of the face, as it mostly does beside the face that separates best.
// @return whether the planes through the two points, square to the line between them, show that there are no closer ones.
bool is_beside_face(const Segment& s, const Polytope& p, std::uint32_t face, ContactAxis& axis) noexcept {
    ClosestPoints closest;
    std::uint32_t e = p.loops[face].first_edge;
    for (std::uint32_t k = 0; k < p.loops[face].edge_count; ++k, e = p.half_edges[e].next) closest.offer_edge(s, p, e / 2);
    axis = closest.axis();
    const double of_segment = std::max(glm::dot(axis.normal, s.from), glm::dot(axis.normal, s.to));
    return lowest(p, axis.normal).value - of_segment >= axis.separation * (1.0 - kInsideTolerance);
}

// The closest points of a polytope and a segment apart from it. The polytope's is in a face that an end is over, or on an edge next to
// a plane that is below an end: a normal between those of the edge's planes separates from the segment. The face need not be the one that
// separates best: the planes of faces that were merged lie a little outside of them.
ContactAxis distance_axis(const Segment& s, const Polytope& p, std::vector<std::uint32_t>& edges) {
    const dvec3 ends[2] = {s.from, s.to};
    list_edges_above_one(p, ends, 0.0, edges);
    ClosestPoints closest;
    for (const std::uint32_t k : edges) closest.offer_edge(s, p, k);
    for (std::uint32_t face = 0; face < p.face_count(); ++face) {
        const dvec3 normal = p.normal(face);
        for (const dvec3& end : ends) {
            const double height = glm::dot(normal, end) - p.offset(face);
            if (height > 0.0 && height * height < closest.distance_sq && is_over_face(p, face, end)) closest.offer(end, end - height * normal);
        }
    }
    return closest.axis();
}

struct ClippedSegment {
    double low = 0.0, high = 1.0;
    std::uint32_t low_edge = 0, high_edge = 0;
};

// The part of the segment over the face, seen along `normal`, which points to the polytope.
ClippedSegment clip_to_face(const RoundSegment& core, const Polytope& p, const ConvexHull::Face& face, const dvec3& normal,
                            double tolerance) noexcept {
    const Segment& s = core.segment;
    ClippedSegment clip;
    std::uint32_t e = face.first_edge;
    for (std::uint32_t k = 0; k < face.edge_count; ++k) {
        const std::uint32_t name = p.edge_name(e / 2);
        const dvec3 v = p.origin_of(e);
        e = p.half_edges[e].next;
        const dvec3 edge = p.origin_of(e) - v;
        const dvec3 side = glm::cross(normal, edge);
        const double allowed = tolerance * std::sqrt(glm::dot(side, side));
        const double from = glm::dot(side, s.from - v), to = glm::dot(side, s.to - v);
        if (from <= allowed && to <= allowed) continue;
        if (from > allowed && to > allowed) return {1.0, 0.0, 0, 0};
        const double t = from / (from - to);
        if (from > to && t > clip.low) {
            clip.low = t;
            clip.low_edge = name;
        } else if (to > from && t < clip.high) {
            clip.high = t;
            clip.high_edge = name;
        }
    }
    return clip;
}

std::uint64_t segment_name(double t, std::uint32_t edge) noexcept {
    if (t < kSnap) return feature_name(FeatureKind::VertexOfFirst, 0, 0);
    if (t > 1.0 - kSnap) return feature_name(FeatureKind::VertexOfFirst, 1, 0);
    return feature_name(FeatureKind::Edges, 0, edge);
}

}  // namespace

bool find_axis(const RoundSegment& core, const Polytope& polytope, double margin, PolygonScratch& scratch, ContactAxis& axis) {
    const Segment& s = core.segment;
    const double touching = kTouching * polytope.size, farthest = core.radius + margin;
    axis = face_axis(s, polytope);
    const std::uint32_t face = axis.feature_b;
    if (polytope.side_count > 0) try_sides(s, polytope, axis);
    if (axis.separation > farthest + touching) return false;
    if (!(axis.separation > touching) && s.from != s.to) try_edges(s, polytope, scratch.edges, axis);
    if (axis.separation > touching && (axis.kind != AxisKind::FaceOfB || !is_over_face(polytope, face, axis.on_a))) {
        ContactAxis distance;
        if (!is_beside_face(s, polytope, face, distance)) distance = distance_axis(s, polytope, scratch.edges);
        if (distance.separation > axis.separation) axis = distance;
    }
    return axis.separation <= farthest;
}

void build_patch(const RoundSegment& core, const Polytope& polytope, const ContactAxis& axis, double margin, AxisPoint axis_point,
                 PolygonScratch& scratch, Patch& patch) {
    const Segment& s = core.segment;
    const dvec3 d = s.to - s.from;
    const double length = std::sqrt(glm::dot(d, d));
    const double size = std::max({polytope.size, length, core.radius});
    const dvec3 axis_u = any_perpendicular(axis.normal), axis_w = glm::cross(axis.normal, axis_u);
    std::vector<Candidate>& points = scratch.candidates;
    points.clear();
    const auto add = [&](const dvec3& p, double distance, std::uint64_t name) {
        if (!(distance - core.radius <= margin)) return;
        const dvec3 position = p + (0.5 * (core.radius + distance)) * axis.normal;
        points.push_back({position, distance - core.radius, glm::dot(p, axis_u), glm::dot(p, axis_w), name});
    };

    const std::uint32_t face = axis.kind == AxisKind::FaceOfB ? axis.feature_b : face_along(polytope, -axis.normal).number;
    const dvec3 normal = polytope.normal(face);
    const double slope = glm::dot(normal, axis.normal);
    if (-slope > kLeastSlope && length > 0.0) {
        // What counts as touching may be beside a face by as much.
        const double beside = axis.kind == AxisKind::Distance ? 0.0 : kTouching * polytope.size;
        const ClippedSegment clip = clip_to_face(core, polytope, polytope.loops[face], axis.normal, kInsideTolerance * size + beside);
        if (clip.low <= clip.high) {
            const auto to_face = [&](const dvec3& p) { return (polytope.offset(face) - glm::dot(normal, p)) / slope; };
            add(s.at(clip.low), to_face(s.at(clip.low)), segment_name(clip.low, clip.low_edge));
            add(s.at(clip.high), to_face(s.at(clip.high)), segment_name(clip.high, clip.high_edge));
        }
    }
    const auto near_axis_point = [&](const Candidate& c) {
        if (!(c.separation <= axis.separation - core.radius + kPointTolerance * size)) return false;
        const double du = c.u - glm::dot(axis.on_a, axis_u), dw = c.w - glm::dot(axis.on_a, axis_w);
        return du * du + dw * dw <= kPointTolerance * kPointTolerance * size * size;
    };
    if (axis_point == AxisPoint::Keep && std::none_of(points.begin(), points.end(), near_axis_point)) {
        const double t = closest_parameter(s, axis.on_a);
        add(axis.on_a, axis.separation, segment_name(t, axis.feature_b));
    }
    Chosen chosen{};
    const int count = reduce_points(points, kPointTolerance * size, outline_start(axis.normal, axis_u, axis_w), 0.0, chosen);
    patch.normal = axis.normal;
    patch.count = 0;
    for (int i = 0; i < count; ++i) {
        const Candidate& c = points[static_cast<std::size_t>(chosen[static_cast<std::size_t>(i)])];
        patch.add(c.position, c.separation, c.feature);
    }
}

}  // namespace carom::detail
