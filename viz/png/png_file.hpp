// Pictures as PNG files.
//
//   Status written = write_png(image, "depth.png");
//   Result<Image> again = read_png("depth.png");          // the same pixels
#pragma once

#include <carom/core/result.hpp>
#include <carom/viz/image.hpp>

#include <string>

namespace carom {

/// Replaces the file by the picture, 8 bits a channel, without loss.
/// @param image  at least one pixel, as many pixels as width and height say.
/// @return InvalidArgument for a picture that is not so, Io with the path where the file cannot be written.
[[nodiscard]] Status write_png(const Image& image, const std::string& path);

/// @return the pixels of a PNG file of at most 8192 x 8192; what its format has besides 8-bit colours is converted, and transparency is
/// laid on black. Io where there is no such file, Parse where it is no PNG, is damaged, or is larger.
[[nodiscard]] Result<Image> read_png(const std::string& path);

}  // namespace carom
