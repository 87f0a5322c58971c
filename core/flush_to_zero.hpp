// Numbers next to zero take a processor a hundred times as long as others: here they are zero for a while.
#pragma once

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace carom {

/// While it lives, the calling thread takes denormal floats and doubles for 0 and makes none (x86: FTZ and DAZ; elsewhere it does nothing). Then all is as before.
/// What it covers must be calls: a compiler may move arithmetic past it.
class FlushToZero {
public:
#if defined(__SSE2__)
    FlushToZero() noexcept : before_(_mm_getcsr()) { _mm_setcsr(before_ | kFlushResults | kZeroOperands); }
    ~FlushToZero() { _mm_setcsr(before_); }
#else
    FlushToZero() noexcept = default;
#endif
    FlushToZero(const FlushToZero&) = delete;
    FlushToZero& operator=(const FlushToZero&) = delete;

private:
#if defined(__SSE2__)
    static constexpr unsigned kFlushResults = 0x8000, kZeroOperands = 0x0040;
    unsigned before_;
#endif
};

}  // namespace carom
