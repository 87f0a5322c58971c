// Two boxes on their way: which of their fifteen axes parts them the longest, when the last of these lets them meet, and where they touch then.
//
//   const BoxAxes axes({half_a, axes_a, half_b, axes_b, between});
//   const BoxSlide slide = axes.slide(along, 1.0, rounding);           // neither turns: when they meet
//   const BoxTouch touch = axes.touch(slide.axis, slide.t * along, 1e-9);
#pragma once

#include <carom/core/types.hpp>

#include <array>

namespace carom::detail {

/// Two boxes at one time.
struct BoxPlaces {
    dvec3 half_a{0.0};
    const dmat3& axes_a;  ///< columns of unit length to rounding
    dvec3 half_b{0.0};
    const dmat3& axes_b;
    dvec3 between{0.0};  ///< from A's centre to B's
};

/// How they move on from there.
struct BoxRates {
    dvec3 along{0.0};  ///< of B's centre, seen from A's, which does not turn
    dvec3 turn_a{0.0}, turn_b{0.0};
    double bend = 0.0;  ///< half the second derivative of a gap, or about that
};

/// The normal of a face of A or of B, or the one square to an edge of each.
struct BoxAxis {
    static constexpr int kNone = 3;
    int a = kNone;      ///< of A's axes
    int b = kNone;      ///< of B's
    double sign = 0.0;  ///< +1 or -1, so that it points from A to B; 0: there is no such axis

    [[nodiscard]] bool exists() const noexcept { return sign != 0.0; }
};

/// When two boxes that do not turn meet.
struct BoxSlide {
    bool passes = false;  ///< they do not, up to the end
    double t = 0.0;       ///< not before; 0 where no axis parts them at the start
    BoxAxis axis;         ///< which parted them last
};

/// Two points that all but touch.
struct BoxTouch {
    dvec3 on_b{0.0};        ///< from A's centre, world axes
    double distance = 0.0;  ///< of the point of A's that is nearest to it, to rounding
};

class BoxAxes {
public:
    explicit BoxAxes(const BoxPlaces& places) noexcept;

    /// The axes one by one: each parts the boxes up to the time at which it lets them meet and after that at which it parts them again, all of it
    /// linear in t; they meet where no axis parts them (Gottschalk, Lin, Manocha 1996; over time: Eberly, Dynamic Collision Detection Using
    /// Oriented Bounding Boxes, 2008).
    /// @param until  0 to 1. @param rounding  gaps up to this are none: 2^-46 of sizes, distance and way.
    /// Rounding, u = 2^-53: entries of the axes err by 5 u (core_pair()), so those of the matrix between the two frames by 21 u, a centre's or a way's
    /// in a frame by 12 u of its length. Heights along the axis of two edges, which is left as long as it comes out (at most 1), are products of
    /// the two and err by 50 u of the length, extents along it by 33 u of the reaches: all of it is below half of `rounding`. So what is parted by
    /// more is parted, however near to parallel two edges are; what they are parted by less for is for touch() to find out.
    [[nodiscard]] BoxSlide slide(const dvec3& along, double until, double rounding) const noexcept;

    /// @return the axis that parts the boxes now by more than `rounding` and will for longest, by its rate: a guess. None where none does.
    [[nodiscard]] BoxAxis longest(const BoxRates& rates, double rounding) const noexcept;

    /// @return unit, world axes, from A to B; zero for edges that are parallel.
    [[nodiscard]] dvec3 normal(const BoxAxis& axis) const noexcept;

    /// @param shift  how far B has gone. @param enough  no nearer points are looked for.
    /// @return the corner that is nearest across the face, or the nearest points of the two edges. Where these are farther apart than enough, as those
    /// of faces that lie on each other may be, either box's point that is nearest to the other's, a few times over.
    [[nodiscard]] BoxTouch touch(const BoxAxis& axis, const dvec3& shift, double enough) const noexcept;

private:
    using Row = std::array<double, 3>;

    [[nodiscard]] BoxTouch foremost(const BoxAxis& axis, const dvec3& between) const noexcept;

    BoxPlaces at_;
    std::array<Row, 3> c_{}, size_{};  // [i][j]: B's axis j along A's axis i, and its magnitude
};

}  // namespace carom::detail
