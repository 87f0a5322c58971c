#include <carom/viz/color.hpp>

#include <array>

namespace carom {
namespace {

// Chosen by eye for a light background: equal lightness within the set, neighbours far apart in hue.
constexpr std::array<Color, kPaletteSize> kPalette{{
    {62, 124, 177, 255},   // blue
    {232, 141, 52, 255},   // orange
    {88, 164, 99, 255},    // green
    {214, 87, 83, 255},    // coral
    {132, 108, 176, 255},  // violet
    {70, 186, 178, 255},   // teal
    {238, 193, 72, 255},   // yellow
    {200, 112, 160, 255},  // pink
    {141, 153, 64, 255},   // olive
    {108, 128, 150, 255},  // slate
}};

std::uint8_t mix_channel(std::uint8_t a, std::uint8_t b, double t) noexcept {
    return static_cast<std::uint8_t>(a + t * (static_cast<double>(b) - a) + 0.5);
}

}  // namespace

Color palette(std::uint32_t index) noexcept { return kPalette[index % kPaletteSize]; }

Color mix(Color a, Color b, double t) noexcept {
    if (!(t > 0.0)) return a;
    if (t >= 1.0) return b;
    return {mix_channel(a.r, b.r, t), mix_channel(a.g, b.g, t), mix_channel(a.b, b.b, t), mix_channel(a.a, b.a, t)};
}

}  // namespace carom
