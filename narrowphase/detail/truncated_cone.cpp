#include <carom/narrowphase/detail/truncated_cone.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace carom::detail {
namespace {

// Cosines of multiples of an eighth of pi; the sines are those a quarter turn before.
constexpr double kCos[kRimCorners] = {1.0,
                                      0.92387953251128674,
                                      0.70710678118654752,
                                      0.38268343236508977,
                                      0.0,
                                      -0.38268343236508977,
                                      -0.70710678118654752,
                                      -0.92387953251128674,
                                      -1.0,
                                      -0.92387953251128674,
                                      -0.70710678118654752,
                                      -0.38268343236508977,
                                      0.0,
                                      0.38268343236508977,
                                      0.70710678118654752,
                                      0.92387953251128674};

// A direction along the axis and across it.
struct Split {
    double along = 0.0;
    double across = 0.0;
};

Split split(const TruncatedCone& solid, const dvec3& direction) noexcept {
    const double x = glm::dot(direction, solid.axes[0]), z = glm::dot(direction, solid.axes[2]);
    return {glm::dot(direction, solid.axis()), std::sqrt(x * x + z * z)};
}

}  // namespace

dvec3 TruncatedCone::outward(const dvec3& direction) const noexcept {
    const double x = glm::dot(direction, axes[0]), z = glm::dot(direction, axes[2]);
    const double length = std::sqrt(x * x + z * z);
    if (!(length > 1e-140)) return axes[0];  // the squares are about to underflow
    return (x / length) * axes[0] + (z / length) * axes[2];
}

dvec3 TruncatedCone::support(const dvec3& direction) const noexcept {
    const Split d = split(*this, direction);
    const bool upper = half_height * d.along + upper_radius * d.across > -half_height * d.along + lower_radius * d.across;
    return upper ? upper_centre() + upper_radius * outward(direction) : lower_centre() + lower_radius * outward(direction);
}

double TruncatedCone::reach(const dvec3& direction) const noexcept {
    const Split d = split(*this, direction);
    return glm::dot(centre, direction) +
           std::max(half_height * d.along + upper_radius * d.across, -half_height * d.along + lower_radius * d.across);
}

dvec3 TruncatedCone::side_normal(const dvec3& outward) const noexcept {
    const double rise = 2.0 * half_height, inward = lower_radius - upper_radius;
    const double length = std::sqrt(rise * rise + inward * inward);
    return (rise / length) * outward + (inward / length) * axis();
}

TruncatedCone truncated_cone(const Shape& shape, const dmat3& axes, const dvec3& centre) noexcept {
    if (const Cylinder* cylinder = std::get_if<Cylinder>(&shape)) {
        const double r = static_cast<double>(cylinder->radius);
        return {centre, axes, static_cast<double>(cylinder->half_height), r, r};
    }
    const Cone& cone = as<Cone>(shape);
    return {centre, axes, static_cast<double>(cone.half_height), static_cast<double>(cone.radius), 0.0};
}

Aabb box_of(const TruncatedCone& solid) noexcept {
    Aabb box;
    for (int k = 0; k < 3; ++k) {
        dvec3 direction{0.0};
        direction[k] = 1.0;
        box.upper[k] = solid.reach(direction);
        box.lower[k] = -solid.reach(-direction);
    }
    return box;
}

FacePolygon disc_of(const TruncatedCone& solid, bool upper, const ContactPlane& plane, std::vector<FaceCorner>& corners) {
    const dvec3 centre = upper ? solid.upper_centre() : solid.lower_centre();
    const double radius = upper ? solid.upper_radius : solid.lower_radius;
    corners.clear();
    for (int i = 0; i < kRimCorners; ++i) {
        // Angles run from axes[0] to axes[2], clockwise about the axis.
        const int k = upper ? kRimCorners - 1 - i : i;
        const double cosine = kCos[k], sine = kCos[(k + 3 * kRimCorners / 4) % kRimCorners];
        const dvec3 p = centre + (radius * cosine) * solid.axes[0] + (radius * sine) * solid.axes[2];
        const auto name = static_cast<std::uint32_t>(upper ? kRimCorners + k : k);
        corners.push_back({p, glm::dot(p, plane.axis_u), glm::dot(p, plane.axis_w), name, name});
    }
    const dvec3 normal = upper ? solid.axis() : -solid.axis();
    return {corners, normal, glm::dot(normal, centre)};
}

FacePolygon side_line_of(const TruncatedCone& solid, const dvec3& outward, const ContactPlane& plane, std::vector<FaceCorner>& corners) {
    corners.clear();
    const dvec3 lower = solid.lower_centre() + solid.lower_radius * outward;
    const dvec3 upper = solid.upper_centre() + solid.upper_radius * outward;
    corners.push_back({lower, glm::dot(lower, plane.axis_u), glm::dot(lower, plane.axis_w), kSidePoint, kSidePoint});
    corners.push_back({upper, glm::dot(upper, plane.axis_u), glm::dot(upper, plane.axis_w), kSidePoint + 1, kSidePoint});
    const dvec3 normal = solid.side_normal(outward);
    return {corners, normal, std::max(glm::dot(normal, lower), glm::dot(normal, upper))};
}

}  // namespace carom::detail
