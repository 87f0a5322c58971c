#include <carom/dynamics/stage.hpp>

namespace carom {

const char* to_string(Stage stage) noexcept {
    switch (stage) {
        case Stage::Bounds: return "Bounds";
        case Stage::Pairs: return "Pairs";
        case Stage::Collide: return "Collide";
        case Stage::Restitution: return "Restitution";
        case Stage::Islands: return "Islands";
        case Stage::Direct: return "Direct";
        case Stage::Joints: return "Joints";
        case Stage::Prepare: return "Prepare";
        case Stage::Velocities: return "Velocities";
        case Stage::WarmStart: return "WarmStart";
        case Stage::Solve: return "Solve";
        case Stage::Positions: return "Positions";
        case Stage::Relax: return "Relax";
        case Stage::Store: return "Store";
        case Stage::Continuous: return "Continuous";
        case Stage::Quarantine: return "Quarantine";
        case Stage::Sleep: return "Sleep";
    }
    return "unknown";
}

std::array<Stage, kStageCount> all_stages() noexcept {
    std::array<Stage, kStageCount> stages{};
    for (int i = 0; i < kStageCount; ++i) stages[static_cast<std::size_t>(i)] = static_cast<Stage>(i);
    return stages;
}

}  // namespace carom
