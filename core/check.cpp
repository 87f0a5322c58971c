#include <carom/core/check.hpp>

#include <atomic>
#include <cstdio>
#include <cstdlib>

namespace carom {
namespace {

void throw_misuse(const Error& error) { throw MisuseError(error); }

std::atomic<ErrorHandler> g_handler{&throw_misuse};

}  // namespace

const char* to_string(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::InvalidArgument: return "InvalidArgument";
        case ErrorCode::NotFinite: return "NotFinite";
        case ErrorCode::DeadId: return "DeadId";
        case ErrorCode::WrongType: return "WrongType";
        case ErrorCode::Degenerate: return "Degenerate";
        case ErrorCode::Empty: return "Empty";
        case ErrorCode::UnknownName: return "UnknownName";
        case ErrorCode::Parse: return "Parse";
        case ErrorCode::Io: return "Io";
    }
    return "unknown";
}

MisuseError::MisuseError(Error error)
    : std::invalid_argument(error.where + ": " + error.message), error_(std::move(error)) {}

ErrorHandler set_error_handler(ErrorHandler handler) noexcept {
    return g_handler.exchange(handler != nullptr ? handler : &throw_misuse);
}

void report_error(ErrorCode code, std::string message, std::source_location where) {
    g_handler.load()(Error{code, std::move(message), where.function_name()});
}

namespace detail {

void assertion_failed(const char* condition, std::source_location where) noexcept {
    std::fprintf(stderr, "%s:%u: assertion failed in %s: %s\n", where.file_name(), where.line(), where.function_name(),
                 condition);
    std::abort();
}

}  // namespace detail
}  // namespace carom
