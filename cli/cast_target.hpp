// What `carom cast` casts rays at: a mesh by name or from a file, or a scene as it stands before its first step.
//
//   Result<CastTarget> target = load_target("bumpy", std::nullopt, executor);
//   if (target->mesh) closest_hit(target->mesh->bvh, ray); else target->scene->rays.cast_ray(ray);
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/collision/mesh_data.hpp>
#include <carom/collision/static_bvh.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/result.hpp>
#include <carom/scenes/scene.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/ray_scene.hpp>

#include <optional>
#include <string>

namespace carom::cli {

struct MeshTarget {
    MeshData data;        ///< welded
    StaticBvh bvh;
    double build_s;       ///< what building the hierarchy took [s]
    bool closed = false;  ///< every edge joins two triangles that run along it in opposite directions
};

struct SceneTarget {
    scenes::SceneRun run;
    RayScene rays;
};

/// Exactly one of mesh and scene is there.
struct CastTarget {
    std::string name;
    std::optional<MeshTarget> mesh;
    std::optional<SceneTarget> scene;
    Aabb bounds;  ///< of the mesh, or of the scene's bounded shapes [m]
};

/// @param name      of a mesh or a scene, a mesh file (by its ending, see mesh_format) or a scene file (ends in .json or has a slash).
/// @param bodies    dynamic bodies of a scene that has a size; refused for anything else (where = --bodies).
/// @param executor  builds the mesh's hierarchy, and is the scene's own; must outlive the target.
/// @return UnknownName with the names there are; what reading the file says; Empty for a mesh whose triangles are all points or edges; Empty for a scene without bounded shapes.
[[nodiscard]] Result<CastTarget> load_target(const std::string& name, std::optional<int> bodies, Executor& executor);

/// @return a camera that sees all of the target, from above at an angle.
[[nodiscard]] Camera camera_for(const CastTarget& target, double aspect);

}  // namespace carom::cli
