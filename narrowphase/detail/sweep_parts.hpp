// A point that moves from the origin along `motion`, t in [0, 1], against what closed shapes are made of, grown by a radius: points,
// segments, parallelograms and triangles without their rim, boxes.
//
//   SweepPart first = sweep_segment(path, q, u);
//   first = earlier(first, sweep_face(path, q, u, v, FaceKind::Triangle));
//
// Rounding, with S = path.size: each function finds the part with its surface moved by less than 16 eps S, since distances from the line
// come from cross products of relative error eps with |q| <= S, and lengths along it from products of sums and differences. `radius`
// is grown by kGrowth eps S beforehand, so that answers are those of larger parts, and times are then moved down by kRounded, more than the
// few roundings that make them up.
#pragma once

#include <carom/core/types.hpp>

namespace carom::detail {

inline constexpr double kNoContact = 2.0;
inline constexpr double kGrowth = 32.0 * 0x1p-52;
inline constexpr double kLeastGrowth = 1e-70;
inline constexpr double kLargestSwept = 1e70;
inline constexpr double kRounded = 1.0 - 0x1p-48;
/// Squares of shorter motions, times those of the least radius, underflow; below these lengths segments and faces are less than growth hides.
inline constexpr double kShortMotion = 1e-60;
inline constexpr double kShortSegment = 1e-100;
inline constexpr double kShortFace = 1e-69;
inline constexpr double kHiddenSpeed = 1e-100;     ///< the least growth hides slower motions along an axis
inline constexpr double kShortestNormal = 1e-140;  ///< of half-spaces: squares of shorter ones lose digits

struct SweepPath {
    dvec3 motion{0.0};
    double radius = 0.0;  ///< grown
    double size = 0.0;    ///< S
};

struct SweepPart {
    double t = kNoContact;
    dvec3 normal{0.0};  ///< towards the part; its length is 1 or, where the part is met at no distance, 0
};
[[nodiscard]] inline const SweepPart& earlier(const SweepPart& a, const SweepPart& b) noexcept { return b.t < a.t ? b : a; }

enum class FaceKind : unsigned char { Triangle, Parallelogram };

/// @param first  what is met then or later need not be told, and is nothing.
[[nodiscard]] SweepPart sweep_point(const SweepPath& path, const dvec3& q, double first = kNoContact) noexcept;
/// q + s u, 0 <= s <= 1; u may be zero.
[[nodiscard]] SweepPart sweep_segment(const SweepPath& path, const dvec3& q, const dvec3& u, double first = kNoContact) noexcept;
/// The face at the corner q with the sides u and v, of which only the inside is met here, and what rounding makes of its plane.
struct SweepFace {
    dvec3 q{0.0}, u{0.0}, v{0.0};
    dvec3 area{0.0};                                     ///< u x v
    double length_u = 0.0, length_v = 0.0, twice = 0.0;  ///< of u, v and the area
    /// The angle at q is so small that the normal is uncertain by more than the width: the rim, grown by rim_growth(), holds all of it.
    bool needle = false;
    double slack =
        0.0;  ///< by how much a face that is no needle may be off along its normal, which is uncertain by eps over the angle's sine

    SweepFace(const SweepPath& path, const dvec3& corner, const dvec3& side_u, const dvec3& side_v) noexcept;
    /// By how much the segments about the face are to be grown, so that no path enters the grown face from beside without meeting them.
    [[nodiscard]] double rim_growth() const noexcept;
};
/// Nothing where it is a needle.
[[nodiscard]] SweepPart sweep_face(const SweepPath& path, const SweepFace& face, FaceKind kind) noexcept;
/// A solid box along the axes, rim and all.
[[nodiscard]] SweepPart sweep_box(const SweepPath& path, const dvec3& lower, const dvec3& upper) noexcept;

}  // namespace carom::detail
