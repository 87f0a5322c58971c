// Collects what the readers of mesh files find: positions, and faces that it cuts into triangles.
//
//   if (!builder.add_vertex(p)) ...                         // not finite
//   if (const char* problem = builder.add_face(corners)) return error(problem);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/result.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace carom {

class MeshBuilder {
public:
    explicit MeshBuilder(std::string where) : where_(std::move(where)) {}

    void reserve(std::size_t vertices, std::size_t triangles);
    [[nodiscard]] std::size_t vertex_count() const noexcept { return mesh_.vertices.size(); }

    /// A position in any precision. @return false if no finite float is near it; it is not added then.
    [[nodiscard]] bool add_vertex(const dvec3& position);
    /// A face; fewer than three corners leave nothing. Corners must be of vertices that are there already.
    /// @return what is wrong with it, in words; nullptr if nothing is.
    [[nodiscard]] const char* add_face(std::span<const std::uint32_t> corners);

    [[nodiscard]] Error parse_error(const std::string& message) const { return {ErrorCode::Parse, message, where_}; }
    [[nodiscard]] Error unsupported(const std::string& message) const { return {ErrorCode::WrongType, message, where_}; }
    /// Of the vertex that would come next.
    [[nodiscard]] Error not_finite() const;
    /// @return the mesh, which the builder loses; Empty without triangles, InvalidArgument for too many.
    [[nodiscard]] Result<MeshData> finish();

private:
    void add_concave(std::span<const std::uint32_t> corners, const dvec3& normal);
    MeshData mesh_;
    std::string where_;
    std::vector<std::uint32_t> rest_;  // corners of the face at hand that are not clipped yet
};

}  // namespace carom
