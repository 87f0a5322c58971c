// Other libraries as candidates of the studies of rays.
//
//   StudyOptions options{.ray_peers = ray_peers()};
//
// Each is asked what Carom is asked, through the same kind of function. Settings: `world` as for Carom, the precision in which the origin
// comes into the mesh's frame; `test` the precision that the library then works in.
#pragma once

#include <carom/studies/accuracy/ray_problem.hpp>

#include <vector>

namespace carom::peers {

/// Embree 3, robust and fast, with its own hierarchy in float.
[[nodiscard]] std::vector<accuracy::RayCaster> embree_rays();
/// Bullet's ray test of a triangle mesh with a quantised hierarchy, in float. Its rays have an end: beyond the far side of the mesh.
[[nodiscard]] std::vector<accuracy::RayCaster> bullet_rays();
/// CGAL's AABB tree in double, without filtered predicates and with them (exact verdicts, rounded points).
[[nodiscard]] std::vector<accuracy::RayCaster> cgal_rays();

/// @return all of them.
[[nodiscard]] inline std::vector<accuracy::RayCaster> ray_peers() {
    std::vector<accuracy::RayCaster> all;
    for (const auto& some : {embree_rays(), bullet_rays(), cgal_rays()}) {
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

/// A ray's origin in the frame of the mesh, by a subtraction in double or (a world of floats) in float.
[[nodiscard]] inline dvec3 relative_origin(const Ray& ray, const dvec3& offset, bool world_in_double) {
    return world_in_double ? ray.origin - offset : dvec3(vec3(ray.origin) - vec3(offset));
}

}  // namespace carom::peers
