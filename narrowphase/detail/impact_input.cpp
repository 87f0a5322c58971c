#include <carom/narrowphase/detail/impact_input.hpp>

#include <cmath>
#include <variant>

namespace carom::detail {
namespace {

bool within(const dvec3& v, double bound) noexcept { return std::abs(v.x) <= bound && std::abs(v.y) <= bound && std::abs(v.z) <= bound; }

bool is_size(float x) noexcept { return is_finite(x) && x >= 0.0f; }
bool sized(const Sphere& s) noexcept { return is_size(s.radius); }
bool sized(const Box& b) noexcept { return is_size(b.half_extents.x) && is_size(b.half_extents.y) && is_size(b.half_extents.z); }
bool sized(const Capsule& c) noexcept { return is_size(c.radius) && is_size(c.half_segment); }
bool sized(const Cylinder& c) noexcept { return is_size(c.radius) && is_size(c.half_height); }
bool sized(const Cone& c) noexcept { return is_size(c.radius) && is_size(c.half_height); }
bool sized(const Plane& p) noexcept { return is_finite(p.normal) && is_finite(p.offset) && p.normal != vec3{0.0f}; }
template <class Pointer>
bool sized(const Pointer&) noexcept {
    return true;  // checked when it was built, or for null by query_fault()
}

}  // namespace

bool fit(const Pose& pose) noexcept { return is_finite(pose.orientation) && within(pose.position, kLargestLength); }

bool fit(const RigidMotion& m) noexcept {
    return fit(m.start) && within(m.translation, kLargestLength) && within(m.pivot, kLargestLength) && within(m.rotation, kLargestTurn);
}

bool fit(const TimeOfImpactSettings& s) noexcept {
    const auto usual = [](double length) { return length >= 0.0 && length <= kLargestLength; };
    return usual(s.separation) && usual(s.tolerance) && s.most_checks >= 1 && s.until >= 0.0 && s.until <= 1.0;
}

bool is_shape(const Shape& shape) noexcept {
    return std::visit([](const auto& alternative) { return sized(alternative); }, shape);
}

}  // namespace carom::detail
