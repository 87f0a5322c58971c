// Lines, fields and numbers of text formats.
//
//   LineReader lines(contents);
//   while (lines.next()) { Fields fields(lines.line()); std::optional<double> x = parse_number<float>(fields.next()); }
#pragma once

#include <charconv>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace carom {

inline bool is_space(char c) noexcept { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// The words of a text, between white space. An empty word comes after the last.
class Fields {
public:
    explicit Fields(std::string_view text) : rest_(text) {}
    std::string_view next() {
        while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
        std::size_t size = 0;
        while (size < rest_.size() && !is_space(rest_[size])) ++size;
        const std::string_view field = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return field;
    }
    /// What follows the last word.
    [[nodiscard]] std::string_view rest() const { return rest_; }

private:
    std::string_view rest_;
};

/// The lines of a text that hold anything, without what follows a '#'. Lines end with LF, CR LF or the text.
class LineReader {
public:
    explicit LineReader(std::string_view text, std::size_t number = 0) : rest_(text), number_(number) {}
    /// @return false after the last line.
    bool next() {
        while (!rest_.empty()) {
            const std::size_t end = rest_.find('\n');
            line_ = rest_.substr(0, end);
            rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
            ++number_;
            line_ = line_.substr(0, line_.find('#'));
            if (line_.find_first_not_of(" \t\r\v\f") != std::string_view::npos) return true;
        }
        line_ = {};
        return false;
    }
    [[nodiscard]] std::string_view line() const { return line_; }
    [[nodiscard]] std::size_t bytes_left() const { return rest_.size(); }
    /// @return "line 7: " and the message; the line is the one last read, counted from 1.
    [[nodiscard]] std::string at(const std::string& message) const { return "line " + std::to_string(number_) + ": " + message; }

private:
    std::string_view rest_, line_;
    std::size_t number_;
};

/// A number that takes up all of `field`; none otherwise. Integers in decimal. Of reals, too large ones and words for them are
/// infinities or NaN, too small ones are zero; a real is rounded to T once.
template <class T>
[[nodiscard]] std::optional<T> parse_number(std::string_view field) {
    if (field.size() > 1 && field.front() == '+' && field[1] != '-') field.remove_prefix(1);
    T value{};
    const char* const end = field.data() + field.size();
    const std::from_chars_result result = std::from_chars(field.data(), end, value);
    if (result.ptr != end || result.ec == std::errc::invalid_argument) return std::nullopt;
    if (result.ec == std::errc{}) return value;
    if constexpr (std::is_same_v<T, float>) {
        const std::optional<double> wide = parse_number<double>(field);
        return wide ? std::optional(static_cast<float>(*wide)) : std::nullopt;
    } else if constexpr (std::is_same_v<T, double>) {
        const bool small = field.find("e-") != std::string_view::npos || field.find("E-") != std::string_view::npos;
        return small ? 0.0 : std::numeric_limits<double>::infinity();
    } else {
        return std::nullopt;
    }
}

}  // namespace carom
