// Typed access to a JSON tree; every failure names file, line and key.
//
//   Fields fields(node);
//   const double radius = positive(fields.require("radius"));
//   fields.done();                       // whatever was not asked for is an unknown key
//
// Failures leave by SceneFileError, which read_scene turns into a Result.
#pragma once

#include <carom/core/types.hpp>
#include <carom/scenes/detail/json_tree.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace carom::scenes::detail {

struct SceneFileError {
    Error error;
};

/// A value with the way to it. The parent and the file's name must outlive it.
struct Node {
    const JsonValue& value;
    const std::string& file;
    const Node* parent = nullptr;
    std::string_view key{};  ///< in the parent object; empty: an element
    std::size_t index = 0;   ///< in the parent array

    /// @return e.g. "bodies[3].shapes[0].radius"; empty for the root.
    [[nodiscard]] std::string path() const;
};

/// Ends the reading with an error at `node`.
[[noreturn]] void fail_at(const Node& node, ErrorCode code, std::string message);

/// The members of an object. Keeps a reference to the node.
class Fields {
public:
    /// `node` must be an object.
    explicit Fields(const Node& node);
    [[nodiscard]] std::optional<Node> find(std::string_view key);
    [[nodiscard]] Node require(std::string_view key);
    /// Refuses members that were never asked for.
    void done() const;

private:
    const Node& node_;
    const JsonValue::Object& members_;
    std::vector<std::string_view> known_;
};

[[nodiscard]] const JsonValue::Array& array(const Node& node);
[[nodiscard]] inline Node element(const Node& list, std::size_t index) {
    return {array(list)[index], list.file, &list, {}, index};
}

[[nodiscard]] const std::string& text(const Node& node);
[[nodiscard]] bool boolean(const Node& node);
[[nodiscard]] double number(const Node& node);                              ///< finite
[[nodiscard]] double number(const Node& node, double lower, double upper);  ///< in [lower, upper]
[[nodiscard]] double positive(const Node& node);                            ///< > 0
[[nodiscard]] int integer(const Node& node, int lower, int upper);          ///< whole, in [lower, upper]
[[nodiscard]] float single(const Node& node);                               ///< within float's range
[[nodiscard]] float positive_single(const Node& node);                      ///< > 0 as a float
[[nodiscard]] dvec3 vector(const Node& node);                               ///< three numbers
[[nodiscard]] vec3 single_vector(const Node& node);
/// [w, x, y, z] of length 1 to 1e-3, or {"axis": [x, y, z], "angle": radians}.
[[nodiscard]] dquat rotation(const Node& node);

}  // namespace carom::scenes::detail
