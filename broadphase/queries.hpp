// Questions about the boxes of a broadphase as they stand after its last update.
//
//   query_sphere(broadphase, {0, 1, 0}, 5.0, [&](std::uint32_t slot) { hear(slot); return true; });
//   std::optional<BoxHit> hit = closest_on_ray(broadphase, {0, 9, 0}, {0, -1, 0}, 20.0, [&](std::uint32_t slot) { return solid(slot); });
//
// All coordinates are relative to the broadphase's origin, like the boxes, and must be finite; anything else is misuse, and nothing is
// visited. Every box that the shape touches (closed tests, in double) is visited once, in no promised order, until `visit` returns
// false. A box that lies within 1e-14 of the coordinates' size of touching may be visited too.
// Cost: a tree goes down to what the shape touches, a grid looks at the layers, rows and cells that it touches, of rays and moving boxes at
// the cells along the path alone, nearest first; the other methods look at every box. No allocation but for nearest_boxes; const, so any number of threads may ask at once.
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/types.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace carom {

using SlotVisitor = FunctionRef<bool(std::uint32_t slot)>;

/// A half-space: dot(normal, x) <= offset. The normal need not be of unit length.
struct HalfSpace {
    dvec3 normal{0.0, 1.0, 0.0};
    double offset = 0.0;
};

/// Where a ray enters a box, in lengths of its direction; 0 where it starts inside.
struct BoxHit {
    std::uint32_t slot = 0;
    double t = 0.0;
    friend bool operator==(const BoxHit&, const BoxHit&) = default;
};

/// Boxes that overlap the box; lower <= upper.
void query_box(const Broadphase& broadphase, const dvec3& lower, const dvec3& upper, SlotVisitor visit);
/// Boxes that come within `radius` >= 0 of the point.
void query_sphere(const Broadphase& broadphase, const dvec3& centre, double radius, SlotVisitor visit);
/// Boxes that are not wholly outside any one of the half-spaces: conservative, so that a box beyond an edge of the volume may be
/// visited. The planes of a frustum point outward.
void query_volume(const Broadphase& broadphase, std::span<const HalfSpace> half_spaces, SlotVisitor visit);
/// Boxes that the ray origin + t direction meets with 0 <= t <= t_max. The direction is not zero.
void query_ray(const Broadphase& broadphase, const dvec3& origin, const dvec3& direction, double t_max, SlotVisitor visit);
/// Boxes that a box meets which moves by `motion`, with a part of the motion in 0 .. 1; lower <= upper.
void query_swept_box(const Broadphase& broadphase, const dvec3& lower, const dvec3& upper, const dvec3& motion, SlotVisitor visit);

/// The box that the ray enters first among those that `accept` takes; of several at one t, that of the lowest slot.
[[nodiscard]] std::optional<BoxHit> closest_on_ray(const Broadphase& broadphase, const dvec3& origin, const dvec3& direction, double t_max,
                                                   SlotVisitor accept);

/// The `count` boxes nearest to the point, nearest first and by slot among equals; all of them if there are fewer.
[[nodiscard]] std::vector<std::uint32_t> nearest_boxes(const Broadphase& broadphase, const dvec3& point, std::size_t count);

}  // namespace carom
