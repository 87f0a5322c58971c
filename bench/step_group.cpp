#include <carom/bench/step_group.hpp>

#include <carom/scenes/scene.hpp>
#include <carom/studies/oracle/penetration.hpp>
#include <carom/studies/peers/engines.hpp>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <optional>

namespace carom::bench {
namespace {

using accuracy::Engine;
using accuracy::SceneBodies;
using accuracy::moving_bodies;
using accuracy::scene_bodies;

constexpr int kTurn = 10;  // steps that an engine takes before the next one does

struct Peer {
    const char* name;
    std::unique_ptr<Engine> (*make)(const SceneBodies&);
};
constexpr std::array<Peer, 2> kPeers{{{"bullet", peers::make_bullet}, {"ode", peers::make_ode}}};

struct Bench {
    const char* name;
    const char* scene;
    std::optional<int> bodies;
    const char* left_out = "";  ///< a peer that would take too long
};
const std::array<Bench, 6> kBenches{{{"pyramid/40", "pyramid", {}},
                                     {"pile_boxes/1000", "pile_boxes", 1000},
                                     {"pile_boxes/4000", "pile_boxes", 4000},
                                     {"pile_boxes/16000", "pile_boxes", 16000, "ode"},
                                     {"pile_mixed/4000", "pile_mixed", 4000},
                                     {"mesh_bowl/2000", "mesh_bowl", 2000}}};

// One engine's way through a scene.
struct Contender {
    std::unique_ptr<Engine> engine;
    double cpu_ms = 0.0;
    oracle::Penetration penetration{};
    double mean_speed = 0.0;
    int escaped = 0;
};

bool matches(const Bench& bench, const Peer& peer, const std::string& filter) {
    return fmt::format("{}/{}", bench.name, peer.name).find(filter) != std::string::npos;
}

Result<scenes::SceneRun> build(const Bench& bench) { return scenes::make_scene(bench.scene, {.bodies = bench.bodies}); }

// CPU time of all threads of this process [ms].
double cpu_now() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// @return the wall time over the CPU time of the whole run: well above 1 where other programs held the processor.
double take_turns(std::vector<Contender>& contenders, int steps, double dt) {
    const auto wall_start = std::chrono::steady_clock::now();
    const double cpu_start = cpu_now();
    for (int done = 0; done < steps; done += kTurn) {
        const int count = std::min(kTurn, steps - done);
        for (Contender& contender : contenders) {
            const double start = cpu_now();
            for (int i = 0; i < count; ++i) contender.engine->step(dt);
            contender.cpu_ms += cpu_now() - start;
        }
    }
    const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - wall_start;
    return wall.count() / (cpu_now() - cpu_start);
}

// Puts the engine's bodies into a fresh world of the same scene and looks there.
Status judge(const Bench& bench, Contender& contender) {
    Result<scenes::SceneRun> fresh = build(bench);
    if (!fresh) return fresh.error();
    const std::vector<BodyId> ids = moving_bodies(fresh->world);
    double sum = 0.0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        fresh->world.set_pose(ids[i], contender.engine->pose(i));
        sum += glm::length(contender.engine->velocity(i));
    }
    contender.mean_speed = sum / static_cast<double>(ids.size());
    contender.escaped = scenes::count_escaped(fresh->world, fresh->domain);
    contender.penetration = oracle::geometric_penetration(fresh->world);
    return {};
}

Quality quality(const Contender& contender) {
    return {{"max_penetration", contender.penetration.polytopes.maximum},
            {"mean_penetration", contender.penetration.polytopes.mean}};
}

void print_head(std::FILE* out) {
    fmt::print(out, "{:<17} {:<7} {:>7} {:>9} {:>8}  {:>19}  {:>7}  {:>6}  {:>7}\n", "", "", "", "ms a", "Carom's", "overlap [mm]",
               "below", "mean", "");
    fmt::print(out, "{:<17} {:<7} {:>7} {:>9} {:>8}  {:>9} {:>9}  {:>7}  {:>6}  {:>7}\n", "bench", "engine", "version", "step", "speed",
               "maximum", "mean", "terrain", "mm/s", "escaped");
    std::fflush(out);
}

void print(std::FILE* out, const Bench& bench, const std::vector<Contender>& contenders, int steps) {
    for (const Contender& c : contenders) {
        fmt::print(out, "{:<17} {:<7} {:>7} {:>9.3f} {:>7.2f}x  {:>9.2f} {:>9.3f}  {:>7.2f}  {:>6.1f}  {:>7}\n", bench.name,
                   c.engine->name(), c.engine->version(), c.cpu_ms / steps, c.cpu_ms / contenders[0].cpu_ms,
                   1e3 * c.penetration.polytopes.maximum, 1e3 * c.penetration.polytopes.mean, 1e3 * c.penetration.terrain.maximum,
                   1e3 * c.mean_speed, c.escaped);
    }
}

// Runs one scene through Carom and `peers`, and adds a row for each of these.
Status run_bench(const Bench& bench, const std::vector<Peer>& peers, std::FILE* table, std::vector<Row>& rows) {
    Result<scenes::SceneRun> run = build(bench);
    if (!run) return run.error();
    const SceneBodies bodies = scene_bodies(run->world);
    std::vector<Contender> contenders;
    contenders.push_back({.engine = accuracy::make_carom(std::move(run->world))});
    for (const Peer& peer : peers) contenders.push_back({.engine = peer.make(bodies)});

    const double wall_over_cpu = take_turns(contenders, run->steps, run->dt);
    for (Contender& contender : contenders) {
        if (Status status = judge(bench, contender); !status) return status;
    }
    print(table, bench, contenders, run->steps);
    if (wall_over_cpu > 1.1) {
        fmt::print(table, "  note: other programs held the processor; this run took {:.2f} times its CPU time\n", wall_over_cpu);
    }
    std::fflush(table);
    const Contender& carom = contenders[0];
    for (std::size_t i = 1; i < contenders.size(); ++i) {
        const Contender& peer = contenders[i];
        rows.push_back({.bench = bench.name,
                        .peer = peer.engine->name(),
                        .peer_version = peer.engine->version(),
                        .threads = 1,
                        .carom_ms = carom.cpu_ms / run->steps,
                        .peer_ms = peer.cpu_ms / run->steps,
                        .carom_quality = quality(carom),
                        .peer_quality = quality(peer)});
    }
    return {};
}

}  // namespace

Result<std::vector<Row>> run_step_group(const GroupRequest& request) {
    std::vector<Row> rows;
    bool matched = false;
    for (const Bench& bench : kBenches) {
        std::vector<Peer> peers;
        for (const Peer& peer : kPeers) {
            if (!matches(bench, peer, request.filter)) continue;
            if (!matched) print_head(request.table);
            matched = true;
            if (peer.name == std::string(bench.left_out)) {
                fmt::print(request.table, "{:<17} {:<7} left out: it alone would take minutes\n", bench.name, peer.name);
            } else {
                peers.push_back(peer);
            }
        }
        if (peers.empty()) continue;
        if (Status status = run_bench(bench, peers, request.table, rows); !status) return status.error();
    }
    if (!matched) {
        return Error{ErrorCode::UnknownName, fmt::format("no row of the group matches \"{}\"", request.filter), "filter"};
    }
    return rows;
}

}  // namespace carom::bench
