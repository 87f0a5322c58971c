// Which instruction sets kernels are compiled for. Kernel files include this first; core/lanes.hpp shows how.
//
// SSE4 (4 lanes), AVX2 (8), AVX-512 (16) and what the compiler's own flags allow: with GCC 12 on plain x86-64 that is one
// lane of scalar code, for processors older than SSE4.2 and AES. Elsewhere the compiler's target alone. SSSE3 and the later
// AVX-512 sets would cost build time and gain nothing here; SVE and RISC-V vectors have no fixed size and cannot be held in
// a struct.
#pragma once

#ifdef HIGHWAY_HWY_DETECT_TARGETS_H_
#error "Include <carom/core/simd_targets.hpp> before any header of Highway: it chooses the targets."
#endif

#define HWY_DISABLED_TARGETS \
    (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_WASM_EMU256)

#include <hwy/detect_targets.h>
