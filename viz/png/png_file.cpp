#include <carom/viz/png/png_file.hpp>

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace carom {
namespace {

constexpr png_uint_32 kMostPixels = 8192;

struct CloseFile {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

// libpng's own description of a picture, released at the end.
struct Description {
    png_image image{};
    Description() { image.version = PNG_IMAGE_VERSION; }
    ~Description() { png_image_free(&image); }
    Description(const Description&) = delete;
    Description& operator=(const Description&) = delete;
};

}  // namespace

Status write_png(const Image& image, const std::string& path) {
    const bool whole = image.width > 0 && image.height > 0 &&
                       image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (!whole) return Error{ErrorCode::InvalidArgument, "the picture has no pixels, or not as many as its size says", "write_png"};
    Description description;
    description.image.width = static_cast<png_uint_32>(image.width);
    description.image.height = static_cast<png_uint_32>(image.height);
    description.image.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&description.image, path.c_str(), 0, image.pixels.data(), 0, nullptr) == 0) {
        return Error{ErrorCode::Io, std::string("cannot be written: ") + description.image.message, path};
    }
    return {};
}

Result<Image> read_png(const std::string& path) {
    const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
    if (!file) return Error{ErrorCode::Io, std::string("cannot be read: ") + std::strerror(errno), path};
    Description description;
    const auto damaged = [&] { return Error{ErrorCode::Parse, std::string("no PNG: ") + description.image.message, path}; };
    if (png_image_begin_read_from_stdio(&description.image, file.get()) == 0) return damaged();
    if (description.image.width > kMostPixels || description.image.height > kMostPixels) {
        return Error{ErrorCode::Parse, "larger than 8192 x 8192 pixels", path};
    }
    description.image.format = PNG_FORMAT_RGB;
    Image image(static_cast<int>(description.image.width), static_cast<int>(description.image.height));
    const png_color black{0, 0, 0};
    if (png_image_finish_read(&description.image, &black, image.pixels.data(), 0, nullptr) == 0) return damaged();
    return image;
}

}  // namespace carom
