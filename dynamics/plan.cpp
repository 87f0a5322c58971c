// The plan: what the next step runs and leaves out, and why.
#include <carom/dynamics/plan.hpp>

#include <carom/broadphase/chooser.hpp>
#include <carom/core/check.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <cstdio>

namespace carom {
namespace {

std::string sentence(const char* format, double value) {
    char text[160];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

/// Without gravity there is no load by which to choose how stiff a contact should be.
bool can_solve_directly(const WorldDef& def) {
    return (def.contact_method == ContactMethod::Automatic || def.contact_method == ContactMethod::Direct) && def.gravity != dvec3{0.0};
}

bool looks_at_islands(const WorldDef& def) { return can_solve_directly(def) || def.contact_method == ContactMethod::Impulses; }

std::string reason_for_direct(Stage stage, const WorldDef& def) {
    if (def.contact_method == ContactMethod::Soft) return "skipped: WorldDef::contact_method is Soft";
    if (def.contact_method == ContactMethod::Impulses) {
        return stage == Stage::Islands ? "runs: every island is put down for sequential impulses" : "runs: WorldDef::contact_method is Impulses";
    }
    if (!can_solve_directly(def)) return "skipped: there is no gravity, and so no load that soft contacts could sag under";
    if (def.contact_method == ContactMethod::Direct) {
        return stage == Stage::Islands ? "runs: every island is put down for the direct solve" : "runs: WorldDef::contact_method is Direct";
    }
    return stage == Stage::Islands ? "runs: says which islands soft contacts would let sink too far, by the law of their sag"
                                   : "runs where there are such islands: small enough for the budget, and at rest, unless they are very small and squashed; the others stay soft";
}

std::string reason_for_sleep(const WorldDef& def, std::size_t asleep, std::size_t dynamic) {
    if (!def.sleep.enabled) return "skipped: WorldDef::sleep is off";
    return "runs: " + std::to_string(asleep) + " of " + std::to_string(dynamic) + " dynamic bodies sleep, and the other stages have nothing to do for them";
}

std::string reason_for(Stage stage, const dynamics::StepChoices& choices, const WorldDef& def, bool everything) {
    if (stage == Stage::Restitution && !choices.restitution) return "skipped: no shape bounces (all restitution is 0)";
    if (stage == Stage::Relax && !def.relax) return "skipped: WorldDef::relax is off";
    if (stage == Stage::Joints) return choices.joints ? "runs: there are joints" : choices.all_asleep ? "skipped: every dynamic body sleeps" : "skipped: there are no joints";
    if (!choices.contacts && choices.all_asleep && stage != Stage::Positions && stage != Stage::Quarantine) {
        return "skipped: every dynamic body sleeps, and nothing else moves";
    }
    if (!choices.contacts && stage != Stage::Positions && stage != Stage::Quarantine) {
        return "skipped: no two shapes could meet (one body with shapes, or none that moves)";
    }
    if (stage == Stage::Islands || stage == Stage::Direct) return reason_for_direct(stage, def);
    if (stage == Stage::Continuous) {
        return def.continuous.enabled ? "runs for bodies that a step moves by more than a share of their size; looks for such, and does nothing where there are none"
                                      : "skipped: WorldDef::continuous is off, and what is fast may pass through others";
    }
    if (everything) return "runs: the plan is to run everything";
    switch (stage) {
        case Stage::Positions: return "runs: free bodies move exactly, bodies in contact once a substep";
        case Stage::Quarantine: return "runs: every state is checked for NaN and infinity";
        case Stage::Restitution: return "runs: some shape has restitution";
        case Stage::Relax: return "runs: WorldDef::relax is on";
        default: return "runs: a dynamic body with a shape could meet another";
    }
}

bool runs(Stage stage, const dynamics::StepChoices& choices, const WorldDef& def) {
    switch (stage) {
        case Stage::Islands:
        case Stage::Direct: return choices.contacts && looks_at_islands(def);
        case Stage::Positions:
        case Stage::Quarantine: return true;
        case Stage::Sleep: return def.sleep.enabled;
        case Stage::Joints: return choices.joints;
        case Stage::Restitution: return choices.contacts && choices.restitution;
        case Stage::Continuous: return choices.continuous;
        case Stage::Relax: return choices.contacts && def.relax;
        default: return choices.contacts;
    }
}

}  // namespace

dynamics::StepChoices World::Impl::choose() const {
    if (def.plan == PlanMode::Everything) return {.continuous = def.continuous.enabled};
    const bool could_meet = census.bodies >= 2 && census.dynamic_bodies > 0, any_awake = is_any_awake();
    const bool meet = could_meet && any_awake;
    return {meet, census.bouncing_shapes > 0, !joints.empty() && any_awake, meet && def.continuous.enabled, !any_awake};
}

BroadphasePlan World::Impl::plan_broadphase(double dt) const {
    if (!choose().contacts) return {BroadphaseMethod::Automatic, "not used: no two shapes could meet"};
    if (broadphase.method() != BroadphaseMethod::Automatic) return {broadphase.method(), broadphase.reason()};
    // Nothing is chosen yet: look at the boxes that the first step would make.
    dynamics::ProxySet next = proxies;
    for (std::uint32_t slot = 0; slot < next.by_slot.size(); ++slot) {
        if (!dynamics::is_usable(arrays.states[next.bodies[slot]], dt)) dynamics::drop_proxy(next, slot);
    }
    SerialExecutor alone;
    dynamics::update_swept_bounds(next, arrays, {def.gravity, dt}, calm_rule(), alone);
    dynamics::note_listed(next);
    const auto count = static_cast<std::size_t>(std::count(next.listed.begin(), next.listed.end(), 1));
    if (count == 0) return {BroadphaseMethod::Automatic, "not used: no shape has a box"};
    const SceneChoice first = choose_for(next.boxes, next.listed, count, 1.0);
    return {first.choice.method, describe(first.choice, first.scene)};
}

Plan World::plan(double dt) const {
    CAROM_REQUIRE(is_finite(dt), ErrorCode::NotFinite, "dt must be finite", {});
    CAROM_REQUIRE(dt >= 0.0, ErrorCode::InvalidArgument, "dt must not be negative", {});
    CAROM_REQUIRE(dynamics::can_step(dt, impl_->def.gravity), ErrorCode::InvalidArgument, dynamics::kTooLong, {});
    const WorldDef& def = impl_->def;
    const dynamics::StepChoices choices = impl_->choose();
    Plan plan;
    plan.mode = def.plan;
    plan.substeps = def.substeps;
    for (const Stage stage : all_stages()) {
        const bool everything = def.plan == PlanMode::Everything;
        plan.entries.push_back({stage, runs(stage, choices, def),
                                stage == Stage::Sleep ? reason_for_sleep(def, impl_->sleepers.count(), static_cast<std::size_t>(impl_->census.dynamic_bodies))
                                                      : reason_for(stage, choices, def, everything)});
    }
    plan.broadphase = impl_->plan_broadphase(dt);
    plan.settings.push_back(sentence("substeps: %.0f a step", def.substeps));
    plan.settings.push_back(sentence("contacts as springs of %.4g times the substep rate", def.contact_rate));
    plan.settings.push_back(sentence("damping ratio of contacts: %.4g", def.contact_damping));
    plan.settings.push_back(def.contact_reuse > 0.0
                                ? sentence("contacts are kept until two shapes have moved against each other by %.4g of the smallest extent", def.contact_reuse)
                                : "contacts are found anew in every step");
    plan.settings.push_back(std::string("islands of bodies in contact are solved by the method ") + to_string(def.contact_method));
    if (can_solve_directly(def)) {
        plan.settings.push_back(sentence("solved directly, a contact sags by at most %.4g of the smallest extent", def.direct_sag));
        plan.settings.push_back(sentence("a direct solve may take %.0f block operations a factorisation", static_cast<double>(def.direct_budget)));
    }
    plan.settings.push_back(def.relax ? "a relax pass follows each substep" : "no relax pass: pushing overlap out adds energy");
    plan.settings.push_back(sentence("overlap is pushed out by at most %.4g of the smallest extent a step", def.max_push));
    if (impl_->census.resisting_shapes > 0) {
        plan.settings.push_back(sentence("%.0f shapes resist to rolling or spinning: a pass over their contacts follows each Solve and Relax, and their islands stay soft",
                                         impl_->census.resisting_shapes));
    }
    if (def.sleep.enabled) {
        plan.settings.push_back(sentence("islands sleep that have been still for %.4g s", def.sleep.time) +
                                sentence(": no point moved by more than %.4g of the smallest extent", def.sleep.motion));
    }
    return plan;
}

}  // namespace carom
