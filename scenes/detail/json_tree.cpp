#include <carom/scenes/detail/json_tree.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>

namespace carom::scenes::detail {
namespace {

using nlohmann::json;

/// The line of the character that the parser read last; a line break belongs to the line that it ends.
struct LineCount {
    int line = 1;
    bool broken = false;

    void read(char c) {
        if (broken) ++line;
        broken = c == '\n';
    }
};

/// Hands characters to the parser and counts lines; the parser says no positions of what it accepts.
class CountingIterator {
public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = const char&;

    CountingIterator(const char* at, LineCount* lines) : at_(at), lines_(lines) {}
    reference operator*() const { return *at_; }
    CountingIterator& operator++() {
        lines_->read(*at_++);
        return *this;
    }
    CountingIterator operator++(int) {
        CountingIterator before = *this;
        ++*this;
        return before;
    }
    friend bool operator==(const CountingIterator& a, const CountingIterator& b) { return a.at_ == b.at_; }

private:
    const char* at_;
    LineCount* lines_;
};

/// Builds the tree from the parser's events. A handler that returns false ends the parse.
class TreeBuilder final : public json::json_sax_t {
public:
    TreeBuilder(const LineCount& lines, const std::string& file) : lines_(lines), file_(file) {}

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(std::int64_t value) override { return add(static_cast<double>(value)); }
    bool number_unsigned(std::uint64_t value) override { return add(static_cast<double>(value)); }
    bool number_float(double value, const std::string&) override { return add(value); }
    bool string(std::string& value) override { return add(std::string(std::move(value))); }
    bool binary(json::binary_t&) override { return fail("binary data is not JSON"); }

    bool start_object(std::size_t) override { return open(JsonValue::Object{}); }
    bool key(std::string& name) override {
        const auto& members = std::get<JsonValue::Object>(open_.back()->data);
        if (std::ranges::find(members, name, &std::pair<std::string, JsonValue>::first) != members.end()) {
            return fail(fmt::format("the key \"{}\" is there twice", name));
        }
        key_ = std::move(name);
        return true;
    }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(JsonValue::Array{}); }
    bool end_array() override { return close(); }

    bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& problem) override {
        const std::string text = problem.what();  // "[json.exception.parse_error.101] what went wrong"
        const std::size_t prefix = text.find("] ");
        return fail(prefix == std::string::npos ? text : text.substr(prefix + 2));
    }

    Result<JsonValue> finish() {
        if (error_) return *std::move(error_);
        return std::move(root_);
    }

private:
    template <class T>
    bool add(T value) {
        return place(std::move(value)) != nullptr;
    }

    /// Puts a value where it belongs: into the innermost open container, or at the root.
    template <class T>
    JsonValue* place(T value) {
        if (++count_ > kMaxJsonValues) {
            fail(fmt::format("more than {} values", kMaxJsonValues));
            return nullptr;
        }
        JsonValue* slot = &root_;
        if (!open_.empty()) {
            if (auto* list = std::get_if<JsonValue::Array>(&open_.back()->data)) {
                slot = &list->emplace_back();
            } else {
                slot =
                    &std::get<JsonValue::Object>(open_.back()->data).emplace_back(std::move(key_), JsonValue{}).second;
            }
        }
        slot->data.template emplace<T>(std::move(value));
        slot->line = lines_.line;
        return slot;
    }

    template <class T>
    bool open(T container) {
        if (open_.size() == kMaxJsonDepth) return fail(fmt::format("nested deeper than {} levels", kMaxJsonDepth));
        JsonValue* placed = place(std::move(container));
        if (placed == nullptr) return false;
        open_.push_back(placed);  // stays valid: only the innermost container grows
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    bool fail(std::string message) {
        error_ = Error{ErrorCode::Parse, std::move(message), fmt::format("{}:{}", file_, lines_.line)};
        return false;
    }

    const LineCount& lines_;
    const std::string& file_;
    JsonValue root_;
    std::vector<JsonValue*> open_;
    std::string key_;
    std::size_t count_ = 0;
    std::optional<Error> error_;
};

}  // namespace

const char* JsonValue::kind() const noexcept {
    constexpr const char* kKinds[] = {"null", "true or false", "a number", "a string", "an array", "an object"};
    return kKinds[data.index()];
}

Result<JsonValue> parse_json(std::string_view text, const std::string& file) {
    LineCount lines;
    TreeBuilder builder(lines, file);
    const char* begin = text.data();
    json::sax_parse(CountingIterator(begin, &lines), CountingIterator(begin + text.size(), &lines), &builder);
    return builder.finish();
}

}  // namespace carom::scenes::detail
