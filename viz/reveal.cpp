#include <carom/viz/reveal.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/core/check.hpp>
#include <carom/viz/layer.hpp>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace carom {
namespace {

constexpr std::size_t kMostSamples = 64;
constexpr float kFlat = 0.866f;  // cosine of 30 degrees: a bend of less is no edge
constexpr Color kDark{40, 44, 52, 255};

using Corners = std::array<dvec3, 3>;

Corners corners_of(const DebugLayer& layer, const DebugTriangle& t) {
    return {dvec3(layer.vertices[t.vertices[0]].position), dvec3(layer.vertices[t.vertices[1]].position),
            dvec3(layer.vertices[t.vertices[2]].position)};
}

/// The middles of the bodies' boxes, of at most kMostSamples of them.
std::vector<dvec3> middles(const DebugLayer& layer) {
    std::map<BodyId, Aabb> boxes;
    for (const DebugTriangle& t : layer.triangles) {
        for (const dvec3& p : corners_of(layer, t)) boxes[t.body] = merge(boxes[t.body], {p, p});
    }
    std::vector<dvec3> all, some;
    for (const auto& [body, box] : boxes) all.push_back(0.5 * box.lower + 0.5 * box.upper);
    const std::size_t count = std::min(all.size(), kMostSamples);
    for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
    return some;
}

/// Whether the way from `eye` to `point` crosses the triangle (Möller, Trumbore 1997); from behind too, unless backs are not drawn.
bool crosses(const Corners& t, const dvec3& eye, const dvec3& point, bool hide_backs) {
    const dvec3 way = point - eye, e1 = t[1] - t[0], e2 = t[2] - t[0];
    const dvec3 p = glm::cross(way, e2);
    const double determinant = glm::dot(e1, p);  // positive: seen from the front
    if (hide_backs ? determinant <= 0.0 : determinant == 0.0) return false;
    const dvec3 s = (eye - t[0]) / determinant;
    const double u = glm::dot(s, p);
    const dvec3 q = glm::cross(s, e1);
    const double v = glm::dot(way, q), at = glm::dot(e2, q);
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at > 0.0 && at < 1.0;
}

std::set<BodyId> find_hiding(const DebugLayer& fixed, const std::vector<dvec3>& points, const dvec3& eye) {
    std::map<BodyId, std::vector<bool>> hidden;  // by the body that hides
    for (const DebugTriangle& t : fixed.triangles) {
        const Corners corners = corners_of(fixed, t);
        std::vector<bool>& mine = hidden[t.body];
        mine.resize(points.size(), false);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!mine[i]) mine[i] = crosses(corners, eye, points[i], fixed.hide_backs);
        }
    }
    std::set<BodyId> hiding;
    for (const auto& [body, of] : hidden) {
        const auto count = static_cast<double>(std::count(of.begin(), of.end(), true));
        if (count > kMostHidden * static_cast<double>(points.size())) hiding.insert(body);
    }
    return hiding;
}

/// The triangles' edges where they end or bend.
class Edges {
public:
    void add(const Corners& corners, const DebugTriangle& triangle) {
        const dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double length = glm::length(normal);
        if (!(length > 0.0)) return;
        for (std::size_t k = 0; k < 3; ++k) {
            Key key{at(corners[k]), at(corners[(k + 1) % 3])};
            if (key.second < key.first) std::swap(key.first, key.second);
            Sides& sides = all_[key];
            sides.normals.push_back(vec3(normal / length));
            sides.color = mix(triangle.color, kDark, 0.5);
            sides.body = triangle.body;
        }
    }
    void append_to(DebugLayer& layer) const {
        for (const auto& [key, sides] : all_) {
            const bool flat = sides.normals.size() == 2 && glm::dot(sides.normals[0], sides.normals[1]) > kFlat;
            if (!flat) layer.lines.push_back({point(key.first), point(key.second), sides.color, sides.body});
        }
    }

private:
    using Point = std::array<float, 3>;
    using Key = std::pair<Point, Point>;
    struct Sides {
        std::vector<vec3> normals;
        Color color;
        BodyId body;
    };
    static Point at(const dvec3& p) { return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; }
    static vec3 point(const Point& p) { return {p[0], p[1], p[2]}; }
    std::map<Key, Sides> all_;
};

}  // namespace

std::size_t reveal(DebugFrame& frame, const Camera& camera) {
    const Status status = validate(camera);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, 0);
    DebugLayer* const fixed = frame.find(to_string(Layer::Static));
    const DebugLayer* const moving = frame.find(to_string(Layer::Shapes));
    if (fixed == nullptr || moving == nullptr) return 0;
    const std::vector<dvec3> points = middles(*moving);
    const std::set<BodyId> hiding = find_hiding(*fixed, points, camera.position - frame.origin);
    Edges edges;
    for (const DebugTriangle& t : fixed->triangles) {
        if (hiding.contains(t.body)) edges.add(corners_of(*fixed, t), t);
    }
    std::erase_if(fixed->triangles, [&](const DebugTriangle& t) { return hiding.contains(t.body); });
    edges.append_to(*fixed);
    return hiding.size();
}

}  // namespace carom
