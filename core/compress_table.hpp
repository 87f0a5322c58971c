// Where the true lanes of a mask stand, for core/lanes.hpp: a table that GCC leaves in place.
//
//   kTrueLanes.of[0b1010] is {1, 3, 0, 0, 0, 0, 0, 0}
#pragma once

#include <cstdint>

namespace carom::detail {

struct alignas(64) TrueLanes {
    std::uint8_t of[256][8];
};

constexpr TrueLanes make_true_lanes() noexcept {
    TrueLanes table{};
    for (unsigned mask = 0; mask < 256; ++mask) {
        unsigned count = 0;
        for (unsigned lane = 0; lane < 8; ++lane) {
            if (((mask >> lane) & 1u) != 0) table.of[mask][count++] = static_cast<std::uint8_t>(lane);
        }
    }
    return table;
}

inline constexpr TrueLanes kTrueLanes = make_true_lanes();

}  // namespace carom::detail
