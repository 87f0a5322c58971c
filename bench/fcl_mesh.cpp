#include <carom/bench/fcl_mesh.hpp>

#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/OBBRSS.h>
#include <fcl/narrowphase/collision.h>

#include <vector>

namespace carom::bench {

struct FclMesh::Model {
    std::shared_ptr<fcl::BVHModel<fcl::OBBRSS<double>>> bvh = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
};

FclMesh::FclMesh(const MeshData& mesh) : model_(std::make_unique<Model>()) {
    std::vector<fcl::Vector3<double>> vertices;
    std::vector<fcl::Triangle> triangles;
    for (const vec3& v : mesh.vertices) vertices.emplace_back(double(v.x), double(v.y), double(v.z));
    for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    model_->bvh->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    model_->bvh->addSubModel(vertices, triangles);
    model_->bvh->endModel();
}
FclMesh::~FclMesh() = default;

std::size_t FclMesh::pairs_with(const FclMesh& other, const Pose& other_in_this, std::size_t most) const {
    fcl::Transform3<double> placed = fcl::Transform3<double>::Identity();
    const dquat& q = other_in_this.orientation;
    const dvec3& p = other_in_this.position;
    placed.linear() = fcl::Quaternion<double>(q.w, q.x, q.y, q.z).toRotationMatrix();
    placed.translation() = fcl::Vector3<double>(p.x, p.y, p.z);
    const fcl::CollisionRequest<double> request(most, false);
    fcl::CollisionResult<double> result;
    fcl::collide(model_->bvh.get(), fcl::Transform3<double>::Identity(), other.model_->bvh.get(), placed, request, result);
    return result.numContacts();
}

const char* FclMesh::version() noexcept { return FCL_VERSION; }

}  // namespace carom::bench
