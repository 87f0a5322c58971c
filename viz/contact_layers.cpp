#include <carom/viz/contact_layers.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/viz/layer.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>
#include <utility>

namespace carom {
namespace {

constexpr Color kOfA{60, 110, 200, 90}, kOfB{226, 132, 20, 90};
constexpr Color kLineA{30, 70, 160, 255}, kLineB{180, 96, 0, 255};
constexpr Color kAxis{140, 40, 160, 255}, kTouching{200, 30, 30, 255}, kNear{40, 110, 220, 255}, kCommon{200, 30, 30, 255};

/// Everything about a pair in the frame's coordinates: about A's shape, along world axes.
class PairPainter {
public:
    PairPainter(const World& world, const ContactExplanation& why) : world_(world), why_(why), pair_(why.pairs[why.deciding]) {
        frame_.origin = pair_.pose_a.position;
        const double g = glm::length(world.settings().gravity);
        if (g > 0.0) frame_.up = -world.settings().gravity / g;
        frame_.caption = why.sentence;
        length_ = std::min(extent_of(pair_.shape_a, pair_.pose_a), extent_of(pair_.shape_b, pair_.pose_b)) / 4.0;
        if (!is_finite(length_)) length_ = 1.0;
    }

    DebugFrame paint() {
        paint_shape(pair_.shape_a, pair_.pose_a, why_.body_a, kOfA);
        paint_shape(pair_.shape_b, pair_.pose_b, why_.body_b, kOfB);
        if (pair_.bounds) paint_bounds(*pair_.bounds);
        if (pair_.contact) {
            if (pair_.contact->axis) paint_axis(*pair_.contact->axis);
            if (pair_.contact->distance) paint_simplex(*pair_.contact->distance);
            if (pair_.contact->patch) paint_patch(*pair_.contact->patch);
            paint_manifolds(pair_.contact->manifolds);
            paint_nodes(pair_.contact->margin);
        }
        return std::move(frame_);
    }

private:
    [[nodiscard]] double extent_of(ShapeId id, const Pose& pose) const {
        const Aabb box = bounds(world_.shape(id), pose);
        const dvec3 extent = box.upper - box.lower;
        return std::max({extent.x, extent.y, extent.z});
    }

    DebugLayer& layer(const char* name) {
        if (DebugLayer* found = frame_.find(name)) return *found;
        DebugLayer& added = frame_.layers.emplace_back();
        added.name = name;
        added.on_top = true;
        return added;
    }

    void paint_shape(ShapeId id, const Pose& pose, BodyId body, Color color) {
        const bool moves = world_.type(body) != BodyType::Static;
        DebugLayer& out = layer(to_string(moves ? Layer::Shapes : Layer::Static));
        out.on_top = false;
        const Pose local{pose.position - frame_.origin, pose.orientation};
        const ShapeStyle style{.color = color, .second = color, .body = body, .segments = 32};
        if (const Plane* plane = std::get_if<Plane>(&world_.shape(id))) {
            append_plane(out, *plane, local, {.half_size = 8.0 * length_}, style);
        } else {
            append_shape(out, world_.shape(id), local, style);
        }
    }

    void paint_bounds(const BoundsFinding& found) {
        const dvec3 by = world_.broadphase_origin() - frame_.origin;
        const auto edges = [&](const FloatAabb& box, Color color, BodyId body) {
            append_box_edges(layer(kWhyBounds), {dvec3(box.lower) + by, dvec3(box.upper) + by}, Pose{}, color, body);
        };
        const bool plane_a = type_of(world_.shape(pair_.shape_a)) == ShapeType::Plane, plane_b = type_of(world_.shape(pair_.shape_b)) == ShapeType::Plane;
        if (!plane_a) edges(found.box_a, kLineA, why_.body_a);
        if (!plane_b) edges(found.box_b, kLineB, why_.body_b);
        layer(kWhyBounds).visible = pair_.rung == Rung::Bounds;
    }

    void line(DebugLayer& out, const dvec3& from, const dvec3& to, Color color) { out.lines.push_back({vec3(from), vec3(to), color, {}}); }

    void outline(DebugLayer& out, const std::vector<dvec3>& corners, Color color) {
        for (std::size_t i = 0; i < corners.size(); ++i) line(out, corners[i], corners[(i + 1) % corners.size()], color);
    }

    /// A square across the axis.
    void square(DebugLayer& out, const dvec3& middle, const dvec3& normal, Color color) {
        const dvec3 other = std::abs(normal.x) < 0.6 ? dvec3{1, 0, 0} : dvec3{0, 1, 0};
        const dvec3 u = length_ * glm::normalize(glm::cross(normal, other)), w = glm::cross(normal, u);
        outline(out, {middle + u + w, middle - u + w, middle - u - w, middle + u - w}, color);
    }

    void paint_axis(const SeparatingAxis& axis) {
        if (!is_finite(axis.on_a) || !is_finite(axis.on_b)) return;
        DebugLayer& out = layer(kWhyAxis);
        const dvec3 normal(axis.normal), middle = 0.5 * (axis.on_a + axis.on_b);
        const double half = 0.5 * std::abs(axis.gap) + length_;
        line(out, middle - half * normal, middle + half * normal, kAxis);
        square(out, axis.on_a, normal, kLineA);
        square(out, axis.on_b, normal, kLineB);
        char text[64];
        std::snprintf(text, sizeof text, "%s %.4g m", axis.gap < 0.0 ? "overlap" : "gap", std::abs(axis.gap));
        out.texts.push_back({vec3(middle + half * normal), text, kAxis, {}});
    }

    void corners_of_simplex(DebugLayer& out, const std::vector<dvec3>& corners, Color color) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            out.points.push_back({vec3(corners[i]), color, {}});
            for (std::size_t k = 0; k < i; ++k) line(out, corners[k], corners[i], color);
        }
    }

    void paint_simplex(const DistanceBounds& distance) {
        if (distance.simplex_a.empty()) return;
        DebugLayer& out = layer(kWhySimplex);
        out.visible = !distance.cores_overlap;  // then it only proves the overlap, and hides the contacts
        out.line_width = 3.0f;
        corners_of_simplex(out, distance.simplex_a, kLineA);
        corners_of_simplex(out, distance.simplex_b, kLineB);
    }

    void paint_patch(const FacePatch& patch) {
        DebugLayer& out = layer(kWhyPatch);
        out.line_width = 3.0f;
        outline(out, patch.face_a, kLineA);
        outline(out, patch.face_b, kLineB);
        outline(out, patch.common, kCommon);
    }

    void paint_manifolds(const std::vector<Manifold>& manifolds) {
        for (const Manifold& m : manifolds) {
            DebugLayer& out = layer(kWhyManifold);
            out.point_size = 12.0f;
            for (const ContactPoint& p : m.used()) {
                const Color color = p.separation <= 0.0f ? kTouching : kNear;
                out.points.push_back({p.position, color, {}});
                out.lines.push_back({p.position, p.position + static_cast<float>(length_) * m.normal, color, {}});
            }
        }
    }

    void paint_nodes(double margin) {
        const auto* a = std::get_if<TriangleMeshPtr>(&world_.shape(pair_.shape_a));
        const auto* b = std::get_if<TriangleMeshPtr>(&world_.shape(pair_.shape_b));
        if (a == nullptr || b == nullptr) return;
        std::set<std::int32_t> seen_a, seen_b;  // a node is looked at with several of the other tree
        for (const NodePair& pair : visited_nodes((*a)->bvh(), (*b)->bvh(), inverse(pair_.pose_a) * pair_.pose_b, margin)) {
            if (seen_a.insert(pair.a.id).second) paint_node(pair.a, pair_.pose_a, kLineA, why_.body_a);
            if (seen_b.insert(pair.b.id).second) paint_node(pair.b, pair_.pose_b, kLineB, why_.body_b);
        }
    }

    void paint_node(const VisitedNode& node, const Pose& pose, Color color, BodyId body) {
        if (!node.is_leaf) color.a = 60;
        DebugLayer& out = layer(kWhyNodes);
        out.visible = false;  // it hides the contacts
        append_box_edges(out, node.box, {pose.position - frame_.origin, pose.orientation}, color, body);
    }

    const World& world_;
    const ContactExplanation& why_;
    const ShapePairExplanation& pair_;
    DebugFrame frame_;
    double length_ = 1.0;
};

}  // namespace

DebugFrame make_contact_frame(const World& world, const ContactExplanation& why) {
    if (why.pairs.empty()) return {};
    const ShapePairExplanation& pair = why.pairs[why.deciding];
    if (!world.is_alive(pair.shape_a) || !world.is_alive(pair.shape_b)) return {};
    return PairPainter(world, why).paint();
}

}  // namespace carom
