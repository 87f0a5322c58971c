// The watertight test of a ray against a triangle.
//
//   RayFrame frame(origin, direction);
//   if (auto hit = intersect(frame, a, b, c)) { hit->distance; hit->weights; }
#pragma once

#include <carom/collision/detail/exact_sign.hpp>
#include <carom/core/types.hpp>

#include <cmath>
#include <optional>

namespace carom {

/// The frame in which a ray is the third axis: translated to its origin, axes permuted so that its largest component comes last,
/// then sheared. A vertex's image depends on the ray and the vertex alone, hence is the same for every triangle round it.
class RayFrame {
public:
    /// @param direction  unit length.
    RayFrame(const dvec3& origin, const dvec3& direction) noexcept : origin_(origin) {
        const dvec3 size = glm::abs(direction);
        z_ = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        shear_x_ = direction[x_] / direction[z_];
        shear_y_ = direction[y_] / direction[z_];
        direction_z_ = direction[z_];
    }
    /// @return the vertex as the ray sees it; z is not divided by the direction's.
    [[nodiscard]] dvec3 project(const vec3& vertex) const noexcept {
        const dvec3 v = dvec3(vertex) - origin_;
        return {v[x_] - shear_x_ * v[z_], v[y_] - shear_y_ * v[z_], v[z_]};
    }
    [[nodiscard]] double direction_z() const noexcept { return direction_z_; }

private:
    dvec3 origin_{0.0};
    int x_ = 0;
    int y_ = 1;
    int z_ = 2;
    double shear_x_ = 0.0;
    double shear_y_ = 0.0;
    double direction_z_ = 1.0;
};

struct TriangleCrossing {
    double distance = 0.0;  ///< of the line: negative behind the origin
    dvec3 weights{0.0};     ///< of the corners: the point is their mean by these, which sum to 1
};

/// The weights, which sum to 1, of three corners at the axis along which p, q and r are their images.
/// @param difference  (a, b, c, d) to a b - c d with its exact sign.
/// @return nothing where the axis passes outside of the triangle or lies in its plane.
template <class Difference>
[[nodiscard]] std::optional<dvec3> weights_at_axis(const dvec3& p, const dvec3& q, const dvec3& r, const Difference& difference) noexcept {
    const double u = difference(r.x, q.y, r.y, q.x);
    const double v = difference(p.x, r.y, p.y, r.x);
    const double w = difference(q.x, p.y, q.y, p.x);
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) {
        return std::nullopt;
    }
    const double determinant = u + v + w;
    if (determinant == 0.0) {
        return std::nullopt;
    }
    return dvec3{u, v, w} / determinant;
}

/// Where the line of a ray crosses a triangle, its edges and corners included, from either side.
///
/// Method: Woop, Benthin, Wald, Watertight Ray/Triangle Intersection (JCGT 2013). Departure: in double, and the signs of the edge
/// functions of the projected corners are exact, so that triangles which tile the plane around a line leave no gap at edges or at
/// vertices. A line in the plane of the triangle does not cross it.
[[nodiscard]] inline std::optional<TriangleCrossing> intersect(const RayFrame& frame, const vec3& a, const vec3& b,
                                                               const vec3& c) noexcept {
    const dvec3 p = frame.project(a);
    const dvec3 q = frame.project(b);
    const dvec3 r = frame.project(c);
    const std::optional<dvec3> weights = weights_at_axis(p, q, r, difference_of_products);
    if (!weights) {
        return std::nullopt;
    }
    const double z = weights->x * p.z + weights->y * q.z + weights->z * r.z;
    return TriangleCrossing{z / frame.direction_z(), *weights};
}

}  // namespace carom
