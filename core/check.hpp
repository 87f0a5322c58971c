// Checks: misuse by the caller (always on) and bugs of our own (debug and test builds).
//
//   CAROM_REQUIRE(dt >= 0, ErrorCode::InvalidArgument, "dt must not be negative", StepReport{});
//   CAROM_ASSERT(a.index < b.index);
#pragma once

#include <carom/core/result.hpp>

#include <source_location>
#include <stdexcept>
#include <string>

namespace carom {

/// What the default error handler throws: a std::invalid_argument that carries the typed error.
class MisuseError : public std::invalid_argument {
public:
    explicit MisuseError(Error error);
    [[nodiscard]] const Error& error() const noexcept { return error_; }

private:
    Error error_;
};

/// Called at misuse of the API, before anything has changed. May throw; if it returns, the call that was misused returns
/// its documented null value.
using ErrorHandler = void (*)(const Error&);

/// Replaces the handler for the whole process; null brings the default back (throws MisuseError).
/// @return the handler before. Thread-safe.
ErrorHandler set_error_handler(ErrorHandler handler) noexcept;

/// Reports misuse to the handler.
void report_error(ErrorCode code, std::string message, std::source_location where = std::source_location::current());

namespace detail {
[[noreturn]] void assertion_failed(const char* condition, std::source_location where) noexcept;
}

}  // namespace carom

/// Refuses misuse: reports it and returns the last argument (nothing for void functions).
#define CAROM_REQUIRE(condition, code, message, ...)    \
    do {                                                \
        if (!(condition)) {                             \
            ::carom::report_error((code), (message));   \
            return __VA_ARGS__;                         \
        }                                               \
    } while (false)

#if !defined(NDEBUG) || defined(CAROM_ENABLE_ASSERT)
#define CAROM_ASSERT(condition) \
    ((condition) ? void(0) : ::carom::detail::assertion_failed(#condition, std::source_location::current()))
#else
#define CAROM_ASSERT(condition) static_cast<void>(sizeof((condition) ? 1 : 0))
#endif
