// Results that can fail, with typed errors that name the place.
//
//   Result<Scene> scene = read_scene(path);
//   if (!scene) { print(scene.error().message); }
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace carom {

/// What went wrong, for programs; the message is for people.
enum class ErrorCode {
    InvalidArgument,  ///< a value outside the documented range
    NotFinite,        ///< NaN or infinity where a finite number is needed
    DeadId,           ///< an id whose object was destroyed, or that never existed
    WrongType,        ///< right form, wrong kind (a mesh on a dynamic body without mass properties, a JSON string for a number)
    Degenerate,       ///< geometry without volume or area
    Empty,            ///< nothing where something is needed
    UnknownName,      ///< a scene, key or command that does not exist
    Parse,            ///< text that is not of the format
    Io,               ///< a file that cannot be read or written
};

/// @return the code's name, as written above.
[[nodiscard]] const char* to_string(ErrorCode code) noexcept;

/// One failure: what, in words, and where (a function, or file:line, or a JSON path).
struct Error {
    ErrorCode code = ErrorCode::InvalidArgument;
    std::string message;
    std::string where;
};

/// Either a value or an Error.
template <class T>
class [[nodiscard]] Result {
public:
    Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

    [[nodiscard]] bool has_value() const noexcept { return state_.index() == 0; }
    explicit operator bool() const noexcept { return has_value(); }

    /// Requires has_value(); throws std::bad_variant_access otherwise.
    [[nodiscard]] T& value() & { return std::get<0>(state_); }
    [[nodiscard]] const T& value() const& { return std::get<0>(state_); }
    [[nodiscard]] T&& value() && { return std::get<0>(std::move(state_)); }
    T& operator*() & { return value(); }
    const T& operator*() const& { return value(); }
    T&& operator*() && { return std::move(*this).value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

    /// Requires !has_value(); throws std::bad_variant_access otherwise.
    [[nodiscard]] const Error& error() const { return std::get<1>(state_); }

private:
    std::variant<T, Error> state_;
};

/// A result without a value: nothing on success, an Error otherwise.
class [[nodiscard]] Status {
public:
    Status() = default;
    Status(Error error) : error_(std::move(error)) {}
    [[nodiscard]] bool ok() const noexcept { return !error_.has_value(); }
    explicit operator bool() const noexcept { return ok(); }
    [[nodiscard]] const Error& error() const { return error_.value(); }

private:
    std::optional<Error> error_;
};

}  // namespace carom
