// What a World holds. Public calls live in world.cpp (bodies, shapes), world_state.cpp (reading and setting), world_query.cpp
// (rays, energy, hash, contacts), plan.cpp and world_step.cpp (the step).
#pragma once

#include <carom/core/slot_map.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>
#include <carom/dynamics/detail/direct_islands.hpp>
#include <carom/dynamics/detail/part_surface.hpp>
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

/// The last pose of a body from which a step could go on.
struct ValidPose {
    BodyId id;
    Pose pose;
};

/// What takes part in the simulation: bodies with shapes, and what those are.
struct Census {
    int bodies = 0;
    int dynamic_bodies = 0;
    int bouncing_shapes = 0;

    /// A body with shapes comes (sign +1) or goes (-1).
    void count_body(BodyType type, int sign) noexcept {
        bodies += sign;
        if (type == BodyType::Dynamic) dynamic_bodies += sign;
    }
    /// One of its shapes does.
    void count_shape(const Shape& shape, float restitution, int sign) noexcept {
        if (bounces(shape, restitution)) bouncing_shapes += sign;
    }
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
        return {def.gravity, dt, def.substeps, def.contact_rate, def.contact_damping, def.max_push};
    }
    [[nodiscard]] dynamics::DirectStep direct_step(double dt) const noexcept {
        return {def.gravity, dt, def.substeps, def.contact_rate, def.max_push, def.direct_sag};
    }
    /// How much of the impulses of the step before this one starts from.
    [[nodiscard]] float impulse_scale(double dt) const noexcept {
        return last_substep > 0.0 ? static_cast<float>(dt / def.substeps / last_substep) : 1.0f;
    }
    /// Where the body's origin is.
    [[nodiscard]] Pose body_pose(BodyId body) const;
    /// Puts the body's origin at `pose`.
    void place_body(BodyId body, const Pose& pose);
    /// The mass of a body's shapes and of one more.
    [[nodiscard]] MassProperties mass_with(const dynamics::BodyRecord& record, const MassProperties& added) const;
    /// Sets the mass and keeps the origin and the motion of the body's points where they are.
    void assign_mass(BodyId body, const MassProperties& mass);
    /// Makes the proxy of a shape, or makes it anew.
    void put_proxy(ShapeId id);
    /// The same for all shapes of a body.
    void put_proxies(BodyId body);
    /// Lets a body that has its role take part, or no longer: its proxies come or go, and no others.
    void put_in(BodyId body);
    void take_out(BodyId body);
    void count_body(BodyId body, int sign);
    /// What the scene as it stands needs; all of it in PlanMode::Everything.
    [[nodiscard]] dynamics::StepChoices choose() const;
    /// The broadphase's method and why; before the first step, what that will choose.
    [[nodiscard]] BroadphasePlan plan_broadphase(double dt) const;
    /// Takes out every body whose state no step of `dt` can take on, at its last valid pose, at rest.
    void quarantine_unusable(double dt, StepReport& report);

    WorldDef def;
    SerialExecutor serial;

    SlotMap<dynamics::BodyRecord, BodyId> bodies;
    std::vector<BodyId> body_order;
    dynamics::BodyArrays arrays;
    SlotMap<dynamics::ShapeRecord, ShapeId> shapes;

    dynamics::Census census;
    dynamics::ProxySet proxies;
    Broadphase broadphase;
    std::vector<NumberedPair> candidates;
    dynamics::CandidateNames names;
    CollideScratch collide_scratch;
    dynamics::ContactSet contacts, previous;
    dynamics::DirectIslands direct;
    dynamics::ContactSolver solver;
    std::vector<dynamics::ValidPose> last_valid;  // by slot
    double last_substep = 0.0;  // [s]; impulses are carried in proportion
    std::uint64_t steps = 0;
    bool looked_for_contacts = false;  // in the last step
};

}  // namespace carom
