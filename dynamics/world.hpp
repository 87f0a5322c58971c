// The world: bodies, shapes, and the step.
//
//   World world({.gravity = {0, -9.81, 0}});
//   BodyId ground = world.create_body({.type = BodyType::Static});
//   world.add_shape(ground, Plane{{0, 1, 0}, 0});
//   StepReport report = world.step(1.0 / 60.0);
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/collision/mass_properties.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/body.hpp>
#include <carom/dynamics/contact_method.hpp>
#include <carom/dynamics/continuous_settings.hpp>
#include <carom/dynamics/joint.hpp>
#include <carom/dynamics/plan.hpp>
#include <carom/dynamics/sleep_settings.hpp>
#include <carom/dynamics/step_report.hpp>
#include <carom/dynamics/world_memory.hpp>
#include <carom/narrowphase/manifold.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace carom {

struct WorldDef {
    dvec3 gravity{0.0, -9.81, 0.0};   ///< [m/s²]
    int substeps = 8;                 ///< per step, 1..1024
    Executor* executor = nullptr;     ///< null: serial. Not owned; must outlive the world
    BroadphaseMethod broadphase = BroadphaseMethod::Automatic;
    std::size_t pair_limit = std::size_t{1} << 27;  ///< pairs of boxes that are kept, 1..2^31; see StepReport::pairs_limited
    PlanMode plan = PlanMode::Automatic;
    double contact_rate = 0.1875;     ///< frequency of soft contacts over the substep rate 1/h, in (0, 0.25]: 90 Hz at h = 1/480 s;
                                      ///< doubled against static bodies
    double contact_damping = 1.0;     ///< damping ratio of the soft contact, >= 0
    double max_push = 0.1;            ///< overlap is removed by at most this share of the smaller shape's smallest extent a step, >= 0
    double contact_reuse = 1e-3;      ///< share of the smaller shape's smallest extent, in [0, 0.1], that two shapes may move against each other before
                                      ///< their contact is found anew; 0: in every step. docs/step.md (Collide) has what else makes it be found anew
    double spin_tolerance = 1e-6;     ///< relative error allowed of the rotational energy of free bodies, within 1e-12 .. 1; it does not grow
                                      ///< with time. Bodies of three unlike moments are sub-cycled to it (free_rotation.hpp)
    ContactMethod contact_method = ContactMethod::Automatic;
    double direct_sag = 1e-4;         ///< share of the smallest extent, in [1e-6, 0.01], that a point which carries its whole island sags by where it
                                      ///< is solved directly; slender columns get less
    std::size_t direct_budget = 20'000;  ///< products of 6 x 6 blocks, 0..2^32, that a factorisation of an island may take, at some 30 ns each
    bool relax = true;                ///< the pass that takes out the energy of the push
    bool report_balance = false;      ///< fill StepReport::balance
    bool report_residual = false;     ///< fill StepReport::residual; costs one look at each body and contact
    bool record_paths = false;        ///< keep how bodies moved in a step and what they met, for explain_sweep() and sweeps(); costs a copy of each body's
                                      ///< state a step, and changes nothing else
    ContinuousSettings continuous{};  ///< on: what moves far in a step passes through nothing
    SleepSettings sleep{};            ///< off: every body is worked on in every step
};

/// @return InvalidArgument or NotFinite with a message that names the setting, where one is out of its range.
[[nodiscard]] Status validate(const WorldDef& def);

/// A ray's first hit in a world.
struct WorldRayHit {
    BodyId body;
    ShapeId shape;
    RayHit hit;
};

/// One contact manifold with what it joins.
struct ContactView {
    ShapeId shape_a, shape_b;           ///< dead where they were destroyed since the step
    BodyId body_a, body_b;
    dvec3 origin{0.0};                  ///< world position that the manifold's points are relative to, at the start of the step [m]
    Manifold manifold;                  ///< its pair is a number of the world's own
    std::array<float, kMaxManifoldPoints> normal_impulse{};  ///< per point, of the last substep [N s]
    std::array<vec3, kMaxManifoldPoints> friction_impulse{};   ///< the same, on B, world axes
};

struct ContactExplanation;  // <carom/dynamics/explain.hpp>
struct SweepExplanation;    // <carom/dynamics/explain_sweep.hpp>
struct StepSweeps;
struct Passage;
struct ShapeCast;           // <carom/dynamics/world_cast.hpp>
struct WorldImpact;

/// Bodies, shapes and the step. Every call with bad input (dead id, NaN, wrong range) reports misuse through the error
/// handler before anything changes, and returns a null id, a zero value or nothing. Not thread-safe; const calls may run at once.
class World {
public:
    /// A definition that validate() refuses is misuse; where the error handler returns, the world has the default settings.
    explicit World(const WorldDef& def = {});
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    [[nodiscard]] const WorldDef& settings() const noexcept;

    BodyId create_body(const BodyDef& def = {});
    /// Removes the body, its shapes and its joints.
    void destroy_body(BodyId body);
    /// Adds a shape; the mass of a dynamic body is then the sum over its shapes, and over the parts of compounds: of a closed mesh that of
    /// its solid, of an open one that of its hull. Planes and one-sided meshes only on static and kinematic bodies, and no flat mesh on a dynamic
    /// one: refused as WrongType or Degenerate. Mass and moments of inertia must be within 1e-30 .. 1e30 (kg, kg m²) and no bounded shape may
    /// reach farther than 1e30 m: the floats of solver and broadphase hold no others. set_mass_properties asks the same of masses.
    ShapeId add_shape(BodyId body, Shape shape, const ShapeDef& def = {});

    /// Joins two bodies, or a body and the world: a BallJointDef or a SpringDef (joint.hpp). The bodies must be alive and unlike, and one of
    /// them dynamic. Costs O(joints) at worst.
    JointId create_joint(const JointDef& def);
    void destroy_joint(JointId joint);

    [[nodiscard]] bool is_alive(BodyId body) const noexcept;
    [[nodiscard]] bool is_alive(ShapeId shape) const noexcept;
    [[nodiscard]] bool is_alive(JointId joint) const noexcept;
    /// @return the living joints, in order of creation; valid until a joint is created or destroyed.
    [[nodiscard]] std::span<const JointId> joints() const noexcept;
    [[nodiscard]] std::size_t body_count() const noexcept;
    /// @return the living bodies, in order of creation; valid until a body is created or destroyed.
    [[nodiscard]] std::span<const BodyId> bodies() const noexcept;

    [[nodiscard]] BodyType type(BodyId body) const;
    [[nodiscard]] const std::string& name(BodyId body) const;
    [[nodiscard]] Pose pose(BodyId body) const;             ///< of the body's origin
    [[nodiscard]] dvec3 center_of_mass(BodyId body) const;  ///< world [m]
    [[nodiscard]] dvec3 linear_velocity(BodyId body) const;
    [[nodiscard]] dvec3 angular_velocity(BodyId body) const;
    [[nodiscard]] MassProperties mass_properties(BodyId body) const;  ///< in the body's frame; zero unless dynamic
    [[nodiscard]] bool is_quarantined(BodyId body) const;
    [[nodiscard]] std::span<const ShapeId> shapes(BodyId body) const;

    [[nodiscard]] BodyId body_of(ShapeId shape) const;
    [[nodiscard]] const Shape& shape(ShapeId shape) const;       ///< a unit sphere for a dead id, after the report
    [[nodiscard]] const ShapeDef& shape_def(ShapeId shape) const;
    [[nodiscard]] Pose shape_pose(ShapeId shape) const;          ///< in the world

    [[nodiscard]] const JointDef& joint_def(JointId joint) const;  ///< a spring of no stiffness for a dead id, after the report
    /// Where the joint is, with the bodies as they are.
    [[nodiscard]] JointState joint_state(JointId joint) const;
    /// Gives a joint other numbers or bodies; what create_joint() refuses is refused. What pushed it in the last step stays known.
    void set_joint(JointId joint, const JointDef& def);

    /// Puts a quarantined body back into the simulation, in the state it has; nothing for any other body.
    void release(BodyId body);
    void set_pose(BodyId body, const Pose& pose);
    void set_linear_velocity(BodyId body, const dvec3& velocity);
    void set_angular_velocity(BodyId body, const dvec3& velocity);
    void set_mass_properties(BodyId body, const MassProperties& mass);
    void set_gravity_scale(BodyId body, double scale);                      ///< see BodyDef; within ±1e6
    void set_damping(BodyId body, double linear, double angular);           ///< see BodyDef; within 0 .. 1e9 1/s
    /// @param locked  bits of LockedAxes. Motion along and about them stops at once.
    void set_locked_axes(BodyId body, unsigned char locked);
    /// @param continuity  not of static bodies, but for Automatic.
    void set_continuity(BodyId body, Continuity continuity);
    [[nodiscard]] Continuity continuity(BodyId body) const;
    [[nodiscard]] double gravity_scale(BodyId body) const;
    [[nodiscard]] double linear_damping(BodyId body) const;
    [[nodiscard]] double angular_damping(BodyId body) const;
    [[nodiscard]] unsigned char locked_axes(BodyId body) const;
    /// Pushes through the whole of the next step that is not of dt = 0, evenly; forces and torques add up until then.
    /// @param force [N], at the world point `point` [m]; acceleration at most 1e15 m/s². What a step cannot follow (StepReport::quarantined) goes
    /// into quarantine at its start, as a speck does that a torque would turn by more than 2,000 rad.
    void apply_force(BodyId body, const dvec3& force, const dvec3& point);
    void apply_torque(BodyId body, const dvec3& torque);                    ///< the same with a torque [N m]
    /// Changes the velocity at once. @param impulse [N s], at the world point `point` [m].
    void apply_impulse(BodyId body, const dvec3& impulse, const dvec3& point);

    /// @return false for a dynamic body that sleeps, true for any other. What sleeps stays where it is, at rest, until something wakes it and the
    /// island that it is part of: a contact with what moves, a call that changes or pushes it, a body or shape under it that goes or is moved.
    [[nodiscard]] bool is_awake(BodyId body) const;
    /// Wakes a body's island; of a static or kinematic body all that sleeps on it. Time to fall asleep begins anew.
    void wake(BodyId body);
    /// Puts a body's whole island to sleep without waiting for SleepSettings::time, if all of it is at rest and held as docs/dynamics.md asks, and
    /// some step has shown so. Misuse where WorldDef::sleep is off. @return whether it sleeps.
    bool put_to_sleep(BodyId body);

    /// Advances by `dt` seconds. dt = 0 changes no bit; NaN, infinite or negative dt is refused. docs/step.md explains each stage.
    /// What is thrown in it (std::bad_alloc; by the executor or the error handler) comes out, and leaves a world that can go on: some bodies may have
    /// moved and others not, there are no contacts, and what slept is awake. What is thrown in a loop that several threads share ends the program.
    StepReport step(double dt);

    /// What the next step will run and skip, and who will find the pairs. @param dt its length [s], by which boxes go round the motion
    /// that it predicts; before the first step the method follows from the boxes. Refused like that of step().
    [[nodiscard]] Plan plan(double dt = 0.0) const;
    /// Hash of every body's pose and velocities, in order of creation; where WorldDef::sleep is on, also of who sleeps and who has been still how long.
    [[nodiscard]] std::uint64_t state_hash() const;
    /// What the world holds, as the last step left it; larger meanwhile by what its lists are copied to as they grow. Cost: a look at each body.
    [[nodiscard]] WorldMemory memory() const noexcept;
    [[nodiscard]] Energy energy() const;
    [[nodiscard]] Momentum momentum() const;

    /// The contacts of the last step, in a fixed order; then those that bodies asleep had when they fell asleep.
    [[nodiscard]] std::size_t contact_count() const noexcept;
    [[nodiscard]] ContactView contact(std::size_t index) const;

    /// The bounds of the last step's bounded shapes and what keeps their pairs, for queries and pictures. The slot of a box is
    /// ShapeId::slot of its shape; boxes are relative to broadphase_origin().
    [[nodiscard]] const Broadphase& broadphase() const noexcept;
    [[nodiscard]] dvec3 broadphase_origin() const noexcept;

    /// Why two bodies touch, or why not: what each stage of the last step made of their shapes. <carom/dynamics/explain.hpp> has the result;
    /// an empty one for a dead id, after the report. Cost: some µs for every two shapes, of meshes O(triangles), and what the broadphase
    /// takes to show its parts. Allocates; changes nothing.
    [[nodiscard]] ContactExplanation explain(BodyId a, BodyId b) const;

    /// What became of two bodies on their way through the last step: whether they were followed, when they touched, and what let one pass through
    /// the other. <carom/dynamics/explain_sweep.hpp> has the result. Misuse, and an empty result: a dead id, and a world without
    /// WorldDef::record_paths. Cost: O(bodies), and for every two shapes some 40 times of impact along their paths; of one-sided meshes that come
    /// near O(triangles log triangles). Allocates; changes nothing.
    [[nodiscard]] SweepExplanation explain_sweep(BodyId a, BodyId b) const;
    /// Its passage alone, for a look at every step. Cost: two or three searches for every two shapes.
    [[nodiscard]] std::optional<Passage> passage(BodyId a, BodyId b) const;
    /// The bodies that were followed in the last step, what they met, and when; empty where nothing was followed. Misuse as of explain_sweep().
    /// Cost: a search anew for each impact.
    [[nodiscard]] StepSweeps sweeps() const;
    /// Where a body's origin was in the last step. @param t  within 0 .. 1 of the step: 0 at its start, 1 where it left the body; later calls
    /// that move it do not count. Misuse as of explain_sweep(), and a t out of range; then, and for what the step did not know, the pose that
    /// the body has.
    [[nodiscard]] Pose pose_within_step(BodyId body, double t) const;

    /// First hit over all shapes but those of quarantined bodies; ties go to the body created first. Linear in the number of shapes
    /// in this version.
    [[nodiscard]] std::optional<WorldRayHit> cast_ray(const Ray& ray) const;

    /// What a convex shape that moves and turns meets first, of all shapes where they stand (shape_pose()) but those of quarantined bodies;
    /// world_cast.hpp has the words. Never later than the true time (impact.hpp); nothing is returned only where it is proved that it meets
    /// nothing. Ties go to the body created first. Cost: linear in the number of shapes, some 10 ns each that is not near the path, and cast_shape()
    /// of narrowphase for each that is; no allocation. Bad input: misuse, and nothing.
    [[nodiscard]] std::optional<WorldImpact> cast_shape(const ShapeCast& cast) const;
    /// The first contact with each shape that is met, the earliest first; of several at one t, the body created first.
    [[nodiscard]] std::vector<WorldImpact> cast_shape_all(const ShapeCast& cast) const;
    /// cast_shape() of many at once, on the world's executor: the same answers but for Impact::checks. Of batches of 32 and more a hierarchy
    /// of the shapes as they stand is made first, and a cast then costs what it comes near to.
    /// @param out  (n,) as `casts`. Bad input in any: misuse, and nothing changes.
    void cast_shapes(std::span<const ShapeCast> casts, std::span<std::optional<WorldImpact>> out) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace carom
