// The plan: what the next step runs and leaves out, and why.
#include <carom/dynamics/plan.hpp>

#include <carom/dynamics/detail/part_surface.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <cstdio>

namespace carom {
namespace {

std::string sentence(const char* format, double value) {
    char text[160];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string reason_for(Stage stage, const dynamics::StepChoices& choices, const WorldDef& def, bool everything) {
    if (stage == Stage::Restitution && !choices.restitution) return "skipped: no shape bounces (all restitution is 0)";
    if (stage == Stage::Relax && !def.relax) return "skipped: WorldDef::relax is off";
    if (!choices.contacts && stage != Stage::Positions && stage != Stage::Quarantine) {
        return "skipped: no two shapes could meet (one body with shapes, or none that moves)";
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
        case Stage::Positions:
        case Stage::Quarantine: return true;
        case Stage::Restitution: return choices.contacts && choices.restitution;
        case Stage::Relax: return choices.contacts && def.relax;
        default: return choices.contacts;
    }
}

}  // namespace

dynamics::StepChoices World::Impl::choose() const {
    if (def.plan == PlanMode::Everything) return {};
    std::size_t bodies_with_shapes = 0;
    bool any_dynamic = false;
    bool any_bounce = false;
    for (const BodyId id : body_order) {
        const dynamics::BodyRecord& record = *bodies.find(id);
        if (record.quarantined || record.shapes.empty()) continue;
        ++bodies_with_shapes;
        any_dynamic |= record.type == BodyType::Dynamic;
        for (const ShapeId id_of_shape : record.shapes) {
            const dynamics::ShapeRecord& s = *shapes.find(id_of_shape);
            any_bounce |= dynamics::bounces(s.shape, s.def.restitution);
        }
    }
    return {bodies_with_shapes >= 2 && any_dynamic, any_bounce};
}

Plan World::plan() const {
    const WorldDef& def = impl_->def;
    const dynamics::StepChoices choices = impl_->choose();
    Plan plan;
    plan.mode = def.plan;
    plan.substeps = def.substeps;
    for (const Stage stage : all_stages()) {
        const bool everything = def.plan == PlanMode::Everything;
        plan.entries.push_back({stage, runs(stage, choices, def), reason_for(stage, choices, def, everything)});
    }
    plan.settings.push_back(std::string("broadphase: ") + to_string(impl_->broadphase.method()) + ": " + impl_->broadphase.reason());
    plan.settings.push_back(sentence("substeps: %.0f a step", def.substeps));
    plan.settings.push_back(sentence("contacts as springs of %.4g times the substep rate", def.contact_rate));
    plan.settings.push_back(sentence("damping ratio of contacts: %.4g", def.contact_damping));
    plan.settings.push_back(def.relax ? "a relax pass follows each substep" : "no relax pass: pushing overlap out adds energy");
    plan.settings.push_back(sentence("overlap is pushed out by at most %.4g of the smallest extent a step", def.max_push));
    return plan;
}

}  // namespace carom
