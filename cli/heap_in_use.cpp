#include <carom/cli/heap_in_use.hpp>

#include <cstdlib>  // and with it the version of glibc

#if defined(__GLIBC__)
#if __GLIBC_PREREQ(2, 33)
#define CAROM_HAS_MALLINFO2 1
#include <malloc.h>
#endif
#endif

namespace carom::cli {

std::optional<std::size_t> heap_in_use() {
#ifdef CAROM_HAS_MALLINFO2
    const struct mallinfo2 info = mallinfo2();
    const std::size_t bytes = info.uordblks + info.hblkhd;
    if (bytes > 0) return bytes;  // 0: somebody else's malloc
#endif
    return std::nullopt;
}

}  // namespace carom::cli
