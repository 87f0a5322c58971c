#include <carom/collision/detail/convex_solid.hpp>

#include <carom/collision/convex_hull.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace carom::detail {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// A triangle that is lower than this many tolerances has no side that it faces.
constexpr double kNeedle = 16.0;

// So many triangles are held against all vertices before a hull is built.
constexpr std::size_t kSamples = 8;

struct Corners {
    std::array<dvec3, 3> p;
    dvec3 normal{0.0};     // of the length of twice the area
    double longest = 0.0;  // edge

    Corners(std::span<const vec3> vertices, const Triangle& t) : p{dvec3(vertices[t[0]]), dvec3(vertices[t[1]]), dvec3(vertices[t[2]])} {
        const dvec3 u = p[1] - p[0], v = p[2] - p[0], w = p[2] - p[1];
        normal = glm::cross(u, v);
        longest = std::sqrt(std::max({glm::dot(u, u), glm::dot(v, v), glm::dot(w, w)}));
    }
    [[nodiscard]] double doubled_area() const { return glm::length(normal); }
};

// Whether all vertices are behind the triangle's plane, to what the tolerance becomes where the plane is far from the triangle.
bool is_outermost(std::span<const vec3> vertices, const Corners& t, double extent, double tolerance) {
    const double area = t.doubled_area(), allowed = area + extent * t.longest;  // times the tolerance over the area: heights
    const double offset = glm::dot(t.normal, t.p[0]) + allowed * tolerance;
    return std::ranges::all_of(vertices, [&](const vec3& v) { return glm::dot(t.normal, dvec3(v)) <= offset; });
}

std::vector<vec3> used_vertices(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    std::vector<bool> is_used(vertices.size(), false);
    std::vector<vec3> used;
    for (const Triangle& t : triangles) {
        for (const std::uint32_t v : t) {
            if (!is_used[v]) used.push_back(vertices[v]);
            is_used[v] = true;
        }
    }
    return used;
}

// The faces of a hull: which of them a triangle lies on.
class HullSurface {
public:
    HullSurface(const ConvexHull& hull, double tolerance) : hull_(hull), tolerance_(tolerance), around_(hull.vertices().size()) {
        for (std::uint32_t v = 0; v < hull.vertices().size(); ++v) {
            const vec3& p = hull.vertices()[v];
            numbers_.emplace(std::array<float, 3>{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f}, v);
        }
        for (const ConvexHull::HalfEdge& e : hull.edges()) around_[e.origin].push_back(e.face);
        for (const ConvexHull::Face& face : hull.faces()) area_ += area_of(face);
    }

    [[nodiscard]] double doubled_area() const { return area_; }

    /// Faces at a corner of the triangle first, then where the last triangle was, then all.
    [[nodiscard]] bool carries(std::span<const vec3> vertices, const Triangle& triangle) {
        const Corners t(vertices, triangle);
        for (const std::uint32_t v : triangle) {
            const vec3& p = vertices[v];
            const auto known = numbers_.find({p.x + 0.0f, p.y + 0.0f, p.z + 0.0f});
            if (known == numbers_.end()) continue;
            if (std::ranges::any_of(around_[known->second], [&](std::uint32_t face) { return lies_on(t, face); })) return true;
        }
        if (lies_on(t, last_)) return true;
        for (last_ = 0; last_ < hull_.faces().size(); ++last_) {
            if (lies_on(t, last_)) return true;
        }
        last_ = 0;
        return false;
    }

private:
    [[nodiscard]] bool lies_on(const Corners& t, std::uint32_t face) const {
        const ConvexHull::Face& f = hull_.faces()[face];
        const auto is_near = [&](const dvec3& p) { return std::abs(glm::dot(f.normal, p) - f.offset) <= tolerance_; };
        if (!std::ranges::all_of(t.p, is_near)) return false;
        return glm::dot(f.normal, t.normal) > 0.0 || t.doubled_area() <= kNeedle * tolerance_ * t.longest;
    }
    [[nodiscard]] double area_of(const ConvexHull::Face& face) const {
        const auto corner = [&](std::uint32_t edge) { return dvec3(hull_.vertices()[hull_.edges()[edge].origin]); };
        dvec3 sum{0.0};
        const dvec3 first = corner(face.first_edge);
        for (std::uint32_t e = hull_.edges()[face.first_edge].next; e != face.first_edge; e = hull_.edges()[e].next) {
            sum += glm::cross(corner(e) - first, corner(hull_.edges()[e].next) - first);
        }
        return glm::length(sum);
    }

    const ConvexHull& hull_;
    double tolerance_;
    std::map<std::array<float, 3>, std::uint32_t> numbers_;
    std::vector<std::vector<std::uint32_t>> around_;  // faces by vertex
    std::uint32_t last_ = 0;
    double area_ = 0.0;
};

}  // namespace

ConvexHullPtr convex_solid(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    if (triangles.size() > kMostSolidTriangles) return nullptr;
    const std::vector<vec3> used = used_vertices(vertices, triangles);
    vec3 lower = used.front(), upper = used.front();
    for (const vec3& p : used) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    const dvec3 size = dvec3(upper) - dvec3(lower);
    const double extent = std::max({size.x, size.y, size.z}), tolerance = kSolidTolerance * extent;
    for (std::size_t k = 0; k < kSamples; ++k) {
        if (!is_outermost(used, {vertices, triangles[k * (triangles.size() - 1) / (kSamples - 1)]}, extent, tolerance)) return nullptr;
    }
    const Result<ConvexHullPtr> hull = ConvexHull::build(used);
    if (!hull || (*hull)->faces().size() > kMostSolidFaces) return nullptr;  // flat, or large
    HullSurface surface(**hull, tolerance);
    double area = 0.0;
    for (const Triangle& t : triangles) {
        if (!surface.carries(vertices, t)) return nullptr;
        area += Corners(vertices, t).doubled_area();
    }
    // All of it faces outwards, so it covers the hull a whole number of times: once, if it has less than half as much again.
    return area < 1.5 * surface.doubled_area() ? *hull : nullptr;
}

}  // namespace carom::detail
