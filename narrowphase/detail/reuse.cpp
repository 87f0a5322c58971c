#include <carom/collision/aabb.hpp>
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/reuse.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

// How far the shape's points may be from its origin, by its box.
double reach_of(const Aabb& box) noexcept { return glm::length(glm::max(glm::abs(box.lower), glm::abs(box.upper))); }
double reach_of(const Shape& shape) {
    switch (type_of(shape)) {
        case ShapeType::Plane: return std::numeric_limits<double>::infinity();
        case ShapeType::TriangleMesh: return reach_of(std::get<TriangleMeshPtr>(shape)->local_bounds());
        case ShapeType::Compound: return reach_of(std::get<CompoundPtr>(shape)->local_bounds());
        default: return bounding_radius(shape);
    }
}

bool is_carried(const Shape& shape) {
    switch (type_of(shape)) {
        case ShapeType::Sphere:
        case ShapeType::Capsule:
        case ShapeType::Box:
        case ShapeType::Plane:
        case ShapeType::ConvexHull:
        case ShapeType::TriangleMesh: return true;
        case ShapeType::Compound: {
            const auto parts = std::get<CompoundPtr>(shape)->parts();
            return std::all_of(parts.begin(), parts.end(), [](const CompoundPart& part) { return is_carried(part.shape) && core_radius(part.shape) == 0.0; });
        }
        default: return false;
    }
}

}  // namespace

MotionLine motion_line(const Shape& shape, const Pose& before, const Pose& now) noexcept {
    MotionLine line;
    line.before[0][3] = static_cast<float>(core_radius(shape));
    const dvec3 motion = now.position - before.position;
    // Of the turn less the identity every term is small where the turn is, and nothing cancels.
    const dquat q = now.orientation * glm::conjugate(before.orientation);
    const bool turned = before.orientation != now.orientation && type_of(shape) != ShapeType::Sphere;  // a sphere looks the same
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, yz = q.y * q.z, zx = q.z * q.x;
    const dvec3 w = q.w * dvec3{q.x, q.y, q.z};
    const double rows[3][3] = {{-2.0 * (yy + zz), 2.0 * (xy - w.z), 2.0 * (zx + w.y)},
                               {2.0 * (xy + w.z), -2.0 * (xx + zz), 2.0 * (yz - w.x)},
                               {2.0 * (zx - w.y), 2.0 * (yz + w.x), -2.0 * (xx + yy)}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) line.turn[i][j] = turned ? static_cast<float>(rows[i][j]) : 0.0f;
        line.turn[i][3] = static_cast<float>(motion[i]);
        line.before[0][i] = static_cast<float>(before.position[i]);
        line.before[1][i] = static_cast<float>(before.position[i] - static_cast<double>(line.before[0][i]));
    }
    return line;
}

ShapeTrait trait_of(const Shape& shape) noexcept {
    const TriangleMeshPtr* const mesh = std::get_if<TriangleMeshPtr>(&shape);
    return {std::nextafter(static_cast<float>(reach_of(shape)), std::numeric_limits<float>::infinity()), is_carried(shape),
            mesh != nullptr && (*mesh)->is_one_sided()};
}

PairRecord record_of(const NumberedPair& pair, const ShapeTrait& a, const ShapeTrait& b, bool touches, bool undecided) noexcept {
    PairRecord record;
    record.reach = std::min(a.reach, b.reach);
    record.margin = pair.margin + pair.slack;
    record.a = pair.a;
    record.b = pair.b;
    // Pairs that were found together are not all looked at anew together.
    const auto share = static_cast<std::int32_t>(scrambled((std::uint64_t{pair.a} << 32) | pair.b) % (kMostReuses / 2));
    record.state = static_cast<std::int32_t>(kMostReuses) - 1 - share;
    if (b.reach < a.reach) record.state |= kBSmaller;
    if (undecided) record.state |= kUndecided;
    if (touches ? !(a.carried && b.carried) : a.one_sided || b.one_sided) record.state |= kRolls;
    return record;
}

}  // namespace carom::detail
