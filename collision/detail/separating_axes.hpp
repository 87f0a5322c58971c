// Whether boxes and triangles are apart, by the axes that can separate them, in double.
//
//   Verdict v = separate(box_a, box_b, axis_error<float>());
//   if (v == Verdict::Unclear) v = distance(...) > slack ? Verdict::Apart : Verdict::Together;
//
// Any axis proves separation if the gap along it exceeds the rounding of its own computation, so Apart is certain. The reverse needs
// care: the cross product of nearly parallel edges is a short vector with few right digits, and the true axis near it may separate
// by the square root of a rounding. Where such an axis shows neither a gap nor an overlap larger than its error, the verdict is Unclear.
#pragma once

#include <carom/collision/detail/closest_box.hpp>

namespace carom::geo::detail {

enum class Verdict { Apart, Together, Unclear };

/// What a dot product loses, in parts of the lengths involved: four roundings of T, because axes of an Obb are orthonormal only to T.
template <class T>
[[nodiscard]] constexpr double axis_error() noexcept {
    return 4.0 * static_cast<double>(std::numeric_limits<T>::epsilon());
}

/// Fifteen axes: three faces each and nine pairs of edges. Source: Gottschalk, Lin, Manocha, OBBTree (SIGGRAPH 1996), sec. 5.
/// @param error  axis_error of the axes' scalar type.
[[nodiscard]] Verdict separate(const Obb<double>& a, const Obb<double>& b, double error) noexcept;
[[nodiscard]] Verdict separate(const AlignedBox& a, const Obb<double>& b, double error) noexcept;

/// Thirteen axes. Source: Akenine-Moller, Fast 3D Triangle-Box Overlap Testing (JGT 2001). `error` as above.
[[nodiscard]] Verdict separate(const Triangle<double>& a, const AlignedBox& b, double error) noexcept;
[[nodiscard]] Verdict separate(const Triangle<double>& a, const Obb<double>& b, double error) noexcept;

/// Eleven axes; what lies in one plane is Unclear.
[[nodiscard]] Verdict separate(const Triangle<double>& a, const Triangle<double>& b, double error) noexcept;

}  // namespace carom::geo::detail
