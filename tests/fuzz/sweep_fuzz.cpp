// libFuzzer on sweep_check.hpp: every input is a sweep, or two convex shapes that move and turn, of raw bits.
#include "report.hpp"
#include "sweep_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::sweep_fault({data, size}));
}
