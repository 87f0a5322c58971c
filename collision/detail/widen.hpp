// Primitives of floats as primitives of doubles, exactly.
//
//   geo::Obb<double> wide = widened(box);
#pragma once

#include <carom/collision/primitives.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace carom::geo {

/// The numbers of a primitive in order of its members.
template <template <class> class Shape, class T>
using Scalars = std::array<T, sizeof(Shape<T>) / sizeof(T)>;

template <template <class> class Shape, class T>
[[nodiscard]] Shape<double> widened(const Shape<T>& shape) noexcept {
    const auto scalars = std::bit_cast<Scalars<Shape, T>>(shape);
    Scalars<Shape, double> wide{};
    for (std::size_t i = 0; i < wide.size(); ++i) {
        wide[i] = static_cast<double>(scalars[i]);
    }
    return std::bit_cast<Shape<double>>(wide);
}

[[nodiscard]] inline double largest(const dvec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// @return 0 for sizes of which products of four stay in range, otherwise the power of two that brings `size` near 1.
/// Held back from powers that double lacks, which are still enough to bring any size into range.
[[nodiscard]] inline int excess(double size) noexcept {
    if ((size > 0x1p-150 && size < 0x1p150) || size == 0.0) [[likely]] {
        return 0;
    }
    int exponent = 0;
    static_cast<void>(std::frexp(size, &exponent));
    return std::clamp(exponent, -1000, 1000);
}

/// The same plane with a normal near 1, where its own is out of range.
[[nodiscard]] inline Plane<double> balanced(const Plane<double>& plane) noexcept {
    const double scale = std::ldexp(1.0, -excess(largest(plane.normal)));
    return {plane.normal * scale, plane.offset * scale};
}

}  // namespace carom::geo
