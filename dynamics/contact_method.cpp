#include <carom/dynamics/contact_method.hpp>

namespace carom {

const char* to_string(ContactMethod method) noexcept {
    switch (method) {
        case ContactMethod::Automatic: return "automatic";
        case ContactMethod::Soft: return "soft";
        case ContactMethod::Direct: return "direct";
        case ContactMethod::Impulses: return "impulses";
    }
    return "unknown";
}

}  // namespace carom
