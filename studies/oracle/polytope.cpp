#include <carom/studies/oracle/polytope.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace carom::oracle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void finish_faces(Polytope& p) {
    for (Polytope::Face& face : p.faces) {
        face.offset = -kInfinity;
        for (const dvec3& v : p.vertices) face.offset = std::max(face.offset, glm::dot(face.normal, v));
    }
}

Polytope box_polytope(const Box& box, const Pose& pose) {
    Polytope p;
    p.position = pose.position;
    const dvec3 half(box.half_extents);
    for (int i = 0; i < 8; ++i) {
        const dvec3 corner{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z};
        p.vertices.push_back(rotate(pose.orientation, corner));
    }
    // Corners as bits xyz; each loop counter-clockwise from outside. Faces in the order -x, +x, -y, +y, -z, +z.
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kLoops{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (std::uint32_t f = 0; f < 6; ++f) {
        dvec3 normal{0.0};
        normal[static_cast<int>(f / 2)] = f % 2 == 0 ? -1.0 : 1.0;
        p.faces.push_back({rotate(pose.orientation, normal), 0.0, 4 * f, 4});
        p.loops.insert(p.loops.end(), kLoops[f].begin(), kLoops[f].end());
    }
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::uint32_t u = (axis + 1) % 3;
        const std::uint32_t v = (axis + 2) % 3;
        for (std::uint32_t side = 0; side < 4; ++side) {
            const std::uint32_t u_side = side & 1u;
            const std::uint32_t v_side = side >> 1u;
            const std::uint32_t start = (u_side << u) | (v_side << v);
            p.edges.push_back({start, start | (1u << axis), 2 * u + u_side, 2 * v + v_side});
        }
    }
    finish_faces(p);
    return p;
}

Polytope hull_polytope(const ConvexHull& hull, const Pose& pose) {
    Polytope p;
    p.position = pose.position;
    for (const vec3& v : hull.vertices()) p.vertices.push_back(rotate(pose.orientation, dvec3(v)));
    for (const ConvexHull::Face& face : hull.faces()) {
        p.faces.push_back(
            {rotate(pose.orientation, face.normal), 0.0, static_cast<std::uint32_t>(p.loops.size()), face.edge_count});
        std::uint32_t edge = face.first_edge;
        for (std::uint32_t i = 0; i < face.edge_count; ++i) {
            p.loops.push_back(hull.edges()[edge].origin);
            edge = hull.edges()[edge].next;
        }
    }
    for (std::uint32_t e = 0; e < hull.edges().size(); e += 2) {
        const ConvexHull::HalfEdge& half = hull.edges()[e];
        const ConvexHull::HalfEdge& twin = hull.edges()[ConvexHull::twin(e)];
        p.edges.push_back({half.origin, twin.origin, half.face, twin.face});
    }
    finish_faces(p);
    return p;
}

double support(const Polytope& p, const dvec3& n) {
    double best = -kInfinity;
    for (const dvec3& v : p.vertices) best = std::max(best, glm::dot(n, v));
    return best;
}

/// @return the overlap of a and b + offset along the unit vector n, pushing b along n.
double overlap_along(const Polytope& a, const Polytope& b, const dvec3& offset, const dvec3& n) {
    return support(a, n) + support(b, -n) - glm::dot(n, offset);
}

/// An edge of B as the pruning test sees it, mirrored through the origin.
struct MirroredEdge {
    dvec3 left{0.0}, right{0.0};  ///< the negated normals of its faces
    dvec3 direction{0.0};
    dvec3 start{0.0};
};

std::vector<MirroredEdge> mirrored_edges(const Polytope& b) {
    std::vector<MirroredEdge> edges;
    edges.reserve(b.edges.size());
    for (const Polytope::Edge& e : b.edges) {
        edges.push_back(
            {-b.faces[e.left].normal, -b.faces[e.right].normal, b.vertices[e.b] - b.vertices[e.a], b.vertices[e.a]});
    }
    return edges;
}

/// Lowers `best` by the axes from crosses of edges; stops at an axis that parts the two.
double least_over_edges(const Polytope& a, const Polytope& b, const dvec3& offset, double best) {
    const std::vector<MirroredEdge> others = mirrored_edges(b);
    for (const Polytope::Edge& edge : a.edges) {
        const dvec3& left = a.faces[edge.left].normal;
        const dvec3& right = a.faces[edge.right].normal;
        const dvec3 direction = a.vertices[edge.b] - a.vertices[edge.a];
        for (const MirroredEdge& other : others) {
            // The two arcs of normals cross on the sphere iff each separates the ends of the other, on the same side.
            const double c = glm::dot(other.left, direction);
            const double d = glm::dot(other.right, direction);
            if (c * d >= 0.0) continue;
            const double l = glm::dot(left, other.direction);
            const double r = glm::dot(right, other.direction);
            if (l * r >= 0.0) continue;
            dvec3 axis = glm::cross(direction, other.direction);
            const double length_sq = glm::dot(axis, axis);
            if (length_sq == 0.0) continue;
            axis /= std::sqrt(length_sq);
            if (glm::dot(axis, left + right) < 0.0) axis = -axis;
            if (glm::dot(axis, other.left + other.right) < 0.0) continue;  // the arcs cross on opposite sides
            const double overlap = glm::dot(axis, a.vertices[edge.a] - other.start - offset);
            if (overlap < best) best = std::min(best, overlap_along(a, b, offset, axis));
            if (best <= 0.0) return 0.0;
        }
    }
    return best;
}

double point_segment_distance_sq(const dvec3& p, const dvec3& a, const dvec3& b) {
    const dvec3 ab = b - a;
    const double length_sq = glm::dot(ab, ab);
    const double t = length_sq > 0.0 ? std::clamp(glm::dot(p - a, ab) / length_sq, 0.0, 1.0) : 0.0;
    const dvec3 to = p - (a + t * ab);
    return glm::dot(to, to);
}

/// @return whether the segment p q meets the polytope; both in its coordinates.
bool segment_meets(const dvec3& p, const dvec3& q, const Polytope& polytope) {
    double enter = 0.0;
    double leave = 1.0;
    for (const Polytope::Face& face : polytope.faces) {
        const double at_p = glm::dot(face.normal, p) - face.offset;
        const double at_q = glm::dot(face.normal, q) - face.offset;
        if (at_p > 0.0 && at_q > 0.0) return false;
        if (at_p > 0.0) enter = std::max(enter, at_p / (at_p - at_q));
        if (at_q > 0.0) leave = std::min(leave, at_p / (at_p - at_q));
    }
    return enter <= leave;
}

/// @return the shortest translation that takes the segment p q out of the polytope that it meets.
double segment_escape(const dvec3& p, const dvec3& q, const Polytope& polytope) {
    double best = kInfinity;
    for (const Polytope::Face& face : polytope.faces) {
        best = std::min(best, face.offset - std::min(glm::dot(face.normal, p), glm::dot(face.normal, q)));
    }
    for (const Polytope::Edge& edge : polytope.edges) {
        const dvec3 axis = glm::cross(polytope.vertices[edge.b] - polytope.vertices[edge.a], q - p);
        const double length = glm::length(axis);
        if (length == 0.0) continue;
        for (const dvec3& n : {axis / length, axis / -length}) {
            best = std::min(best, support(polytope, n) - std::min(glm::dot(n, p), glm::dot(n, q)));
        }
    }
    return best;
}

bool projects_into(const Polytope& polytope, const Polytope::Face& face, const dvec3& point) {
    for (std::uint32_t i = 0; i < face.count; ++i) {
        const dvec3& u = polytope.vertices[polytope.loops[face.first + i]];
        const dvec3& v = polytope.vertices[polytope.loops[face.first + (i + 1) % face.count]];
        if (glm::dot(glm::cross(v - u, point - u), face.normal) < 0.0) return false;
    }
    return true;
}

/// @return the distance of the segment p q from the polytope that it does not meet.
double segment_gap(const dvec3& p, const dvec3& q, const Polytope& polytope) {
    double best = kInfinity;
    for (const Polytope::Face& face : polytope.faces) {
        for (const dvec3& end : {p, q}) {
            const double height = glm::dot(face.normal, end) - face.offset;
            if (height >= 0.0 && height < best && projects_into(polytope, face, end)) best = height;
        }
    }
    for (const Polytope::Edge& edge : polytope.edges) {
        best = std::min(best, segment_distance(polytope.vertices[edge.a], polytope.vertices[edge.b], p, q));
    }
    return best;
}

std::optional<Polytope> turned_polytope(float lower, float upper, float half_height, const Pose& pose) {
    std::vector<vec3> points;
    for (int k = 0; k < kTurnedSides; ++k) {
        const SinCos angle = sin_cos(2.0 * kPi * k / kTurnedSides);
        const vec3 outward(dvec3{angle.cos, 0.0, angle.sin});
        points.push_back(lower * outward - vec3{0.0f, half_height, 0.0f});
        points.push_back(upper * outward + vec3{0.0f, half_height, 0.0f});
    }
    const Result<ConvexHullPtr> hull = ConvexHull::build(points);
    return hull ? std::optional(hull_polytope(**hull, pose)) : std::nullopt;
}

}  // namespace

std::optional<Polytope> make_polytope(const Shape& shape, const Pose& pose) {
    if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape)) {
        return turned_polytope(cylinder->radius, cylinder->radius, cylinder->half_height, pose);
    }
    if (const Cone* cone = std::get_if<Cone>(&shape)) return turned_polytope(cone->radius, 0.0f, cone->half_height, pose);
    if (const Box* box = std::get_if<Box>(&shape)) return box_polytope(*box, pose);
    if (const ConvexHullPtr* hull = std::get_if<ConvexHullPtr>(&shape)) return hull_polytope(**hull, pose);
    return std::nullopt;
}

double overlap_depth(const Polytope& a, const Polytope& b) {
    const dvec3 offset = b.position - a.position;
    double best = kInfinity;
    for (const Polytope::Face& face : a.faces) {
        best = std::min(best, face.offset + support(b, -face.normal) - glm::dot(face.normal, offset));
        if (best <= 0.0) return 0.0;
    }
    for (const Polytope::Face& face : b.faces) {
        best = std::min(best, face.offset + support(a, -face.normal) + glm::dot(face.normal, offset));
        if (best <= 0.0) return 0.0;
    }
    return least_over_edges(a, b, offset, best);
}

double overlap_depth(const Box& a, const Pose& pose_a, const Box& b, const Pose& pose_b) {
    const dmat3 axes_a = glm::mat3_cast(pose_a.orientation);
    const dmat3 axes_b = glm::mat3_cast(pose_b.orientation);
    const dvec3 half_a(a.half_extents);
    const dvec3 half_b(b.half_extents);
    const dvec3 offset = pose_b.position - pose_a.position;
    const auto overlap = [&](const dvec3& n) {
        const dvec3 along_a = glm::abs(n * axes_a);  // n · each axis
        const dvec3 along_b = glm::abs(n * axes_b);
        return glm::dot(half_a, along_a) + glm::dot(half_b, along_b) - std::abs(glm::dot(n, offset));
    };
    double best = kInfinity;
    for (int i = 0; i < 3; ++i) {
        best = std::min({best, overlap(axes_a[i]), overlap(axes_b[i])});
        if (best <= 0.0) return 0.0;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const dvec3 axis = glm::cross(axes_a[i], axes_b[j]);
            const double length = glm::length(axis);
            if (length == 0.0) continue;
            best = std::min(best, overlap(axis / length));
            if (best <= 0.0) return 0.0;
        }
    }
    return best;
}

std::optional<Round> make_round(const Shape& shape, const Pose& pose) {
    if (const Sphere* sphere = std::get_if<Sphere>(&shape)) {
        return Round{pose.position, pose.position, static_cast<double>(sphere->radius)};
    }
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
        const dvec3 half = rotate(pose.orientation, dvec3{0.0, static_cast<double>(capsule->half_segment), 0.0});
        return Round{pose.position - half, pose.position + half, static_cast<double>(capsule->radius)};
    }
    return std::nullopt;
}

double overlap_depth(const Round& a, const Round& b) {
    return std::max(0.0, a.radius + b.radius - segment_distance(a.a, a.b, b.a, b.b));
}

double overlap_depth(const Round& a, const Polytope& b) {
    const dvec3 p = a.a - b.position;
    const dvec3 q = a.b - b.position;
    for (const Polytope::Face& face : b.faces) {
        if (std::min(glm::dot(face.normal, p), glm::dot(face.normal, q)) - face.offset >= a.radius) return 0.0;
    }
    if (segment_meets(p, q, b)) return a.radius + segment_escape(p, q, b);
    return std::max(0.0, a.radius - segment_gap(p, q, b));
}

double segment_distance(const dvec3& a0, const dvec3& a1, const dvec3& b0, const dvec3& b1) {
    // The minimum lies at an end of one of them, or inside both on the common perpendicular.
    double best = std::min({point_segment_distance_sq(a0, b0, b1), point_segment_distance_sq(a1, b0, b1),
                            point_segment_distance_sq(b0, a0, a1), point_segment_distance_sq(b1, a0, a1)});
    const dvec3 u = a1 - a0;
    const dvec3 v = b1 - b0;
    const dvec3 w = b0 - a0;
    const dvec3 n = glm::cross(u, v);
    const double n_sq = glm::dot(n, n);
    if (n_sq > 0.0) {
        const double s = glm::dot(glm::cross(w, v), n) / n_sq;
        const double t = glm::dot(glm::cross(w, u), n) / n_sq;
        if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) {
            const dvec3 to = w + t * v - s * u;
            best = std::min(best, glm::dot(to, to));
        }
    }
    return std::sqrt(best);
}

dvec3 closest_on_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 ab = b - a;
    const dvec3 ac = c - a;
    const dvec3 ap = p - a;
    const double d1 = glm::dot(ab, ap);
    const double d2 = glm::dot(ac, ap);
    if (d1 <= 0.0 && d2 <= 0.0) return a;
    const dvec3 bp = p - b;
    const double d3 = glm::dot(ab, bp);
    const double d4 = glm::dot(ac, bp);
    if (d3 >= 0.0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + ab * (d1 / (d1 - d3));
    const dvec3 cp = p - c;
    const double d5 = glm::dot(ab, cp);
    const double d6 = glm::dot(ac, cp);
    if (d6 >= 0.0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + ac * (d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double scale = 1.0 / (va + vb + vc);
    return a + ab * (vb * scale) + ac * (vc * scale);
}

}  // namespace carom::oracle
