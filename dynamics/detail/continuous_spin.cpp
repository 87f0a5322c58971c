// What spins faster than a step can follow is slowed down.
#include <carom/dynamics/detail/continuous.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr int kMostCuts = 16;  // each by a hundredth, at least, of the fastest that is seen

}  // namespace

// Contacts may give a slender body more spin than a step can follow. Left alone it would not be watched, and yet stay in the world if somebody struck it, which
// slows it as well. What flew has not been turned at all, or had another spin when the step began: that of unlike moments goes up and down.
bool Continuous::slow_down(const ContinuousScene& scene, std::uint32_t slot) {
    if (scene.bodies.roles[slot] != Role::Dynamic) return false;
    const bool flew = flies(scene, slot);
    BodyState start = flew ? departure_of(slot)->start : scene.bodies.states[slot], end = scene.bodies.states[slot];
    for (int cut = 0; cut < kMostCuts; ++cut) {
        const double spin = std::max(glm::length(start.spin), glm::length(end.spin));
        if (!(spin * scene.dt > kMostTurn && spin <= kMostSpeed)) return false;
        start.spin *= kSlowedTurn / (spin * scene.dt);
        end = start;
        if (flew) integrate_free(end, scene.bodies.masses[slot], scene.free_motion(slot), scene.dt);
        if (!is_usable(end, scene.dt)) continue;
        if (flew) depart(slot, start), arrive(slot, end);
        scene.bodies.states[slot] = end;
        return true;
    }
    return false;
}

// It had its way at the spin of its blow, of which what it has now is another phase.
void Continuous::slow_at_end(const ContinuousScene& scene, BodyState& state) {
    const double turn = glm::length(state.spin) * scene.dt;
    if (!(turn > kMostTurn)) return;
    state.spin *= kSlowedTurn / turn;
    ++counts_.slowed;
}

}  // namespace carom::dynamics
