// Reads scenes from JSON files.
#include <carom/collision/mass_properties.hpp>
#include <carom/scenes/detail/file_joints.hpp>
#include <carom/scenes/detail/file_shapes.hpp>
#include <carom/scenes/detail/json_fields.hpp>
#include <carom/scenes/detail/json_tree.hpp>
#include <carom/scenes/scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

namespace carom::scenes {
namespace {

using detail::element;
using detail::fail_at;
using detail::Fields;
using detail::FileShape;
using detail::JsonValue;
using detail::Node;

constexpr std::uintmax_t kMaxFileBytes = 64u << 20u;

struct FileBody {
    BodyDef def;
    std::vector<FileShape> shapes;
};

Result<std::string> read_file(const std::string& path) {
    std::error_code problem;
    const std::filesystem::file_status status = std::filesystem::status(path, problem);
    if (!std::filesystem::exists(status)) return Error{ErrorCode::Io, "there is no such file", path};
    if (!std::filesystem::is_regular_file(status)) return Error{ErrorCode::Io, "is not a regular file", path};
    const std::uintmax_t size = std::filesystem::file_size(path, problem);
    if (problem) return Error{ErrorCode::Io, "cannot be read: " + problem.message(), path};
    if (size > kMaxFileBytes) {
        return Error{ErrorCode::Io, fmt::format("is {} bytes long; scene files are {} at most", size, kMaxFileBytes),
                     path};
    }
    std::ifstream file(path, std::ios::binary);
    std::string text(size, '\0');
    if (!file || (size > 0 && !file.read(text.data(), static_cast<std::streamsize>(size)))) {
        return Error{ErrorCode::Io, "cannot be read", path};
    }
    return text;
}

BodyType read_type(const Node& node) {
    const std::string& name = detail::text(node);
    if (name == "static") return BodyType::Static;
    if (name == "kinematic") return BodyType::Kinematic;
    if (name == "dynamic") return BodyType::Dynamic;
    fail_at(node, ErrorCode::UnknownName,
            fmt::format("\"{}\" is none of \"static\", \"kinematic\", \"dynamic\"", name));
}

/// Mass of several shapes may overflow where that of each does not.
void check_mass(const Node& node, const std::vector<FileShape>& shapes) {
    std::vector<MassProperties> parts;
    for (const FileShape& shape : shapes) {
        parts.push_back(transform(mass_properties(shape.shape, shape.def.density).value(), shape.def.local));
    }
    const Status valid = validate(combine(parts));
    if (!valid) fail_at(node, valid.error().code, valid.error().message);
}

unsigned char read_locked(const Node& node) {
    unsigned char locked = LockedAxes::None;
    for (std::size_t i = 0; i < detail::array(node).size(); ++i) {
        const std::string& name = detail::text(element(node, i));
        constexpr std::array<const char*, 6> kNames{"move_x", "move_y", "move_z", "turn_x", "turn_y", "turn_z"};
        const auto found = std::ranges::find(kNames, name);
        if (found == kNames.end()) {
            fail_at(element(node, i), ErrorCode::UnknownName, fmt::format("\"{}\" is none of \"move_x\" .. \"turn_z\"", name));
        }
        locked = static_cast<unsigned char>(locked | 1u << (found - kNames.begin()));
    }
    return locked;
}

Continuity read_continuity(const Node& node, BodyType type) {
    const std::string& name = detail::text(node);
    for (const Continuity continuity : {Continuity::Automatic, Continuity::Always, Continuity::Never}) {
        if (name != to_string(continuity)) continue;
        if (type == BodyType::Static) fail_at(node, ErrorCode::InvalidArgument, "static bodies do not move");
        return continuity;
    }
    fail_at(node, ErrorCode::UnknownName, fmt::format("\"{}\" is none of \"automatic\", \"always\", \"never\"", name));
}

/// What only dynamic bodies have.
void read_traits(Fields& fields, BodyDef& def) {
    const auto find = [&](const char* key) {
        auto given = fields.find(key);
        if (given && def.type != BodyType::Dynamic) fail_at(*given, ErrorCode::InvalidArgument, "of dynamic bodies only");
        return given;
    };
    if (const auto given = find("gravity_scale")) def.gravity_scale = detail::number(*given, -1e6, 1e6);
    if (const auto given = find("linear_damping")) def.linear_damping = detail::number(*given, 0.0, 1e9);
    if (const auto given = find("angular_damping")) def.angular_damping = detail::number(*given, 0.0, 1e9);
    if (const auto given = find("locked")) def.locked = read_locked(*given);
    if (const auto given = find("can_sleep")) def.can_sleep = detail::boolean(*given);
}

FileBody read_body(const Node& node) {
    Fields fields(node);
    FileBody body;
    if (const auto given = fields.find("name")) body.def.name = detail::text(*given);
    if (const auto given = fields.find("type")) body.def.type = read_type(*given);
    if (const auto given = fields.find("position")) body.def.position = detail::vector(*given);
    if (const auto given = fields.find("orientation")) body.def.orientation = detail::rotation(*given);
    if (const auto given = fields.find("linear_velocity")) {
        if (body.def.type == BodyType::Static) fail_at(*given, ErrorCode::InvalidArgument, "static bodies do not move");
        body.def.linear_velocity = detail::vector(*given);
    }
    if (const auto given = fields.find("angular_velocity")) {
        if (body.def.type == BodyType::Static) fail_at(*given, ErrorCode::InvalidArgument, "static bodies do not move");
        body.def.angular_velocity = detail::vector(*given);
    }
    if (const auto given = fields.find("continuity")) body.def.continuity = read_continuity(*given, body.def.type);
    read_traits(fields, body.def);
    const Node shapes = fields.require("shapes");
    fields.done();
    for (std::size_t i = 0; i < detail::array(shapes).size(); ++i) {
        body.shapes.push_back(detail::read_shape(element(shapes, i), body.def.type));
    }
    if (body.shapes.empty()) fail_at(shapes, ErrorCode::Empty, "a body needs a shape");
    if (body.def.type == BodyType::Dynamic) check_mass(shapes, body.shapes);
    return body;
}

Aabb read_domain(const Node& node) {
    Fields fields(node);
    const Aabb domain{detail::vector(fields.require("lower")), detail::vector(fields.require("upper"))};
    fields.done();
    if (is_empty(domain)) fail_at(node, ErrorCode::InvalidArgument, "lower must not be over upper on any axis");
    return domain;
}

/// The root object, with the world's settings for `options`.
SceneRun read_root(const Node& root, const std::string& path, const SceneOptions& options) {
    Fields fields(root);
    SceneRun run{.name = std::filesystem::path(path).stem().string(), .world = World(WorldDef{})};
    WorldDef def = options.world;
    def.gravity = WorldDef{}.gravity;
    if (const auto given = fields.find("name")) run.name = detail::text(*given);
    if (const auto given = fields.find("gravity")) def.gravity = detail::vector(*given);
    if (const auto given = fields.find("dt")) run.dt = detail::positive(*given);
    if (const auto given = fields.find("steps")) run.steps = detail::integer(*given, 0, 1'000'000'000);
    if (const auto given = fields.find("substeps")) def.substeps = detail::integer(*given, 1, 1024);
    if (const auto given = fields.find("continuous")) def.continuous.enabled &= detail::boolean(*given);
    if (const auto given = fields.find("sleep")) def.sleep.enabled |= detail::boolean(*given);
    if (const auto given = fields.find("domain")) run.domain = read_domain(*given);
    def.substeps = options.substeps.value_or(def.substeps);
    const Node bodies = fields.require("bodies");
    const std::optional<Node> joints = fields.find("joints");
    fields.done();

    const std::size_t count = detail::array(bodies).size();
    if (count > static_cast<std::size_t>(kMaxSceneBodies)) {
        fail_at(bodies, ErrorCode::InvalidArgument,
                fmt::format("{} bodies; at most {} are allowed", count, kMaxSceneBodies));
    }
    run.world = World(def);
    for (std::size_t i = 0; i < count; ++i) {
        const FileBody body = read_body(element(bodies, i));
        const BodyId id = run.world.create_body(body.def);
        for (const FileShape& shape : body.shapes) run.world.add_shape(id, shape.shape, shape.def);
        // Shapes move the centre of mass, and with it the point whose velocity the file gives.
        if (body.def.type == BodyType::Dynamic) run.world.set_linear_velocity(id, body.def.linear_velocity);
    }
    for (std::size_t i = 0; joints && i < detail::array(*joints).size(); ++i) {
        run.world.create_joint(detail::read_joint(element(*joints, i), run.world));
    }
    return run;
}

}  // namespace

Result<SceneRun> read_scene(const std::string& path, const SceneOptions& options) {
    if (options.bodies) return Error{ErrorCode::InvalidArgument, "a scene file says its own bodies", "bodies"};
    if (!options.set.empty()) {
        const std::string& key = options.set.begin()->first;
        return Error{ErrorCode::UnknownName, fmt::format("a scene file has no parameter \"{}\"", key), "set " + key};
    }
    const int substeps = options.substeps.value_or(options.world.substeps);
    if (substeps < 1 || substeps > 1024) {
        return Error{ErrorCode::InvalidArgument, fmt::format("{} is outside 1..1024", substeps), "substeps"};
    }
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    const Result<JsonValue> root = detail::parse_json(*text, path);
    if (!root) return root.error();
    try {
        return read_root(Node{*root, path}, path, options);
    } catch (const detail::SceneFileError& failure) {
        return failure.error;
    }
}

}  // namespace carom::scenes
