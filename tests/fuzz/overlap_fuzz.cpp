// libFuzzer on overlap_check.hpp: every input is a pair of primitives whose answers exact rationals judge.
#include "overlap_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::overlap_fault({data, size}));
}
