#include <carom/cli/build_info.hpp>

#include <fstream>
#include <string_view>
#include <thread>

namespace carom::cli {

std::string version() { return CAROM_VERSION; }
std::string compiler() { return CAROM_COMPILER; }
std::string build_type() { return CAROM_BUILD_TYPE; }

std::string cpu_model() {
    constexpr std::string_view kKey = "model name";
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const std::size_t colon = line.find(": ");
        if (line.starts_with(kKey) && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return {};
}

int cpu_cores() { return static_cast<int>(std::thread::hardware_concurrency()); }

}  // namespace carom::cli
