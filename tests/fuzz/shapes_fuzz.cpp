// libFuzzer on shapes_check.hpp: every input is a scene of two convex shapes and a compound, of raw bits or of everyday sizes.
#include "report.hpp"
#include "shapes_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::shapes_fault({data, size}));
}
