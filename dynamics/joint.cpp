#include <carom/dynamics/joint.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

namespace carom {
namespace {

constexpr double kMost = 1e30;  // of lengths, stiffness and damping

bool in_range(double x) { return x >= 0.0 && x <= kMost; }

Error fault(double x, const char* message) { return {is_finite(x) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, message, "joint"}; }

}  // namespace

const char* kind_of(const JointDef& def) noexcept { return std::holds_alternative<SpringDef>(def) ? "spring" : "ball joint"; }

Status validate(const JointDef& def) {
    const auto anchors = [](const auto& joint) -> Status {
        if (!is_finite(joint.anchor_a) || !is_finite(joint.anchor_b)) return Error{ErrorCode::NotFinite, "anchors must be finite", "joint"};
        if (glm::length(joint.anchor_a) <= kMost && glm::length(joint.anchor_b) <= kMost) return {};
        return Error{ErrorCode::InvalidArgument, "anchors must be within 1e30 m of their bodies", "joint"};
    };
    if (Status status = std::visit(anchors, def); !status) return status;
    const SpringDef* spring = std::get_if<SpringDef>(&def);
    if (spring == nullptr) return {};
    if (!in_range(spring->rest_length)) return fault(spring->rest_length, "the rest length must be within 0 .. 1e30 m");
    if (!in_range(spring->stiffness)) return fault(spring->stiffness, "the stiffness must be within 0 .. 1e30 N/m");
    if (!in_range(spring->damping)) return fault(spring->damping, "the damping must be within 0 .. 1e30 N s/m");
    return {};
}

SpringDamper spring_damper(double frequency, double damping_ratio, double mass) {
    CAROM_REQUIRE(is_finite(frequency) && is_finite(damping_ratio) && is_finite(mass), ErrorCode::NotFinite,
                  "frequency, damping ratio and mass must be finite", {});
    CAROM_REQUIRE(frequency >= 0.0 && damping_ratio >= 0.0 && mass >= 0.0, ErrorCode::InvalidArgument,
                  "frequency, damping ratio and mass must not be negative", {});
    const double rate = 2.0 * kPi * frequency;
    return {mass * rate * rate, 2.0 * damping_ratio * mass * rate};
}

}  // namespace carom
