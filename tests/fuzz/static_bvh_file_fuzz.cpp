// libFuzzer on static_bvh_file_check.hpp: every input claims to be a saved hierarchy, as it is and with its checksum made to fit.
#include "report.hpp"
#include "static_bvh_file_check.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return carom::test::report(carom::test::static_bvh_file_fault({reinterpret_cast<const std::byte*>(data), size}));
}
