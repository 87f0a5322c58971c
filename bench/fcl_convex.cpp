#include <carom/bench/fcl_convex.hpp>

#include <carom/collision/convex_hull.hpp>

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/math/motion/interp_motion.h>
#include <fcl/math/motion/translation_motion.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/continuous_collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <exception>
#include <vector>

namespace carom::bench {

namespace {

fcl::Transform3<double> to_fcl(const Pose& pose) {
    const dquat& q = pose.orientation;
    const dvec3& p = pose.position;
    fcl::Transform3<double> transform = fcl::Transform3<double>::Identity();
    transform.linear() = fcl::Quaternion<double>(q.w, q.x, q.y, q.z).toRotationMatrix();
    transform.translation() = fcl::Vector3<double>(p.x, p.y, p.z);
    return transform;
}

}  // namespace

struct FclPlace::Data {
    fcl::Transform3<double> transform = fcl::Transform3<double>::Identity();
};

FclPlace::FclPlace(const Pose& pose) : data_(std::make_unique<Data>()) { data_->transform = to_fcl(pose); }
FclPlace::~FclPlace() = default;
FclPlace::FclPlace(FclPlace&&) noexcept = default;

struct FclMotion::Data {
    std::unique_ptr<fcl::MotionBase<double>> motion;
    bool turns = false;
};

FclMotion::FclMotion(const RigidMotion& motion) : data_(std::make_unique<Data>()) {
    const fcl::Transform3<double> from = to_fcl(motion.start), to = to_fcl(pose_at(motion, 1.0));
    data_->turns = motion.rotation != dvec3{0.0};
    if (!data_->turns) {
        data_->motion = std::make_unique<fcl::TranslationMotion<double>>(from, to);
    } else {
        data_->motion = std::make_unique<fcl::InterpMotion<double>>(from, to);
    }
}
FclMotion::~FclMotion() = default;
FclMotion::FclMotion(FclMotion&&) noexcept = default;

struct FclConvex::Geometry {
    std::unique_ptr<fcl::CollisionGeometry<double>> shape;
};

FclConvex::FclConvex(const Shape& shape) : geometry_(std::make_unique<Geometry>()) {
    if (const Box* box = std::get_if<Box>(&shape)) {
        const dvec3 side = 2.0 * dvec3(box->half_extents);
        geometry_->shape = std::make_unique<fcl::Box<double>>(side.x, side.y, side.z);
    } else if (const Sphere* ball = std::get_if<Sphere>(&shape)) {
        geometry_->shape = std::make_unique<fcl::Sphere<double>>(static_cast<double>(ball->radius));
    } else {
        const ConvexHull& hull = *std::get<ConvexHullPtr>(shape);
        const auto vertices = std::make_shared<std::vector<fcl::Vector3<double>>>();
        for (const vec3& v : hull.vertices()) vertices->emplace_back(double(v.x), double(v.y), double(v.z));
        const auto faces = std::make_shared<std::vector<int>>();
        for (const ConvexHull::Face& face : hull.faces()) {
            faces->push_back(static_cast<int>(face.edge_count));
            std::uint32_t e = face.first_edge;
            for (std::uint32_t k = 0; k < face.edge_count; ++k, e = hull.edges()[e].next) {
                faces->push_back(static_cast<int>(hull.edges()[e].origin));
            }
        }
        geometry_->shape = std::make_unique<fcl::Convex<double>>(vertices, static_cast<int>(hull.faces().size()), faces);
    }
    geometry_->shape->computeLocalAABB();
}
FclConvex::~FclConvex() = default;
FclConvex::FclConvex(FclConvex&&) noexcept = default;

bool FclConvex::overlaps(const FclConvex& other, const FclPlace& here, const FclPlace& there) const {
    const fcl::CollisionRequest<double> request(1, false);
    fcl::CollisionResult<double> result;
    return fcl::collide(geometry_->shape.get(), here.data_->transform, other.geometry_->shape.get(), there.data_->transform, request, result) > 0;
}

std::optional<double> FclConvex::depth(const FclConvex& other, const FclPlace& here, const FclPlace& there) const {
    try {
        const fcl::CollisionRequest<double> request(1, true);
        fcl::CollisionResult<double> result;
        fcl::collide(geometry_->shape.get(), here.data_->transform, other.geometry_->shape.get(), there.data_->transform, request, result);
        double most = 0.0;
        for (std::size_t i = 0; i < result.numContacts(); ++i) most = std::max(most, result.getContact(i).penetration_depth);
        return most;
    } catch (const std::exception&) {
        return {};
    }
}

std::optional<double> FclConvex::distance(const FclConvex& other, const FclPlace& here, const FclPlace& there) const {
    try {
        const fcl::DistanceRequest<double> request(true);
        fcl::DistanceResult<double> result;
        return fcl::distance(geometry_->shape.get(), here.data_->transform, other.geometry_->shape.get(), there.data_->transform, request, result);
    } catch (const std::exception&) {
        return {};
    }
}

FclImpact FclConvex::time_of_impact(const FclConvex& other, const FclMotion& here, const FclMotion& there) const {
    try {
        const fcl::MotionBase<double>&a = *here.data_->motion, &b = *there.data_->motion;
        a.integrate(0.0);  // from where the last search left them
        b.integrate(0.0);
        fcl::ContinuousCollisionRequest<double> request;
        request.ccd_solver_type = fcl::CCDC_CONSERVATIVE_ADVANCEMENT;
        // On what turns, libccd's assertions end the program (FCL 0.7 of Debian 12).
        if (here.data_->turns || there.data_->turns) request.gjk_solver_type = fcl::GST_INDEP;
        fcl::ContinuousCollisionResult<double> result;
        fcl::continuousCollide(geometry_->shape.get(), &a, other.geometry_->shape.get(), &b, request, result);
        return {result.is_collide, result.time_of_contact, false};
    } catch (const std::exception&) {
        return {false, 1.0, true};
    }
}

}  // namespace carom::bench
