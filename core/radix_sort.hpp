// A stable sort of 64-bit keys, the only sort inside a step: no comparisons, the same order everywhere.
//
//   RadixScratch scratch;                       // kept from step to step
//   radix_sort(keys, body_of_key, scratch);
//   std::uint32_t key = ordered_key(lower_x);   // floats in the order of <
#pragma once

#include <carom/core/check.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace carom {

/// Memory of radix_sort; grows to the largest sort and stays.
struct RadixScratch {
    std::vector<std::uint64_t> keys;
    std::vector<std::uint32_t> payload;
};

/// @return an integer that sorts as the float does: -inf < ... < -0 < +0 < ... < +inf. NaN sorts beyond the infinities.
[[nodiscard]] inline std::uint32_t ordered_key(float x) noexcept {
    const auto word = std::bit_cast<std::uint32_t>(x);
    return (word >> 31) != 0 ? ~word : word | 0x80000000u;
}

/// Sorts `keys` ascending and moves `payload` along; equal keys keep their order.
/// Method: least significant digit first, bytes as digits; a byte that all keys share costs nothing but its count.
/// @param payload  (n,) as keys; otherwise reports misuse and changes nothing. n < 2^32.
/// Cost: O(n) for each byte that differs; no allocation once the scratch has grown.
inline void radix_sort(std::span<std::uint64_t> keys, std::span<std::uint32_t> payload, RadixScratch& scratch) {
    CAROM_REQUIRE(keys.size() == payload.size(), ErrorCode::InvalidArgument, "keys and payload differ in size");
    const std::size_t n = keys.size();
    if (n < 2) return;
    if (scratch.keys.size() < n) {
        scratch.payload.resize(n);
        scratch.keys.resize(n);  // last: whoever runs out of memory in between finds too few of them
    }
    std::array<std::array<std::uint32_t, 256>, 8> counts{};
    for (const std::uint64_t key : keys) {
        for (unsigned digit = 0; digit < 8; ++digit) ++counts[digit][(key >> (8 * digit)) & 255u];
    }
    std::uint64_t* from = keys.data();
    std::uint64_t* to = scratch.keys.data();
    std::uint32_t* payload_from = payload.data();
    std::uint32_t* payload_to = scratch.payload.data();
    for (unsigned digit = 0; digit < 8; ++digit) {
        std::array<std::uint32_t, 256>& count = counts[digit];
        if (count[(from[0] >> (8 * digit)) & 255u] == n) continue;
        std::uint32_t start = 0;
        for (std::uint32_t& c : count) start += std::exchange(c, start);
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint32_t place = count[(from[i] >> (8 * digit)) & 255u]++;
            to[place] = from[i];
            payload_to[place] = payload_from[i];
        }
        std::swap(from, to);
        std::swap(payload_from, payload_to);
    }
    if (from == keys.data()) return;
    for (std::size_t i = 0; i < n; ++i) {
        keys[i] = from[i];
        payload[i] = payload_from[i];
    }
}

}  // namespace carom
