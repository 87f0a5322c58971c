#include <carom/narrowphase/collide.hpp>

namespace carom {
namespace {

bool is_convex(ShapeType type) noexcept { return type != ShapeType::Plane && type != ShapeType::TriangleMesh; }

}  // namespace

bool can_collide(ShapeType a, ShapeType b) noexcept { return is_convex(a) || is_convex(b); }

}  // namespace carom
