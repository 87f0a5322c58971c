// Bullet, from its single-precision build: the world that its own examples make, with margins and iterations left alone.
#include <carom/studies/peers/engines.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <btBulletDynamicsCommon.h>

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>
#include <utility>

namespace carom::peers {
namespace {

using accuracy::Engine;
using accuracy::FixedShape;
using accuracy::MovingBody;
using accuracy::SceneBodies;

static_assert(sizeof(btScalar) == sizeof(float), "the comparison is with Bullet's single-precision build");

btScalar to_bt(double x) { return static_cast<btScalar>(x); }
btVector3 to_bt(const dvec3& v) { return {to_bt(v.x), to_bt(v.y), to_bt(v.z)}; }
btTransform to_bt(const Pose& pose) {
    const dquat& q = pose.orientation;
    return btTransform{btQuaternion{to_bt(q.x), to_bt(q.y), to_bt(q.z), to_bt(q.w)}, to_bt(pose.position)};
}
dvec3 from_bt(const btVector3& v) { return {double{v.x()}, double{v.y()}, double{v.z()}}; }

// The arrays that a btBvhTriangleMeshShape reads for as long as it lives.
struct MeshArrays {
    explicit MeshArrays(const TriangleMesh& mesh)
        : vertices(mesh.vertices().begin(), mesh.vertices().end()) {
        for (const TriangleMesh::Triangle& triangle : mesh.triangles()) {
            for (const std::uint32_t corner : triangle) indices.push_back(static_cast<int>(corner));
        }
        view = std::make_unique<btTriangleIndexVertexArray>(
            static_cast<int>(indices.size() / 3), indices.data(), static_cast<int>(3 * sizeof(int)),
            static_cast<int>(vertices.size()), &vertices[0].x, static_cast<int>(sizeof(vec3)));
    }
    std::vector<vec3> vertices;
    std::vector<int> indices;
    std::unique_ptr<btTriangleIndexVertexArray> view;
};

class BulletEngine final : public Engine {
public:
    explicit BulletEngine(const SceneBodies& bodies)
        : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
        world_.setGravity(to_bt(bodies.gravity));
        for (const FixedShape& fixed : bodies.fixed) {
            add({0.0f, nullptr, make_shape(fixed.shape, Pose{})}, fixed.pose, fixed.friction, fixed.restitution);
        }
        for (const MovingBody& moving : bodies.moving) add_moving(moving);
    }

    ~BulletEngine() override {
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    }

    std::string name() const override { return "bullet"; }
    std::string version() const override { return fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100); }
    void step(double dt) override { world_.stepSimulation(to_bt(dt), 0); }

    Pose pose(std::size_t index) const override {
        const btTransform& t = moving_[index].body->getWorldTransform();
        const btQuaternion q = t.getRotation();
        const Pose mass{from_bt(t.getOrigin()),
                        glm::normalize(dquat{double{q.w()}, double{q.x()}, double{q.y()}, double{q.z()}})};
        return mass * moving_[index].shape_in_mass;
    }
    dvec3 velocity(std::size_t index) const override { return from_bt(moving_[index].body->getLinearVelocity()); }
    dvec3 spin(std::size_t index) const override { return from_bt(moving_[index].body->getAngularVelocity()); }

private:
    struct Moving {
        btRigidBody* body;
        Pose shape_in_mass;
    };

    void add_moving(const MovingBody& moving) {
        // A box, sphere or capsule is in the frame of its mass already; only a hull's points are moved there.
        btRigidBody& body = add({to_bt(moving.mass), nullptr, make_shape(moving.shape, moving.shape_in_mass), to_bt(moving.moments)},
                                moving.pose, moving.friction, moving.restitution);
        body.setLinearVelocity(to_bt(moving.linear_velocity));
        body.setAngularVelocity(to_bt(moving.angular_velocity));
        body.setActivationState(DISABLE_DEACTIVATION);
        moving_.push_back({&body, moving.shape_in_mass});
    }

    btRigidBody& add(btRigidBody::btRigidBodyConstructionInfo info, const Pose& pose, double friction, double restitution) {
        info.m_startWorldTransform = to_bt(pose);
        info.m_friction = to_bt(std::sqrt(friction));  // Bullet multiplies the two, of both: this gives the geometric mean
        info.m_restitution = to_bt(std::sqrt(restitution));
        bodies_.push_back(std::make_unique<btRigidBody>(info));
        world_.addRigidBody(bodies_.back().get());
        return *bodies_.back();
    }

    btCollisionShape* make_shape(const Shape& shape, const Pose& placed) {
        switch (type_of(shape)) {
            case ShapeType::Sphere: return keep<btSphereShape>(std::get<Sphere>(shape).radius);
            case ShapeType::Box: return keep<btBoxShape>(to_bt(dvec3(std::get<Box>(shape).half_extents)));
            case ShapeType::Capsule: {
                const Capsule& capsule = std::get<Capsule>(shape);
                return keep<btCapsuleShape>(capsule.radius, 2.0f * capsule.half_segment);
            }
            case ShapeType::ConvexHull: {
                auto* hull = keep<btConvexHullShape>();
                for (const vec3& v : std::get<ConvexHullPtr>(shape)->vertices()) {
                    hull->addPoint(to_bt(transform_point(placed, dvec3(v))), false);
                }
                hull->recalcLocalAabb();
                return hull;
            }
            case ShapeType::TriangleMesh: {
                meshes_.push_back(std::make_unique<MeshArrays>(*std::get<TriangleMeshPtr>(shape)));
                return keep<btBvhTriangleMeshShape>(meshes_.back()->view.get(), true);
            }
            case ShapeType::Cylinder:
            case ShapeType::Cone:
            case ShapeType::Compound:
            case ShapeType::Plane: break;
        }
        throw std::invalid_argument(fmt::format("bullet: the scenes compared have no {}", to_string(type_of(shape))));
    }

    template <class T, class... Arguments>
    T* keep(Arguments&&... arguments) {
        auto shape = std::make_unique<T>(std::forward<Arguments>(arguments)...);
        T* raw = shape.get();
        shapes_.push_back(std::move(shape));
        return raw;
    }

    // In order of use: Bullet holds plain pointers from each to what stands above it.
    std::vector<std::unique_ptr<MeshArrays>> meshes_;
    std::vector<std::unique_ptr<btCollisionShape>> shapes_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<Moving> moving_;
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_;
};

}  // namespace

std::unique_ptr<accuracy::Engine> make_bullet(const accuracy::SceneBodies& bodies) { return std::make_unique<BulletEngine>(bodies); }

}  // namespace carom::peers
