#include <carom/scenes/detail/file_shapes.hpp>

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/teapot.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <fmt/format.h>

#include <limits>
#include <utility>
#include <vector>

namespace carom::scenes::detail {
namespace {

constexpr double kFinestChord = 1e-4;  // of a teapot's size; it then has some hundred thousand triangles

template <class T>
T value_or_fail(const Node& node, Result<T> result) {
    if (!result) fail_at(node, result.error().code, result.error().message);
    return std::move(result).value();
}

std::vector<vec3> read_points(const Node& node) {
    std::vector<vec3> points;
    points.reserve(array(node).size());
    for (std::size_t i = 0; i < array(node).size(); ++i) points.push_back(single_vector(element(node, i)));
    return points;
}

MeshData read_teapot(const Node& node, Fields& fields) {
    const double size = static_cast<double>(positive_single(fields.require("size")));
    double chord_error = 0.005 * size;
    if (const auto given = fields.find("chord_error")) chord_error = number(*given, kFinestChord * size, size);
    return value_or_fail(node, teapot(size, chord_error));
}

MeshData read_terrain(Fields& fields) {
    TerrainSettings settings;
    if (const auto given = fields.find("level")) settings.level = integer(*given, 1, 10);
    if (const auto given = fields.find("spacing")) settings.spacing = number(*given, 1e-6, 1e6);
    if (const auto given = fields.find("roughness")) settings.roughness = number(*given, 0.0, 1.0);
    if (const auto given = fields.find("height")) settings.height = number(*given, 0.0, 1e6);
    if (const auto given = fields.find("seed")) {
        settings.seed = static_cast<std::uint64_t>(integer(*given, 0, std::numeric_limits<int>::max()));
    }
    if (const auto given = fields.find("rim")) settings.rim = boolean(*given);
    return diamond_square(settings);
}

MeshData read_inline(Fields& fields) {
    MeshData mesh;
    mesh.vertices = read_points(fields.require("vertices"));
    if (mesh.vertices.empty()) fail_at(fields.require("vertices"), ErrorCode::Empty, "a mesh needs vertices");
    const int last = static_cast<int>(mesh.vertices.size()) - 1;
    const Node list = fields.require("triangles");
    for (std::size_t t = 0; t < array(list).size(); ++t) {
        const Node corners = element(list, t);
        if (array(corners).size() != 3)
            fail_at(corners, ErrorCode::WrongType, "a triangle is three indices of vertices");
        std::array<std::uint32_t, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k)
            triangle[k] = static_cast<std::uint32_t>(integer(element(corners, k), 0, last));
        mesh.triangles.push_back(triangle);
    }
    return mesh;
}

Shape read_mesh(const Node& node, Fields& fields) {
    MeshData mesh;
    if (const auto generator = fields.find("generate")) {
        const std::string& name = text(*generator);
        if (name == "teapot") {
            mesh = read_teapot(node, fields);
        } else if (name == "terrain") {
            mesh = read_terrain(fields);
        } else {
            fail_at(*generator, ErrorCode::UnknownName,
                    fmt::format("\"{}\" is neither \"teapot\" nor \"terrain\"", name));
        }
    } else {
        mesh = read_inline(fields);
    }
    TriangleMeshSettings settings;
    if (const auto given = fields.find("one_sided")) settings.one_sided = boolean(*given);
    return value_or_fail(node, TriangleMesh::build(mesh.vertices, mesh.triangles, settings));
}

Shape read_hull(const Node& node, Fields& fields) {
    if (const auto generator = fields.find("generate")) {
        if (text(*generator) != "teapot")
            fail_at(*generator, ErrorCode::UnknownName, "a hull can be generated from \"teapot\" only");
        return value_or_fail(node, ConvexHull::build(read_teapot(node, fields).vertices));
    }
    const Node points = fields.require("points");
    return value_or_fail(points, ConvexHull::build(read_points(points)));
}

Shape read_plane(Fields& fields) {
    const Node normal_node = fields.require("normal");
    const dvec3 normal = vector(normal_node);
    const double length = glm::length(normal);
    if (!(length > 0.0) || !is_finite(length)) {
        fail_at(normal_node, ErrorCode::InvalidArgument,
                "must have a direction: its length is 0 or beyond double's range");
    }
    float offset = 0.0f;
    if (const auto given = fields.find("offset")) offset = single(*given);
    return Plane{vec3(normal / length), offset};
}

ShapeDef read_matter(Fields& fields) {
    ShapeDef def;
    if (const auto given = fields.find("density")) def.density = positive(*given);
    if (const auto given = fields.find("friction")) {
        if (number(*given) < 0.0) fail_at(*given, ErrorCode::InvalidArgument, "must not be negative");
        def.friction = single(*given);
    }
    if (const auto given = fields.find("restitution")) def.restitution = static_cast<float>(number(*given, 0.0, 1.0));
    if (const auto given = fields.find("position")) def.local.position = vector(*given);
    if (const auto given = fields.find("orientation")) def.local.orientation = rotation(*given);
    return def;
}

CombineRule read_rule(const Node& node) {
    using enum CombineRule;
    for (const CombineRule rule : {Average, GeometricMean, Minimum, Product, Maximum}) {
        if (text(node) == to_string(rule)) return rule;
    }
    fail_at(node, ErrorCode::UnknownName,
            fmt::format("\"{}\" is none of \"average\", \"geometric_mean\", \"minimum\", \"product\", \"maximum\"", text(node)));
}

/// How the whole shape meets others: parts of compounds have no rules of their own, and do not resist to rolling by themselves.
void read_rules(Fields& fields, ShapeDef& def) {
    if (const auto given = fields.find("friction_rule")) def.friction_rule = read_rule(*given);
    if (const auto given = fields.find("restitution_rule")) def.restitution_rule = read_rule(*given);
    if (const auto given = fields.find("rolling_resistance")) def.rolling_resistance = static_cast<float>(number(*given, 0.0, 1e30));
    if (const auto given = fields.find("torsion")) def.torsion = static_cast<float>(number(*given, 0.0, 1e30));
    if (const auto given = fields.find("rolling_rule")) def.rolling_rule = read_rule(*given);
}

Shape read_geometry(const Node& node, Fields& fields);

CompoundPart read_part(const Node& node) {
    Fields fields(node);
    CompoundPart part{read_geometry(node, fields)};
    const ShapeDef def = read_matter(fields);
    fields.done();
    part.pose = def.local;
    if (fields.find("density")) part.material.density = def.density;
    if (fields.find("friction")) part.material.friction = def.friction;
    if (fields.find("restitution")) part.material.restitution = def.restitution;
    if (const ShapeType type = type_of(part.shape); !is_convex_solid(type)) {
        fail_at(node, ErrorCode::WrongType, fmt::format("a {} cannot be part of a compound", to_string(type)));
    }
    return part;
}

Shape read_compound(Fields& fields) {
    const Node list = fields.require("parts");
    std::vector<CompoundPart> parts;
    for (std::size_t i = 0; i < array(list).size(); ++i) parts.push_back(read_part(element(list, i)));
    return value_or_fail(list, Compound::build(std::move(parts)));
}

template <class Turned>
Shape read_turned(Fields& fields) {
    const float radius = positive_single(fields.require("radius"));
    return Turned{radius, positive_single(fields.require("half_height"))};
}

Shape read_geometry(const Node& node, Fields& fields) {
    const Node type_node = fields.require("type");
    const std::string& type = text(type_node);
    if (type == "sphere") return Sphere{positive_single(fields.require("radius"))};
    if (type == "box") {
        const Node half = fields.require("half_extents");
        static_cast<void>(vector(half));
        return Box{
            {positive_single(element(half, 0)), positive_single(element(half, 1)), positive_single(element(half, 2))}};
    }
    if (type == "capsule") {
        const float radius = positive_single(fields.require("radius"));
        const Node half_segment = fields.require("half_segment");
        if (number(half_segment) < 0.0) fail_at(half_segment, ErrorCode::InvalidArgument, "must not be negative");
        return Capsule{radius, single(half_segment)};
    }
    if (type == "cylinder") return read_turned<Cylinder>(fields);
    if (type == "cone") return read_turned<Cone>(fields);
    if (type == "compound") return read_compound(fields);
    if (type == "plane") return read_plane(fields);
    if (type == "convex_hull") return read_hull(node, fields);
    if (type == "triangle_mesh") return read_mesh(node, fields);
    fail_at(type_node, ErrorCode::UnknownName, fmt::format("there is no shape \"{}\"", type));
}

/// Refuses what the body cannot carry.
void check_fit(const Node& node, const FileShape& read, BodyType body) {
    const Status valid = validate(read.shape);
    if (!valid) fail_at(node, valid.error().code, valid.error().message);
    if (body != BodyType::Dynamic) return;
    if (!is_bounded(read.shape)) fail_at(node, ErrorCode::WrongType, "a plane fits static and kinematic bodies only");
    const TriangleMeshPtr* const mesh = std::get_if<TriangleMeshPtr>(&read.shape);
    if (mesh != nullptr && (*mesh)->is_one_sided()) fail_at(node, ErrorCode::WrongType, "a one-sided mesh fits static and kinematic bodies only");
    const MassProperties mass = value_or_fail(node, mass_properties(read.shape, read.def.density));
    const Status massive = validate(transform(mass, read.def.local));
    if (!massive) fail_at(node, massive.error().code, massive.error().message);
}

}  // namespace

FileShape read_shape(const Node& node, BodyType body) {
    Fields fields(node);
    Shape shape = read_geometry(node, fields);
    FileShape read{std::move(shape), read_matter(fields)};
    read_rules(fields, read.def);
    fields.done();
    check_fit(node, read, body);
    return read;
}

}  // namespace carom::scenes::detail
