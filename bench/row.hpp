// What every group of the comparison hands back: rows for the table and the JSON file.
//
//   nlohmann::ordered_json report = to_json(rows);
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace carom::bench {

/// A group's own errors by name, in SI units.
using Quality = std::vector<std::pair<std::string, double>>;

/// The same work by Carom and by one peer, timed in one run.
struct Row {
    std::string bench;  ///< e.g. "pile_boxes/4000"
    std::string peer;   ///< e.g. "bullet"
    std::string peer_version;
    int threads = 1;
    double carom_ms = 0.0;
    double peer_ms = 0.0;
    Quality carom_quality;
    Quality peer_quality;
};

/// @return the peer's time over Carom's.
[[nodiscard]] inline double speedup(const Row& row) { return row.peer_ms / row.carom_ms; }

/// @return {"rows": [...]}, a member of each row by its name, with "speedup" besides.
[[nodiscard]] nlohmann::ordered_json to_json(std::span<const Row> rows);

}  // namespace carom::bench
