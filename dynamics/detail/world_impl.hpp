// What a World holds. Public calls live in world.cpp (bodies, shapes), world_state.cpp (reading and setting), world_query.cpp
// (rays, energy, hash, contacts), plan.cpp and world_step.cpp (the step).
#pragma once

#include <carom/core/slot_map.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/narrowphase/collide.hpp>

#include <string>
#include <vector>

namespace carom {

namespace dynamics {

/// A body as users know it; its state is in BodyArrays, at the id's slot.
struct BodyRecord {
    BodyType type = BodyType::Static;
    std::string name;
    std::vector<ShapeId> shapes;
    bool quarantined = false;
};

struct ShapeRecord {
    BodyId body;
    Shape shape;
    ShapeDef def;
};

/// Which work the scene needs at all.
struct StepChoices {
    bool contacts = true;     ///< two shapes exist that could meet: Bounds to Relax, and Store
    bool restitution = true;  ///< some shape bounces
};

}  // namespace dynamics

struct World::Impl {
    explicit Impl(const WorldDef& settings);

    [[nodiscard]] Executor& executor() noexcept { return def.executor != nullptr ? *def.executor : serial; }

    [[nodiscard]] dynamics::SolverSettings solver_settings(double dt) const noexcept {
        return {def.gravity, dt, def.substeps, def.contact_frequency, def.contact_damping, def.max_push_speed};
    }
    /// Where the body's origin is.
    [[nodiscard]] Pose body_pose(BodyId body) const;
    /// Puts the body's origin at `pose`.
    void place_body(BodyId body, const Pose& pose);
    /// Sums the mass over the shapes and keeps the origin and the motion of its points where they are.
    void update_mass(BodyId body);
    void assign_mass(BodyId body, const MassProperties& mass);
    /// Lists shapes anew after bodies or shapes came or went.
    void refresh_proxies();
    /// What the scene as it stands needs; all of it in PlanMode::Everything.
    [[nodiscard]] dynamics::StepChoices choose() const;
    /// Takes a body out of the simulation at its last valid pose, at rest.
    void quarantine(std::uint32_t slot, StepReport& report);

    WorldDef def;
    SerialExecutor serial;

    SlotMap<dynamics::BodyRecord, BodyId> bodies;
    std::vector<BodyId> body_order;
    dynamics::BodyArrays arrays;
    SlotMap<dynamics::ShapeRecord, ShapeId> shapes;

    bool proxies_stale = true;
    dynamics::StepChoices choices;  // of the next step; valid while proxies are not stale
    dynamics::ProxySet proxies;
    std::unique_ptr<Broadphase> broadphase;
    std::vector<ShapePair> shape_pairs;
    CollideScratch collide_scratch;
    dynamics::ContactSet contacts, previous;
    dynamics::ContactSolver solver;
    std::vector<dynamics::BodyState> last_valid;
    std::vector<std::uint32_t> lost;
    std::uint64_t steps = 0;
};

}  // namespace carom
