#include <carom/bench/narrowphase_group.hpp>

#include <carom/bench/convex_group.hpp>
#include <carom/bench/fcl_mesh.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/bumpy.hpp>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>
#include <utility>

namespace carom::bench {
namespace {

constexpr int kPasses = 3;
constexpr int kPoses = 100;

// CPU time of this process [ms].
double cpu_now() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// What reading the clock adds to a measurement [ms]: some tenths of a microsecond, a twentieth of a verdict.
double cost_of_clock() {
    double least = 1.0;
    for (int n = 0; n < 1000; ++n) {
        const double start = cpu_now();
        least = std::min(least, cpu_now() - start);
    }
    return least;
}

std::vector<Pose> mesh_poses() {
    Random random(11);
    std::vector<Pose> poses;
    for (int n = 0; n < kPoses; ++n) {
        Pose pose;
        dquat& q = pose.orientation;
        double length_sq = 0.0;
        do {
            q.w = random.range(-1.0, 1.0), q.x = random.range(-1.0, 1.0), q.y = random.range(-1.0, 1.0), q.z = random.range(-1.0, 1.0);
            length_sq = glm::dot(q, q);
        } while (length_sq > 1.0 || length_sq < 0.01);
        q = glm::normalize(q);
        dvec3 way{0.0};
        do {
            way.x = random.range(-1.0, 1.0), way.y = random.range(-1.0, 1.0), way.z = random.range(-1.0, 1.0);
            length_sq = glm::dot(way, way);
        } while (length_sq > 1.0 || length_sq < 0.01);
        pose.position = glm::normalize(way) * random.range(1.6, 2.25);
        poses.push_back(pose);
    }
    return poses;
}

struct Tally {
    double carom_ms = 0.0, peer_ms = 0.0;
    std::size_t carom = 0, peer = 0;
};

/// @param carom, peer  give what they count.
template <class Carom, class Peer>
Tally take_turns(const std::vector<Pose>& poses, Carom carom, Peer peer) {
    Tally tally;
    for (int pass = 0; pass < kPasses; ++pass) {
        for (const Pose& pose : poses) {
            const double start = cpu_now();
            tally.carom += carom(pose);
            const double middle = cpu_now();
            tally.peer += peer(pose);
            tally.carom_ms += middle - start;
            tally.peer_ms += cpu_now() - middle;
        }
    }
    constexpr double kQueries = kPasses * kPoses;
    const double clock = cost_of_clock();
    return {tally.carom_ms / kQueries - clock, tally.peer_ms / kQueries - clock, tally.carom / kPasses, tally.peer / kPasses};
}

Row row(const GroupRequest& request, const char* bench, const Tally& tally, const char* quality) {
    Row out;
    out.bench = bench;
    out.peer = "fcl";
    out.peer_version = FclMesh::version();
    out.carom_ms = tally.carom_ms;
    out.peer_ms = tally.peer_ms;
    if (quality != nullptr) {
        out.carom_quality = {{quality, static_cast<double>(tally.carom)}};
        out.peer_quality = {{quality, static_cast<double>(tally.peer)}};
    }
    fmt::print(request.table, "{:<14} carom {:>10.4f} ms   fcl {:>10.4f} ms   {:>7.2f}x   {} {} {}\n", bench, tally.carom_ms, tally.peer_ms,
               speedup(out), quality == nullptr ? "" : quality, tally.carom, tally.peer);
    std::fflush(request.table);
    return out;
}

}  // namespace

Result<std::vector<Row>> run_narrowphase_group(const GroupRequest& request) {
    const auto wanted = [&](const char* bench) { return fmt::format("{}/fcl", bench).find(request.filter) != std::string::npos; };
    const bool build = wanted("mesh/build"), boolean = wanted("mesh/boolean"), all = wanted("mesh/all");
    std::vector<Row> rows = run_convex_rows(request);
    if (!build && !boolean && !all) {
        if (!rows.empty()) return rows;
        return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    }
    const MeshData data = scenes::bumpy(scenes::kBumpy70k);
    Tally tally;
    for (int n = 0; build && n < kPasses; ++n) {
        const double start = cpu_now();
        const Result<StaticBvh> bvh = StaticBvh::build(data.vertices, data.triangles);
        if (!bvh) return bvh.error();
        const double middle = cpu_now();
        const FclMesh mesh(data);
        tally.carom_ms += (middle - start) / kPasses;
        tally.peer_ms += (cpu_now() - middle) / kPasses;
    }
    if (build) rows.push_back(row(request, "mesh/build", tally, nullptr));

    const Result<StaticBvh> bvh = StaticBvh::build(data.vertices, data.triangles);
    if (!bvh) return bvh.error();
    const FclMesh mesh(data);
    const std::vector<Pose> poses = mesh_poses();
    if (boolean) {
        tally = take_turns(
            poses, [&](const Pose& pose) { return std::size_t{meshes_overlap(*bvh, *bvh, pose)}; },
            [&](const Pose& pose) { return mesh.pairs_with(mesh, pose, 1); });
        rows.push_back(row(request, "mesh/boolean", tally, "poses_that_touch"));
    }
    if (all) {
        std::vector<TrianglePair> pairs;
        tally = take_turns(
            poses,
            [&](const Pose& pose) {
                overlapping_pairs(*bvh, *bvh, pose, pairs);
                return pairs.size();
            },
            [&](const Pose& pose) { return mesh.pairs_with(mesh, pose, FclMesh::kAll); });
        rows.push_back(row(request, "mesh/all", tally, "pairs"));
    }
    const auto apart = std::max(tally.carom, tally.peer) - std::min(tally.carom, tally.peer);
    if (1000 * apart > tally.carom) {
        return Error{ErrorCode::WrongType, fmt::format("Carom finds {}, FCL {}", tally.carom, tally.peer), "mesh"};
    }
    return rows;
}

}  // namespace carom::bench
