#include <carom/studies/peers/ray_peers.hpp>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <glm/geometric.hpp>

namespace carom::peers {
namespace {

btVector3 to_bt(const dvec3& v) { return {btScalar(v.x), btScalar(v.y), btScalar(v.z)}; }

/// A mesh in Bullet about its own origin; what it points to stays with it.
class BulletMesh {
public:
    explicit BulletMesh(const accuracy::RayCases& part)
        : vertices_(part.mesh->vertices().begin(), part.mesh->vertices().end()),
          triangles_(part.mesh->triangles().begin(), part.mesh->triangles().end()),
          middle_(0.5 * (part.mesh->local_bounds().lower + part.mesh->local_bounds().upper)),
          size_(glm::length(part.mesh->local_bounds().upper - part.mesh->local_bounds().lower)) {
        btIndexedMesh mesh;
        mesh.m_numTriangles = static_cast<int>(triangles_.size());
        mesh.m_triangleIndexBase = reinterpret_cast<const unsigned char*>(triangles_.data());
        mesh.m_triangleIndexStride = sizeof(triangles_[0]);
        mesh.m_numVertices = static_cast<int>(vertices_.size());
        mesh.m_vertexBase = reinterpret_cast<const unsigned char*>(vertices_.data());
        mesh.m_vertexStride = sizeof(vec3);
        mesh.m_vertexType = PHY_FLOAT;
        arrays_.addIndexedMesh(mesh, PHY_INTEGER);
        shape_ = std::make_unique<btBvhTriangleMeshShape>(&arrays_, true);
        object_.setCollisionShape(shape_.get());
    }

    /// @param direction  of length one.
    [[nodiscard]] std::optional<double> distance(const dvec3& origin, const dvec3& direction) {
        const double reach = glm::length(middle_ - origin) + size_;
        const btTransform from(btQuaternion::getIdentity(), to_bt(origin)),
            to(btQuaternion::getIdentity(), to_bt(origin + reach * direction));
        btCollisionWorld::ClosestRayResultCallback callback(from.getOrigin(), to.getOrigin());
        btCollisionWorld::rayTestSingle(from, to, &object_, shape_.get(), btTransform::getIdentity(), callback);
        if (!callback.hasHit()) return std::nullopt;
        return static_cast<double>(callback.m_closestHitFraction) * reach;
    }

private:
    std::vector<vec3> vertices_;
    std::vector<TriangleMesh::Triangle> triangles_;
    dvec3 middle_;
    double size_;
    btTriangleIndexVertexArray arrays_;
    std::unique_ptr<btBvhTriangleMeshShape> shape_;
    btCollisionObject object_;
};

accuracy::RayCaster caster(bool world_in_double) {
    const auto prepare = [world_in_double](const accuracy::RayCases& part) -> accuracy::RayCaster::Cast {
        return [mesh = std::make_shared<BulletMesh>(part), offset = part.offset, world_in_double](const Ray& ray) {
            return mesh->distance(relative_origin(ray, offset, world_in_double), glm::normalize(ray.direction));
        };
    };
    return {"bullet", {{"world", world_in_double ? "double" : "float"}, {"test", "float"}}, prepare};
}

}  // namespace

std::vector<accuracy::RayCaster> bullet_rays() { return {caster(true), caster(false)}; }

}  // namespace carom::peers
