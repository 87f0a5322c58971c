// The contact of a face of one box with another box.
#pragma once

#include <carom/narrowphase/detail/box_sat.hpp>

namespace carom::detail {

/// Fills `patch` with the points where the boxes meet under the face axis `axis`; none where no part of the other box's nearest face is
/// over the face. Points lie square over the reference face, so its rectangle makes every test a comparison.
void build_box_face_patch(const BoxPair& p, const BoxAxis& axis, double margin, Patch& patch) noexcept;

}  // namespace carom::detail
