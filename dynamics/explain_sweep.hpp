// What became of two bodies on their way through the last step: who was followed, who met whom and when, and what let one pass through the other.
//
//   World world({.record_paths = true});
//   world.step(dt);
//   SweepExplanation why = world.explain_sweep(bullet, wall);
//   print(why.sentence);                                       // "B was met by A at t = 0.31 of the step ..."
//   if (why.passage) print(to_string(why.passage->cause), why.passage->remedy);
//
// Times are fractions of the step, from 0 to 1. Paths are the integrator's, with as many turns as were made, never the short arc between two poses; what
// contacts or joints held goes along the screw between its two poses. docs/continuous.md has the words.
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/continuous_settings.hpp>
#include <carom/narrowphase/impact.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carom {

/// Whether a body was followed in a step, or what kept it from that.
enum class Following : unsigned char {
    Followed,
    NoStep,     ///< no step has been done yet, or the last one looked for no contacts
    OutOfStep,  ///< it came since, or is quarantined
    NoShapes,
    Static,
    Asleep,  ///< until something that was followed met it
    Still,   ///< it did not move
    Slow,    ///< it moved by no more than the share of its size that is left to contacts
    Never,   ///< its Continuity forbids it
    Off,     ///< ContinuousSettings::enabled is false
};
/// @return "followed", "no step", "out of step", "no shapes", "static", "asleep", "still", "slow", "never", "off".
[[nodiscard]] const char* to_string(Following following) noexcept;

/// What stopped a body that stays where its last impact was until the step is over.
enum class StopCause : unsigned char {
    None,
    Impacts,  ///< it came to ContinuousSettings::most_impacts
    Budget,   ///< the step came to the most impacts, times of impact or pieces of paths that it looks at
    Partner,  ///< it met what had stopped
    Depth,    ///< it was in the middle of what it touched, and would have come deeper
    Crushed,  ///< after one of these something kinematic came upon it, and it could not go along: what does not give way, or another carrier, was in its way, or its axes are locked
};
/// @return "none", "impacts", "budget", "partner", "depth", "crushed".
[[nodiscard]] const char* to_string(StopCause cause) noexcept;

struct FollowFinding {
    Following reason = Following::NoStep;
    Continuity continuity = Continuity::Automatic;
    double motion = 0.0;  ///< how far a point of it may have come, at most; infinite for a plane that turns [m]
    double limit = 0.0;   ///< what moves more is followed: ContinuousSettings::motion times the smallest extent [m]
    bool flew = false;    ///< by itself: its path is the integrator's. Else contacts or joints held it
    int impacts = 0;      ///< in the step, with anything
    StopCause stopped = StopCause::None;
    double stopped_at = 1.0;  ///< when it was stopped
};

/// Whether two shapes were watched on their way, or what kept them from it; of a passage its cause.
enum class SweepReason : unsigned char {
    Watched,
    SameBody,
    NoStep,  ///< no step has been done yet, or the last one looked for no contacts
    NoShapes,
    OutOfStep,  ///< a shape came or changed since the step, or its body is quarantined
    NeitherDynamic,
    Filter,    ///< layers and masks do not agree
    Joined,    ///< a joint of their bodies leaves their contacts out
    BackFace,  ///< one is a one-sided mesh, and the other came from behind
    Off,       ///< ContinuousSettings::enabled is false, and one of them moved so far that it would have been followed
    Never,     ///< the Continuity of the one that moved so far forbids it
    Still,     ///< neither moved
    Slow,      ///< neither moved far: contacts are to hold them
    Company,   ///< they came little way against each other: contacts are to hold them
    TooDeep,   ///< they were so deep in each other when the step began that contacts alone hold them
    Pressed,   ///< of a passage: they had contacts, which did not hold them
    Crushed,   ///< of a passage: one is kinematic, and the other could not go along with it (StopCause::Crushed)
};
/// @return "watched", "same body", "no step", "no shapes", "out of step", "neither dynamic", "filter", "joined", "back face", "off", "never",
/// "still", "slow", "company", "too deep", "pressed", "crushed".
[[nodiscard]] const char* to_string(SweepReason reason) noexcept;

/// A blow, or a stop, of the step's continuous stage.
struct SweepImpact {
    BodyId body_a{}, body_b{};
    ShapeId shape_a{}, shape_b{};
    double t = 0.0;
    ImpactStatus status = ImpactStatus::Separated;  ///< of the search that found it
    double margin = 0.0;             ///< how near they were at least: the tolerance of the search and what their paths may bend [m]
    double watched = 1.0;            ///< share of A's thickness that was held against B: less than 1 where the two touched already
    dvec3 point{0.0};                ///< in the world [m]
    dvec3 normal{0.0};               ///< unit, from A to B; zero where no direction is known
    bool blow = false;               ///< their velocities changed; else at least one of them stopped there
    Pose pose_a{}, pose_b{};         ///< of the bodies' origins, at t
    std::vector<double> advances{};  ///< when conservative advancement looked before t, ascending; none where there is a closed form
};

/// A's middle came to B: a hundredth of the thickness of the one that is thinned (A, but for a B that alone has mass). What is on one side of a surface
/// has to bring its middle there before it is on the other.
struct Passage {
    std::uint64_t step = 0;
    double t = 0.0;        ///< never later than it was
    double touched = 0.0;  ///< when the two themselves first touched in the step
    bool through = false;  ///< apart again when the step was over; else still in each other
    SweepReason cause = SweepReason::Watched;
    ShapeId shape_a{}, shape_b{};
    std::string remedy{};    ///< the setting that would have caught it
    std::string sentence{};  ///< all of this, of A and B as they were asked for
};

/// Two shapes along their paths.
struct ShapeSweep {
    ShapeId shape_a{}, shape_b{};
    SweepReason reason = SweepReason::NoStep;
    Impact impact{};      ///< of the whole step, as the bodies went: its t is never later than the true one. Overlapping: from the start on
    double margin = 0.0;  ///< where they may have touched: they were at least as near as this at t [m]
    double clearance = 0.0;  ///< where they stayed apart: by at least this [m]
    std::optional<Passage> passage{};
};

struct SweepExplanation {
    BodyId body_a{}, body_b{};
    std::uint64_t step = 0;  ///< the last one; 0: none yet
    double dt = 0.0;         ///< its length [s]
    FollowFinding a{}, b{};
    SweepReason reason = SweepReason::NoStep;  ///< of the deciding pair
    std::vector<ShapeSweep> pairs{};           ///< of every two shapes that the step knew and that may meet, planes with planes left out
    std::size_t deciding = 0;                  ///< the first to pass, else the first to touch, else the one with the least clearance
    std::vector<SweepImpact> impacts{};        ///< of A or B with anything, in the order of their times
    std::optional<Passage> passage{};          ///< of the deciding pair
    std::string sentence{};
    /// Empty, or where a passage has no cause: faults of the engine's.
    std::vector<std::string> disagreements{};
};

/// A body that was followed in the last step, met by one that was, or would have been followed if it might (Following::Off, Never).
struct BodySweep {
    BodyId body{};
    FollowFinding follow{};
    std::vector<double> times{};  ///< 0, those of its impacts, 1
};

/// All that the continuous stage did in the last step, for pictures.
struct StepSweeps {
    std::uint64_t step = 0;
    double dt = 0.0;                     ///< [s]
    std::vector<BodySweep> bodies{};     ///< in the order of their slots
    std::vector<SweepImpact> impacts{};  ///< in the order of their times
};

}  // namespace carom
