// Runs a scene from end to end and measures it.
//
//   Result<RunRecord> record = simulate(run, {.after_step = [&](int done) { return recorder->stepped(run, done); }});
#pragma once

#include <carom/dynamics/plan.hpp>
#include <carom/scenes/scene.hpp>
#include <carom/studies/oracle/ledger.hpp>
#include <carom/studies/oracle/penetration.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace carom::cli {

/// Largest geometric penetrations of a run by kind of pair [m].
struct PeakPenetration {
    double polytopes = 0.0, round = 0.0, terrain = 0.0;
};

/// CPU time of the steps of the last third of a run, when what falls has mostly settled: other programs on the machine do not count.
struct LateSteps {
    int steps = 0;
    double mean_ms = 0.0, p50_ms = 0.0, p99_ms = 0.0, max_ms = 0.0;  ///< of the process, all threads together
};

/// The measurements of a run; docs/cli.md defines each by its key in the JSON report.
struct RunRecord {
    std::string scene;
    std::uint64_t seed = 0;
    std::size_t bodies = 0;
    int steps = 0;
    double dt = 0.0;
    int substeps = 0;
    int threads = 1;
    Plan plan;

    double total_ms = 0.0;
    std::optional<double> mean_step_ms, p99_step_ms;  ///< none without steps
    std::array<double, kStageCount> stage_ms{};
    std::optional<LateSteps> late;                    ///< none without steps
    std::optional<std::size_t> world_bytes;           ///< that building and running the scene allocated and holds; none where it is not known

    WorldMemory memory;                               ///< at the end

    oracle::Penetration penetration;
    std::optional<PeakPenetration> peak;              ///< none where only the end was looked at
    double energy_drift = 0.0;
    std::optional<oracle::MomentumDrift> momentum_drift;
    std::optional<std::size_t> escaped;
    std::optional<int> tunnelled;
    std::size_t non_finite = 0, quarantined = 0;
    std::size_t pairs_limited = 0;  ///< steps that left pairs out
    std::size_t undecided = 0, overflow = 0, deep = 0;
    DirectCounts direct;            ///< islands solved directly, over all steps
    ContinuousCounts continuous;    ///< bodies followed along their paths, over all steps
    std::size_t asleep = 0;     ///< bodies, after the last step
    std::size_t fell_asleep = 0, woken = 0;  ///< over all steps
    double reused_share = 0.0;  ///< of all pairs of all steps: contacts carried along from the step before

    std::optional<double> max_speed, mean_speed;      ///< none without dynamic bodies
    std::size_t contacts = 0, manifolds = 0;
    std::uint64_t state_hash = 0;
};

/// The rule for energy: what a run may gain, relative to the largest kinetic energy so far + m g L.
inline constexpr double kEnergyRule = 1e-3;

struct SimulateSettings {
    int threads = 1;                             ///< for the record
    int peak_every = 1;                          ///< steps between looks at the penetration; 0: at the end only
    std::optional<std::size_t> heap_before;      ///< heap_in_use() before the scene was built
    std::function<Status(int done)> after_step;  ///< may be empty; an error ends the run
};

/// @return the record, or the error of `after_step`.
[[nodiscard]] Result<RunRecord> simulate(scenes::SceneRun& run, const SimulateSettings& settings);

}  // namespace carom::cli
