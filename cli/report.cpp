#include <carom/cli/report.hpp>

#include <carom/cli/build_info.hpp>

#include <carom/core/hash.hpp>
#include <carom/core/simd_width.hpp>

#include <fmt/format.h>

#include <iterator>

namespace carom::cli {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json plan_json(const Plan& plan) {
    Json stages = Json::array();
    for (const PlanEntry& entry : plan.entries) {
        stages.push_back({{"stage", to_string(entry.stage)}, {"run", entry.run}, {"reason", entry.reason}});
    }
    return {{"mode", plan.mode == PlanMode::Automatic ? "automatic" : "everything"},
            {"stages", stages},
            {"broadphase", {{"method", to_string(plan.broadphase.method)}, {"reason", plan.broadphase.reason}}},
            {"settings", plan.settings}};
}

Json time_json(const RunRecord& record) {
    Json by_stage = Json::object(), late = nullptr;
    if (const auto& l = record.late) late = {{"steps", l->steps}, {"mean", l->mean_ms}, {"p50", l->p50_ms}, {"p99", l->p99_ms}, {"max", l->max_ms}};
    for (Stage stage : all_stages()) {
        by_stage[to_string(stage)] = record.stage_ms[static_cast<std::size_t>(stage)];
    }
    return {{"total", record.total_ms},
            {"mean_step", or_null(record.mean_step_ms)},
            {"p99_step", or_null(record.p99_step_ms)},
            {"by_stage", by_stage},
            {"last_third_cpu", late}};
}

Json kind_json(const oracle::PenetrationSummary& end, const std::optional<PeakPenetration>& peak, double PeakPenetration::*kind) {
    return {{"max", end.maximum}, {"mean", end.mean}, {"pairs", end.pairs}, {"peak", peak ? Json((*peak).*kind) : Json(nullptr)}};
}

Json error_json(const RunRecord& record) {
    const oracle::Penetration& now = record.penetration;
    Json out{{"max_penetration", now.polytopes.maximum},
             {"mean_penetration", now.polytopes.mean},
             {"peak_penetration", record.peak ? Json(record.peak->polytopes) : Json(nullptr)},
             {"round", kind_json(now.round, record.peak, &PeakPenetration::round)},
             {"terrain", kind_json(now.terrain, record.peak, &PeakPenetration::terrain)},
             {"energy_drift", record.energy_drift},
             {"momentum_drift", nullptr},
             {"angular_momentum_drift", nullptr},
             {"angular_momentum_magnitude_drift", nullptr},
             {"escaped", or_null(record.escaped)},
             {"tunnelled", or_null(record.tunnelled)},
             {"non_finite", record.non_finite},
             {"quarantined", record.quarantined},
             {"pairs_limited", record.pairs_limited},
             {"undecided", record.undecided},
             {"overflow", record.overflow},
             {"deep", record.deep}};
    if (record.momentum_drift) {
        out["momentum_drift"] = record.momentum_drift->linear;
        out["angular_momentum_drift"] = record.momentum_drift->angular;
        out["angular_momentum_magnitude_drift"] = record.momentum_drift->angular_magnitude;
    }
    return out;
}

Json direct_json(const DirectCounts& direct) {
    return {{"stiff", direct.stiff},
            {"solved", direct.solved},
            {"too_large", direct.too_large},
            {"ordered", direct.ordered},
            {"moving", direct.moving},
            {"waiting", direct.waiting},
            {"fell_back", direct.fell_back},
            {"iterations", direct.iterations},
            {"factorisations", direct.factorisations},
            {"operations", direct.operations}};
}

Json continuous_json(const ContinuousCounts& continuous) {
    return {{"followed", continuous.followed},
            {"pairs", continuous.pairs},
            {"impacts", continuous.impacts},
            {"clamped", continuous.clamped},
            {"stopped", continuous.stopped},
            {"carried", continuous.carried},
            {"crushed", continuous.crushed},
            {"parted", continuous.parted},
            {"slowed", continuous.slowed},
            {"overlapping", continuous.overlapping}};
}

std::string direct_text(const DirectCounts& direct) {
    if (direct.stiff == 0) return "solver        no island was too stiff for soft contacts\n";
    return fmt::format("solver        islands too stiff for soft contacts, over all steps: {}; of these {} solved directly, {} too large, {} moving, {} waiting, "
                       "{} fell back\n              {} iterations, {} factorisations of {} block operations\n",
                       direct.stiff, direct.solved, direct.too_large, direct.moving, direct.waiting, direct.fell_back, direct.iterations,
                       direct.factorisations, direct.operations);
}

std::string count(const char* what, std::size_t n) { return n == 0 ? "" : fmt::format("  {} {}", n, what); }

Json memory_json(const WorldMemory& memory) {
    return {{"bodies", memory.bodies},     {"shapes", memory.shapes}, {"joints", memory.joints},   {"broadphase", memory.broadphase},
            {"contacts", memory.contacts}, {"solver", memory.solver}, {"scratch", memory.scratch}, {"other", memory.other}};
}

}  // namespace

Json to_json(const RunRecord& record) {
    return {{"scene", record.scene},
            {"seed", record.seed},
            {"bodies", record.bodies},
            {"steps", record.steps},
            {"dt", record.dt},
            {"substeps", record.substeps},
            {"threads", record.threads},
            {"machine", {{"cpu", cpu_model()}, {"cores", cpu_cores()}}},
            {"build", {{"version", version()}, {"compiler", compiler()}, {"type", build_type()}, {"simd_width", simd_width()}}},
            {"plan", plan_json(record.plan)},
            {"time_ms", time_json(record)},
            {"memory", {{"world_bytes", or_null(record.world_bytes)}, {"parts", memory_json(record.memory)}}},
            {"error", error_json(record)},
            {"speed", {{"max", or_null(record.max_speed)}, {"mean", or_null(record.mean_speed)}}},
            {"direct", direct_json(record.direct)},
            {"continuous", continuous_json(record.continuous)},
            {"sleep", {{"asleep", record.asleep}, {"fell_asleep", record.fell_asleep}, {"woken", record.woken}}},
            {"contacts", record.contacts},
            {"manifolds", record.manifolds},
            {"reused_share", record.reused_share},
            {"state_hash", to_hex(record.state_hash)}};
}

std::string summary(const RunRecord& record) {
    fmt::memory_buffer text;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{}: {} bodies, {} steps of {:.6g} s with {} substeps, seed {}, {} thread{}, SIMD width {}\n\n", record.scene,
                   record.bodies, record.steps, record.dt, record.substeps, record.seed, record.threads,
                   record.threads == 1 ? "" : "s", simd_width());
    if (record.mean_step_ms) {
        fmt::format_to(out, "time          mean {:.3f} ms a step, 99 % within {:.3f} ms, {:.2f} s in all\n", *record.mean_step_ms,
                       *record.p99_step_ms, record.total_ms * 1e-3);
        for (Stage stage : all_stages()) {
            const double ms = record.stage_ms[static_cast<std::size_t>(stage)];
            fmt::format_to(out, "  {:<11} {:9.3f} ms {:5.1f} %\n", to_string(stage), ms / record.steps,
                           record.total_ms > 0.0 ? 100.0 * ms / record.total_ms : 0.0);
        }
    }
    if (record.late) {
        fmt::format_to(out, "last third    mean {:.3f} ms of CPU time a step, half within {:.3f}, 99 % within {:.3f}, all within {:.3f} ms\n", record.late->mean_ms,
                       record.late->p50_ms, record.late->p99_ms, record.late->max_ms);
    }
    if (record.world_bytes) {
        fmt::format_to(out, "memory        {:.1f} MB", static_cast<double>(*record.world_bytes) * 1e-6);
        fmt::format_to(out, "{}\n", record.bodies > 0 ? fmt::format(", {} bytes a body", *record.world_bytes / record.bodies) : "");
    }
    const auto kilobytes = [](std::size_t bytes) { return static_cast<double>(bytes) * 1e-3; };
    const WorldMemory& parts = record.memory;
    fmt::format_to(out, "  of it [kB]  bodies {:.0f}, shapes {:.0f}, joints {:.0f}, broadphase {:.0f}, contacts {:.0f}, solver {:.0f}, scratch {:.0f}, other {:.0f}\n", kilobytes(parts.bodies),
                   kilobytes(parts.shapes), kilobytes(parts.joints), kilobytes(parts.broadphase), kilobytes(parts.contacts), kilobytes(parts.solver),
                   kilobytes(parts.scratch), kilobytes(parts.other));
    fmt::format_to(out, "broadphase    {}: {}\n", to_string(record.plan.broadphase.method), record.plan.broadphase.reason);
    const auto penetration = [&](const char* kind, const oracle::PenetrationSummary& end, double PeakPenetration::*peak) {
        fmt::format_to(out, "  {:<22} max {:.3g}  mean {:.3g}  over {} pairs", kind, end.maximum, end.mean, end.pairs);
        fmt::format_to(out, "{}\n", record.peak ? fmt::format("  peak of the run {:.3g}", (*record.peak).*peak) : "");
    };
    fmt::format_to(out, "\npenetration at the end, from poses and shapes [m]\n");
    penetration("boxes and hulls", record.penetration.polytopes, &PeakPenetration::polytopes);
    penetration("spheres and capsules", record.penetration.round, &PeakPenetration::round);
    penetration("meshes and planes", record.penetration.terrain, &PeakPenetration::terrain);
    fmt::format_to(out, "energy gained {:.3g} of the reference (the rule allows {:g})\n", record.energy_drift, kEnergyRule);
    if (record.momentum_drift) {
        fmt::format_to(out, "momentum      off by {:.3g} linear, {:.3g} angular (relative)\n", record.momentum_drift->linear,
                       record.momentum_drift->angular);
    }
    fmt::format_to(out, "escaped       {}", record.escaped ? fmt::to_string(*record.escaped) : "- (the scene has no limits)");
    fmt::format_to(out, "{}{}{}{}{}\n", count("not finite", record.non_finite), count("quarantined", record.quarantined),
                   count("steps that left pairs out", record.pairs_limited), count("pairs undecided", record.undecided), count("manifolds beyond the last colour", record.overflow));
    if (record.tunnelled) fmt::format_to(out, "tunnelled     {} of {}\n", *record.tunnelled, record.bodies);
    if (record.continuous.followed > 0) {
        fmt::format_to(out, "continuous    {} ways followed, {} impacts, {} bodies stopped at the last they were allowed, {} pairs too deep to be watched\n",
                       record.continuous.followed, record.continuous.impacts, record.continuous.stopped, record.continuous.overlapping);
    }
    fmt::format_to(out, "deep          {} points whose push-out was limited, over all steps\n", record.deep);
    if (record.max_speed) {
        fmt::format_to(out, "speed         max {:.3g} m/s, mean {:.3g} m/s\n", *record.max_speed, *record.mean_speed);
    }
    fmt::format_to(out, "{}", direct_text(record.direct));
    if (record.fell_asleep > 0) {
        fmt::format_to(out, "sleep         {} asleep at the end; {} fell asleep and {} woke over all steps\n", record.asleep, record.fell_asleep, record.woken);
    }
    fmt::format_to(out, "contacts      {} in {} manifolds; {:.0f} % of all pairs were carried along\nstate hash    {}\n", record.contacts,
                   record.manifolds, 100.0 * record.reused_share, to_hex(record.state_hash));
    return fmt::to_string(text);
}

}  // namespace carom::cli
