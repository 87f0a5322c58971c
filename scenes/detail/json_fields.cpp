#include <carom/scenes/detail/json_fields.hpp>

#include <carom/core/math.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::scenes::detail {
namespace {

template <class T>
const T& expect(const Node& node, const char* wanted) {
    if (const T* value = std::get_if<T>(&node.value.data)) return *value;
    fail_at(node, ErrorCode::WrongType, fmt::format("should be {}, but is {}", wanted, node.value.kind()));
}

const JsonValue::Array& array_of(const Node& node, std::size_t size) {
    const auto& list = array(node);
    if (list.size() != size) {
        fail_at(node, ErrorCode::WrongType, fmt::format("should hold {} numbers, but holds {}", size, list.size()));
    }
    return list;
}

}  // namespace

std::string Node::path() const {
    if (parent == nullptr) return {};
    const std::string before = parent->path();
    if (key.empty()) return fmt::format("{}[{}]", before, index);
    return before.empty() ? std::string(key) : fmt::format("{}.{}", before, key);
}

void fail_at(const Node& node, ErrorCode code, std::string message) {
    const std::string path = node.path();
    std::string where = fmt::format("{}:{}", node.file, node.value.line);
    if (!path.empty()) where += ": " + path;
    throw SceneFileError{{code, std::move(message), std::move(where)}};
}

Fields::Fields(const Node& node) : node_(node), members_(expect<JsonValue::Object>(node, "an object")) {}

std::optional<Node> Fields::find(std::string_view key) {
    known_.push_back(key);
    for (const auto& [name, value] : members_) {
        if (name == key) return Node{value, node_.file, &node_, name, 0};
    }
    return std::nullopt;
}

Node Fields::require(std::string_view key) {
    const std::optional<Node> found = find(key);
    if (!found) fail_at(node_, ErrorCode::Empty, fmt::format("\"{}\" is missing", key));
    return *found;
}

void Fields::done() const {
    for (const auto& [name, value] : members_) {
        if (std::ranges::find(known_, name) != known_.end()) continue;
        fail_at(Node{value, node_.file, &node_, name, 0}, ErrorCode::UnknownName,
                fmt::format("there is no key \"{}\" here", name));
    }
}

const JsonValue::Array& array(const Node& node) { return expect<JsonValue::Array>(node, "an array"); }
const std::string& text(const Node& node) { return expect<std::string>(node, "a string"); }
bool boolean(const Node& node) { return expect<bool>(node, "true or false"); }
double number(const Node& node) { return expect<double>(node, "a number"); }

double number(const Node& node, double lower, double upper) {
    const double value = number(node);
    if (value < lower || value > upper) {
        fail_at(node, ErrorCode::InvalidArgument, fmt::format("{} is outside {}..{}", value, lower, upper));
    }
    return value;
}

double positive(const Node& node) {
    const double value = number(node);
    if (!(value > 0.0)) fail_at(node, ErrorCode::InvalidArgument, fmt::format("must be over 0, but is {}", value));
    return value;
}

int integer(const Node& node, int lower, int upper) {
    const double value = number(node, lower, upper);
    if (value != std::floor(value))
        fail_at(node, ErrorCode::WrongType, fmt::format("should be a whole number, but is {}", value));
    return static_cast<int>(value);
}

float single(const Node& node) {
    const double value = number(node);
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max())) {
        fail_at(node, ErrorCode::InvalidArgument, fmt::format("{} is too large for single precision", value));
    }
    return static_cast<float>(value);
}

float positive_single(const Node& node) {
    static_cast<void>(positive(node));
    const float value = single(node);
    if (!(value >= std::numeric_limits<float>::min())) {
        fail_at(node, ErrorCode::InvalidArgument, fmt::format("{} is too small for single precision", number(node)));
    }
    return value;
}

dvec3 vector(const Node& node) {
    static_cast<void>(array_of(node, 3));
    return {number(element(node, 0)), number(element(node, 1)), number(element(node, 2))};
}

vec3 single_vector(const Node& node) {
    static_cast<void>(array_of(node, 3));
    return {single(element(node, 0)), single(element(node, 1)), single(element(node, 2))};
}

dquat rotation(const Node& node) {
    if (std::holds_alternative<JsonValue::Object>(node.value.data)) {
        Fields fields(node);
        const Node axis_node = fields.require("axis");
        const dvec3 axis = vector(axis_node);
        const double angle = number(fields.require("angle"));
        fields.done();
        const double length = glm::length(axis);
        if (!(length > 0.0) || !is_finite(length)) {
            fail_at(axis_node, ErrorCode::InvalidArgument,
                    "must have a direction: its length is 0 or beyond double's range");
        }
        return rotation_about(axis / length, angle);
    }
    static_cast<void>(array_of(node, 4));
    const dquat q{number(element(node, 0)), number(element(node, 1)), number(element(node, 2)),
                  number(element(node, 3))};
    const double length = glm::length(q);
    if (!(std::abs(length - 1.0) <= 1e-3)) {
        fail_at(node, ErrorCode::InvalidArgument,
                fmt::format("a quaternion w, x, y, z must have length 1, not {}", length));
    }
    return q / length;
}

}  // namespace carom::scenes::detail
