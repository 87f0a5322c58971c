#include <carom/bench/row.hpp>

#include <nlohmann/json.hpp>

namespace carom::bench {
namespace {

nlohmann::ordered_json to_json(const Quality& quality) {
    nlohmann::ordered_json out = nlohmann::ordered_json::object();
    for (const auto& [name, value] : quality) out[name] = value;
    return out;
}

}  // namespace

nlohmann::ordered_json to_json(std::span<const Row> rows) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows) {
        list.push_back({{"bench", row.bench},
                        {"peer", row.peer},
                        {"peer_version", row.peer_version},
                        {"threads", row.threads},
                        {"carom_ms", row.carom_ms},
                        {"peer_ms", row.peer_ms},
                        {"speedup", speedup(row)},
                        {"carom_quality", to_json(row.carom_quality)},
                        {"peer_quality", to_json(row.peer_quality)}});
    }
    return {{"rows", list}};
}

}  // namespace carom::bench
