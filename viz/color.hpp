// Colours of debug geometry, and the palette they come from.
//
//   Color c = palette(body.slot);
#pragma once

#include <cstdint>

namespace carom {

/// Red, green, blue and opacity, each 0..255, in sRGB.
struct Color {
    std::uint8_t r = 200, g = 200, b = 200, a = 255;
    friend bool operator==(const Color&, const Color&) = default;
};

inline constexpr std::uint32_t kPaletteSize = 10;

/// @return one of kPaletteSize well-separated colours of similar lightness; the index wraps round.
[[nodiscard]] Color palette(std::uint32_t index) noexcept;

/// @return `a` at t = 0, `b` at t = 1, linear between, channel by channel; t outside [0, 1] (or NaN) counts as the nearer end
/// (as 0).
[[nodiscard]] Color mix(Color a, Color b, double t) noexcept;

}  // namespace carom
