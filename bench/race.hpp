// Contenders that take turns at the same work, so that a machine whose speed drifts treats all alike.
//
//   std::vector<double> ns = race({carom_turn, peer_turn}, {.items = 20'000, .turn = 1'000});
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace carom::bench {

/// Does the turn that begins at item `first`.
using Turn = std::function<void(std::size_t first)>;

struct RaceLength {
    std::size_t items = 20000;  ///< a multiple of
    std::size_t turn = 1000;    ///< items a turn
    int passes = 7;             ///< over all items, odd, after one to warm up
};

/// @return for each contender the median over the passes of CPU time of the process, an item [ns]. Each contender sees an item once a pass:
/// repeated at once, a turn would run from the cache.
[[nodiscard]] std::vector<double> race(std::span<const Turn> contenders, const RaceLength& length);

}  // namespace carom::bench
