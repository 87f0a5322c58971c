// What built this program and what it runs on.
#pragma once

#include <string>

namespace carom::cli {

[[nodiscard]] std::string version();     ///< of Carom, "0.1.0"
[[nodiscard]] std::string compiler();    ///< "GNU 12.2.0"
[[nodiscard]] std::string build_type();  ///< "RelWithDebInfo"; empty if none was chosen
[[nodiscard]] std::string cpu_model();   ///< as the system names it; empty where it does not say
[[nodiscard]] int cpu_cores();           ///< that the system offers, hardware threads included

}  // namespace carom::cli
