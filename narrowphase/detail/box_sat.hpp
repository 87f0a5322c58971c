// The fifteen axes of two boxes.
//
//   BoxPair p = box_pair(pair);
//   BoxAxis axis;
//   if (!find_box_axis(p, margin, axis)) return;   // farther apart than the margin
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>

#include <cmath>
#include <limits>

namespace carom::detail {

/// Two boxes in the frame of the first. Plain arrays: every index is known once the loops are unrolled.
struct BoxPair {
    double a[3];         ///< half extents
    double b[3];
    double axes[3][3];   ///< axes[i][j]: component along axis i of A of axis j of B
    double size[3][3];   ///< |axes|
    double offset_a[3];  ///< centre of B from A, along A's axes
    double offset_b[3];  ///< centre of B from A, along B's axes
};

/// The axis of the greatest separation: a face of A (`of_b` < 0), a face of B (`of_a` < 0), or an edge of each.
struct BoxAxis {
    double separation = -std::numeric_limits<double>::infinity();
    int of_a = -1;
    int of_b = -1;
};

[[nodiscard]] BoxPair box_pair(const PairFrame& pair) noexcept;

/// Method: Gottschalk, Lin, Manocha, OBBTree (1996), sec. 5, with normalised edge axes. An edge axis wins over the faces only where it is
/// better by kFacePreference of the size.
/// @return false as soon as one axis separates the boxes by more than `margin`.
bool find_box_axis(const BoxPair& p, double margin, BoxAxis& axis) noexcept;

}  // namespace carom::detail
