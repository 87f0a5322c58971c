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

}  // namespace carom::geo
