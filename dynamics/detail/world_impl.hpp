// What a World holds. Public calls live in world.cpp (bodies, shapes), world_joint.cpp, world_state.cpp (reading and setting), world_query.cpp
// (rays, energy, hash, contacts), world_cast.cpp, plan.cpp and world_step.cpp (the step).
#pragma once

#include <carom/core/slot_map.hpp>
#include <carom/dynamics/detail/carried_contacts.hpp>
#include <carom/dynamics/detail/cast_targets.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/continuous.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>
#include <carom/dynamics/detail/impacts.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/contact_residual.hpp>
#include <carom/dynamics/detail/direct_islands.hpp>
#include <carom/dynamics/detail/joint_set.hpp>
#include <carom/dynamics/detail/joint_solver.hpp>
#include <carom/dynamics/detail/part_surface.hpp>
#include <carom/dynamics/detail/passing.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/shape_list.hpp>
#include <carom/dynamics/detail/share_choice.hpp>
#include <carom/dynamics/detail/sleepers.hpp>
#include <carom/dynamics/detail/step.hpp>
#include <carom/dynamics/detail/step_paths.hpp>
#include <carom/dynamics/detail/team.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/narrowphase/collide.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace carom {

namespace dynamics {

/// A body as users know it; its state is in BodyArrays, at the id's slot.
struct BodyRecord {
    BodyType type = BodyType::Static;
    bool quarantined = false;
    std::unique_ptr<const std::string> name;  ///< null: it has none
    ShapeList shapes;
};

struct ShapeRecord {
    BodyId body;
    Shape shape;
    std::shared_ptr<const ShapeDef> def;  ///< shared with those that came right before and after, where they are alike
};

/// The last pose of a body from which a step could go on, and its velocity there; where there was none, the origin.
struct ValidPose {
    Pose pose;
    dvec3 velocity{0.0};
};

/// What takes part in the simulation: bodies with shapes, and what those are.
struct Census {
    int bodies = 0;
    int dynamic_bodies = 0;
    int bouncing_shapes = 0;
    int resisting_shapes = 0;  ///< to rolling or spinning

    /// A body with shapes comes (sign +1) or goes (-1).
    void count_body(BodyType type, int sign) noexcept {
        bodies += sign;
        if (type == BodyType::Dynamic) dynamic_bodies += sign;
    }
    /// One of its shapes does.
    void count_shape(const Shape& shape, const ShapeDef& def, int sign) noexcept {
        if (bounces(shape, def.restitution)) bouncing_shapes += sign;
        if (resists({def.rolling_resistance, def.torsion})) resisting_shapes += sign;
    }
};

/// The largest that a body may be pulled and damped, so that a step stays within the range of floats.
inline constexpr double kMostGravityScale = 1e6;
inline constexpr double kMostDamping = 1e9;  ///< [1/s]

/// @return null if all is well, else what is wrong.
[[nodiscard]] inline const char* fault_of_gravity_scale(double scale) noexcept {
    return scale >= -kMostGravityScale && scale <= kMostGravityScale ? nullptr : "the gravity scale must be within -1e6 .. 1e6";
}
[[nodiscard]] inline const char* fault_of_damping(double linear, double angular) noexcept {
    const auto good = [](double c) { return c >= 0.0 && c <= kMostDamping; };
    return good(linear) && good(angular) ? nullptr : "damping must be within 0 .. 1e9 1/s";
}
[[nodiscard]] inline const char* fault_of_continuity(Continuity continuity, BodyType type) noexcept {
    if (continuity > Continuity::Never) return "no such continuity";
    return continuity == Continuity::Automatic || type != BodyType::Static ? nullptr : "static bodies are not followed";
}
[[nodiscard]] inline const char* fault_of_locks(unsigned char locked) noexcept {
    return (locked & ~LockedAxes::All) == 0 ? nullptr : "no such axis to lock";
}

/// Which work the scene needs at all.
struct StepChoices {
    bool contacts = true;     ///< two shapes exist that could meet: Bounds to Relax, and Store
    bool restitution = true;  ///< some shape bounces
    bool joints = true;       ///< there are joints
    bool continuous = true;   ///< bodies that move far are followed
    bool all_asleep = false;  ///< every dynamic body sleeps, and no kinematic one moves
};

}  // namespace dynamics

struct World::Impl {
    explicit Impl(const WorldDef& settings);
    struct SweepJudge;  // explain_sweep.cpp, as is
    [[nodiscard]] SweepExplanation judge_sweep(BodyId a, BodyId b, bool brief) const;

    [[nodiscard]] Executor& executor() noexcept { return def.executor != nullptr ? *def.executor : serial; }
    /// Of a step: the executor's threads together, or one where there is too little to do.
    [[nodiscard]] Executor& threads() noexcept { return team.is_running() ? static_cast<Executor&>(team) : serial; }
    [[nodiscard]] StepReport take_step(const World& world, double dt);
    /// After a step that something thrown has ended: forgets what it may have left half done, and all that steps remember beside the bodies.
    void give_up_step() noexcept;

    [[nodiscard]] dynamics::SolverSettings solver_settings(double dt) const noexcept {
        return {def.gravity, dt, def.substeps, contact_rate(dt), def.contact_damping, def.max_push, census.resisting_shapes > 0};
    }
    [[nodiscard]] dynamics::DirectStep direct_step(double dt) const noexcept {
        return {def.gravity, dt, soft_substep * def.substeps, def.substeps, contact_rate(dt), def.max_push, def.direct_sag};
    }
    /// WorldDef::contact_rate where steps are alike. After a longer one contacts stay as soft as they were in it and stiffen little by little: a
    /// spring that is let loose at a higher stiffness than it was compressed at throws what lies on it.
    [[nodiscard]] double contact_rate(double dt) const noexcept { return def.contact_rate * std::min(1.0, dt / def.substeps / soft_substep); }
    void note_substep(double dt) noexcept;
    [[nodiscard]] dynamics::JointStep joint_step(double dt) const noexcept {
        return {def.gravity, dt, def.substeps, def.spin_tolerance, def.direct_budget};
    }
    /// How much of the impulses of the step before this one starts from: no more than all, for those of an impact do not grow with the step.
    [[nodiscard]] float impulse_scale(double dt) const noexcept {
        return std::min(1.0f, substep_ratio(dt));
    }
    /// Of this step's substep to that of the step before; 1 in the first.
    [[nodiscard]] float substep_ratio(double dt) const noexcept {
        return last_substep > 0.0 ? static_cast<float>(dt / def.substeps / last_substep) : 1.0f;
    }
    /// Where a joint's anchor is: on a body, or in the world for a null id.
    [[nodiscard]] dvec3 anchor_point(BodyId body, const dvec3& anchor) const;
    /// Visits every shape that takes part, by bodies in order of creation.
    void visit_cast_targets(FunctionRef<void(const dynamics::CastTarget& target)> visit) const;
    /// Whether the bodies of a joint are alive, unlike, and one of them moves. Otherwise reports misuse.
    [[nodiscard]] bool can_join(const JointDef& joint) const;
    /// Where the body's origin is.
    [[nodiscard]] Pose body_pose(BodyId body) const;
    /// Puts the body's origin at `pose`.
    void place_body(BodyId body, const Pose& pose);
    /// What the body at `slot` asks for beyond gravity, to be set. From the first call on every body has traits.
    [[nodiscard]] dynamics::BodyTraits& traits_of(std::uint32_t slot);
    /// Takes out what moves the body along or about its locked axes.
    void keep_locks(std::uint32_t slot);
    /// Adds to what pushes the body in the next step.
    void push(BodyId body, const dvec3& force, const dvec3& torque);
    /// What moves the body at `slot` in a step while nothing touches it.
    [[nodiscard]] dynamics::FreeMotion free_motion(std::size_t slot) const noexcept;
    void integrate_free_bodies(bool contacts_found, double dt);
    void drop_parted();
    void forget_pushes();
    /// The same for all that are alike and come one after the other.
    [[nodiscard]] std::shared_ptr<const ShapeDef> shared_def(const ShapeDef& kept);
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
    /// Wakes a body's island; of a body without mass what sleeps on it. Nothing where sleep is off.
    void wake(BodyId body);
    /// A body without mass came, or was put elsewhere: what it is near to wakes in the next step.
    void note_placed(BodyId body);
    /// Whether anything dynamic is awake, or anything kinematic moves.
    [[nodiscard]] bool is_any_awake() const;
    /// What wakes by others than contacts, before a step.
    void wake_before_step(double dt);
    /// What wakes by the contacts found in this step. @return whether anything does: the contacts must be found again.
    [[nodiscard]] bool wake_touched();
    void fall_asleep(double dt, StepReport& report);
    void note_moved_contacts();
    void take_over_contacts(dynamics::Step& step);
    void trim_lists();
    void find_contacts(dynamics::Step& step, const dynamics::Motion& motion);
    [[nodiscard]] dynamics::CalmRule calm_rule() const;
    [[nodiscard]] bool choose_looked(double dt);
    void patch_contacts(dynamics::Step& step);
    /// Marks the pairs of this step that only pass by each other.
    void find_passing(dynamics::Step& step, const dynamics::Motion& motion);
    void mark_displaced(const dynamics::StepChoices& choices);
    void solve_contacts(dynamics::Step& step, double dt);
    /// Follows what moved far.
    void follow(dynamics::Step& step, double dt);
    [[nodiscard]] dynamics::SleepScene sleep_scene();
    /// Wakes both bodies of a joint that comes, changes or goes.
    void wake_joined(const JointDef& joint);
    /// What the scene as it stands needs; all of it in PlanMode::Everything.
    [[nodiscard]] dynamics::StepChoices choose() const;
    /// The broadphase's method and why; before the first step, what that will choose.
    [[nodiscard]] BroadphasePlan plan_broadphase(double dt) const;
    /// Whether what was applied to the body leaves its speed and spin where a step can follow them.
    [[nodiscard]] bool can_be_pushed(std::uint32_t slot, double dt) const noexcept;
    /// Takes out every body whose state no step of `dt` can take on, at its last valid pose, at rest.
    void quarantine_unusable(double dt, StepReport& report);

    WorldDef def;
    SerialExecutor serial;
    dynamics::Team team;
    dynamics::ShareChoice share_choice;

    SlotMap<dynamics::BodyRecord, BodyId> bodies;
    std::vector<BodyId> body_order;
    dynamics::BodyArrays arrays;
    SlotMap<dynamics::ShapeRecord, ShapeId> shapes;
    std::shared_ptr<const ShapeDef> last_def;  // of the shape that came last

    dynamics::Census census;
    dynamics::ProxySet proxies;
    Broadphase broadphase;
    dynamics::CandidateParts candidate_parts;
    dynamics::CandidateNames names;
    CollideScratch collide_scratch;
    dynamics::ContactSet contacts;
    dynamics::ScratchPool scratch;         // of stages
    dynamics::ScratchList<NumberedPair> candidates{scratch};  // until contacts are found; those that are looked at where the others are kept
    dynamics::CarriedContacts previous{scratch};  // of the step before, while those of this one are found
    std::vector<Manifold> last_manifolds;  // of the step before, where pairs of it may be carried along; else empty
    std::vector<Manifold> found_manifolds;  // while they are found; else anything
    dynamics::ContactChanges contact_changes;
    bool contacts_hold = false;   // those of the last step, but for what its motion changed
    bool contacts_held = false;   // so it was when this step began
    bool pairs_complete = false;  // the broadphase listed all
    std::vector<unsigned char> displaced;  // by slot: bodies that others than the contact solver put where they are
    dynamics::Uses whole_looks;               // steps that find all contacts anew
    bool taken_over = false, patched = false;  // in this step: whether `previous` has the contacts of the step before, or `contacts` still are those
    bool carries = false;                     // when it began, the candidates of the step before had names
    dynamics::Passing passing;
    dynamics::Impacts impacts;
    dynamics::DirectIslands direct{scratch};
    dynamics::ResidualMeter residual;  // empty unless WorldDef::report_residual
    dynamics::ContactSolver solver{scratch};
    std::vector<std::uint32_t> free_bodies;  // slots, of the step: those that no contact and no joint holds, and the kinematic ones
    dynamics::Continuous continuous;
    dynamics::StepPaths paths;         // empty unless WorldDef::record_paths
    dynamics::Sleepers sleepers;
    std::vector<dynamics::BodyLink> sleep_links;  // of the joints
    dynamics::JointSet joints;
    dynamics::JointSolver joint_solver;
    std::vector<dynamics::ValidPose> last_valid;  // by slot
    double soft_substep = 0.0;  // [s]; the contacts' frequency is contact_rate over this
    double last_substep = 0.0;  // [s]; impulses are carried in proportion
    std::uint64_t steps = 0;
    bool pushed = false;  // a force or a torque waits for the next step
    bool looked_for_contacts = false;  // in the last step
};

}  // namespace carom
