#include <carom/collision/shapes.hpp>

namespace carom {

const char* to_string(ShapeType type) noexcept {
    switch (type) {
        case ShapeType::Sphere: return "sphere";
        case ShapeType::Box: return "box";
        case ShapeType::Capsule: return "capsule";
        case ShapeType::Plane: return "plane";
        case ShapeType::ConvexHull: return "convex_hull";
        case ShapeType::TriangleMesh: return "triangle_mesh";
    }
    return "unknown";
}

}  // namespace carom
