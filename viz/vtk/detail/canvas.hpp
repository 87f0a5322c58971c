// The look of every picture and window: background, light, camera, caption.
#pragma once

#include <carom/viz/camera.hpp>
#include <carom/viz/debug_frame.hpp>
#include <carom/viz/vtk/detail/frame_actors.hpp>

#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

namespace carom::detail {

struct CanvasSettings {
    int width = 1600;
    int height = 1000;
    bool off_screen = true;
    float pixel_scale = 1.0f;  ///< of points, lines and text
};

/// @return InvalidArgument for a width or height outside 16..8192.
[[nodiscard]] Status validate_size(int width, int height);

/// A render window with a debug frame in it. Make one only where check_display() is content.
class Canvas {
public:
    explicit Canvas(const CanvasSettings& settings);

    /// @param frame  valid.
    void show(const DebugFrame& frame);
    /// @param camera  valid; positions in the world.
    void set_camera(const Camera& camera);
    void set_caption(const std::string& text);

    [[nodiscard]] FrameActors& actors() noexcept { return actors_; }
    [[nodiscard]] vtkRenderWindow* window() noexcept { return window_; }
    [[nodiscard]] vtkRenderer* scene() noexcept { return scene_; }
    void render();

private:
    void add_lights();

    vtkNew<vtkRenderWindow> window_;
    vtkNew<vtkRenderer> scene_, overlay_;
    vtkNew<vtkTextActor> caption_;
    vtkNew<vtkLight> sun_;
    FrameActors actors_;
    dvec3 origin_{0.0};  ///< of the frame shown
};

}  // namespace carom::detail
