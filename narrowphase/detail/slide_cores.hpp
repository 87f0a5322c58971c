// Two cores of points that move on a straight line without turning: up to their contact, all but the last bit of the way.
//
//   const Slide slide = slide_cores({a, b_at_t, along, t, 1.0, least, near});
//   if (slide.passes) ... else t = slide.t;
#pragma once

#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/distance.hpp>

namespace carom::detail {

/// What slides past what.
struct SlideInput {
    const ConvexCore& a;
    const ConvexCore& b;       ///< where it is at t
    const dvec3& along;        ///< how B moves seen from A, per unit of t
    double t = 0.0;            ///< nothing touches before
    double until = 1.0;        ///< contacts later than this need not be found; at most 1
    double least = 0.0;        ///< gaps of the cores up to this are none: radii, separation and what rounding does to a gap
    double near = 0.0;         ///< and those beyond that by this much are left to the caller
};

struct Slide {
    double t = 0.0;         ///< nothing touches before
    bool passes = false;    ///< nor up to `until`
    DistanceCache closest;  ///< the last simplex
    dvec3 normal{0.0};      ///< of the last plane that parted the two: unit, from A to B; zero where none did
};

/// Ray casting by GJK (van den Bergen, Ray Casting against General Convex Objects with Application to Continuous Collision Detection, 2004): each support plane that
/// parts the two by more than `least` moves t on to where it no longer does, and the search for the closest points goes on from there with the simplex that it has.
/// Ends where the two are near, where a plane parts them for good, and where rounding or overlap stop it: then t is as far as it came.
/// @param input  its cores are not curved.
/// Accuracy: t is never later than the first contact, as far as `least` has what rounding does. Cost: some six support points of each.
[[nodiscard]] Slide slide_cores(const SlideInput& input) noexcept;

}  // namespace carom::detail
