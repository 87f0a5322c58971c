// A triangle mesh as FCL knows it: a hierarchy of oriented boxes with swept spheres.
//
//   FclMesh mesh(data);
//   std::size_t pairs = mesh.pairs_with(mesh, b_in_a, FclMesh::kAll);
#pragma once

#include <carom/collision/mesh_data.hpp>
#include <carom/core/pose.hpp>

#include <cstddef>
#include <limits>
#include <memory>

namespace carom::bench {

class FclMesh {
public:
    static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
    explicit FclMesh(const MeshData& mesh);
    ~FclMesh();
    /// @param most  stop at that many. @return how many pairs of triangles FCL finds.
    [[nodiscard]] std::size_t pairs_with(const FclMesh& other, const Pose& other_in_this, std::size_t most) const;
    [[nodiscard]] static const char* version() noexcept;

private:
    struct Model;
    std::unique_ptr<Model> model_;
};

}  // namespace carom::bench
