// A picture as plain pixels.
//
//   Image image(160, 100);
//   image.at(3, 7) = {255, 0, 0};
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

/// Rows from top to bottom, pixels from left to right, red, green and blue each 0..255 in sRGB.
struct Image {
    using Pixel = std::array<std::uint8_t, 3>;

    Image() = default;
    /// A black picture. @param width, height  [pixels] >= 0.
    Image(int width_, int height_)
        : width(width_), height(height_), pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

    int width = 0, height = 0;  ///< [pixels]
    std::vector<Pixel> pixels;  ///< (width height,)

    /// @param x, y  inside the picture, from its upper left corner.
    [[nodiscard]] Pixel& at(int x, int y) { return pixels[index(x, y)]; }
    [[nodiscard]] const Pixel& at(int x, int y) const { return pixels[index(x, y)]; }

    friend bool operator==(const Image&, const Image&) = default;

private:
    [[nodiscard]] std::size_t index(int x, int y) const noexcept {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
};

}  // namespace carom
