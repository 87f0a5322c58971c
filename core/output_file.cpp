#include <carom/core/output_file.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace carom {
namespace {

Error not_written(const std::string& path) {
    const int reason = errno;
    return {ErrorCode::Io, std::string("cannot be written: ") + std::strerror(reason), path.empty() ? "\"\"" : path};
}

}  // namespace

Status check_writable(const std::string& path) {
    if (path == "-") return {};
    std::error_code ignored;
    const bool existed = std::filesystem::exists(path, ignored);
    std::FILE* file = std::fopen(path.c_str(), "a");
    if (file == nullptr) return not_written(path);
    std::fclose(file);
    if (!existed) std::filesystem::remove(path, ignored);
    return {};
}

Status write_text(const std::string& path, const std::string& text) {
    const bool to_stdout = path == "-";
    std::FILE* file = to_stdout ? stdout : std::fopen(path.c_str(), "w");
    if (file == nullptr) return not_written(path);
    bool good = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    good = std::fflush(file) == 0 && good;
    const Status status = good ? Status{} : Status{not_written(to_stdout ? "standard output" : path)};
    if (!to_stdout && std::fclose(file) != 0 && good) return not_written(path);
    return status;
}

}  // namespace carom
