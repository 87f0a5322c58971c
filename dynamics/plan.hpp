// What each stage of the next step will do, what it leaves out, and why.
//
//   for (const PlanEntry& e : world.plan().entries) print(to_string(e.stage), e.run, e.reason);
#pragma once

#include <carom/broadphase/method.hpp>
#include <carom/dynamics/stage.hpp>

#include <string>
#include <vector>

namespace carom {

/// Automatic leaves out what the scene does not need, where the state stays bit-identical; Everything runs every stage.
enum class PlanMode : unsigned char { Automatic, Everything };

struct PlanEntry {
    Stage stage{};
    bool run = true;
    std::string reason;  ///< what runs or what is skipped, and why, in one sentence
};

/// Who finds the pairs of boxes that overlap. It changes times, never results.
struct BroadphasePlan {
    BroadphaseMethod method = BroadphaseMethod::Automatic;  ///< Automatic: no boxes to choose by, or no pairs to look for
    std::string reason;                                     ///< why this one, in one sentence
};

struct Plan {
    PlanMode mode = PlanMode::Automatic;
    int substeps = 8;
    std::vector<PlanEntry> entries;        ///< one for each stage, in order
    BroadphasePlan broadphase;
    std::vector<std::string> settings;     ///< choices that change accuracy, one sentence each
};

}  // namespace carom
