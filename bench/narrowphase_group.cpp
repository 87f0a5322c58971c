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
#include <optional>
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

// The ball beside itself without a turn, near and far; and where it is itself.
std::vector<Pose> aligned_poses() {
    std::vector<Pose> poses;
    for (const dvec3& way : {dvec3{1, 0, 0}, dvec3{0, 1, 0}, dvec3{0, 0, 1}, glm::normalize(dvec3{1, 1, 1})}) {
        for (const double distance : {0.01, 0.1, 0.5, 1.0, 1.5, 1.9}) poses.push_back({.position = distance * way});
    }
    return poses;
}

struct Tally {
    double carom_ms = 0.0, peer_ms = 0.0;
    std::size_t carom = 0, peer = 0;
    double least_speedup = 0.0;  // of all poses
};

/// @param carom, peer  give what they count.
template <class Carom, class Peer>
Tally take_turns(const std::vector<Pose>& poses, Carom carom, Peer peer) {
    Tally tally;
    const double clock = cost_of_clock();
    std::vector<double> carom_ms(poses.size()), peer_ms(poses.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const double start = cpu_now();
            tally.carom += carom(poses[i]);
            const double middle = cpu_now();
            tally.peer += peer(poses[i]);
            carom_ms[i] += middle - start - clock;
            peer_ms[i] += cpu_now() - middle - clock;
        }
    }
    tally.least_speedup = peer_ms[0] / carom_ms[0];
    for (std::size_t i = 0; i < poses.size(); ++i) {
        tally.carom_ms += carom_ms[i] / static_cast<double>(kPasses * poses.size());
        tally.peer_ms += peer_ms[i] / static_cast<double>(kPasses * poses.size());
        tally.least_speedup = std::min(tally.least_speedup, peer_ms[i] / carom_ms[i]);
    }
    tally.carom /= kPasses;
    tally.peer /= kPasses;
    return tally;
}

Row row(const GroupRequest& request, const char* bench, const Tally& tally, const char* quality) {
    Row out;
    out.bench = bench;
    out.peer = "fcl";
    out.peer_version = FclMesh::version();
    out.carom_ms = tally.carom_ms;
    out.peer_ms = tally.peer_ms;
    if (quality != nullptr) {
        out.carom_quality = {{quality, static_cast<double>(tally.carom)}, {"least_speedup", tally.least_speedup}};
        out.peer_quality = {{quality, static_cast<double>(tally.peer)}};
    }
    fmt::print(request.table, "{:<23} carom {:>10.4f} ms   fcl {:>10.4f} ms   {:>7.2f}x", bench, tally.carom_ms, tally.peer_ms,
               speedup(out));
    if (quality != nullptr)
        fmt::print(request.table, "   at least {:.2f}x at every pose   {} {} and {}", tally.least_speedup, quality, tally.carom,
                   tally.peer);
    fmt::print(request.table, "\n");
    std::fflush(request.table);
    return out;
}

// What both are asked at each of the poses.
class MeshRace {
public:
    MeshRace(const MeshData& data, StaticBvh bvh) : bvh_(std::move(bvh)), mesh_(data) {}

    [[nodiscard]] Tally boolean(const std::vector<Pose>& poses) const {
        return take_turns(
            poses, [&](const Pose& pose) { return std::size_t{meshes_overlap(bvh_, bvh_, pose)}; },
            [&](const Pose& pose) { return mesh_.pairs_with(mesh_, pose, 1); });
    }
    [[nodiscard]] Tally all(const std::vector<Pose>& poses) const {
        std::vector<TrianglePair> pairs;
        return take_turns(
            poses,
            [&](const Pose& pose) {
                overlapping_pairs(bvh_, bvh_, pose, pairs);
                return pairs.size();
            },
            [&](const Pose& pose) { return mesh_.pairs_with(mesh_, pose, FclMesh::kAll); });
    }

private:
    StaticBvh bvh_;
    FclMesh mesh_;
};

Status check_same(const Tally& tally) {
    const auto apart = std::max(tally.carom, tally.peer) - std::min(tally.carom, tally.peer);
    if (1000 * apart <= tally.carom) return {};
    return Error{ErrorCode::WrongType, fmt::format("Carom finds {}, FCL {}", tally.carom, tally.peer), "mesh"};
}

Result<Tally> race_builds(const MeshData& data) {
    Tally tally;
    for (int n = 0; n < kPasses; ++n) {
        const double start = cpu_now();
        const Result<StaticBvh> bvh = StaticBvh::build(data.vertices, data.triangles);
        if (!bvh) return bvh.error();
        const double middle = cpu_now();
        const FclMesh mesh(data);
        tally.carom_ms += (middle - start) / kPasses;
        tally.peer_ms += (cpu_now() - middle) / kPasses;
    }
    return tally;
}

}  // namespace

Result<std::vector<Row>> run_narrowphase_group(const GroupRequest& request) {
    std::vector<Row> rows = run_convex_rows(request);
    const std::size_t convex = rows.size();
    const auto wanted = [&](const char* bench) { return fmt::format("{}/fcl", bench).find(request.filter) != std::string::npos; };
    const MeshData data = scenes::bumpy(scenes::kBumpy70k);
    if (wanted("mesh/build")) {
        const Result<Tally> tally = race_builds(data);
        if (!tally) return tally.error();
        rows.push_back(row(request, "mesh/build", *tally, nullptr));
    }
    struct Asked {
        const char* bench;
        bool all;
        std::vector<Pose> poses;
        bool same;  // whether both are to find the same: FCL's verdicts on what touches are not exact
    };
    const std::vector<Asked> asked{{"mesh/boolean", false, mesh_poses(), true},
                                   {"mesh/all", true, mesh_poses(), true},
                                   {"mesh/aligned/boolean", false, aligned_poses(), false},
                                   {"mesh/aligned/all", true, aligned_poses(), false},
                                   {"mesh/coincident/boolean", false, std::vector<Pose>(20), false},
                                   {"mesh/coincident/all", true, std::vector<Pose>(1), false}};
    std::optional<MeshRace> race;
    for (const Asked& ask : asked) {
        if (!wanted(ask.bench)) continue;
        if (!race) {
            Result<StaticBvh> bvh = StaticBvh::build(data.vertices, data.triangles);
            if (!bvh) return bvh.error();
            race.emplace(data, std::move(*bvh));
        }
        const Tally tally = ask.all ? race->all(ask.poses) : race->boolean(ask.poses);
        rows.push_back(row(request, ask.bench, tally, ask.all ? "pairs" : "poses_that_touch"));
        if (const Status status = ask.same ? check_same(tally) : Status{}; !status) return status.error();
    }
    if (rows.size() == convex && convex == 0)
        return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    return rows;
}

}  // namespace carom::bench
