// Numbers from bytes of either order.
//
//   float x = load<float>(bytes, /* big_endian */ false);
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace carom {

/// @param bytes  at least sizeof(T) of them.
template <class T>
[[nodiscard]] T load(std::string_view bytes, bool big_endian) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes.data(), sizeof(T));
    if (big_endian != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}

}  // namespace carom
