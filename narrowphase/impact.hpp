// When two moving things first touch: the answer that every sweep and every search for a time of impact gives.
//
//   Impact hit = time_of_impact(VertexFaceMotion{vertex, face});
//   if (may_touch(hit.status)) move_until(hit.t);
#pragma once

#include <carom/core/types.hpp>

namespace carom {

/// How two things that move from t = 0 to t = 1 meet. Contact is closed: what touches, touches.
enum class ImpactStatus : unsigned char {
    Separated,    ///< proved: no contact at any t in [0, 1]
    Touching,     ///< they touch at t, to within the tolerance and rounding; never before it
    Overlapping,  ///< they touch or overlap at t = 0, to within rounding
    Clamped,      ///< the cap on checks was reached: no contact before t is proved, and nothing after it is known
    Invalid,      ///< NaN or infinity in the input, or a shape that is none: nothing is known, t is 0
};
/// @return "separated", "touching", "overlapping", "clamped" or "invalid".
[[nodiscard]] const char* to_string(ImpactStatus status) noexcept;

/// @return whether a caller who must not miss a contact has to expect one: all but Separated.
[[nodiscard]] constexpr bool may_touch(ImpactStatus status) noexcept { return status != ImpactStatus::Separated; }

/// The first contact of A and B, either of which may move. There is none before `t`, whatever the status, but for Invalid.
template <class T>
struct BasicImpact {
    ImpactStatus status = ImpactStatus::Separated;
    T t = T(1);                        ///< in [0, 1], never later than the true time; 1 (or where the search was to end) where they stay separated
    glm::vec<3, T> point{T(0)};        ///< where they touch, on B's surface unless the function says otherwise; zero where they do not
    glm::vec<3, T> normal{T(0)};       ///< unit, from A to B; zero where they do not touch and where no direction is to be had
    int checks = 0;                    ///< certificates tried
};
using Impact = BasicImpact<double>;

}  // namespace carom
