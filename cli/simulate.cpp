#include <carom/cli/simulate.hpp>

#include <carom/cli/heap_in_use.hpp>

#include <carom/core/types.hpp>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>
#include <vector>

namespace carom::cli {
namespace {

void add(DirectCounts& sum, const DirectCounts& step) {
    sum.stiff += step.stiff;
    sum.solved += step.solved;
    sum.too_large += step.too_large;
    sum.ordered += step.ordered;
    sum.moving += step.moving;
    sum.waiting += step.waiting;
    sum.fell_back += step.fell_back;
    sum.iterations += step.iterations;
    sum.factorisations += step.factorisations;
    sum.operations += step.operations;
}

void add(ContinuousCounts& sum, const ContinuousCounts& step) {
    sum.followed += step.followed;
    sum.pairs += step.pairs;
    sum.impacts += step.impacts;
    sum.clamped += step.clamped;
    sum.stopped += step.stopped;
    sum.carried += step.carried;
    sum.crushed += step.crushed;
    sum.parted += step.parted;
    sum.slowed += step.slowed;
    sum.overlapping += step.overlapping;
}

/// Nearest rank: the smallest time that `percent` of the steps do not exceed. @param sorted  not empty
double percentile(const std::vector<double>& sorted, std::size_t percent) { return sorted[(percent * sorted.size() + 99) / 100 - 1]; }

LateSteps late_steps(const std::vector<double>& cpu_ms) {
    std::vector<double> last(cpu_ms.end() - static_cast<std::ptrdiff_t>((cpu_ms.size() + 2) / 3), cpu_ms.end());
    LateSteps late{.steps = static_cast<int>(last.size())};
    for (const double ms : last) late.mean_ms += ms / static_cast<double>(last.size());
    std::sort(last.begin(), last.end());
    late.p50_ms = percentile(last, 50), late.p99_ms = percentile(last, 99), late.max_ms = last.back();
    return late;
}

// What is gathered step by step.
class Observer {
public:
    Observer(const scenes::SceneRun& run, int peak_every)
        : domain_(run.domain), peak_every_(peak_every), energy_(run.world), momentum_(run.world) {
        look(run.world, 0);
    }

    void bodies_changed(const World& world) {
        energy_.bodies_changed(world);
        momentum_.bodies_changed(world);
    }

    void stepped(const World& world, const StepReport& report, double cpu_ms, int done) {
        energy_.stepped(world);
        momentum_.stepped(world);
        step_ms_.push_back(report.total_ms);
        cpu_ms_.push_back(cpu_ms);
        for (std::size_t i = 0; i < kStageCount; ++i) {
            stage_ms_[i] += report.stage_ms[i];
        }
        quarantined_.insert(report.quarantined.begin(), report.quarantined.end());
        undecided_ += report.undecided;
        pairs_ += report.pairs;
        reused_ += report.reused;
        pairs_limited_ += report.pairs_limited ? 1 : 0;
        overflow_ += report.overflow;
        deep_ += report.deep;
        add(direct_, report.direct);
        add(continuous_, report.continuous);
        asleep_ = report.asleep;
        fell_asleep_ += report.fell_asleep;
        woken_ += report.woken;
        contacts_ = report.contacts;
        manifolds_ = report.manifolds;
        look(world, done);
    }

    void write(RunRecord& record) const {
        record.stage_ms = stage_ms_;
        for (double ms : step_ms_) {
            record.total_ms += ms;
        }
        if (!step_ms_.empty()) {
            std::vector<double> sorted = step_ms_;
            std::sort(sorted.begin(), sorted.end());
            record.p99_step_ms = percentile(sorted, 99);
            record.late = late_steps(cpu_ms_);
            record.mean_step_ms = record.total_ms / static_cast<double>(sorted.size());
        }
        if (peak_every_ > 0) record.peak = peak_;
        record.energy_drift = energy_.drift();
        record.momentum_drift = momentum_.drift();
        if (!is_empty(domain_)) record.escaped = escaped_.size();
        record.quarantined = quarantined_.size();
        record.undecided = undecided_;
        record.reused_share = pairs_ > 0 ? static_cast<double>(reused_) / static_cast<double>(pairs_) : 0.0;
        record.pairs_limited = pairs_limited_;
        record.overflow = overflow_;
        record.deep = deep_;
        record.direct = direct_;
        record.continuous = continuous_;
        record.asleep = asleep_;
        record.fell_asleep = fell_asleep_;
        record.woken = woken_;
        record.contacts = contacts_;
        record.manifolds = manifolds_;
    }

private:
    void look(const World& world, int done) {
        if (peak_every_ > 0 && done % peak_every_ == 0) {
            const oracle::Penetration now = oracle::geometric_penetration(world);
            peak_.polytopes = std::max(peak_.polytopes, now.polytopes.maximum);
            peak_.round = std::max(peak_.round, now.round.maximum);
            peak_.terrain = std::max(peak_.terrain, now.terrain.maximum);
        }
        if (is_empty(domain_)) return;
        for (BodyId body : world.bodies()) {
            if (world.type(body) != BodyType::Dynamic) continue;
            const dvec3 center = world.center_of_mass(body);
            const bool inside = glm::all(glm::greaterThanEqual(center, domain_.lower)) &&
                                glm::all(glm::lessThanEqual(center, domain_.upper));
            if (!inside) escaped_.insert(body);
        }
    }

    Aabb domain_;
    int peak_every_;
    oracle::EnergyLedger energy_;
    oracle::MomentumLedger momentum_;
    PeakPenetration peak_;
    std::vector<double> step_ms_, cpu_ms_;
    std::array<double, kStageCount> stage_ms_{};
    std::set<BodyId> escaped_, quarantined_;
    std::size_t undecided_ = 0, pairs_limited_ = 0, overflow_ = 0, deep_ = 0, contacts_ = 0, manifolds_ = 0;
    std::size_t pairs_ = 0, reused_ = 0;
    std::size_t asleep_ = 0, fell_asleep_ = 0, woken_ = 0;
    DirectCounts direct_;
    ContinuousCounts continuous_;
};

// Bodies, speeds and hash of the last state.
void look_at_end(const scenes::SceneRun& run, RunRecord& record) {
    const World& world = run.world;
    double sum = 0.0, most = 0.0;
    for (BodyId body : world.bodies()) {
        const Pose pose = world.pose(body);
        const dvec3 velocity = world.linear_velocity(body);
        const bool finite = is_finite(pose.position) && is_finite(pose.orientation) && is_finite(velocity) &&
                            is_finite(world.angular_velocity(body));
        record.non_finite += finite ? 0 : 1;
        if (world.type(body) != BodyType::Dynamic) continue;
        ++record.bodies;
        sum += glm::length(velocity);
        most = std::max(most, glm::length(velocity));
    }
    if (record.bodies > 0) {
        record.max_speed = most;
        record.mean_speed = sum / static_cast<double>(record.bodies);
    }
    if (run.tunnelled) record.tunnelled = run.tunnelled(world);
    record.penetration = oracle::geometric_penetration(world);
    record.state_hash = world.state_hash();
    record.plan = world.plan(run.dt);
}

}  // namespace

Result<RunRecord> simulate(scenes::SceneRun& run, const SimulateSettings& settings) {
    RunRecord record;
    record.scene = run.name;
    record.seed = run.seed;
    record.steps = run.steps;
    record.dt = run.dt;
    record.substeps = run.world.settings().substeps;
    record.threads = settings.threads;

    Observer observer(run, settings.peak_every);
    for (int i = 0; i < run.steps; ++i) {
        run.before_step(i);
        observer.bodies_changed(run.world);
        const std::clock_t before = std::clock();
        const StepReport report = run.world.step(run.dt);
        observer.stepped(run.world, report, static_cast<double>(std::clock() - before) * 1e3 / CLOCKS_PER_SEC, i + 1);
        if (settings.after_step) {
            if (Status status = settings.after_step(i + 1); !status) return status.error();
        }
    }
    if (const auto now = heap_in_use(); now && settings.heap_before && settings.threads == 1) record.world_bytes = *now - std::min(*now, *settings.heap_before);
    record.memory = run.world.memory();
    observer.write(record);
    look_at_end(run, record);
    return record;
}

}  // namespace carom::cli
