// A world as it stands, prepared for many rays: a box about each shape lets most of them be passed by.
//
//   const RayScene scene(world);
//   if (std::optional<WorldRayHit> hit = scene.cast_ray(ray)) ...           // what world.cast_ray(ray) gives
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/dynamics/world.hpp>

#include <optional>
#include <vector>

namespace carom {

class RayScene {
public:
    /// Copies poses and shapes (heavy ones are shared): what happens to the world later does not show here.
    explicit RayScene(const World& world);

    /// The same hit as World::cast_ray, to the bit. @param ray  validate(ray) holds; a bad one hits nothing.
    /// Cost: some 3 ns a shape, and a cast against each whose box the ray meets nearer than the best hit so far. No allocation,
    /// thread-safe.
    [[nodiscard]] std::optional<WorldRayHit> cast_ray(const Ray& ray) const;

    /// @return the box of all bounded shapes; empty where there are none.
    [[nodiscard]] const Aabb& bounds() const noexcept { return bounds_; }

private:
    struct Item {
        Aabb box;  ///< infinite for a plane
        Pose pose;
        Shape shape;
        BodyId body;
        ShapeId id;
    };
    std::vector<Item> items_;
    Aabb bounds_;
};

}  // namespace carom
