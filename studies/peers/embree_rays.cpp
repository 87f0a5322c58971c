#include <carom/studies/peers/embree_scene.hpp>
#include <carom/studies/peers/ray_peers.hpp>

#include <glm/geometric.hpp>

namespace carom::peers {
namespace {

accuracy::RayCaster caster(bool robust, bool world_in_double) {
    const auto prepare = [robust, world_in_double](const accuracy::RayCases& part) -> accuracy::RayCaster::Cast {
        MeshData mesh;
        mesh.vertices.assign(part.mesh->vertices().begin(), part.mesh->vertices().end());
        mesh.triangles.assign(part.mesh->triangles().begin(), part.mesh->triangles().end());
        auto scene = std::make_shared<const EmbreeScene>(mesh, EmbreeSettings{.robust = robust, .high_quality = !robust});
        return [scene, offset = part.offset, world_in_double](const Ray& ray) -> std::optional<double> {
            const vec3 direction(ray.direction);
            const EmbreeHit hit =
                scene->closest_hit({.origin = vec3(relative_origin(ray, offset, world_in_double)), .direction = direction});
            if (!is_finite(hit.t)) return std::nullopt;
            return static_cast<double>(hit.t) * glm::length(dvec3(direction));
        };
    };
    return {"embree", {{"mode", robust ? "robust" : "fast"}, {"world", world_in_double ? "double" : "float"}, {"test", "float"}}, prepare};
}

}  // namespace

std::vector<accuracy::RayCaster> embree_rays() {
    return {caster(true, true), caster(true, false), caster(false, true), caster(false, false)};
}

}  // namespace carom::peers
