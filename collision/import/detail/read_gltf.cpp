// glTF 2.0: the meshes of the default scene, each where its node is.
#include <carom/collision/import/detail/bytes.hpp>
#include <carom/collision/import/detail/gltf_document.hpp>
#include <carom/collision/import/detail/readers.hpp>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include <array>
#include <utility>

namespace carom {
namespace {

constexpr std::uint64_t kTriangles = 4, kStrip = 5, kFan = 6;
constexpr std::uint64_t kMostCorners = std::uint64_t{3} << 28;  // of all instances

using Frame = std::pair<glm::dmat3, dvec3>;  // a point p goes to first * p + second

template <std::size_t N>
std::optional<std::array<double, N>> numbers(const GltfJson& json) {
    std::array<double, N> out{};
    if (!json.is_array() || json.size() != N) return std::nullopt;
    for (std::size_t i = 0; i < N; ++i) {
        if (!json[i].is_number()) return std::nullopt;
        out[i] = json[i].get<double>();
    }
    return out;
}

// The matrix of the quaternion x, y, z, w, of length one to rounding.
glm::dmat3 rotation(const std::array<double, 4>& q) {
    const auto [x, y, z, w] = q;
    return {dvec3(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
            dvec3(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
            dvec3(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))};
}

// A node's own frame; none if its numbers are not what they should be.
std::optional<Frame> frame_of(const GltfJson& node) {
    if (const GltfJson& matrix = member(node, "matrix"); !matrix.is_null()) {
        const auto m = numbers<16>(matrix);
        if (!m) return std::nullopt;
        const auto column = [&](std::size_t c) { return dvec3((*m)[4 * c], (*m)[4 * c + 1], (*m)[4 * c + 2]); };
        return Frame{glm::dmat3(column(0), column(1), column(2)), column(3)};
    }
    const GltfJson &t = member(node, "translation"), &r = member(node, "rotation"), &s = member(node, "scale");
    const auto move = t.is_null() ? std::array<double, 3>{0, 0, 0} : numbers<3>(t);
    const auto turn = r.is_null() ? std::array<double, 4>{0, 0, 0, 1} : numbers<4>(r);
    const auto scale = s.is_null() ? std::array<double, 3>{1, 1, 1} : numbers<3>(s);
    if (!move || !turn || !scale) return std::nullopt;
    glm::dmat3 linear = rotation(*turn);
    for (int c = 0; c < 3; ++c) linear[c] *= (*scale)[static_cast<std::size_t>(c)];
    return Frame{linear, dvec3((*move)[0], (*move)[1], (*move)[2])};
}

class SceneReader {
public:
    SceneReader(const GltfDocument& document, MeshBuilder& builder) : document_(document), builder_(builder) {}

    // Nodes in the order of the file, parents first. Each may be reached once, so that a ring ends and cost stays bounded.
    Status read() {
        const GltfJson& json = document_.json();
        const GltfJson& scene = item(json, "scenes", whole_member(json, "scene").value_or(0));
        std::vector<std::pair<GltfJson, Frame>> stack;
        std::vector<bool> seen(member(json, "nodes").size(), false);
        const auto push_all = [&](const GltfJson& list, const Frame& frame) {
            for (auto node = list.rbegin(); node != list.rend(); ++node) stack.emplace_back(*node, frame);
        };
        push_all(member(scene, "nodes"), {glm::dmat3(1.0), dvec3(0.0)});
        while (!stack.empty()) {
            const auto [name, parent] = std::move(stack.back());
            stack.pop_back();
            const std::optional<std::uint64_t> index = name.is_number_unsigned() ? std::optional(name.get<std::uint64_t>()) : std::nullopt;
            const GltfJson& node = item(json, "nodes", index);
            const std::optional<Frame> own = frame_of(node);
            if (!node.is_object() || !own) return builder_.parse_error("has a node that is none");
            if (seen[*index]) return builder_.parse_error("reaches node " + std::to_string(*index) + " twice");
            seen[*index] = true;
            const Frame frame{parent.first * own->first, parent.first * own->second + parent.second};
            if (Status status = read_mesh_of(node, frame); !status) return status;
            push_all(member(node, "children"), frame);
        }
        return {};
    }

private:
    Status read_mesh_of(const GltfJson& node, const Frame& frame) {
        if (member(node, "mesh").is_null()) return {};
        const GltfJson& mesh = item(document_.json(), "meshes", whole_member(node, "mesh"));
        if (!member(mesh, "primitives").is_array()) return builder_.parse_error("has a node with a mesh that is not there");
        for (const GltfJson& primitive : member(mesh, "primitives")) {
            const std::uint64_t mode = member(primitive, "mode").is_null() ? kTriangles : whole_member(primitive, "mode").value_or(7);
            if (mode > kFan) return builder_.parse_error("has a primitive of no known mode");
            if (mode < kTriangles) continue;  // points and lines
            if (Status status = read_primitive(primitive, mode, frame); !status) return status;
        }
        return {};
    }

    Status read_primitive(const GltfJson& primitive, std::uint64_t mode, const Frame& frame) {
        const Result<GltfArray> positions = document_.array(whole_member(member(primitive, "attributes"), "POSITION"), "VEC3", builder_);
        if (!positions) return positions.error();
        std::optional<GltfArray> indices;
        if (!member(primitive, "indices").is_null()) {
            const Result<GltfArray> read = document_.array(whole_member(primitive, "indices"), "SCALAR", builder_);
            if (!read) return read.error();
            indices = *read;
        }
        const std::size_t corners = indices ? indices->count : positions->count;
        done_ += corners + positions->count;
        if (done_ > kMostCorners) return Error{ErrorCode::InvalidArgument, "has more than 2^28 triangles", builder_.parse_error("").where};
        const auto first = static_cast<std::uint32_t>(builder_.vertex_count());
        for (std::size_t i = 0; i < positions->count; ++i) {
            const std::string_view p = positions->bytes.substr(i * positions->stride);
            const dvec3 own(load<float>(p, false), load<float>(p.substr(4), false), load<float>(p.substr(8), false));
            if (!builder_.add_vertex(frame.first * own + frame.second)) return builder_.not_finite();
        }
        const bool mirrored = glm::determinant(frame.first) < 0.0;
        const std::size_t step = mode == kTriangles ? 3 : 1;
        for (std::size_t i = 0; i + 3 <= corners; i += step) {
            std::array<std::uint32_t, 3> t{};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t at = mode == kFan && k == 0 ? 0 : i + k;
                const std::uint64_t index = indices ? index_at(*indices, at) : at;
                if (index >= positions->count) return builder_.parse_error("has an index beyond its positions");
                t[k] = first + static_cast<std::uint32_t>(index);
            }
            if (mirrored != (mode == kStrip && i % 2 == 1)) std::swap(t[1], t[2]);
            if (const char* problem = builder_.add_face(t)) return builder_.parse_error(problem);
        }
        return {};
    }

    static std::uint64_t index_at(const GltfArray& indices, std::size_t i) {
        const std::string_view bytes = indices.bytes.substr(i * indices.stride);
        if (indices.component == kGltfUint8) return load<std::uint8_t>(bytes, false);
        return indices.component == kGltfUint16 ? load<std::uint16_t>(bytes, false) : load<std::uint32_t>(bytes, false);
    }

    const GltfDocument& document_;
    MeshBuilder& builder_;
    std::uint64_t done_ = 0;
};

}  // namespace

Status read_gltf(std::string_view contents, const std::string& path, MeshBuilder& builder) {
    const Result<GltfDocument> document = GltfDocument::open(contents, path, builder);
    return document ? SceneReader(*document, builder).read() : Status(document.error());
}

}  // namespace carom
