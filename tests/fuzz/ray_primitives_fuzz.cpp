// libFuzzer on ray_primitives_check.hpp: every input is a scene whose answers exact rationals judge.
#include "ray_primitives_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::ray_primitives_fault({data, size}));
}
