#include <carom/bench/rays_group.hpp>

#include <carom/collision/mesh_rays.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/studies/peers/embree_scene.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <functional>
#include <memory>
#include <optional>

namespace carom::bench {
namespace {

using FloatRay = geo::Ray<float>;
using peers::EmbreeHit, peers::EmbreeScene, peers::EmbreeSettings;

constexpr std::size_t kTurn = 50'000;  // rays that a contender casts before the next one does
constexpr int kPasses = 5;
constexpr int kBuilds = 3;
constexpr std::size_t kLeakRays = 1'000'000;

struct Mesh {
    const char* name;
    int edge;
};
constexpr std::array<Mesh, 2> kMeshes{{{"bumpy70k", scenes::kBumpy70k}, {"bumpy1m", scenes::kBumpy1m}}};

struct Peer {
    const char* name;
    EmbreeSettings settings;
};
constexpr std::array<Peer, 2> kPeers{{{"embree-robust", {.robust = true}}, {"embree-fast", {.high_quality = true}}}};
constexpr Peer kBuilder{"embree-medium", {}};

struct RayHit1 {
    bool hit = false;
    float t = 0.0f;
};

/// Somebody who casts rays, and what it took.
struct Contender {
    std::string name;
    std::function<RayHit1(const FloatRay&)> look;                         ///< one ray, for the judge
    std::function<void(std::span<const FloatRay>)> cast;                  ///< a turn
    double cpu_ms = 0.0;
    double wrong = 0.0;
};

// CPU time of this process [ms].
double cpu_now() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::string bench_name(const Mesh& mesh, const char* what) { return fmt::format("{}/{}", mesh.name, what); }

bool matches(const std::string& bench, const Peer& peer, const std::string& filter) {
    return fmt::format("{}/{}", bench, peer.name).find(filter) != std::string::npos;
}

/// From inside at edges and corners; the ball is star-shaped, and its middle half is inside.
std::vector<FloatRay> leak_rays(const MeshData& mesh) {
    Random random(4711);
    std::vector<FloatRay> rays;
    rays.reserve(kLeakRays);
    const auto choose = [&](std::size_t count) { return static_cast<std::size_t>(random.unit() * static_cast<double>(count)); };
    for (std::size_t i = 0; i < kLeakRays; ++i) {
        const auto& triangle = mesh.triangles[choose(mesh.triangles.size())];
        const std::size_t corner = choose(3);
        const vec3& a = mesh.vertices[triangle[corner]];
        const vec3& b = mesh.vertices[triangle[(corner + 1) % 3]];
        const vec3 target = i % 3 == 0 ? a : vec3(dvec3(a) + (dvec3(b) - dvec3(a)) * random.unit());
        const double x = random.range(-0.25, 0.25), y = random.range(-0.25, 0.25);
        const vec3 origin(dvec3{x, y, random.range(-0.25, 0.25)});
        rays.push_back({.origin = origin, .direction = target - origin});
    }
    return rays;
}

void take_turns(std::vector<Contender>& contenders, std::span<const FloatRay> rays) {
    for (int pass = 0; pass < kPasses; ++pass) {
        for (std::size_t first = 0; first < rays.size(); first += kTurn) {
            const auto turn = rays.subspan(first, std::min(kTurn, rays.size() - first));
            for (Contender& contender : contenders) {
                const double start = cpu_now();
                contender.cast(turn);
                contender.cpu_ms += (cpu_now() - start) / kPasses;
            }
        }
    }
}

Contender carom_contender(const StaticBvh& bvh, std::vector<MeshHit>& hits) {
    return {.name = "carom",
            .look = [&bvh](const FloatRay& ray) {
                const MeshHit hit = closest_hit(bvh, ray);
                return RayHit1{static_cast<bool>(hit), hit.t};
            },
            .cast = [&bvh, &hits](std::span<const FloatRay> rays) {
                for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = closest_hit(bvh, rays[i]);
            }};
}

Contender embree_contender(const char* name, const EmbreeScene& scene, std::vector<EmbreeHit>& hits) {
    return {.name = name,
            .look = [&scene](const FloatRay& ray) {
                const EmbreeHit hit = scene.closest_hit(ray);
                return RayHit1{is_finite(hit.t), hit.t};
            },
            .cast = [&scene, &hits](std::span<const FloatRay> rays) {
                for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = scene.closest_hit(rays[i]);
            }};
}

/// Counts rays that see something else than the cast in double does.
void judge(const TriangleMeshPtr& mesh, std::span<const FloatRay> rays, std::vector<Contender>& contenders) {
    for (const FloatRay& ray : rays) {
        const std::optional<RayHit> exact = cast_ray(mesh, Ray{dvec3(ray.origin), dvec3(ray.direction)});
        const double length = std::sqrt(glm::dot(dvec3(ray.direction), dvec3(ray.direction)));
        for (Contender& contender : contenders) {
            const RayHit1 seen = contender.look(ray);
            const bool agrees = seen.hit == exact.has_value() &&
                                (!exact || std::abs(static_cast<double>(seen.t) * length - exact->distance) <= 1e-4 * (1.0 + exact->distance));
            contender.wrong += agrees ? 0.0 : 1.0;
        }
    }
}

void print_head(std::FILE* out) {
    fmt::print(out, "{:<16} {:<14} {:>9} {:>9} {:>8}  {}\n", "bench", "who", "ms", "M/s", "speed", "quality");
    std::fflush(out);
}

void print(std::FILE* out, const std::string& bench, const std::string& who, double ms, double items, double carom_ms,
           const Quality& quality) {
    std::string text;
    for (const auto& [name, value] : quality) text += fmt::format("{} {:g}  ", name, value);
    fmt::print(out, "{:<16} {:<14} {:>9.2f} {:>9.3f} {:>7.2f}x  {}\n", bench, who, ms, items / ms / 1e3, ms / carom_ms, text);
    std::fflush(out);
}

/// What a mesh is measured with, built when the first row wants it.
struct Prepared {
    MeshData data;
    std::optional<StaticBvh> bvh;
    TriangleMeshPtr mesh;
    std::vector<std::unique_ptr<EmbreeScene>> scenes;  ///< as kPeers
};

Result<Prepared> prepare_mesh(const Mesh& mesh) {
    Prepared out;
    out.data = scenes::bumpy(mesh.edge);
    Result<StaticBvh> bvh = StaticBvh::build(out.data.vertices, out.data.triangles);
    if (!bvh) return bvh.error();
    out.bvh.emplace(std::move(*bvh));
    Result<TriangleMeshPtr> exact = TriangleMesh::build(out.data.vertices, out.data.triangles);
    if (!exact) return exact.error();
    out.mesh = *exact;
    for (const Peer& peer : kPeers) out.scenes.push_back(std::make_unique<EmbreeScene>(out.data, peer.settings));
    return out;
}

void run_rays(const std::string& bench, const Prepared& prepared, std::span<const FloatRay> rays, const char* quality,
              const GroupRequest& request, std::vector<Row>& rows) {
    std::vector<MeshHit> hits(kTurn);
    std::vector<EmbreeHit> embree_hits(kTurn);
    std::vector<Contender> contenders{carom_contender(*prepared.bvh, hits)};
    for (std::size_t i = 0; i < kPeers.size(); ++i) {
        if (matches(bench, kPeers[i], request.filter)) {
            contenders.push_back(embree_contender(kPeers[i].name, *prepared.scenes[i], embree_hits));
        }
    }
    take_turns(contenders, rays);
    if (std::string(quality) == "leaks") {
        for (const FloatRay& ray : rays) {
            for (Contender& contender : contenders) contender.wrong += contender.look(ray).hit ? 0.0 : 1.0;
        }
    } else {
        judge(prepared.mesh, rays, contenders);
    }
    const Contender& carom = contenders[0];
    for (const Contender& contender : contenders) {
        print(request.table, bench, contender.name, contender.cpu_ms, static_cast<double>(rays.size()), carom.cpu_ms,
              {{quality, contender.wrong}});
        if (&contender == &carom) continue;
        rows.push_back({.bench = bench,
                        .peer = contender.name,
                        .peer_version = EmbreeScene::version(),
                        .threads = 1,
                        .carom_ms = carom.cpu_ms,
                        .peer_ms = contender.cpu_ms,
                        .carom_quality = {{quality, carom.wrong}},
                        .peer_quality = {{quality, contender.wrong}}});
    }
}

void run_build(const std::string& bench, const MeshData& mesh, const GroupRequest& request, std::vector<Row>& rows) {
    double carom_ms = 0.0, peer_ms = 0.0;
    Quality quality;
    for (int i = 0; i < kBuilds; ++i) {
        double start = cpu_now();
        const Result<StaticBvh> bvh = StaticBvh::build(mesh.vertices, mesh.triangles);
        carom_ms += (cpu_now() - start) / kBuilds;
        quality = {{"bytes_per_triangle", static_cast<double>(bvh->bytes()) / static_cast<double>(mesh.triangles.size())},
                   {"sah_cost", bvh->sah_cost()}};
        start = cpu_now();
        const EmbreeScene scene(mesh, kBuilder.settings);
        peer_ms += (cpu_now() - start) / kBuilds;
    }
    const auto triangles = static_cast<double>(mesh.triangles.size());
    print(request.table, bench, "carom", carom_ms, triangles, carom_ms, quality);
    print(request.table, bench, kBuilder.name, peer_ms, triangles, carom_ms, {});
    rows.push_back({.bench = bench,
                    .peer = kBuilder.name,
                    .peer_version = EmbreeScene::version(),
                    .threads = 1,
                    .carom_ms = carom_ms,
                    .peer_ms = peer_ms,
                    .carom_quality = quality,
                    .peer_quality = {}});
}

}  // namespace

Result<std::vector<Row>> run_rays_group(const GroupRequest& request) {
    std::vector<Row> rows;
    bool matched = false;
    for (const Mesh& mesh : kMeshes) {
        const auto wanted = [&](const char* what) {
            const std::string bench = bench_name(mesh, what);
            return std::ranges::any_of(kPeers, [&](const Peer& peer) { return matches(bench, peer, request.filter); });
        };
        const bool camera = wanted("camera"), chords = wanted("chords"), leaks = wanted("leaks");
        const bool build = matches(bench_name(mesh, "build"), kBuilder, request.filter);
        if (!camera && !chords && !leaks && !build) continue;
        if (!matched) print_head(request.table);
        matched = true;
        if (build) run_build(bench_name(mesh, "build"), scenes::bumpy(mesh.edge), request, rows);
        if (!camera && !chords && !leaks) continue;
        const Result<Prepared> prepared = prepare_mesh(mesh);
        if (!prepared) return prepared.error();
        if (camera) run_rays(bench_name(mesh, "camera"), *prepared, scenes::bumpy_camera_rays(), "wrong_rays", request, rows);
        if (chords) run_rays(bench_name(mesh, "chords"), *prepared, scenes::bumpy_chords(), "wrong_rays", request, rows);
        if (leaks) run_rays(bench_name(mesh, "leaks"), *prepared, leak_rays(prepared->data), "leaks", request, rows);
    }
    if (!matched) {
        return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    }
    return rows;
}

}  // namespace carom::bench
