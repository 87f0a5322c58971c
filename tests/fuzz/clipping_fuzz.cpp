// libFuzzer on clipping_check.hpp: every input is a scene whose answers exact rationals judge.
#include "clipping_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::clipping_fault({data, size}));
}
