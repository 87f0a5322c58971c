// How many lanes wide the kernels run, chosen at run time.
//
//   for (int width : available_simd_widths()) { set_simd_width(width); EXPECT_EQ(hash_of_run(), golden); }
//   set_simd_width(0);                         // back to the widest
#pragma once

#include <vector>

namespace carom {

/// @return the lane counts of float kernels that this build has and this processor can run, ascending; on x86-64 some of
/// 1 (scalar code), 4 (SSE4), 8 (AVX2) and 16 (AVX-512).
[[nodiscard]] std::vector<int> available_simd_widths();

/// @return the lane count that kernels run with now; at first the widest available one.
[[nodiscard]] int simd_width();

/// Chooses the lane count for the whole process, other users of Highway's dispatch included. Results do not depend on it,
/// only the speed does. For tests and measurements: not to be called while kernels run in another thread.
/// @param width  one of available_simd_widths(), or 0 for the widest. Otherwise reports misuse and changes nothing.
void set_simd_width(int width);

}  // namespace carom
