// How a fuzz target says that something is wrong.
//
//   extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
//       return test::report(test::clipping_fault({data, size}));
//   }
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace carom::test {

/// Ends the program where there is a fault, which libFuzzer then keeps the input of.
inline int report(const std::string& fault) {
    if (!fault.empty()) {
        std::fprintf(stderr, "fault: %s\n", fault.c_str());
        std::abort();
    }
    return 0;
}

}  // namespace carom::test
