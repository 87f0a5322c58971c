#include <carom/cli/cast_rays.hpp>

#include <carom/cli/cast_gun.hpp>
#include <carom/cli/cast_shapes.hpp>
#include <carom/collision/mesh_rays.hpp>
#include <carom/core/hash.hpp>
#include <carom/studies/accuracy/study.hpp>

#include <algorithm>
#include <atomic>
#include <vector>

namespace carom::cli {
namespace {

constexpr std::uint64_t kBatch = 1 << 18;  // rays that are in memory at once
constexpr std::size_t kGrain = 256;
constexpr double kMissed = -1.0;

// The batch's distances along unit directions, kMissed for a miss.
double cast_at_mesh(const StaticBvh& bvh, const std::vector<geo::Ray<float>>& rays, std::vector<double>& distances,
                    Executor& executor) {
    std::vector<MeshHit> hits(rays.size());
    const accuracy::Stopwatch watch;
    closest_hits(bvh, rays, hits, executor);
    const double time_s = watch.seconds();
    for (std::size_t i = 0; i < rays.size(); ++i) {
        distances[i] = hits[i] ? static_cast<double>(hits[i].t) : kMissed;
    }
    return time_s;
}

double cast_at_scene(const RayScene& scene, const std::vector<Ray>& rays, std::vector<double>& distances, Executor& executor) {
    const accuracy::Stopwatch watch;
    executor.parallel_for(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::optional<WorldRayHit> hit = scene.cast_ray(rays[i]);
            distances[i] = hit ? hit->hit.distance : kMissed;
        }
    });
    return watch.seconds();
}

// A line enters a closed surface as often as it leaves it.
std::uint64_t count_leaks(const StaticBvh& bvh, const std::vector<geo::Ray<float>>& rays, const std::vector<double>& distances,
                          Executor& executor) {
    std::atomic<std::uint64_t> leaks{0};
    executor.parallel_for(rays.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<MeshHit> crossings;
        std::uint64_t found = 0;
        for (std::size_t i = begin; i < end; ++i) {
            all_hits(bvh, rays[i], crossings);
            const bool missed = distances[i] == kMissed && !crossings.empty();
            found += crossings.size() % 2 != 0 || missed ? 1 : 0;
        }
        leaks += found;
    });
    return leaks;
}

}  // namespace

CastRecord cast_rays(const CastTarget& target, const CastSettings& settings, Executor& executor) {
    if (settings.mover != Mover::Ray) return cast_shapes(target, settings, executor);
    CastRecord record;
    if (target.mesh && target.mesh->closed) record.leaks = 0;
    CastGun gun(target, settings);
    StateHash hash;
    for (std::uint64_t done = 0; done < settings.rays;) {
        const std::uint64_t count = std::min(kBatch, settings.rays - done);
        std::vector<Ray> rays(count);
        std::ranges::generate(rays, [&] { return gun.next(); });
        std::vector<double> distances(count, kMissed);
        if (target.mesh) {
            std::vector<geo::Ray<float>> floats(count);
            std::ranges::transform(rays, floats.begin(), [](const Ray& ray) {
                return geo::Ray<float>{.origin = vec3(ray.origin), .direction = vec3(ray.direction)};
            });
            record.time_s += cast_at_mesh(target.mesh->bvh, floats, distances, executor);
            if (record.leaks) *record.leaks += count_leaks(target.mesh->bvh, floats, distances, executor);
        } else {
            record.time_s += cast_at_scene(target.scene->rays, rays, distances, executor);
        }
        for (const double distance : distances) {
            record.hits += distance != kMissed ? 1 : 0;
            hash.add(distance);
        }
        done += count;
        if (settings.progress) settings.progress(done);
    }
    record.answer_hash = hash.digest();
    return record;
}

}  // namespace carom::cli
