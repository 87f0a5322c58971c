#include <carom/viz/make_debug_frame.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/viz/detail/focus.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

namespace carom {
namespace {

constexpr Color kGround{206, 200, 186, 255};
constexpr Color kQuarantined{120, 20, 24, 255};
constexpr Color kTouching{222, 48, 40, 255};
constexpr Color kApart{60, 132, 214, 255};
constexpr Color kNormal{30, 36, 52, 255};
constexpr Color kImpulse{226, 132, 20, 255};
constexpr Color kJoint{150, 60, 170, 255};
constexpr Color kBounds{96, 106, 124, 255};
constexpr Color kBvhRoot{40, 70, 140, 255};
constexpr Color kBvhLeaf{60, 170, 110, 255};
constexpr Color kName{24, 28, 40, 255};

/// Where the scene is and how large: what planes and normals are sized by. Relative to the frame's origin.
struct Extent {
    dvec3 center{0.0};
    double radius = 1.0;
};

/// Fills the layers of one frame.
class FrameBuilder {
public:
    FrameBuilder(const World& world, const DebugFrameSettings& settings, DebugFrame& frame)
        : world_(world), settings_(settings), frame_(frame), extent_(measure()) {}

    void fill() {
        for (const BodyId body : world_.bodies()) {
            for (const ShapeId shape : world_.shapes(body)) {
                add_shape(body, shape);
                if (wants(Layer::Bounds)) add_bounds(body, shape);
                if (wants(Layer::Bvh)) add_bvh(body, shape);
            }
            if (wants(Layer::Names)) add_name(body);
        }
        add_contacts();
        if (!wants(Layer::Joints)) return;
        for (const JointId joint : world_.joints()) add_joint(joint);
    }

private:
    [[nodiscard]] bool wants(Layer layer) const noexcept { return (settings_.layers & layer_bit(layer)) != 0; }
    [[nodiscard]] DebugLayer& layer(Layer which) noexcept { return frame_.layers[static_cast<std::size_t>(which)]; }
    [[nodiscard]] dvec3 local(const dvec3& position) const noexcept { return position - frame_.origin; }
    [[nodiscard]] Pose local_pose(ShapeId shape) const {
        Pose pose = world_.shape_pose(shape);
        pose.position -= frame_.origin;
        return pose;
    }
    [[nodiscard]] bool moves(BodyId body) const { return world_.type(body) != BodyType::Static; }

    /// The extent of the bodies that move; of the static ones where none moves.
    [[nodiscard]] Extent measure() const {
        for (const bool moving : {true, false}) {
            std::vector<dvec3> corners;
            for (const BodyId body : world_.bodies()) {
                if (moves(body) != moving) continue;
                for (const ShapeId shape : world_.shapes(body)) {
                    if (!is_bounded(world_.shape(shape))) continue;
                    const Aabb box = bounds(world_.shape(shape), local_pose(shape));
                    corners.push_back(box.lower);
                    corners.push_back(box.upper);
                }
            }
            detail::remove_outliers(corners);
            if (corners.empty()) continue;
            const Aabb box = detail::box_of(corners);
            const dvec3 half = 0.5 * (box.upper - box.lower);
            return {0.5 * (box.lower + box.upper), std::sqrt(glm::dot(half, half))};
        }
        return {};
    }

    [[nodiscard]] double line_length() const noexcept {
        return settings_.line_length > 0.0 ? settings_.line_length : extent_.radius / 30.0;
    }

    [[nodiscard]] Color color_of(BodyId body, ShapeId shape) const {
        if (world_.is_quarantined(body)) return kQuarantined;
        if (!moves(body)) return kGround;
        if (settings_.color_by == ColorBy::Body) return palette(body.slot);
        return palette(static_cast<std::uint32_t>(type_of(world_.shape(shape))));
    }

    void add_shape(BodyId body, ShapeId shape) {
        const Layer which = moves(body) ? Layer::Shapes : Layer::Static;
        if (!wants(which)) return;
        const ShapeStyle style = two_tone(color_of(body, shape), body, settings_.segments);
        if (const auto* plane = std::get_if<Plane>(&world_.shape(shape))) {
            const double half = settings_.plane_half_size > 0.0 ? settings_.plane_half_size : 1.5 * extent_.radius;
            const ShapeStyle faint{style.color, mix(style.color, style.second, 0.35), body, style.segments};
            append_plane(layer(which), *plane, local_pose(shape), {extent_.center, half, 16}, faint);
        } else {
            append_shape(layer(which), world_.shape(shape), local_pose(shape), style);
        }
    }

    void add_bounds(BodyId body, ShapeId shape) {
        if (!is_bounded(world_.shape(shape))) return;
        append_box_edges(layer(Layer::Bounds), bounds(world_.shape(shape), local_pose(shape)), Pose{}, kBounds, body);
    }

    void add_bvh(BodyId body, ShapeId shape) {
        const Pose pose = local_pose(shape);
        const auto draw = [&](const Aabb& box, int depth) {
            if (depth > settings_.bvh_depth) return;
            const double t = static_cast<double>(depth) / std::max(settings_.bvh_depth, 1);
            append_box_edges(layer(Layer::Bvh), box, pose, mix(kBvhRoot, kBvhLeaf, t), body);
        };
        if (const auto* mesh = std::get_if<TriangleMeshPtr>(&world_.shape(shape))) (*mesh)->visit_nodes(draw);
        if (const auto* compound = std::get_if<CompoundPtr>(&world_.shape(shape))) (*compound)->visit_nodes(draw);
    }

    void add_name(BodyId body) {
        if (world_.name(body).empty()) return;
        layer(Layer::Names).texts.push_back({vec3(local(world_.center_of_mass(body))), world_.name(body), kName, body});
    }

    void add_contacts() {
        if ((settings_.layers & (layer_bit(Layer::Contacts) | layer_bit(Layer::Normals) | layer_bit(Layer::Impulses))) == 0) {
            return;
        }
        float largest = 0.0f;
        for (std::size_t i = 0; i < world_.contact_count(); ++i) {
            for (const float impulse : world_.contact(i).normal_impulse) largest = std::max(largest, impulse);
        }
        for (std::size_t i = 0; i < world_.contact_count(); ++i) add_contact(world_.contact(i), static_cast<double>(largest));
    }

    void add_contact(const ContactView& contact, double largest_impulse) {
        const BodyId body = moves(contact.body_b) ? contact.body_b : contact.body_a;
        const dvec3 normal(contact.manifold.normal);
        for (std::uint32_t k = 0; k < contact.manifold.count; ++k) {
            const ContactPoint& point = contact.manifold.points[k];
            const dvec3 at = local(contact.origin) + dvec3(point.position);
            const vec3 position(at);
            const Color color = point.separation <= 0.0f ? kTouching : kApart;
            if (wants(Layer::Contacts)) layer(Layer::Contacts).points.push_back({position, color, body});
            if (wants(Layer::Normals)) {
                layer(Layer::Normals).lines.push_back({position, vec3(at + line_length() * normal), kNormal, body});
            }
            if (!wants(Layer::Impulses) || k >= contact.normal_impulse.size() || !(largest_impulse > 0.0)) continue;
            const double share = static_cast<double>(contact.normal_impulse[k]) / largest_impulse;
            const vec3 end(at + share * line_length() * normal);
            if (share > 0.0) layer(Layer::Impulses).lines.push_back({position, end, kImpulse, body});
        }
    }

    void add_joint(JointId joint) {
        const JointDef& def = world_.joint_def(joint);
        const JointState state = world_.joint_state(joint);
        const auto [a, b] = std::visit([](const auto& d) { return std::pair{d.body_a, d.body_b}; }, def);
        const BodyId shown = b && moves(b) ? b : a;
        const auto line = [&](const dvec3& from, const dvec3& to) {
            if (from != to) layer(Layer::Joints).lines.push_back({vec3(local(from)), vec3(local(to)), kJoint, shown});
        };
        if (a) line(world_.center_of_mass(a), state.anchor_a);
        line(state.anchor_a, state.anchor_b);
        if (b) line(state.anchor_b, world_.center_of_mass(b));
    }

    const World& world_;
    const DebugFrameSettings& settings_;
    DebugFrame& frame_;
    Extent extent_;
};

std::vector<DebugLayer> make_layers() {
    std::vector<DebugLayer> layers(kLayerCount);
    for (int i = 0; i < kLayerCount; ++i) {
        const auto which = static_cast<Layer>(i);
        DebugLayer& layer = layers[static_cast<std::size_t>(i)];
        layer.name = to_string(which);
        layer.visible = which == Layer::Static || which == Layer::Shapes || which == Layer::Contacts || which == Layer::Normals || which == Layer::Joints;
        layer.on_top = which == Layer::Joints || which == Layer::Contacts || which == Layer::Normals || which == Layer::Impulses;
        layer.hide_backs = which == Layer::Static;
        layer.line_width = which == Layer::Impulses ? 3.0f : 1.5f;
    }
    return layers;
}

bool is_length(double x) { return x >= 0.0 && is_finite(x); }

}  // namespace

DebugFrame make_debug_frame(const World& world, const DebugFrameSettings& settings) {
    CAROM_REQUIRE(is_finite(settings.origin), ErrorCode::NotFinite, "the origin is not finite", DebugFrame{});
    CAROM_REQUIRE(is_length(settings.line_length) && is_length(settings.plane_half_size), ErrorCode::InvalidArgument,
                  "lengths must be finite and not negative", DebugFrame{});
    CAROM_REQUIRE(settings.segments >= 4 && settings.segments <= 256 && settings.segments % 4 == 0,
                  ErrorCode::InvalidArgument, "segments must be a multiple of 4 in 4..256", DebugFrame{});
    CAROM_REQUIRE(settings.bvh_depth >= 0, ErrorCode::InvalidArgument, "bvh_depth must not be negative", DebugFrame{});
    DebugFrame frame;
    frame.origin = settings.origin;
    const dvec3 gravity = world.settings().gravity;
    const double strength = std::sqrt(glm::dot(gravity, gravity));
    if (strength > 0.0) frame.up = -gravity / strength;
    frame.layers = make_layers();
    FrameBuilder(world, settings, frame).fill();
    return frame;
}

}  // namespace carom
