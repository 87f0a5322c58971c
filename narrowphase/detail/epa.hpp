// How deep a truncated cone and another convex set overlap, and along which direction they part most easily.
//
//   Penetration p = penetration(solid, hull.vertices, size, {});
//   if (p.proven) { /* p.depth is the least depth, to 1e-6 of the size */ }
#pragma once

#include <carom/core/types.hpp>
#include <carom/narrowphase/detail/convex_core.hpp>
#include <carom/narrowphase/detail/truncated_cone.hpp>

#include <span>

namespace carom::detail {

struct Penetration {
    dvec3 normal{0.0};    ///< unit, from a to b; zero where no direction was found
    double depth = 0.0;   ///< the overlap along `normal`: moving b by it parts the two [m]
    dvec3 on_a{0.0};      ///< where they touch then, on a and on b
    dvec3 on_b{0.0};
    double floor = 0.0;   ///< of two cores: no direction has less depth than this, but for the rounding of support points [m]
    bool proven = false;  ///< no direction has less depth, but for 1e-6 of the size
};

/// A direction that is known beforehand, with the overlap along it; zero: none.
struct KnownDirection {
    dvec3 normal{0.0};   ///< unit, from a to b
    double depth = 0.0;  ///< [m]
    double excess = 0.0; ///< it is the answer if no direction has less depth than its own less this [m]
};

/// The direction of least overlap of two sets that touch or overlap, or are apart by rounding.
///
/// Method: a polytope of support points grows inside the difference of the two sets, always beyond its face nearest to the origin (van
/// den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects, GDC 2001). That face bounds the depth from
/// below, and the overlap along its normal from above. Departure: it starts from a tetrahedron of support points of its own, which
/// need not hold the origin, so that it depends on no other search; and the least upper bound is kept, so that what is returned is
/// always a direction with its true overlap.
/// Where one and the same depth belongs to a whole belt of directions (coaxial cylinders), the bounds do not meet before the cap: then
/// `proven` is false, though the depth is right as a rule.
/// @param size  the larger extent of the two [m]. The search stops where the bounds meet to 1e-11 of it: directions of smooth contacts
///              hold to about 5e-6 then. It also stops where `known` turns out to be the answer.
/// Total: at most 128 support points, never throws. Cost: 6 of them for flat contacts (1.2 µs), some 20 to 30 for round ones (5 to
/// 25 µs). No allocation.
[[nodiscard]] Penetration penetration(const TruncatedCone& a, std::span<const dvec3> b, double size, const KnownDirection& known) noexcept;
[[nodiscard]] Penetration penetration(const TruncatedCone& a, const TruncatedCone& b, double size, const KnownDirection& known) noexcept;
/// The same of two cores, with `floor`.
[[nodiscard]] Penetration penetration(const ConvexCore& a, const ConvexCore& b, double size) noexcept;

}  // namespace carom::detail
