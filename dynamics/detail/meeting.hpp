// The blow that two bodies give each other where they meet.
//
//   Meeting meeting{bodies of the two};
//   meeting.points.push_back({...});
//   if (meeting.approaches(slow)) meeting.resolve();
#pragma once

#include <carom/core/pose.hpp>
#include <carom/dynamics/detail/blow.hpp>
#include <carom/dynamics/detail/body_state.hpp>

#include <vector>

namespace carom::dynamics {

/// One of the two; without mass it goes on as before.
struct Meeter : BlowBody {
    dvec3 centre{0.0};
};
[[nodiscard]] Meeter meeter_of(const BodyState& state, const BodyMass& mass, bool is_dynamic) noexcept;

struct MeetingPoint {
    dvec3 at{0.0};      ///< [m]
    dvec3 normal{0.0};  ///< unit, from A to B
    double friction = 0.0, restitution = 0.0;
    double impulse = 0.0;  ///< [N s]
    double mass = 0.0;     ///< what the two weigh along the normal [kg]: resolve() finds it
};

/// Two bodies at one time, by the law of blow.hpp. The normal impulses are the least that stop every approach (projected Gauss-Seidel), times 1 + e, with one e for all:
/// the least of those points that approach, so that energy never grows (Newton's law; Smith et al. 2012, sec. 4). Friction follows each within its cone, against the
/// sliding, at most to a stop. Linear and angular momentum are those of before, to rounding.
struct Meeting {
    Meeter a, b;
    std::vector<MeetingPoint> points;

    /// @return whether any point approaches at more than `slow` [m/s].
    [[nodiscard]] bool approaches(double slow) const noexcept;
    /// Changes velocities and spins. @return the points that pushed.
    int resolve();
};

}  // namespace carom::dynamics
