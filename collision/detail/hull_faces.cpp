#include <carom/collision/detail/hull_faces.hpp>
#include <carom/collision/detail/orientation.hpp>
#include <carom/core/check.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace carom::detail {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

dvec3 normal_of(std::span<const dvec3> points, const HullTriangle& t) {
    const dvec3 a = points[t.vertex[0]];
    return glm::cross(points[t.vertex[1]] - a, points[t.vertex[2]] - a);
}

/// The plane that a face grows in.
class SeedPlane {
public:
    SeedPlane(std::span<const dvec3> points, const HullTriangle& seed, double tolerance)
        : points_(points), seed_(seed), tolerance_(tolerance), normal_(normal_of(points, seed)) {
        reach_ = tolerance * glm::length(normal_);
    }

    bool holds(const HullTriangle& triangle) const {
        if (tolerance_ > 0.0 && !(glm::dot(normal_, normal_of(points_, triangle)) > 0.0)) return false;
        return std::all_of(triangle.vertex.begin(), triangle.vertex.end(), [&](std::uint32_t v) { return holds(v); });
    }

private:
    bool holds(std::uint32_t vertex) const {
        const dvec3 a = points_[seed_.vertex[0]];
        if (tolerance_ > 0.0) return std::abs(glm::dot(normal_, points_[vertex] - a)) <= reach_;
        return orientation(a, points_[seed_.vertex[1]], points_[seed_.vertex[2]], points_[vertex]) == 0;
    }

    std::span<const dvec3> points_;
    const HullTriangle& seed_;
    double tolerance_;
    dvec3 normal_;
    double reach_ = 0.0;
};

/// Finds vertices far along a direction by climbing from neighbour to neighbour; on a convex surface the last one is the farthest.
class Climber {
public:
    Climber(std::span<const dvec3> points, std::span<const HullTriangle> triangles)
        : points_(points), triangles_(triangles), triangle_at_(points.size(), kNone) {
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            for (const std::uint32_t v : triangles[t].vertex) triangle_at_[v] = t;
        }
    }

    [[nodiscard]] double farthest(const dvec3& direction, std::uint32_t start) const {
        double best = glm::dot(direction, points_[start]);
        for (std::uint32_t at = start;;) {
            const std::uint32_t center = at;
            const std::uint32_t first = triangle_at_[center];
            std::uint32_t t = first;
            do {
                const std::uint32_t i = edge_from(triangles_[t], center);
                const std::uint32_t v = triangles_[t].vertex[(i + 1) % 3];
                if (const double along = glm::dot(direction, points_[v]); along > best) best = along, at = v;
                t = triangles_[t].neighbor[(i + 2) % 3];
            } while (t != first);
            if (at == center) return best;
        }
    }

private:
    std::span<const dvec3> points_;
    std::span<const HullTriangle> triangles_;
    std::vector<std::uint32_t> triangle_at_;
};

/// The supporting plane of a polygon: Newell's normal, and the offset of the farthest of all points.
void set_plane(ConvexHull::Face& face, std::span<const dvec3> points, const Climber& climber,
               std::span<const std::uint32_t> polygon) {
    const dvec3 origin = points[polygon[0]];
    dvec3 normal{0.0};
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        normal += glm::cross(points[polygon[i - 1]] - origin, points[polygon[i]] - origin);
    }
    // Divided by the largest component first, so that no length over- or underflows.
    const dvec3 size = glm::abs(normal);
    normal /= std::max({size.x, size.y, size.z});
    face.normal = normal / glm::length(normal);
    face.offset = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t v : polygon) face.offset = std::max(face.offset, climber.farthest(face.normal, v));
}

std::vector<std::uint32_t> polygon_of(const HullFaces& hull, const ConvexHull::Face& face) {
    std::vector<std::uint32_t> polygon;
    std::uint32_t edge = face.first_edge;
    do {
        polygon.push_back(hull.edges[edge].origin);
        edge = hull.edges[edge].next;
    } while (edge != face.first_edge);
    return polygon;
}

/// Numbers the half edges between faces, twins together: (triangles, 3), kNone inside a face.
std::vector<std::array<std::uint32_t, 3>> number_edges(std::span<const HullTriangle> triangles, const FaceLabels& labels,
                                                       std::uint32_t& count) {
    std::vector<std::array<std::uint32_t, 3>> numbers(triangles.size(), {kNone, kNone, kNone});
    count = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const std::uint32_t other = triangles[t].neighbor[i];
            if (other < t || labels.face[t] == labels.face[other]) continue;
            numbers[t][i] = count++;
            numbers[other][edge_from(triangles[other], triangles[t].vertex[(i + 1) % 3])] = count++;
        }
    }
    return numbers;
}

double distance_sq_to_segment(const dvec3& p, const dvec3& a, const dvec3& b) {
    const dvec3 along = b - a;
    const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
    const dvec3 gap = p - (a + t * along);
    return glm::dot(gap, gap);
}

double distance_sq_to_face(const dvec3& p, std::span<const dvec3> points, const HullFaces& hull,
                           const ConvexHull::Face& face) {
    bool above = true;
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t edge = face.first_edge;
    do {
        const dvec3 a = points[hull.edges[edge].origin];
        edge = hull.edges[edge].next;
        const dvec3 b = points[hull.edges[edge].origin];
        if (glm::dot(glm::cross(face.normal, b - a), p - a) < 0.0) above = false;
        nearest = std::min(nearest, distance_sq_to_segment(p, a, b));
    } while (edge != face.first_edge);
    const double height = glm::dot(face.normal, p) - face.offset;
    return above ? height * height : nearest;
}

}  // namespace

FaceLabels merge_coplanar(std::span<const dvec3> points, std::span<const HullTriangle> triangles, double tolerance) {
    std::vector<double> size(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) size[t] = glm::length(normal_of(points, triangles[t]));
    std::vector<std::uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return size[a] > size[b]; });

    FaceLabels labels{std::vector<std::uint32_t>(triangles.size(), kNone), 0};
    std::vector<std::uint32_t> front;
    for (const std::uint32_t seed : order) {
        if (labels.face[seed] != kNone) continue;
        const SeedPlane plane(points, triangles[seed], tolerance);
        labels.face[seed] = labels.count;
        front.assign(1, seed);
        while (!front.empty()) {
            const std::uint32_t t = front.back();
            front.pop_back();
            for (const std::uint32_t other : triangles[t].neighbor) {
                if (labels.face[other] != kNone || !plane.holds(triangles[other])) continue;
                labels.face[other] = labels.count;
                front.push_back(other);
            }
        }
        ++labels.count;
    }
    return labels;
}

std::vector<std::uint32_t> corners(std::span<const HullTriangle> triangles, const FaceLabels& labels) {
    std::uint32_t end = 0;
    for (const HullTriangle& t : triangles) end = std::max({end, t.vertex[0] + 1, t.vertex[1] + 1, t.vertex[2] + 1});
    std::vector<std::uint32_t> borders(end, 0);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (labels.face[t] != labels.face[triangles[t].neighbor[i]]) ++borders[triangles[t].vertex[i]];
        }
    }
    std::vector<std::uint32_t> result;
    for (std::uint32_t v = 0; v < end; ++v) {
        if (borders[v] >= 3) result.push_back(v);
    }
    return result;
}

HullFaces link_faces(std::span<const dvec3> points, std::span<const HullTriangle> triangles, const FaceLabels& labels) {
    HullFaces hull;
    std::uint32_t edge_count = 0;
    const auto numbers = number_edges(triangles, labels, edge_count);
    hull.edges.resize(edge_count);
    hull.faces.resize(labels.count);
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (numbers[t][i] == kNone) continue;
            // The next border edge of this face: turn about the end vertex, over the triangles of the face.
            const std::uint32_t end = triangles[t].vertex[(i + 1) % 3];
            std::uint32_t turned = t;
            std::uint32_t edge = (i + 1) % 3;
            while (numbers[turned][edge] == kNone) {
                turned = triangles[turned].neighbor[edge];
                edge = edge_from(triangles[turned], end);
            }
            hull.edges[numbers[t][i]] = {triangles[t].vertex[i], numbers[turned][edge], labels.face[t]};
            ConvexHull::Face& face = hull.faces[labels.face[t]];
            if (face.edge_count++ == 0) face.first_edge = numbers[t][i];
        }
    }
    const Climber climber(points, triangles);
    for (ConvexHull::Face& face : hull.faces) {
        const std::vector<std::uint32_t> polygon = polygon_of(hull, face);
        set_plane(face, points, climber, polygon);
    }
    return hull;
}

bool is_convex_polyhedron(std::span<const dvec3> points, const HullFaces& hull, double tolerance) {
    if (points.size() + hull.faces.size() != hull.edges.size() / 2 + 2) return false;
    for (const ConvexHull::Face& face : hull.faces) {
        const std::vector<std::uint32_t> polygon = polygon_of(hull, face);
        const std::size_t n = polygon.size();
        if (n < 3 || n != face.edge_count) return false;
        for (std::size_t i = 0; i < n; ++i) {
            const dvec3 a = points[polygon[i]];
            const dvec3 b = points[polygon[(i + 1) % n]];
            const dvec3 c = points[polygon[(i + 2) % n]];
            if (!(glm::dot(glm::cross(b - a, c - b), face.normal) > 0.0)) return false;
            if (!(face.offset - glm::dot(face.normal, a) <= tolerance)) return false;
        }
    }
    for (std::uint32_t e = 0; e < hull.edges.size(); e += 2) {
        const ConvexHull::HalfEdge& edge = hull.edges[e];
        const ConvexHull::HalfEdge& twin = hull.edges[e + 1];
        const dvec3 along = points[twin.origin] - points[edge.origin];
        const dvec3 turn = glm::cross(hull.faces[edge.face].normal, hull.faces[twin.face].normal);
        if (!(glm::dot(turn, along) > 0.0)) return false;
    }
    return true;
}

bool is_near_hull(std::span<const dvec3> others, std::span<const dvec3> points, const HullFaces& hull, double tolerance) {
    return std::all_of(others.begin(), others.end(), [&](const dvec3& p) {
        bool inside = true;
        for (const ConvexHull::Face& face : hull.faces) {
            const double height = glm::dot(face.normal, p) - face.offset;
            if (height > tolerance) return false;
            if (height <= 0.0) continue;
            inside = false;
            if (distance_sq_to_face(p, points, hull, face) <= tolerance * tolerance) return true;
        }
        return inside;
    });
}

}  // namespace carom::detail
