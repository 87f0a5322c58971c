#include <carom/cli/picture_size.hpp>

#include <fmt/format.h>

#include <charconv>

namespace carom::cli {

Result<PictureSize> parse_picture_size(const std::string& text) {
    PictureSize size;
    const char* end = text.data() + text.size();
    const std::from_chars_result width = std::from_chars(text.data(), end, size.width);
    const bool has_x = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
    const std::from_chars_result height = has_x ? std::from_chars(width.ptr + 1, end, size.height) : width;
    if (has_x && height.ec == std::errc{} && height.ptr == end && size.width >= 1 && size.height >= 1) return size;
    return Error{ErrorCode::Parse, fmt::format("\"{}\" is not of the form WIDTHxHEIGHT", text), "--size"};
}

}  // namespace carom::cli
