// libFuzzer on mesh_file_check.hpp: every input claims to be a mesh file.
#include "mesh_file_check.hpp"
#include "report.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::mesh_file_fault({data, size}));
}
