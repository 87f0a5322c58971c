#include <carom/studies/oracle/box_pairs.hpp>

#include <cstddef>

namespace carom::oracle {

std::vector<ProxyPair> pairs_of_row(std::span<const FloatAabb> boxes, std::uint32_t a) {
    const FloatAabb mine = boxes[a];
    std::vector<ProxyPair> pairs;
    for (std::size_t b = std::size_t{a} + 1; b < boxes.size(); ++b) {
        bool apart = false;
        for (int k = 0; k < 3; ++k) {
            apart = apart || boxes[b].upper[k] < mine.lower[k] || mine.upper[k] < boxes[b].lower[k];
        }
        if (!apart) pairs.push_back({a, static_cast<std::uint32_t>(b)});
    }
    return pairs;
}

}  // namespace carom::oracle
