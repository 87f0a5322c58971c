// libFuzzer on convex_check.hpp: every input is a pair of raw bits; exact rationals judge the verdicts of two boxes.
#include "convex_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::sat_fault({data, size}));
}
