// What rays see of a scene: a picture of depth, of normals or of ids, drawn with the library's own ray casts and nothing else. No
// display, no graphics library, and the same pixels on every machine.
//
//   Result<Image> image = draw_rays(world, {.width = 640, .height = 400, .camera = camera, .view = RayView::Normal});
//   Status written = write_png(*image, "normals.png");           // <carom/viz/png/png_file.hpp>
#pragma once

#include <carom/collision/ray_cast.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>
#include <carom/core/result.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/image.hpp>
#include <carom/viz/ray_scene.hpp>

#include <cstdint>
#include <optional>

namespace carom {

/// What the colour of a pixel says. Where the ray misses, it is black.
enum class RayView : unsigned char {
    Depth,   ///< along the view: white is nearest in the picture, dark grey farthest
    Normal,  ///< red, green, blue are x, y, z of the world's axes: (n + 1) / 2
    Id,      ///< palette(id)
};

/// What the ray of a pixel meets.
struct PixelHit {
    double distance = 0.0;  ///< along the ray [m]
    dvec3 normal{0.0};      ///< unit, world axes
    std::uint32_t id = 0;
};

struct RayPictureSettings {
    int width = 800;   ///< [pixels], 1..8192
    int height = 500;  ///< [pixels], 1..8192
    Camera camera{};
    RayView view = RayView::Depth;
    Executor* executor = nullptr;  ///< null: the calling thread
};

/// Draws what `cast` finds along the ray through the middle of each pixel. The rays are of unit length to rounding.
/// @param cast  called once a pixel, from all threads of the executor at once.
/// @return what validate(camera) says, or InvalidArgument for a size out of range. The same picture on any number of threads.
/// Cost: one cast a pixel.
[[nodiscard]] Result<Image> draw_rays(FunctionRef<std::optional<PixelHit>(const Ray&)> cast, const RayPictureSettings& settings);

/// The same for a world; the id is the slot of the body.
[[nodiscard]] Result<Image> draw_rays(const World& world, const RayPictureSettings& settings);
[[nodiscard]] Result<Image> draw_rays(const RayScene& scene, const RayPictureSettings& settings);

}  // namespace carom
