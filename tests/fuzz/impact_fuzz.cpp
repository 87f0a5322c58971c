// libFuzzer on impact_check.hpp: every input is a motion of raw bits; exact rationals judge that no time of impact is late.
#include "impact_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::impact_fault({data, size}));
}
