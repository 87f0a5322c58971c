// How early two bodies may meet: a bound that costs some 10 ns, where a time of impact takes a microsecond.
//
//   const Ball a{&course_a, reach_a}, b{&course_b, reach_b};
//   const double t = first_chance(a, b, from, room);    // > 1: never
//
// Each shape is taken for the ball about its body's centre of mass, which goes straight on but for its sway; what stands still, and is large, for its box, and a
// half-space for itself. Nothing touches before, and no search that begins at `from` says so: what its paths may bend and how near it comes are added.
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/dynamics/detail/body_path.hpp>

#include <limits>

namespace carom::dynamics {

inline constexpr double kNoChance = std::numeric_limits<double>::infinity();

/// Where a centre of mass goes, from the beginning of a path to 1.
struct Course {
    dvec3 at{0.0};       ///< when it begins [m]
    double begin = 0.0;  ///< fraction of the step
    dvec3 rate{0.0};     ///< [m] a step
    /// No point of the body is farther from where a screw has it than that, nor is any search's piece of the path: sway and bend [m].
    double play = 0.0;
    double turn = 0.0;  ///< [rad] from the beginning to 1
};
[[nodiscard]] Course course_of(const BodyPath& path) noexcept;

/// A shape on a body, at most.
struct Ball {
    const Course* course = nullptr;
    double reach = 0.0;  ///< from the centre of mass [m]
};

/// @param from  within the courses: nothing is asked of what was before.
/// @param room  shapes that come this near count as touching [m].
/// @return a time from `from` to 1 before which the two do not come so near, and `from` where they may be as near at once; kNoChance: they do not until 1.
[[nodiscard]] double first_chance(const Ball& a, const Ball& b, double from, double room) noexcept;
/// The same of a ball and what stands still, and is within a box.
[[nodiscard]] double first_chance(const Ball& a, const Aabb& still, double from, double room) noexcept;
/// The same of a ball and what is within a box when its own course begins, and within a ball.
[[nodiscard]] double first_chance(const Ball& a, const Ball& b, const Aabb& box, double from, double room) noexcept;
/// The same of a ball and a half-space that does not turn, through `foot` when its own course begins; `normal` points out of it and is of unit length.
[[nodiscard]] double first_chance(const Ball& a, const Course& plane, const dvec3& foot, const dvec3& normal, double from,
                                  double room) noexcept;

}  // namespace carom::dynamics
