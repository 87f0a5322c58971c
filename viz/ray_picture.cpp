#include <carom/viz/ray_picture.hpp>

#include <carom/core/math.hpp>
#include <carom/viz/color.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace carom {
namespace {

constexpr int kMostPixels = 8192;
constexpr double kFarthestGrey = 40.0;

/// The rays of a camera, one through the middle of each pixel.
class Lens {
public:
    explicit Lens(const RayPictureSettings& s) : origin_(s.camera.position) {
        forward_ = glm::normalize(s.camera.target - s.camera.position);
        const SinCos angle = sin_cos(0.5 * s.camera.field_of_view);
        const double pixel = 2.0 * angle.sin / angle.cos / s.height;
        right_ = pixel * glm::normalize(glm::cross(forward_, s.camera.up));
        up_ = glm::cross(right_, forward_);
        middle_ = {0.5 * (s.width - 1), 0.5 * (s.height - 1)};
    }
    [[nodiscard]] Ray ray(int x, int y) const {
        return {.origin = origin_, .direction = glm::normalize(forward_ + (x - middle_.x) * right_ + (middle_.y - y) * up_)};
    }
    [[nodiscard]] const dvec3& forward() const noexcept { return forward_; }

private:
    dvec3 origin_{0.0}, forward_{0.0}, right_{0.0}, up_{0.0};
    dvec2 middle_{0.0};
};

std::uint8_t byte(double value) { return static_cast<std::uint8_t>(std::floor(std::clamp(value, 0.0, 255.0) + 0.5)); }

// Depths to greys, from the nearest to the farthest of the picture.
void shade_depth(const std::vector<double>& depths, Image& image) {
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
    for (const double depth : depths) {
        if (!is_finite(depth)) continue;
        nearest = std::min(nearest, depth);
        farthest = std::max(farthest, depth);
    }
    const double range = farthest > nearest ? farthest - nearest : 1.0;
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (!is_finite(depths[i])) continue;
        const std::uint8_t grey = byte(255.0 - (255.0 - kFarthestGrey) * ((depths[i] - nearest) / range));
        image.pixels[i] = {grey, grey, grey};
    }
}

Image::Pixel color_of(const PixelHit& hit, RayView view) {
    if (view == RayView::Id) {
        const Color color = palette(hit.id);
        return {color.r, color.g, color.b};
    }
    return {byte(127.5 * (hit.normal.x + 1.0)), byte(127.5 * (hit.normal.y + 1.0)), byte(127.5 * (hit.normal.z + 1.0))};
}

}  // namespace

Result<Image> draw_rays(FunctionRef<std::optional<PixelHit>(const Ray&)> cast, const RayPictureSettings& settings) {
    if (Status status = validate(settings.camera); !status) return status.error();
    const bool fits = settings.width >= 1 && settings.width <= kMostPixels && settings.height >= 1 && settings.height <= kMostPixels;
    if (!fits) {
        return Error{ErrorCode::InvalidArgument, "width and height must be in 1.." + std::to_string(kMostPixels), "RayPictureSettings"};
    }
    Image image(settings.width, settings.height);
    std::vector<double> depths(image.pixels.size(), std::numeric_limits<double>::infinity());
    const Lens lens(settings);
    const auto draw_rows = [&](std::size_t begin, std::size_t end) {
        for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Ray ray = lens.ray(x, y);
                const std::optional<PixelHit> hit = cast(ray);
                if (!hit) continue;
                const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
                depths[i] = hit->distance * glm::dot(ray.direction, lens.forward());
                if (settings.view != RayView::Depth) image.pixels[i] = color_of(*hit, settings.view);
            }
        }
    };
    SerialExecutor serial;
    Executor& executor = settings.executor != nullptr ? *settings.executor : serial;
    executor.parallel_for(static_cast<std::size_t>(image.height), 1, draw_rows);
    if (settings.view == RayView::Depth) shade_depth(depths, image);
    return image;
}

Result<Image> draw_rays(const World& world, const RayPictureSettings& settings) {
    return draw_rays(RayScene(world), settings);
}

Result<Image> draw_rays(const RayScene& scene, const RayPictureSettings& settings) {
    const auto cast = [&](const Ray& ray) -> std::optional<PixelHit> {
        const std::optional<WorldRayHit> hit = scene.cast_ray(ray);
        return hit ? std::optional(PixelHit{hit->hit.distance, hit->hit.normal, hit->body.slot}) : std::nullopt;
    };
    return draw_rays(cast, settings);
}

}  // namespace carom
