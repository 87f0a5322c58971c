// Debug geometry of one instant: points, lines, triangles and text in named layers. A plain value that any renderer can draw.
//
//   DebugFrame frame = make_debug_frame(world);                  // <carom/viz/make_debug_frame.hpp>
//   DebugLayer& mine = frame.layers.emplace_back(DebugLayer{.name = "rays"});
//   mine.lines.push_back({.a = from, .b = to, .color = {255, 0, 0, 255}});
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/result.hpp>
#include <carom/core/types.hpp>
#include <carom/viz/color.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace carom {

// Every primitive carries the body it belongs to (null: none), so that a viewer can pick it. Positions are in metres, along
// world axes, relative to DebugFrame::origin.

struct DebugPoint {
    vec3 position{0.0f};
    Color color{};
    BodyId body{};
};

struct DebugLine {
    vec3 a{0.0f};
    vec3 b{0.0f};
    Color color{};
    BodyId body{};
};

struct DebugVertex {
    vec3 position{0.0f};
    vec3 normal{0.0f};  ///< unit, for shading
};

struct DebugTriangle {
    std::array<std::uint32_t, 3> vertices{};  ///< into DebugLayer::vertices, counter-clockwise seen from outside
    Color color{};
    BodyId body{};
};

struct DebugText {
    vec3 position{0.0f};
    std::string text{};
    Color color{};
    BodyId body{};
};

/// Primitives that are shown or hidden together.
struct DebugLayer {
    std::string name{};       ///< unique in its frame; letters, digits, '_' and '-', since exported files are named after it
    bool visible = true;      ///< at first; a viewer may toggle it
    bool on_top = false;      ///< points and lines also shine through what hides them, fainter
    bool hide_backs = false;  ///< triangles seen from behind are not drawn: a sheet that faces away hides nothing
    float point_size = 7.0f;  ///< [pixels] > 0
    float line_width = 1.5f;  ///< [pixels] > 0

    std::vector<DebugPoint> points{};
    std::vector<DebugLine> lines{};
    std::vector<DebugVertex> vertices{};  ///< of the triangles
    std::vector<DebugTriangle> triangles{};
    std::vector<DebugText> texts{};

    [[nodiscard]] bool empty() const noexcept {
        return points.empty() && lines.empty() && triangles.empty() && texts.empty();
    }
};

/// One instant of a scene.
struct DebugFrame {
    dvec3 origin{0.0};         ///< world position that all positions are relative to [m]
    dvec3 up{0.0, 1.0, 0.0};   ///< unit, for cameras
    std::string caption{};     ///< what a picture prints in its corner; may be empty
    std::vector<DebugLayer> layers{};

    /// @return the layer of that name, or null. Cost: linear in the number of layers.
    [[nodiscard]] DebugLayer* find(std::string_view name) noexcept;
    [[nodiscard]] const DebugLayer* find(std::string_view name) const noexcept;
};

/// Checks what renderers and exporters rely on: finite positions, vertex indices in range, positive sizes, unique layer
/// names of the allowed characters.
/// @return NotFinite or InvalidArgument with the layer and the primitive named. Cost: linear in the primitives.
[[nodiscard]] Status validate(const DebugFrame& frame);

}  // namespace carom
