// JSON text as a tree whose every value knows its line, so that errors in a scene can name it.
//
//   Result<JsonValue> root = parse_json(text, "crates.json");
#pragma once

#include <carom/core/result.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace carom::scenes::detail {

inline constexpr std::size_t kMaxJsonDepth = 32;
inline constexpr std::size_t kMaxJsonValues = 4'000'000;

struct JsonValue {
    using Array = std::vector<JsonValue>;
    using Object = std::vector<std::pair<std::string, JsonValue>>;  ///< in the order of the text; keys are unique

    std::variant<std::nullptr_t, bool, double, std::string, Array, Object> data{nullptr};
    int line = 1;

    /// @return what kind of value it is, in words.
    [[nodiscard]] const char* kind() const noexcept;
};

/// Parses the whole of `text`. Numbers become double; those too large for it are an error.
/// @param file  named in errors only.
/// @return Parse, with `where` = file:line, for text that is not JSON, repeats a key, nests deeper than kMaxJsonDepth
/// or holds more than kMaxJsonValues values.
[[nodiscard]] Result<JsonValue> parse_json(std::string_view text, const std::string& file);

}  // namespace carom::scenes::detail
