// Ray probes: a body felt by a fan of rays, as the wheel of a vehicle is. Fast and not exact; collide() is exact.
//
//   RayProbe wheel{.centre = {0.8, 0, 1.2}, .axis = {1, 0, 0}, .rays = 16, .radius = 0.35, .reach = 0.1};
//   std::vector<ProbeContact> contacts;
//   probe(wheel, car, {shapes, poses}, near, contacts);      // near: the numbers of the shapes to look at
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/math.hpp>
#include <carom/core/pose.hpp>
#include <carom/core/result.hpp>
#include <carom/narrowphase/collide.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// Rays from the axis of a wheel outward, in rows across its width; all in its body's frame. A ball is a fan, or several probes.
struct RayProbe {
    dvec3 centre{0.0};             ///< of the wheel [m]
    dvec3 axis{1.0, 0.0, 0.0};     ///< the rays are square to it; any length but 0
    dvec3 middle{0.0, -1.0, 0.0};  ///< the direction about which the fan opens; not along the axis, any length but 0
    double angle = kPi;            ///< between the first and the last ray, 0..2 pi; at 2 pi the fan is a whole turn [rad]
    std::uint32_t rays = 16;       ///< in a row, 1..4096
    std::uint32_t rows = 1;        ///< 1..64
    double width = 0.0;            ///< between the first and the last row, along the axis, >= 0 [m]
    double radius = 0.5;           ///< of the wheel, > 0 [m]
    double reach = 0.0;            ///< surfaces up to this far beyond the radius are reported too, >= 0 [m]
};

/// @return NotFinite or InvalidArgument with a message that names the field, where one is out of its range.
[[nodiscard]] Status validate(const RayProbe& probe);

/// Where one ray met the nearest shape.
struct ProbeContact {
    std::uint32_t probe = 0;      ///< its number in a batch; otherwise 0
    std::uint32_t row = 0, ray = 0;
    std::uint32_t shape = 0;      ///< number of the shape
    std::uint32_t triangle = 0;   ///< of a mesh; otherwise 0
    std::uint32_t part = 0;       ///< of a compound; otherwise 0
    dvec3 point{0.0};             ///< on the shape, in the world [m]
    dvec3 normal{0.0};            ///< unit, from the probe to the shape: against the surface's own
    double separation = 0.0;      ///< along the ray, from the wheel's rim to the surface [m]; negative: overlap
    double clearance = 0.0;       ///< between the wheel's rim and the plane that touches the surface there [m]
};

/// Appends the contacts of one probe, row by row and ray by ray: at most one a ray, of the nearest of the shapes `near`; of several at one
/// distance the first in `near`.
///
/// How wrong it is. A ray sees the surface where it meets it, to cast_ray()'s accuracy, and nothing beside it. Two rays d apart [rad]
/// leave a chord of 2 r sin(d / 2) between their ends unseen: what is narrower may pass between them, and so may what lies between two rows
/// or beyond the outermost. On flat ground square to the wheel, the nearest ray is at most d / 2 off the normal: its separation is too
/// large by at most (r + s)(1 / cos(d / 2) - 1), s the true one, so ground that overlaps by less than that is missed; its clearance is
/// exact there, but a plane goes on beyond the edge at which a surface ends. `carom accuracy probes` has what is missed against the time.
/// A ray that starts inside a solid reports separation -radius, its own direction as the normal.
///
/// @param pose  of the probe's body in the world.
/// @param near  numbers of `placed`; any of them may be of any type, planes and meshes too.
/// Misuse (validate(probe) fails; a pose that is not finite; sizes of `placed` that differ; a number beyond them; a null shape) is
/// reported and appends nothing. Cost: rows x rays x near casts, of 20 ns (a box) to 200 ns (a mesh). Allocates only while `out` grows.
/// Thread-safe.
void probe(const RayProbe& probe, const Pose& pose, const PlacedShapes& placed, std::span<const std::uint32_t> near,
           std::vector<ProbeContact>& out);

/// A probe on a body, for batches.
struct PlacedProbe {
    RayProbe probe;
    Pose pose;                        ///< of the body
    std::uint32_t first_near = 0;     ///< its shapes are `near`[first_near, first_near + near_count)
    std::uint32_t near_count = 0;
};

/// Contacts of many probes, in their order; replaces `out`. The same bits as the call for each, on every number of threads.
/// @param near  of all probes.
/// Misuse as above, and ranges beyond `near`: nothing changes. Allocates while `out` grows, and a number for each probe.
void probe(std::span<const PlacedProbe> probes, const PlacedShapes& placed, std::span<const std::uint32_t> near, Executor& executor,
           std::vector<ProbeContact>& out);

/// @return the smallest box that holds every ray of the probe, in the world [m]: what comes into it may be hit. Misuse as above: an
/// empty box.
[[nodiscard]] Aabb bounds(const RayProbe& probe, const Pose& pose);

}  // namespace carom
