// Rays against a mesh through its hierarchy.
#include <carom/collision/detail/ray_candidates.hpp>
#include <carom/collision/detail/ray_local.hpp>
#include <carom/collision/detail/ray_triangle.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace carom {
namespace {

double largest_coordinate(const dvec3& v) noexcept {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// Against the ray. A sliver whose corners only rounding keeps off one line has no normal: it faces the ray.
dvec3 normal_of(const std::array<vec3, 3>& corners, const dvec3& direction) noexcept {
    const dvec3 a(corners[0]);
    const dvec3 n = glm::cross(dvec3(corners[1]) - a, dvec3(corners[2]) - a);
    const double length_sq = glm::dot(n, n);
    if (!(length_sq > 0.0)) {
        return -direction;
    }
    return n * ((glm::dot(n, direction) > 0.0 ? -1.0 : 1.0) / std::sqrt(length_sq));
}

}  // namespace

std::optional<RayHit> cast_local(const TriangleMesh& mesh, const LocalRay& ray) noexcept {
    const Aabb& bounds = mesh.local_bounds();
    const double radius = 0.5 * glm::length(bounds.upper - bounds.lower);
    const double skipped = free_distance(ray, 0.5 * (bounds.lower + bounds.upper), radius);
    const dvec3 origin = ray.origin + skipped * ray.direction;
    // Vertices are below 1e39: from here the ray leads away, or passes by at this distance.
    if (!(largest_coordinate(origin) < 1e100)) {
        return std::nullopt;
    }
    const RayFrame frame(origin, ray.direction);

    // Wide enough for the rounding of the subtraction; each hit is compared with max_distance itself.
    double nearest = (ray.max_distance - skipped) + 0x1p-50 * skipped;
    std::optional<RayHit> best;
    dvec3 weights{0.0};
    WideRay wide;
    const WideBvh& tree = mesh.bvh().wide();
    if (!prepare(tree, geo::Ray<double>{origin, ray.direction, 0.0, nearest}, wide)) {
        return std::nullopt;
    }
    visit_ray_candidates(tree, wide, [&](const WideLeaf& leaf, unsigned triangles) {
        for (; triangles != 0; triangles &= triangles - 1) {
            const std::uint32_t triangle = leaf.triangle[std::countr_zero(triangles)];
            const std::array<vec3, 3> corners = mesh.corners(triangle);
            const std::optional<TriangleCrossing> crossing = intersect(frame, corners[0], corners[1], corners[2]);
            if (!crossing || !(crossing->distance >= 0.0) || skipped + crossing->distance > ray.max_distance) {
                continue;
            }
            // Ties go to the lowest triangle, whatever the order of the hierarchy.
            if (!best || crossing->distance < nearest || (crossing->distance == nearest && triangle < best->triangle)) {
                nearest = crossing->distance;
                best.emplace().triangle = triangle;
                weights = crossing->weights;
            }
        }
        return wide.own_t(nearest);
    });
    if (best) {
        const std::array<vec3, 3> corners = mesh.corners(best->triangle);
        best->distance = skipped + nearest;
        best->point = weights.x * dvec3(corners[0]) + weights.y * dvec3(corners[1]) + weights.z * dvec3(corners[2]);
        best->normal = normal_of(corners, ray.direction);
    }
    return best;
}

}  // namespace carom
