#include <carom/viz/vtk/detail/files.hpp>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace carom::detail {

Status write_file(const std::string& path, std::string_view bytes) {
    errno = 0;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (out) return {};
    const std::string reason = errno != 0 ? std::strerror(errno) : "unknown reason";
    return Error{ErrorCode::Io, "cannot write " + path + ": " + reason, path};
}

Status make_directory(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!error && std::filesystem::is_directory(path, error)) return {};
    const std::string reason = error ? error.message() : "it is not a directory";
    return Error{ErrorCode::Io, "cannot make the directory " + path + ": " + reason, path};
}

}  // namespace carom::detail
