// Lines against surfaces, in double and in a range of numbers where products neither overflow nor vanish.
//
//   if (auto crossing = cross(disc, line)) { crossing->t; crossing->normal; }
#pragma once

#include <carom/collision/detail/ray_solids.hpp>

#include <optional>
#include <span>

namespace carom::geo {

/// Where a line crosses a surface; the normal is to either side and not of unit length.
struct Crossing {
    double t = 0.0;
    dvec3 normal{0.0};
    dvec3 weights{0.0};  ///< of a triangle's corners
};

[[nodiscard]] std::optional<Crossing> cross(const Plane<double>& plane, const Line& line) noexcept;
[[nodiscard]] std::optional<Crossing> cross(const Disc<double>& disc, const Line& line) noexcept;
[[nodiscard]] std::optional<Crossing> cross(const Triangle<double>& triangle, const Line& line) noexcept;

/// @param corners  one by one through `scale`, a power of two.
template <class T>
[[nodiscard]] std::optional<Crossing> cross(std::span<const Vec3<T>> corners, double scale, const Line& line) noexcept;

}  // namespace carom::geo
