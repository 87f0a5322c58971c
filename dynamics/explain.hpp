// Why two bodies of a world touch, or why not: the ladder that every pair climbs in a step, rung by rung, as the last step saw it.
//
//   ContactExplanation why = world.explain(crate, floor);         // <carom/dynamics/explain.hpp>
//   print(why.sentence);                                          // "they do not touch because ..."
//   for (const ShapePairExplanation& pair : why.pairs) ...
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/core/ids.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/narrowphase/explain.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carom {

/// The rungs, in the order in which a pair climbs them. A pair's rung is the one that ended the climb.
enum class Rung : unsigned char {
    SameBody,      ///< shapes of one body do not meet
    NoShapes,      ///< one of the bodies has none
    Filter,        ///< neither is dynamic, or layers and masks do not agree
    Asleep,        ///< one of the bodies sleeps and the other does not move, or sleeps as well: they are as they were when it fell asleep
    Joined,        ///< a joint of the two bodies leaves their contacts out
    NoStep,        ///< no step has been done yet, or the last one looked for no contacts
    OutOfStep,     ///< a shape came or changed since, or its body is quarantined: the last step knew another one or none
    Bounds,        ///< the boxes around the predicted motion do not overlap; of a plane: the box does not come near it
    PairLimit,     ///< more boxes overlap than WorldDef::pair_limit
    Distance,      ///< farther apart than the margin of the step
    BackFace,      ///< one of them is a one-sided mesh with its back towards the other's centre
    Margin,        ///< contacts within the margin, none of which touches
    Touch,         ///< at least one contact touches
};

/// @return "same body", "no shapes", "filter", "asleep", "joined", "no step", "out of step", "bounds", "pair limit", "distance",
/// "back face", "margin", "touch".
[[nodiscard]] const char* to_string(Rung rung) noexcept;

/// Layers, masks and who moves, of the two shapes.
struct FilterFinding {
    std::uint64_t layer_a = 0, mask_a = 0, layer_b = 0, mask_b = 0;
    bool layers_agree = false;
    bool any_moves = false;  ///< one of them is on a dynamic body
    bool joined = false;     ///< a joint of their bodies leaves their contacts out, as the world is now
};

/// The boxes of the last step, around the motion that it predicted, and the axis on which they are farthest apart or overlap least. Where B
/// is a plane, box_b is empty, the axis -1, and the gap that between A's box and how far the plane's surface may come.
struct BoundsFinding {
    FloatAabb box_a{}, box_b{};  ///< relative to World::broadphase_origin() [m]
    int axis = 0;                ///< 0, 1, 2; -1: a plane's normal
    double gap = 0.0;            ///< [m]; negative or 0: they overlap, which lets the pair pass
};

/// What finds or does not find the pair. Planes have a list of their own, which every movable shape is held against.
struct BroadphaseFinding {
    BroadphaseMethod method = BroadphaseMethod::Automatic;  ///< Automatic: the list of planes
    bool listed = false;
    std::string place;  ///< the cells, interval or node in which the two meet or do not, in one sentence
};

/// The contacts of the last step between two shapes.
struct StepContacts {
    std::size_t manifolds = 0, points = 0;
    double least_separation = 0.0;  ///< of the points; 0 without any [m]
    bool passes = false;            ///< ahead of them, and their motion in the step did not lead there: nobody solved them
    bool carried = false;           ///< not as the poses give them, but carried along from a step before: WorldDef::contact_reuse
};

/// Two shapes on their way up. What lies beyond the rung that ended it is not there, but for `contact`, which is there for every pair
/// that the last step knew and that shapes of their kinds may have.
struct ShapePairExplanation {
    ShapeId shape_a, shape_b;  ///< of body a and of body b
    Rung rung = Rung::NoStep;
    std::optional<FilterFinding> filter;
    std::optional<BoundsFinding> bounds;
    std::optional<BroadphaseFinding> broadphase;
    std::optional<StepContacts> found;       ///< what the step had of the two, where it looked at them
    std::optional<PairExplanation> contact;  ///< measured anew from a to b, at the start of the last step, with the step's margin; 0 where it gave none
    Pose pose_a{}, pose_b{};                 ///< of the shapes then, in the world; `contact` counts from pose_a.position
};

struct ContactExplanation {
    BodyId body_a, body_b;
    std::uint64_t step = 0;     ///< the last one; 0: none yet
    Rung rung = Rung::NoStep;   ///< the highest that any two of their shapes reached
    std::vector<ShapePairExplanation> pairs;  ///< of every two shapes; none for SameBody and NoShapes
    std::size_t deciding = 0;   ///< index of the pair that got highest; of several the one with the least gap
    std::string sentence;       ///< "they touch because ..." or "they do not touch because ..."
    /// Empty, or where the step did something else than the rungs say it should have: faults of the engine's.
    std::vector<std::string> disagreements;
};

}  // namespace carom
