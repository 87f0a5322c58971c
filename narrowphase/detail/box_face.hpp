// The faces of a box as polygons.
#pragma once

#include <carom/narrowphase/detail/polygon_contact.hpp>

#include <algorithm>

namespace carom::detail {

/// Bit k is set where the corner is on the positive side of axis k.
[[nodiscard]] inline std::uint32_t box_vertex(const dvec3& corner) noexcept {
    return (corner.x > 0.0 ? 1u : 0u) | (corner.y > 0.0 ? 2u : 0u) | (corner.z > 0.0 ? 4u : 0u);
}

/// The edge along `axis` through `corner` (whose component along the axis does not matter): 0..11.
[[nodiscard]] inline std::uint32_t box_edge(int axis, const dvec3& corner) noexcept {
    return static_cast<std::uint32_t>(axis) * 4u + (corner[(axis + 1) % 3] > 0.0 ? 1u : 0u) +
           (corner[(axis + 2) % 3] > 0.0 ? 2u : 0u);
}

/// The face of a box on the side `sign` of `axis`.
class BoxFace {
public:
    BoxFace(const dvec3& half, const dmat3& axes, const dvec3& centre, int axis, double sign, const ContactPlane& plane) noexcept
        : normal_(sign * axes[axis]), offset_(glm::dot(normal_, centre) + half[axis]) {
        // e_j x e_k = e_axis: on the negative side the two change places, so that the corners run counter-clockwise from outside.
        const int j = sign > 0.0 ? (axis + 1) % 3 : (axis + 2) % 3;
        const int k = 3 - axis - j;
        side_ = 2.0 * std::min(half[j], half[k]);
        constexpr double kSignJ[4] = {1.0, -1.0, -1.0, 1.0};
        constexpr double kSignK[4] = {1.0, 1.0, -1.0, -1.0};
        for (std::size_t c = 0; c < 4; ++c) {
            dvec3 corner{0.0};
            corner[axis] = sign * half[axis];
            corner[j] = kSignJ[c] * half[j];
            corner[k] = kSignK[c] * half[k];
            FaceCorner& out = corners_[c];
            out.point = centre + axes * corner;
            out.u = glm::dot(out.point, plane.axis_u);
            out.w = glm::dot(out.point, plane.axis_w);
            out.vertex = box_vertex(corner);
            out.edge = box_edge(c % 2 == 0 ? j : k, corner);
        }
    }

    [[nodiscard]] FacePolygon<4> polygon() const noexcept { return {corners_, normal_, offset_}; }
    [[nodiscard]] double least_side() const noexcept { return side_; }

private:
    std::array<FaceCorner, 4> corners_;
    dvec3 normal_{0.0};
    double offset_ = 0.0;
    double side_ = 0.0;
};

}  // namespace carom::detail
