// What a step did, how long it took and how wrong it may be.
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/types.hpp>
#include <carom/dynamics/stage.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace carom {

/// Mechanical energy [J]; potential is -m g·x, zero at the world's origin, and that of stretched springs. Dynamic bodies only.
struct Energy {
    double kinetic = 0.0;
    double potential = 0.0;
    [[nodiscard]] double total() const noexcept { return kinetic + potential; }
};

/// Linear momentum [kg m/s] and angular momentum about the world's origin [kg m²/s]. Dynamic bodies only.
struct Momentum {
    dvec3 linear{0.0};
    dvec3 angular{0.0};
};

/// Change over a step: after less before.
struct Balance {
    Energy energy;
    Momentum momentum;
};

/// How far the contacts at the end of a step are from the laws of contact. Zero of each is an exact solution.
struct ContactResidual {
    double balance = 0.0;  ///< largest over the bodies in contact: what their momentum changed by and no force explains, over the sum of the lengths of all
                           ///< impulses on the body, gravity's included. The contacts' forces of the last substep are taken for those of the whole step: where
                           ///< they change within it (an impact), the balance shows it
    double speed = 0.0;    ///< the largest with which two points that push each other still approach or part, or that touch without a push approach [m/s]
    double cone = 0.0;     ///< by how much the friction of a point exceeds μ times its normal force, over the largest normal force
};

/// Islands of bodies in contact that the soft solver would have let sink too far (WorldDef::contact_method), and what became of them:
/// stiff is the sum of the five that follow.
struct DirectCounts {
    std::size_t stiff = 0;
    std::size_t solved = 0;      ///< directly
    std::size_t too_large = 0;   ///< for WorldDef::direct_budget
    std::size_t ordered = 0;     ///< islands that an order of elimination was looked for in, as they are new or have changed
    std::size_t moving = 0;      ///< too fast for their size, or about to bounce
    std::size_t waiting = 0;     ///< since a solve fell back not long ago
    std::size_t fell_back = 0;   ///< did not converge: thrown away, solved softly instead
    std::size_t iterations = 0;  ///< of all solves: of Newton's method
    std::size_t factorisations = 0;
    std::size_t operations = 0;  ///< of 6 x 6 blocks in these: what WorldDef::direct_budget limits for one of them
};

/// Joints of the step, and how well ball joints held.
struct JointCounts {
    std::size_t joints = 0;      ///< that took part: not those of quarantined bodies
    std::size_t islands = 0;     ///< of bodies that joints join
    std::size_t in_contact = 0;  ///< of these, with contacts too: they share the substeps of the contact solver
    std::size_t swept = 0;       ///< of the islands, those too large for WorldDef::direct_budget: solved joint by joint
    std::size_t given_up = 0;    ///< substeps of islands that found no impulses to close their gaps, as where a rope snaps straight: nothing parts
                                 ///< any faster there, and what gap comes of it is closed later
    double worst_gap = 0.0;      ///< of the anchors of a ball joint at the end of the step [m]
};

/// Bodies that moved far in the step, and what they met on their way (ContinuousSettings).
struct ContinuousCounts {
    std::size_t followed = 0;    ///< bodies that moved so far that their way was looked at
    std::size_t pairs = 0;       ///< times of impact that were asked for
    std::size_t impacts = 0;     ///< that happened
    std::size_t clamped = 0;     ///< searches that came to their cap: contact was assumed where they stopped
    std::size_t stopped = 0;     ///< bodies that came to more impacts than are followed: they stay where the last one was until the step is over
    std::size_t carried = 0;     ///< of these, bodies that something kinematic came upon, or what it carried: they went along with it, as if fixed to it, or slid out of its way until the step was over
    std::size_t crushed = 0;     ///< of these, bodies with no way left between something kinematic, or what it carries, and what does not give way or another that carries; locked axes leave fewer ways, or none: they stand there, and what comes upon them goes on through them
    std::size_t parted = 0;      ///< impacts of two that touched already: they were moved apart by some 1 % of the smaller one's thickness, and their angular momentum with them
    std::size_t slowed = 0;      ///< bodies that an impact, a contact or their own moments made spin faster than a step can follow (2,000 rad): they spin as fast as that
    std::size_t overlapping = 0; ///< pairs that were too deep in each other at the start to be watched: their contacts alone hold them
};

struct StepReport {
    std::uint64_t step = 0;  ///< steps done so far, this one included; 0: the step was refused or dt = 0
    double dt = 0.0;         ///< [s]

    std::array<double, kStageCount> stage_ms{};  ///< wall time by stage, substeps summed
    double total_ms = 0.0;

    std::size_t boxes_given = 0;    ///< to the broadphase: of what moves, but for what is nearly at rest, and of what came or was changed since the step before
    std::size_t boxes_removed = 0;  ///< from it: of what was destroyed or quarantined
    std::size_t pairs = 0;      ///< from the broadphase and the side list of planes
    std::size_t reused = 0;     ///< of these, kept or carried along from the step before: see WorldDef::contact_reuse
    std::size_t manifolds = 0;
    std::size_t contacts = 0;   ///< points of all manifolds
    std::size_t touching = 0;   ///< of these, with separation <= 0
    std::size_t passing = 0;    ///< pairs with contacts ahead that their motion did not lead to: they had none in this step

    std::size_t impacts = 0;       ///< points that bounced, counted at each of their impacts
    std::size_t impacts_left = 0;  ///< contacts that came to more impacts in the step than are followed: the solver stopped them, without a bounce

    double max_penetration = 0.0;   ///< by the manifolds at the start of the step [m]
    double mean_penetration = 0.0;  ///< over the touching points [m]

    bool pairs_limited = false;  ///< more boxes overlapped than WorldDef::pair_limit: contacts of the rest were not looked for
    std::size_t undecided = 0;   ///< pairs whose narrowphase stopped at its cap
    std::size_t overflow = 0;    ///< manifolds beyond the last colour, solved one after the other
    DirectCounts direct;
    JointCounts joints;
    ContinuousCounts continuous;
    std::size_t deep = 0;        ///< points that began the step so deep that their push was limited by WorldDef::max_push

    std::size_t asleep = 0;       ///< bodies that sleep after the step; pairs, manifolds and contacts above are without them
    std::size_t fell_asleep = 0;  ///< since the step before, in this one included
    std::size_t woken = 0;        ///< likewise

    std::optional<Balance> balance;      ///< where WorldDef::report_balance is on, unless the step quarantined a body
    std::optional<ContactResidual> residual;  ///< where WorldDef::report_residual is on, under the same condition
    std::vector<BodyId> quarantined;     ///< bodies that went non-finite in this step: restored, stopped and out of the simulation

    [[nodiscard]] double ms(Stage stage) const noexcept { return stage_ms[static_cast<std::size_t>(stage)]; }
};

}  // namespace carom
