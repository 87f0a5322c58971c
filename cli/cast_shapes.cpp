#include <carom/cli/cast_shapes.hpp>

#include <carom/cli/cast_gun.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/hash.hpp>
#include <carom/dynamics/world_cast.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

namespace carom::cli {
namespace {

constexpr std::uint64_t kBatch = 1 << 15;  // casts that are in memory at once
constexpr std::size_t kGrain = 256;
constexpr double kMissed = -1.0;
constexpr double kUsualShare = 0.01;  // of the target

/// Twelve corners of an icosahedron.
Shape hull_of(float radius) {
    const float golden = 1.618034f, size = radius / std::sqrt(1.0f + golden * golden);
    std::vector<vec3> corners;
    for (const float a : {-1.0f, 1.0f}) {
        for (const float b : {-golden, golden}) {
            corners.push_back(size * vec3{0.0f, a, b});
            corners.push_back(size * vec3{a, b, 0.0f});
            corners.push_back(size * vec3{b, 0.0f, a});
        }
    }
    return *ConvexHull::build(corners);
}

Shape shape_of(Mover mover, float radius) {
    switch (mover) {
        case Mover::Ray:
        case Mover::Ball: return Sphere{radius};
        case Mover::Capsule: return Capsule{radius, radius};
        case Mover::Box: return Box{vec3{radius}};
        case Mover::Hull: return hull_of(radius);
    }
    return Sphere{radius};
}

/// How far the ray goes that the shape's centre follows; infinite where it hits nothing.
double ray_distance(const CastTarget& target, const Ray& ray) {
    if (target.scene) {
        const std::optional<WorldRayHit> hit = target.scene->rays.cast_ray(ray);
        return hit ? hit->hit.distance : std::numeric_limits<double>::infinity();
    }
    const MeshHit hit = closest_hit(target.mesh->bvh, {.origin = vec3(ray.origin), .direction = vec3(ray.direction)});
    return hit ? static_cast<double>(hit.t) : std::numeric_limits<double>::infinity();
}

/// The mesh in a world of its own.
World world_of(const MeshTarget& mesh, Executor& executor) {
    World world({.executor = &executor});
    world.add_shape(world.create_body({.type = BodyType::Static}), *TriangleMesh::build(mesh.data.vertices, mesh.data.triangles));
    return world;
}

}  // namespace

const char* to_string(Mover mover) noexcept {
    switch (mover) {
        case Mover::Ray: return "ray";
        case Mover::Ball: return "ball";
        case Mover::Capsule: return "capsule";
        case Mover::Box: return "box";
        case Mover::Hull: return "hull";
    }
    return "";
}

CastRecord cast_shapes(const CastTarget& target, const CastSettings& settings, Executor& executor) {
    CastRecord record;
    record.late = 0;
    CastGun gun(target, settings);
    record.radius = settings.radius > 0.0 ? settings.radius : kUsualShare * gun.span();
    const Shape shape = shape_of(settings.mover, static_cast<float>(record.radius));
    const World own = target.mesh ? world_of(*target.mesh, executor) : World();
    const World& world = target.mesh ? own : target.scene->run.world;
    const double length = gun.span();
    StateHash hash;
    for (std::uint64_t done = 0; done < settings.rays;) {
        const std::uint64_t count = std::min(kBatch, settings.rays - done);
        std::vector<Ray> rays(count);
        std::ranges::generate(rays, [&] { return gun.next(); });
        std::vector<ShapeCast> casts(count, {.shape = shape});
        for (std::size_t i = 0; i < count; ++i) {
            casts[i].motion = {.start = {rays[i].origin, kIdentityRotation}, .translation = length * rays[i].direction};
        }
        std::vector<std::optional<WorldImpact>> hits(count);
        const accuracy::Stopwatch watch;
        world.cast_shapes(casts, hits);
        record.time_s += watch.seconds();
        std::atomic<std::uint64_t> late{0};
        executor.parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
            std::uint64_t found = 0;
            for (std::size_t i = begin; i < end; ++i) {
                // Rays at meshes are in float, right to 16 u of the distance.
                const double ray = ray_distance(target, rays[i]) * (1.0 + 1e-6);
                found += ray <= length && (!hits[i] || hits[i]->impact.t * length > ray) ? 1 : 0;
            }
            late += found;
        });
        *record.late += late;
        for (const std::optional<WorldImpact>& hit : hits) {
            record.hits += hit ? 1 : 0;
            hash.add(hit ? hit->impact.t * length : kMissed);
        }
        done += count;
        if (settings.progress) settings.progress(done);
    }
    record.answer_hash = hash.digest();
    return record;
}

}  // namespace carom::cli
