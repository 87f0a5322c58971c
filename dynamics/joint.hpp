// What a user says to join two bodies, and what can be read of a joint.
//
//   JointId hinge = world.create_joint(BallJointDef{.body_a = post, .body_b = lamp, .anchor_a = {0, 2, 0}, .anchor_b = {0, 0.3, 0}});
//   JointId rope = world.create_joint(SpringDef{.body_b = lamp, .anchor_a = {0, 9, 0}, .rest_length = 2, .stiffness = 1e4});
//   double pull = glm::length(world.joint_state(rope).force);
#pragma once

#include <carom/core/ids.hpp>
#include <carom/core/result.hpp>
#include <carom/core/types.hpp>

#include <variant>

namespace carom {

/// Two points that stay together while the bodies turn about them. A null body is the world, and its anchor a point of the world; at least
/// one body is dynamic. Where the anchors are apart at first, they close by 1 % of their arms a substep.
struct BallJointDef {
    BodyId body_a{}, body_b{};
    dvec3 anchor_a{0.0}, anchor_b{0.0};  ///< in each body's own frame, within 1e30 [m]
    bool collide_connected = false;      ///< false: contacts between the two bodies are left out
};

/// A spring and a damper along the line between two anchors: the force on B is -(stiffness (length - rest_length) + damping d(length)/dt)
/// along the line from A's anchor to B's. With rest_length = 0 it pulls the anchors together from any side, and the damper slows all of
/// their relative motion down; otherwise two anchors at one point push each other nowhere.
///
/// Stable at any stiffness. While its swing takes more than 2 pi substeps (with h = dt / substeps: ω h <= 1) an undamped spring keeps its amplitude, with a phase off by
/// less than (ω h)⁴/400 a radian; beyond that it is over in a few steps. Either way it rests where the forces balance.
struct SpringDef {
    BodyId body_a{}, body_b{};
    dvec3 anchor_a{0.0}, anchor_b{0.0};  ///< as of a ball joint
    double rest_length = 0.0;            ///< within 0 .. 1e30 [m]
    double stiffness = 0.0;              ///< within 0 .. 1e30 [N/m]
    double damping = 0.0;                ///< within 0 .. 1e30 [N s/m]
    bool collide_connected = false;
};

using JointDef = std::variant<BallJointDef, SpringDef>;

/// @return "ball joint", "spring".
[[nodiscard]] const char* kind_of(const JointDef& def) noexcept;

/// @return what is wrong with the numbers of a definition; its bodies are the world's to judge.
[[nodiscard]] Status validate(const JointDef& def);

struct SpringDamper {
    double stiffness = 0.0;  ///< [N/m]
    double damping = 0.0;    ///< [N s/m]
};
/// @return the spring on which `mass` [kg] swings `frequency` times a second [Hz], with the damping ratio (1: just no overshoot):
/// k = m (2 pi f)², c = 2 ratio m 2 pi f. Of two bodies the mass that counts is 1 / (1/m_a + 1/m_b). Zero after misuse: numbers that are not finite or negative.
[[nodiscard]] SpringDamper spring_damper(double frequency, double damping_ratio, double mass);

/// Where a joint is, and with what it pushed.
struct JointState {
    dvec3 anchor_a{0.0}, anchor_b{0.0};  ///< in the world [m]
    double length = 0.0;                 ///< between them [m]
    double stretch = 0.0;                ///< length less the rest length; of a ball joint the length, which should be 0 [m]
    dvec3 force{0.0};                    ///< on B at its anchor, A takes the opposite: mean over the last step; zero before the first [N]
};

}  // namespace carom
