// Lines against solids, in double and in a range of numbers where squares neither overflow nor vanish.
//
//   if (auto chord = intersect(sphere, line)) { chord->enter; chord->exit; }
#pragma once

#include <carom/collision/primitives.hpp>

#include <limits>
#include <optional>

namespace carom::geo {

/// The line origin + t direction.
struct Line {
    dvec3 origin{0.0};
    dvec3 direction{0.0};
};

/// Where a line is inside, and the outward normals there, not of unit length and zero where they are not known.
struct Chord {
    double enter = -std::numeric_limits<double>::infinity();
    double exit = std::numeric_limits<double>::infinity();
    dvec3 normal_enter{0.0};
    dvec3 normal_exit{0.0};
};

[[nodiscard]] std::optional<Chord> intersect(const Sphere<double>& sphere, const Line& line) noexcept;
[[nodiscard]] std::optional<Chord> intersect(const Aabb<double>& box, const Line& line) noexcept;
[[nodiscard]] std::optional<Chord> intersect(const Obb<double>& box, const Line& line) noexcept;
[[nodiscard]] std::optional<Chord> intersect(const Capsule<double>& capsule, const Line& line) noexcept;
[[nodiscard]] std::optional<Chord> intersect(const Cylinder<double>& cylinder, const Line& line) noexcept;
[[nodiscard]] std::optional<Chord> intersect(const Cone<double>& cone, const Line& line) noexcept;
/// The half-space below.
[[nodiscard]] std::optional<Chord> intersect(const Plane<double>& plane, const Line& line) noexcept;

}  // namespace carom::geo
