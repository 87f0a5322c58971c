// When the parts of deforming triangles first touch: a vertex and a face, or two edges, each corner of which moves on a straight line.
//
//   Impact hit = time_of_impact(VertexFaceMotion{.vertex = {p0, p1}, .face = {{{a0, a1}, {b0, b1}, {c0, c1}}}});
//   if (may_touch(hit.status)) { /* no contact before hit.t: proved */ }
//   Impact near = time_of_impact(EdgeEdgeMotion{...}, {.separation = 0.001});    // when they come within a millimetre
#pragma once

#include <carom/narrowphase/impact.hpp>

#include <array>
#include <span>

namespace carom {

/// The point (1 - t) start + t end, 0 <= t <= 1.
struct MovingPoint {
    dvec3 start{0.0};
    dvec3 end{0.0};
};

/// A is the vertex, B the face, which may be folded to a line or a point at any time.
struct VertexFaceMotion {
    MovingPoint vertex;
    std::array<MovingPoint, 3> face;
};

/// A and B are edges from their first to their second end; either may shrink to a point.
struct EdgeEdgeMotion {
    std::array<MovingPoint, 2> a;
    std::array<MovingPoint, 2> b;
};

struct DeformingSettings {
    double separation = 0.0;  ///< two that are this near count as touching [m]; >= 0, finite
    double tolerance = 0.0;   ///< the search ends once they are within separation + tolerance [m]; >= 0. 0: once rounding hides the rest
    int most_checks = 512;    ///< cap on certificates; >= 1. At the cap the status is Clamped
};

/// The first contact of a vertex with a face, or of two edges, whose corners move on straight lines at constant speeds of their own.
///
/// Guarantee: no false negative, and no contact before the returned t. Each step of t is paid for by a certificate: a plane that has all of
/// A on one side and all of B on the other over the whole step, or the sign of the triple product whose roots are the times at which the
/// four corners lie in one plane; both are polynomials in t whose hulls bound them, less a bound of what rounding may have done
/// (docs/continuous.md derives it). False positives: only where the two come within about 1e-14 of their size of `separation` + `tolerance`
/// (edges at angles of some 1e-6 to each other and needles: 1e-10), or where the cap is reached. At t itself features that graze may be up
/// to 1e-8 of their size apart.
///
/// Method: root finding by inclusion (Snyder 1992; Wang et al. 2021) in t alone, from the left. Departures: the other two parameters are
/// never bisected, since at each time the difference of the two features is a triangle or parallelogram whose hull is known exactly; the
/// inclusion is taken along directions that the closest points suggest, not along the axes alone.
/// @return `point` lies on A: the vertex, or the point of the first edge; `t` and it are where the search ended.
/// Bad input (NaN, infinity, settings out of range): Invalid. Coordinates of any size are scaled by a power of two first.
/// Cost: no allocation, thread-safe; some 80 ns where boxes along the axes or the planes separate the two, 0.1 to 1.5 µs otherwise.
[[nodiscard]] Impact time_of_impact(const VertexFaceMotion& motion, const DeformingSettings& settings = {}) noexcept;
[[nodiscard]] Impact time_of_impact(const EdgeEdgeMotion& motion, const DeformingSettings& settings = {}) noexcept;

/// The first contact of two triangles whose corners move so: the least of six vertices with faces and nine pairs of edges. Triangles that
/// cross at t = 0 without a vertex or edge of the one on the other are found when one of these next passes: they do not count as
/// Overlapping, so start with triangles that are apart.
[[nodiscard]] Impact time_of_impact(const std::array<MovingPoint, 3>& a, const std::array<MovingPoint, 3>& b,
                                    const DeformingSettings& settings = {}) noexcept;

/// Batches: the single call of each. @param out  (n,) as motions; otherwise reports misuse and changes nothing.
void times_of_impact(std::span<const VertexFaceMotion> motions, std::span<Impact> out, const DeformingSettings& settings = {});
void times_of_impact(std::span<const EdgeEdgeMotion> motions, std::span<Impact> out, const DeformingSettings& settings = {});

}  // namespace carom
