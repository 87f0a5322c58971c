// ODE (Debian builds it in double precision): dWorldQuickStep with its own settings, contacts made in the usual callback. The space
// is its sweep-and-prune one: on a pyramid it makes the step twice as fast as the hash space.
#include <carom/studies/peers/engines.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <ode/ode.h>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace carom::peers {
namespace {

using accuracy::Engine;
using accuracy::FixedShape;
using accuracy::MovingBody;
using accuracy::SceneBodies;

constexpr int kMaxContacts = 8;  // of a pair; what ODE's own box against box makes at most

// ODE's capsules lie along z, ours along y: the rotation that carries z to y.
const Pose kCapsuleAxis{dvec3{0.0}, dquat{std::sqrt(0.5), -std::sqrt(0.5), 0.0, 0.0}};

dvec3 from_ode(const dReal* v) { return {v[0], v[1], v[2]}; }

// What a dConvex or dTriMesh reads for as long as it lives.
struct HullArrays {
    HullArrays(const ConvexHull& hull, const Pose& placed) {
        for (const vec3& v : hull.vertices()) {
            const dvec3 p = transform_point(placed, dvec3(v));
            points.insert(points.end(), {p.x, p.y, p.z});
        }
        for (const ConvexHull::Face& face : hull.faces()) {
            const dvec3 normal = rotate(placed.orientation, face.normal);
            planes.insert(planes.end(), {normal.x, normal.y, normal.z, face.offset + glm::dot(normal, placed.position)});
            polygons.push_back(face.edge_count);
            std::uint32_t edge = face.first_edge;
            for (std::uint32_t i = 0; i < face.edge_count; ++i, edge = hull.edges()[edge].next) {
                polygons.push_back(hull.edges()[edge].origin);
            }
        }
    }
    std::vector<dReal> points, planes;
    std::vector<unsigned> polygons;
};

struct MeshArrays {
    explicit MeshArrays(const TriangleMesh& mesh) : vertices(mesh.vertices().begin(), mesh.vertices().end()) {
        for (const TriangleMesh::Triangle& triangle : mesh.triangles()) {
            indices.insert(indices.end(), triangle.begin(), triangle.end());
        }
        data = dGeomTriMeshDataCreate();
        dGeomTriMeshDataBuildSingle(data, vertices.data(), sizeof(vec3), static_cast<int>(vertices.size()), indices.data(),
                                    static_cast<int>(indices.size()), 3 * sizeof(dTriIndex));
        dGeomTriMeshDataPreprocess2(data, 1u << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);  // convex against mesh needs it
    }
    MeshArrays(const MeshArrays&) = delete;
    MeshArrays& operator=(const MeshArrays&) = delete;
    ~MeshArrays() { dGeomTriMeshDataDestroy(data); }

    std::vector<vec3> vertices;
    std::vector<dTriIndex> indices;
    dTriMeshDataID data;
};

// ODE's process-wide state, alive as long as any engine.
struct Library {
    Library() { dInitODE2(0); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
    ~Library() { dCloseODE(); }
};

class OdeEngine final : public Engine {
public:
    explicit OdeEngine(const SceneBodies& bodies)
        : world_(dWorldCreate()), moving_space_(dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY)), fixed_space_(dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY)),
          joints_(dJointGroupCreate(0)) {
        dWorldSetGravity(world_, bodies.gravity.x, bodies.gravity.y, bodies.gravity.z);
        dRandSetSeed(0);  // QuickStep shuffles its rows
        materials_.reserve(bodies.fixed.size() + bodies.moving.size());  // geoms point into it
        for (const FixedShape& fixed : bodies.fixed) {
            const Made made = make_geom(fixed_space_, fixed.shape, Pose{});
            const Pose pose = fixed.pose * made.offset;
            const dQuaternion q{pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z};
            dGeomSetPosition(made.geom, pose.position.x, pose.position.y, pose.position.z);
            dGeomSetQuaternion(made.geom, q);
            set_material(made.geom, {fixed.friction, fixed.restitution});
        }
        for (const MovingBody& moving : bodies.moving) add_moving(moving);
    }

    ~OdeEngine() override {
        dJointGroupDestroy(joints_);
        dSpaceDestroy(moving_space_);
        dSpaceDestroy(fixed_space_);
        dWorldDestroy(world_);
    }

    std::string name() const override { return "ode"; }
    std::string version() const override { return dODE_VERSION; }

    void step(double dt) override {
        dSpaceCollide(moving_space_, this, add_contacts);
        dSpaceCollide2(reinterpret_cast<dGeomID>(moving_space_), reinterpret_cast<dGeomID>(fixed_space_), this, add_contacts);
        dWorldQuickStep(world_, dt);
        dJointGroupEmpty(joints_);
    }

    Pose pose(std::size_t index) const override {
        const dReal* q = dBodyGetQuaternion(moving_[index].body);
        const Pose mass{from_ode(dBodyGetPosition(moving_[index].body)), glm::normalize(dquat{q[0], q[1], q[2], q[3]})};
        return mass * moving_[index].shape_in_mass;
    }
    dvec3 velocity(std::size_t index) const override { return from_ode(dBodyGetLinearVel(moving_[index].body)); }
    dvec3 spin(std::size_t index) const override { return from_ode(dBodyGetAngularVel(moving_[index].body)); }

private:
    struct Moving {
        dBodyID body;
        Pose shape_in_mass;
    };
    struct Material {
        double friction = 0.0, restitution = 0.0;
    };
    struct Made {
        dGeomID geom;
        Pose offset;  ///< of ODE's geom in the frame that it was placed in
    };

    static void add_contacts(void* self, dGeomID a, dGeomID b) {
        if (dGeomIsSpace(a) || dGeomIsSpace(b)) {
            dSpaceCollide2(a, b, self, add_contacts);
            return;
        }
        const OdeEngine& engine = *static_cast<const OdeEngine*>(self);
        std::array<dContact, kMaxContacts> contacts;
        const int count = dCollide(a, b, kMaxContacts, &contacts[0].geom, sizeof(dContact));
        const Material &of_a = *static_cast<const Material*>(dGeomGetData(a)), &of_b = *static_cast<const Material*>(dGeomGetData(b));
        const double friction = std::sqrt(of_a.friction * of_b.friction), restitution = std::max(of_a.restitution, of_b.restitution);
        for (int i = 0; i < count; ++i) {
            // A hull that just touches a box is given a normal of zero; ODE would end the process on it.
            if (!(glm::length(from_ode(contacts[static_cast<std::size_t>(i)].geom.normal)) > 0.5)) continue;
            dSurfaceParameters& surface = contacts[static_cast<std::size_t>(i)].surface;
            surface = {};
            surface.mode = dContactApprox1;  // mu is a coefficient, not a limit of force
            surface.mu = friction;
            if (restitution > 0.0) surface.mode |= dContactBounce, surface.bounce = restitution;
            const dJointID joint = dJointCreateContact(engine.world_, engine.joints_, &contacts[static_cast<std::size_t>(i)]);
            dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
        }
    }

    void add_moving(const MovingBody& moving) {
        const dBodyID body = dBodyCreate(world_);
        dMass mass;
        dMassSetParameters(&mass, moving.mass, 0, 0, 0, moving.moments.x, moving.moments.y, moving.moments.z, 0, 0, 0);
        dBodySetMass(body, &mass);
        const dquat& q = moving.pose.orientation;
        const dQuaternion rotation{q.w, q.x, q.y, q.z};
        dBodySetPosition(body, moving.pose.position.x, moving.pose.position.y, moving.pose.position.z);
        dBodySetQuaternion(body, rotation);
        dBodySetLinearVel(body, moving.linear_velocity.x, moving.linear_velocity.y, moving.linear_velocity.z);
        dBodySetAngularVel(body, moving.angular_velocity.x, moving.angular_velocity.y, moving.angular_velocity.z);

        // A box, sphere or capsule is in the frame of its mass already; only a hull's points are moved there.
        const Made made = make_geom(moving_space_, moving.shape, moving.shape_in_mass);
        dGeomSetBody(made.geom, body);
        if (made.offset != Pose{}) {
            const dquat& o = made.offset.orientation;
            const dQuaternion offset{o.w, o.x, o.y, o.z};
            dGeomSetOffsetQuaternion(made.geom, offset);
        }
        set_material(made.geom, {moving.friction, moving.restitution});
        moving_.push_back({body, moving.shape_in_mass});
    }

    void set_material(dGeomID geom, const Material& material) {
        materials_.push_back(material);
        dGeomSetData(geom, &materials_.back());
    }

    Made make_geom(dSpaceID space, const Shape& shape, const Pose& placed) {
        switch (type_of(shape)) {
            case ShapeType::Sphere: return {dCreateSphere(space, double{std::get<Sphere>(shape).radius}), {}};
            case ShapeType::Box: {
                const dvec3 size = 2.0 * dvec3(std::get<Box>(shape).half_extents);
                return {dCreateBox(space, size.x, size.y, size.z), {}};
            }
            case ShapeType::Capsule: {
                const Capsule& capsule = std::get<Capsule>(shape);
                return {dCreateCapsule(space, double{capsule.radius}, 2.0 * double{capsule.half_segment}), kCapsuleAxis};
            }
            case ShapeType::ConvexHull: {
                hulls_.push_back(std::make_unique<HullArrays>(*std::get<ConvexHullPtr>(shape), placed));
                HullArrays& hull = *hulls_.back();
                return {dCreateConvex(space, hull.planes.data(), static_cast<unsigned>(hull.planes.size() / 4), hull.points.data(),
                                      static_cast<unsigned>(hull.points.size() / 3), hull.polygons.data()),
                        {}};
            }
            case ShapeType::TriangleMesh:
                meshes_.push_back(std::make_unique<MeshArrays>(*std::get<TriangleMeshPtr>(shape)));
                return {dCreateTriMesh(space, meshes_.back()->data, nullptr, nullptr, nullptr), {}};
            case ShapeType::Cylinder:
            case ShapeType::Cone:
            case ShapeType::Compound:
            case ShapeType::Plane: break;
        }
        throw std::invalid_argument(fmt::format("ode: the scenes compared have no {}", to_string(type_of(shape))));
    }

    Library library_;
    std::vector<std::unique_ptr<HullArrays>> hulls_;
    std::vector<std::unique_ptr<MeshArrays>> meshes_;
    std::vector<Material> materials_;
    dWorldID world_;
    dSpaceID moving_space_, fixed_space_;
    dJointGroupID joints_;
    std::vector<Moving> moving_;
};

}  // namespace

std::unique_ptr<accuracy::Engine> make_ode(const accuracy::SceneBodies& bodies) { return std::make_unique<OdeEngine>(bodies); }

}  // namespace carom::peers
