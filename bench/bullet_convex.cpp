#include <carom/bench/bullet_convex.hpp>

#include <carom/collision/convex_hull.hpp>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btContinuousConvexCollision.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <LinearMath/btScalar.h>
#include <LinearMath/btTransform.h>
#include <fmt/format.h>

namespace carom::bench {
namespace {

template <class V>
btVector3 to_bt(const V& v) {
    return {btScalar(v.x), btScalar(v.y), btScalar(v.z)};
}

btTransform to_bt(const Pose& pose) {
    const dquat& q = pose.orientation;
    return btTransform(btQuaternion(btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)), to_bt(pose.position));
}

}  // namespace

struct BulletMotion::Data {
    btTransform from, to;
};

BulletMotion::BulletMotion(const RigidMotion& motion)
    : data_(std::make_unique<Data>(Data{to_bt(motion.start), to_bt(pose_at(motion, 1.0))})) {}
BulletMotion::~BulletMotion() = default;
BulletMotion::BulletMotion(BulletMotion&&) noexcept = default;

struct BulletConvex::Geometry {
    std::unique_ptr<btConvexShape> shape;
};

BulletConvex::BulletConvex(const Shape& shape) : geometry_(std::make_unique<Geometry>()) {
    if (const Sphere* ball = std::get_if<Sphere>(&shape)) {
        geometry_->shape = std::make_unique<btSphereShape>(btScalar(ball->radius));
    } else if (const Box* box = std::get_if<Box>(&shape)) {
        geometry_->shape = std::make_unique<btBoxShape>(to_bt(box->half_extents));
        geometry_->shape->setMargin(btScalar(0));
    } else {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const vec3& v : std::get<ConvexHullPtr>(shape)->vertices()) hull->addPoint(to_bt(v), false);
        hull->recalcLocalAabb();
        hull->setMargin(btScalar(0));
        geometry_->shape = std::move(hull);
    }
}
BulletConvex::~BulletConvex() = default;
BulletConvex::BulletConvex(BulletConvex&&) noexcept = default;

BulletImpact BulletConvex::cast(const BulletConvex& other, const BulletMotion& here, const BulletMotion& there) const {
    btVoronoiSimplexSolver simplex;
    btSubsimplexConvexCast search(geometry_->shape.get(), other.geometry_->shape.get(), &simplex);
    btConvexCast::CastResult result;
    result.m_fraction = btScalar(1);
    const bool met = search.calcTimeOfImpact(here.data_->from, here.data_->to, there.data_->from, there.data_->to, result);
    return {met, static_cast<double>(result.m_fraction)};
}

BulletImpact BulletConvex::time_of_impact(const BulletConvex& other, const BulletMotion& here, const BulletMotion& there) const {
    btVoronoiSimplexSolver simplex;
    btGjkEpaPenetrationDepthSolver depth;
    btContinuousConvexCollision search(geometry_->shape.get(), other.geometry_->shape.get(), &simplex, &depth);
    btConvexCast::CastResult result;
    result.m_fraction = btScalar(1);
    const bool met = search.calcTimeOfImpact(here.data_->from, here.data_->to, there.data_->from, there.data_->to, result);
    return {met, static_cast<double>(result.m_fraction)};
}

std::string BulletConvex::version() { return fmt::format("{}.{}", btGetVersion() / 100, btGetVersion() % 100); }

}  // namespace carom::bench
