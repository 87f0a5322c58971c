#include <carom/collision/import/detail/read_file.hpp>

#include <carom/collision/import/read_mesh.hpp>

#include <filesystem>
#include <fstream>
#include <system_error>

namespace carom {
namespace {

// Refuses what is missing, not a regular file, or too large. @return the size.
Result<std::uint64_t> check_file(const std::string& path) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    if (status.type() == std::filesystem::file_type::not_found) return Error{ErrorCode::Io, "there is no such file", path};
    if (error) return Error{ErrorCode::Io, "cannot be read: " + error.message(), path};
    if (!std::filesystem::is_regular_file(status)) return Error{ErrorCode::Io, "is not a regular file", path};
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (error) return Error{ErrorCode::Io, "cannot be read: " + error.message(), path};
    if (size > kMostMeshFileBytes) return Error{ErrorCode::InvalidArgument, "is larger than 4 GiB", path};
    return size;
}

}  // namespace

Result<std::string> read_file(const std::string& path) {
    const Result<std::uint64_t> size = check_file(path);
    if (!size) return size.error();
    std::ifstream file(path, std::ios::binary);
    std::string contents;
    if (file) contents.resize(*size);
    if (!file || !file.read(contents.data(), static_cast<std::streamsize>(*size))) return Error{ErrorCode::Io, "cannot be read", path};
    return contents;
}

}  // namespace carom
