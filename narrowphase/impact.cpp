#include <carom/narrowphase/impact.hpp>

namespace carom {

const char* to_string(ImpactStatus status) noexcept {
    switch (status) {
        case ImpactStatus::Separated: return "separated";
        case ImpactStatus::Touching: return "touching";
        case ImpactStatus::Overlapping: return "overlapping";
        case ImpactStatus::Clamped: return "clamped";
        case ImpactStatus::Invalid: return "invalid";
    }
    return "invalid";
}

}  // namespace carom
