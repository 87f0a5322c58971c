#include <carom/dynamics/body.hpp>

namespace carom {

const char* to_string(BodyType type) noexcept {
    switch (type) {
        case BodyType::Static: return "static";
        case BodyType::Kinematic: return "kinematic";
        case BodyType::Dynamic: return "dynamic";
    }
    return "unknown";
}

const char* to_string(Continuity continuity) noexcept {
    switch (continuity) {
        case Continuity::Automatic: return "automatic";
        case Continuity::Always: return "always";
        case Continuity::Never: return "never";
    }
    return "unknown";
}

const char* to_string(CombineRule rule) noexcept {
    switch (rule) {
        case CombineRule::Average: return "average";
        case CombineRule::GeometricMean: return "geometric_mean";
        case CombineRule::Minimum: return "minimum";
        case CombineRule::Product: return "product";
        case CombineRule::Maximum: return "maximum";
    }
    return "unknown";
}

}  // namespace carom
