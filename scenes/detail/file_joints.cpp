#include <carom/scenes/detail/file_joints.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace carom::scenes::detail {
namespace {

constexpr double kMost = 1e30;

/// A body by its place in the file or by a name that no other has.
BodyId read_body_name(const Node& node, const World& world) {
    const std::span<const BodyId> bodies = world.bodies();
    if (!std::holds_alternative<std::string>(node.value.data)) {
        if (bodies.empty()) fail_at(node, ErrorCode::UnknownName, "there are no bodies");
        const auto last = static_cast<int>(std::min<std::size_t>(bodies.size() - 1, std::numeric_limits<int>::max()));
        return bodies[static_cast<std::size_t>(integer(node, 0, last))];
    }
    const std::string& name = text(node);
    const auto has_name = [&](BodyId body) { return world.name(body) == name; };
    const auto found = std::ranges::find_if(bodies, has_name);
    if (found == bodies.end()) fail_at(node, ErrorCode::UnknownName, fmt::format("no body is called \"{}\"", name));
    if (std::find_if(found + 1, bodies.end(), has_name) != bodies.end()) {
        fail_at(node, ErrorCode::InvalidArgument, fmt::format("several bodies are called \"{}\": say which by its number", name));
    }
    return *found;
}

Pose pose_of(const World& world, BodyId body) { return body ? world.pose(body) : Pose{}; }

dvec3 read_anchor(const Node& node) {
    const dvec3 anchor = vector(node);
    if (glm::length(anchor) > kMost) fail_at(node, ErrorCode::InvalidArgument, "must be within 1e30 m");
    return anchor;
}

/// What both kinds have: bodies, anchors, whether the two collide.
template <class Def>
Def read_ends(Fields& fields, const Node& node, const World& world) {
    Def def;
    if (const auto given = fields.find("body_a")) def.body_a = read_body_name(*given, world);
    if (const auto given = fields.find("body_b")) def.body_b = read_body_name(*given, world);
    if (def.body_a == def.body_b) fail_at(node, ErrorCode::InvalidArgument, "a joint needs two bodies, or a body and the world");
    const auto moves = [&](BodyId body) { return body && world.type(body) == BodyType::Dynamic; };
    if (!moves(def.body_a) && !moves(def.body_b)) fail_at(node, ErrorCode::WrongType, "one body of a joint must be dynamic");
    const auto at = fields.find("at");
    const std::pair<const char*, dvec3*> anchors[] = {{"anchor_a", &def.anchor_a}, {"anchor_b", &def.anchor_b}};
    for (const auto& [key, anchor] : anchors) {
        const auto given = fields.find(key);
        if (given && at) fail_at(*given, ErrorCode::InvalidArgument, "either anchors or \"at\"");
        if (given) *anchor = read_anchor(*given);
    }
    if (at) {
        const dvec3 point = read_anchor(*at);
        def.anchor_a = inverse_transform_point(pose_of(world, def.body_a), point);
        def.anchor_b = inverse_transform_point(pose_of(world, def.body_b), point);
    }
    if (const auto given = fields.find("collide_connected")) def.collide_connected = boolean(*given);
    return def;
}

}  // namespace

JointDef read_joint(const Node& node, const World& world) {
    Fields fields(node);
    const Node type = fields.require("type");
    const std::string& name = text(type);
    if (name == "ball") {
        const auto def = read_ends<BallJointDef>(fields, node, world);
        fields.done();
        return def;
    }
    if (name != "spring") fail_at(type, ErrorCode::UnknownName, fmt::format("\"{}\" is none of \"ball\", \"spring\"", name));
    auto def = read_ends<SpringDef>(fields, node, world);
    def.rest_length = std::min(glm::length(transform_point(pose_of(world, def.body_b), def.anchor_b) - transform_point(pose_of(world, def.body_a), def.anchor_a)), kMost);
    if (const auto given = fields.find("rest_length")) def.rest_length = number(*given, 0.0, kMost);
    def.stiffness = number(fields.require("stiffness"), 0.0, kMost);
    if (const auto given = fields.find("damping")) def.damping = number(*given, 0.0, kMost);
    fields.done();
    return def;
}

}  // namespace carom::scenes::detail
