// What the VTK tests share: a folder that goes away, a small scene, a process without a display.
#pragma once

#include <carom/viz/camera.hpp>
#include <carom/viz/layer.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <unistd.h>

namespace carom {

/// A new folder, removed with what is in it.
class ScratchFolder {
public:
    explicit ScratchFolder(const std::string& name)
        : path_(std::filesystem::temp_directory_path() / ("carom_" + name + "_" + std::to_string(::getpid()))) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~ScratchFolder() { std::filesystem::remove_all(path_); }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    [[nodiscard]] std::string operator/(const std::string& file) const { return (path_ / file).string(); }
    [[nodiscard]] std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

/// DISPLAY as given (none: unset) for as long as this lives.
class DisplayIs {
public:
    explicit DisplayIs(const char* value) {
        if (const char* before = std::getenv("DISPLAY")) before_ = before;
        if (value != nullptr) {
            ::setenv("DISPLAY", value, 1);
        } else {
            ::unsetenv("DISPLAY");
        }
    }
    ~DisplayIs() {
        if (before_) {
            ::setenv("DISPLAY", before_->c_str(), 1);
        } else {
            ::unsetenv("DISPLAY");
        }
    }
    DisplayIs(const DisplayIs&) = delete;
    DisplayIs& operator=(const DisplayIs&) = delete;

private:
    std::optional<std::string> before_;
};

inline constexpr BodyId kRedBody{3, 1};
inline constexpr BodyId kBlueBody{4, 2};
inline constexpr Color kRed{220, 20, 20, 255};
inline constexpr Color kBlue{20, 20, 220, 255};
inline constexpr Color kGround{196, 190, 176, 255};
inline constexpr Color kGreen{0, 200, 0, 255};

/// A red box to the left of a blue sphere, green contacts between them that the bodies hide from the front.
inline DebugFrame small_scene(const dvec3& origin = dvec3{0.0}) {
    DebugFrame frame;
    frame.origin = origin;
    DebugLayer shapes{.name = to_string(Layer::Shapes)};
    append_shape(shapes, Box{{1.0f, 1.0f, 1.0f}}, {{-1.5, 0.0, 0.0}}, {kRed, kRed, kRedBody, 20});
    append_shape(shapes, Sphere{1.0f}, {{1.5, 0.0, 0.0}}, {kBlue, kBlue, kBlueBody, 20});
    DebugLayer contacts{.name = to_string(Layer::Contacts), .on_top = true, .point_size = 12.0f};
    contacts.points.push_back({{-1.5f, 0.0f, 0.0f}, kGreen, kRedBody});
    contacts.lines.push_back({{-1.5f, 0.0f, 0.0f}, {1.5f, 0.0f, 0.0f}, kGreen, kRedBody});
    DebugLayer names{.name = to_string(Layer::Names), .visible = false};
    names.texts.push_back({{-1.5f, 0.0f, 0.0f}, "red <box> & \"co\"", kRed, kRedBody});
    frame.layers = {shapes, contacts, names};
    return frame;
}

inline constexpr BodyId kWallBody{9, 1};

/// A wall in front of everything that faces the front camera (side = 1) or turns its back on it (-1), and hides its back.
inline DebugFrame with_wall(DebugFrame frame, float side) {
    DebugLayer wall{.name = to_string(Layer::Static), .hide_backs = true};
    append_plane(wall, Plane{{0.0f, 0.0f, side}, 2.0f * side}, {}, {.half_size = 4.0, .tiles = 1}, {kGround, kGround, kWallBody, 20});
    frame.layers.push_back(wall);
    frame.layers[1].visible = false;
    return frame;
}

/// Looks along -z at the middle of small_scene.
inline Camera front_camera(const dvec3& origin = dvec3{0.0}) {
    return {.position = origin + dvec3{0.0, 0.0, 12.0}, .target = origin, .up = {0.0, 1.0, 0.0}, .field_of_view = 0.5};
}

}  // namespace carom
