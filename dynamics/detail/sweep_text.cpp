#include <carom/dynamics/detail/sweep_text.hpp>

#include <cstdio>

namespace carom {

const char* to_string(Following following) noexcept {
    switch (following) {
        case Following::Followed:
            return "followed";
        case Following::NoStep:
            return "no step";
        case Following::OutOfStep:
            return "out of step";
        case Following::NoShapes:
            return "no shapes";
        case Following::Static:
            return "static";
        case Following::Asleep:
            return "asleep";
        case Following::Still:
            return "still";
        case Following::Slow:
            return "slow";
        case Following::Never:
            return "never";
        case Following::Off:
            return "off";
    }
    return "unknown";
}

const char* to_string(StopCause cause) noexcept {
    switch (cause) {
        case StopCause::None:
            return "none";
        case StopCause::Impacts:
            return "impacts";
        case StopCause::Budget:
            return "budget";
        case StopCause::Partner:
            return "partner";
        case StopCause::Depth:
            return "depth";
        case StopCause::Crushed:
            return "crushed";
    }
    return "unknown";
}

const char* to_string(SweepReason reason) noexcept {
    switch (reason) {
        case SweepReason::Watched:
            return "watched";
        case SweepReason::SameBody:
            return "same body";
        case SweepReason::NoStep:
            return "no step";
        case SweepReason::NoShapes:
            return "no shapes";
        case SweepReason::OutOfStep:
            return "out of step";
        case SweepReason::NeitherDynamic:
            return "neither dynamic";
        case SweepReason::Filter:
            return "filter";
        case SweepReason::Joined:
            return "joined";
        case SweepReason::BackFace:
            return "back face";
        case SweepReason::Off:
            return "off";
        case SweepReason::Never:
            return "never";
        case SweepReason::Still:
            return "still";
        case SweepReason::Slow:
            return "slow";
        case SweepReason::Company:
            return "company";
        case SweepReason::TooDeep:
            return "too deep";
        case SweepReason::Pressed:
            return "pressed";
        case SweepReason::Crushed:
            return "crushed";
    }
    return "unknown";
}

namespace dynamics {
namespace {

std::string number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", x);
    return text;
}

/// Why two shapes were not watched, or did not hold each other.
std::string cause_text(SweepReason reason) {
    switch (reason) {
        case SweepReason::Watched:
            return "nothing is known to have let it: a fault of the engine's";
        case SweepReason::SameBody:
            return "shapes of one body never meet";
        case SweepReason::NoStep:
            return "no step has been done yet, or the last one looked for no contacts";
        case SweepReason::NoShapes:
            return "one of them has no shapes";
        case SweepReason::OutOfStep:
            return "the last step did not know both as they are: one came, changed or is quarantined";
        case SweepReason::NeitherDynamic:
            return "neither is dynamic";
        case SweepReason::Filter:
            return "their layers and masks do not agree";
        case SweepReason::Joined:
            return "a joint of the two leaves contacts between them out";
        case SweepReason::BackFace:
            return "one is a one-sided mesh and was met from behind";
        case SweepReason::Off:
            return "continuous collision is off, so nothing was looked for between the start of the step and its end";
        case SweepReason::Never:
            return "its continuity is never, so it was not followed";
        case SweepReason::Still:
            return "neither moved";
        case SweepReason::Slow:
            return "neither moved far enough to be followed, and no contact held them";
        case SweepReason::Company:
            return "they came too little way against each other to be watched, and no contact held them";
        case SweepReason::TooDeep:
            return "they were too deep in each other when the step began to be watched";
        case SweepReason::Pressed:
            return "their contacts did not hold what pressed them into each other";
        case SweepReason::Crushed:
            return "one is kinematic, which nothing stops, and the other could not give way to it";
    }
    return "";
}

std::string met_text(const SweepExplanation& why) {
    for (const SweepImpact& impact : why.impacts) {
        const bool both =
            (impact.body_a == why.body_a && impact.body_b == why.body_b) || (impact.body_a == why.body_b && impact.body_b == why.body_a);
        if (!both) continue;
        return std::string("they met at t = ") + number(impact.t) + " of the step, " + to_string(impact.status) + ", and " +
               (impact.blow ? "were struck apart" : "stopped there");
    }
    return "";
}

/// Whom the one that was followed met instead.
std::string other_text(const SweepExplanation& why) {
    for (const SweepImpact& impact : why.impacts) {
        const auto met = [&](BodyId self, const FollowFinding& follow, const char* name) -> std::string {
            if (follow.reason != Following::Followed || (impact.body_a != self && impact.body_b != self)) return "";
            const BodyId partner = impact.body_a == self ? impact.body_b : impact.body_a;
            return std::string("; ") + name + " met body " + std::to_string(partner.slot) + " at t = " + number(impact.t);
        };
        const std::string text = met(why.body_a, why.a, "A") + met(why.body_b, why.b, "B");
        if (!text.empty()) return text;
    }
    return "";
}

}  // namespace

std::string remedy_of(SweepReason cause, const std::string& who) {
    switch (cause) {
        case SweepReason::NeitherDynamic:
            return "BodyType::Dynamic for one of them";
        case SweepReason::Filter:
            return "ShapeDef::layer and ShapeDef::mask that agree";
        case SweepReason::Joined:
            return "collide_connected = true in their joint";
        case SweepReason::BackFace:
            return "TriangleMeshSettings::one_sided = false";
        case SweepReason::Off:
            return "ContinuousSettings::enabled = true (leave out --no-continuous, or \"continuous\": false in the scene file)";
        case SweepReason::Never:
            return "Continuity::Automatic for " + who;
        case SweepReason::Slow:
        case SweepReason::Company:
            return "Continuity::Always for " + who;
        case SweepReason::TooDeep:
            return "a start at which they are not in each other";
        case SweepReason::Pressed:
            return "more substeps, or ContactMethod::Direct: contacts that give less";
        case SweepReason::Crushed:
            return "a kinematic body that leaves room, or BodyType::Dynamic for it";
        default:
            return "none";
    }
}

std::string passage_text(const Passage& passage, const std::string& who, const std::string& whom) {
    return who + (passage.through ? " passed through " : " came into the middle of ") + whom + " in step " + std::to_string(passage.step) +
           ", at t = " + number(passage.t) + " of it, because " + cause_text(passage.cause) +
           "; what would have caught it: " + passage.remedy;
}

std::string sentence_of(const SweepExplanation& why) {
    if (why.passage) return why.passage->sentence;
    if (why.pairs.empty()) return "they were not watched on their way because " + cause_text(why.reason);
    if (const std::string met = met_text(why); !met.empty()) return met;
    const ShapeSweep& pair = why.pairs[why.deciding];
    const std::string watched = why.reason == SweepReason::Watched ? "they were watched on their way"
                                                                   : "they were not watched on their way because " + cause_text(why.reason);
    switch (pair.impact.status) {
        case ImpactStatus::Separated:
            return watched + ", and stayed at least " + number(pair.clearance) + " m apart" + other_text(why);
        case ImpactStatus::Overlapping:
            return watched + "; they touched from the start of the step on" + other_text(why);
        default:
            return watched + "; they touch at t = " + number(pair.impact.t) + " of the step, within " + number(pair.margin) + " m" +
                   other_text(why);
    }
}

}  // namespace dynamics
}  // namespace carom
