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

}  // namespace carom
