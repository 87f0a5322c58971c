#include <carom/collision/detail/check_mesh.hpp>

#include <carom/collision/detail/wide_bvh.hpp>

#include <string>

namespace carom {

Status check_mesh(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles, const char* where) {
    if (triangles.empty()) return Error{ErrorCode::Empty, "a mesh needs at least one triangle", where};
    if (triangles.size() > WideBvh::kMaxTriangles) {
        return Error{ErrorCode::InvalidArgument, "a mesh holds at most 2^28 triangles", where};
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!is_finite(vertices[i])) return Error{ErrorCode::NotFinite, "vertex " + std::to_string(i) + " is not finite", where};
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (const std::uint32_t v : triangles[i]) {
            if (v < vertices.size()) continue;
            return Error{ErrorCode::InvalidArgument,
                         "triangle " + std::to_string(i) + " names vertex " + std::to_string(v) + " of " + std::to_string(vertices.size()),
                         where};
        }
    }
    return {};
}

}  // namespace carom
