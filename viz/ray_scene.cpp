#include <carom/viz/ray_scene.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

double largest(const dvec3& v) noexcept { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// A ray for slab tests that never miss a box which the ray's casts may meet.
class BoxTest {
public:
    explicit BoxTest(const Ray& ray) : origin_(ray.origin), size_(largest(ray.origin)) {
        const double scale = 1.0 / largest(ray.direction);
        for (int k = 0; k < 3; ++k) {
            // A component that is nearly zero counts as one that drifts by far less than the slack.
            const double d = ray.direction[k] * scale;
            inverse_[k] = 1.0 / (std::abs(d) < 1e-30 ? 1e-30 : d);
        }
        length_ = std::sqrt(glm::dot(ray.direction * scale, ray.direction * scale));
    }
    // False only where the ray surely meets nothing in the box at a distance of at most `reach`.
    [[nodiscard]] bool meets(const Aabb& box, double reach) const noexcept {
        // Casts round the ray by a few ulp of its way to the shape: 1e-12 is a few thousand.
        const double slack = 1e-12 * (size_ + largest(box.lower) + largest(box.upper));
        const dvec3 a = ((box.lower - slack) - origin_) * inverse_;
        const dvec3 b = ((box.upper + slack) - origin_) * inverse_;
        const dvec3 near = glm::min(a, b), far = glm::max(a, b);
        const double enter = std::max({near.x, near.y, near.z, 0.0}), leave = std::min({far.x, far.y, far.z});
        // Not `enter <= leave`: where overflow makes a NaN, the box is met.
        return !(enter * (1.0 - 1e-12) > leave * (1.0 + 1e-12)) && !(enter * length_ * (1.0 - 1e-12) > reach);
    }

private:
    dvec3 origin_{0.0}, inverse_{0.0};
    double size_ = 0.0, length_ = 1.0;
};

}  // namespace

RayScene::RayScene(const World& world) {
    for (const BodyId body : world.bodies()) {
        if (world.is_quarantined(body)) continue;
        for (const ShapeId id : world.shapes(body)) {
            const Pose pose = world.pose(body) * world.shape_def(id).local;
            const Item& item = items_.emplace_back(Item{carom::bounds(world.shape(id), pose), pose, world.shape(id), body, id});
            if (is_bounded(item.shape)) bounds_ = merge(bounds_, item.box);
        }
    }
}

std::optional<WorldRayHit> RayScene::cast_ray(const Ray& ray) const {
    if (!validate(ray)) return std::nullopt;
    const BoxTest test(ray);
    std::optional<WorldRayHit> best;
    Ray rest = ray;
    for (const Item& item : items_) {
        if (is_bounded(item.shape) && !test.meets(item.box, rest.max_distance)) continue;
        const std::optional<RayHit> hit = carom::cast_ray(item.shape, item.pose, rest);
        if (!hit || (best && hit->distance >= best->hit.distance)) continue;
        best = WorldRayHit{item.body, item.id, *hit};
        rest.max_distance = hit->distance;
    }
    return best;
}

}  // namespace carom
