#include <carom/collision/shapes.hpp>

#include <cmath>
#include <string>

namespace carom {
namespace {

Error failure(ErrorCode code, std::string message) { return {code, std::move(message), "validate(Shape)"}; }

Status check_positive(float value, const char* field) {
    if (!is_finite(value)) return failure(ErrorCode::NotFinite, std::string(field) + " is not finite");
    if (!(value > 0.0f)) return failure(ErrorCode::InvalidArgument, std::string(field) + " must be greater than 0");
    return {};
}

Status check(const Sphere& sphere) { return check_positive(sphere.radius, "Sphere::radius"); }

Status check(const Box& box) {
    if (Status status = check_positive(box.half_extents.x, "Box::half_extents.x"); !status) return status;
    if (Status status = check_positive(box.half_extents.y, "Box::half_extents.y"); !status) return status;
    return check_positive(box.half_extents.z, "Box::half_extents.z");
}

Status check(const Capsule& capsule) {
    if (Status status = check_positive(capsule.radius, "Capsule::radius"); !status) return status;
    if (!is_finite(capsule.half_segment)) return failure(ErrorCode::NotFinite, "Capsule::half_segment is not finite");
    if (capsule.half_segment < 0.0f) {
        return failure(ErrorCode::InvalidArgument, "Capsule::half_segment must not be negative");
    }
    return {};
}

Status check(const Plane& plane) {
    if (!is_finite(plane.normal)) return failure(ErrorCode::NotFinite, "Plane::normal is not finite");
    if (!is_finite(plane.offset)) return failure(ErrorCode::NotFinite, "Plane::offset is not finite");
    const dvec3 n{plane.normal};
    if (!(std::abs(std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z) - 1.0) <= 1e-5)) {
        return failure(ErrorCode::InvalidArgument, "Plane::normal must be of unit length");
    }
    return {};
}

Status check_turned(const char* name, float radius, float half_height) {
    const std::string type = name;
    if (Status status = check_positive(radius, (type + "::radius").c_str()); !status) return status;
    if (Status status = check_positive(half_height, (type + "::half_height").c_str()); !status) return status;
    // In double, where no quotient of floats overflows.
    const double ratio = static_cast<double>(radius) / static_cast<double>(half_height);
    if (ratio > static_cast<double>(kMaxSlenderness) || ratio * static_cast<double>(kMaxSlenderness) < 1.0) {
        return failure(ErrorCode::InvalidArgument, type + "::radius and half_height differ by more than a factor of 1e4");
    }
    return {};
}

Status check(const Cylinder& cylinder) { return check_turned("Cylinder", cylinder.radius, cylinder.half_height); }

Status check(const Cone& cone) { return check_turned("Cone", cone.radius, cone.half_height); }

Status check(const CompoundPtr& compound) {
    if (!compound) return failure(ErrorCode::Empty, "CompoundPtr is null");
    return {};
}

Status check(const ConvexHullPtr& hull) {
    if (!hull) return failure(ErrorCode::Empty, "ConvexHullPtr is null");
    return {};
}

Status check(const TriangleMeshPtr& mesh) {
    if (!mesh) return failure(ErrorCode::Empty, "TriangleMeshPtr is null");
    return {};
}

}  // namespace

const char* to_string(ShapeType type) noexcept {
    switch (type) {
        case ShapeType::Sphere: return "sphere";
        case ShapeType::Box: return "box";
        case ShapeType::Capsule: return "capsule";
        case ShapeType::Plane: return "plane";
        case ShapeType::ConvexHull: return "convex_hull";
        case ShapeType::TriangleMesh: return "triangle_mesh";
        case ShapeType::Cylinder: return "cylinder";
        case ShapeType::Cone: return "cone";
        case ShapeType::Compound: return "compound";
    }
    return "unknown";
}

Status validate(const Shape& shape) {
    return std::visit([](const auto& alternative) { return check(alternative); }, shape);
}

}  // namespace carom
