// The size of a picture as an option says it.
//
//   if (Result<PictureSize> size = parse_picture_size("800x500"); !size) return size.error();
#pragma once

#include <carom/core/result.hpp>

#include <string>

namespace carom::cli {

struct PictureSize {
    int width = 0, height = 0;  ///< [pixels]
};

/// @return the size; Parse, `where` "--size", for any other form than WIDTHxHEIGHT with both from 1.
[[nodiscard]] Result<PictureSize> parse_picture_size(const std::string& text);

}  // namespace carom::cli
