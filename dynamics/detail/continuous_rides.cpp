// What is stopped and something kinematic comes upon: it goes along with that, as if fixed to it, until the step is over.
#include <carom/dynamics/detail/continuous.hpp>

namespace carom::dynamics {

std::uint32_t Continuous::carrier_of(const ContinuousScene& scene, std::uint32_t number) const {
    const Mover& mover = movers_[number];
    return scene.bodies.roles[mover.slot] == Role::Kinematic ? number : mover.carrier;
}

bool Continuous::go_together(const ContinuousScene& scene, std::uint32_t a, std::uint32_t b) const {
    if (movers_[a].carrier == kNone && movers_[b].carrier == kNone) return false;
    return carrier_of(scene, a) == carrier_of(scene, b);
}

BodyState Continuous::motion_at(const ContinuousScene& scene, const Mover& mover, double t) const {
    if (mover.carrier != kNone) return mover.ride.motion(t, scene.dt);
    BodyState state = state_at(scene, mover, t);
    if (mover.stopped) state.velocity = mover.slides ? mover.slide / scene.dt : dvec3{0.0}, state.spin = dvec3{0.0};
    return state;
}

bool Continuous::come_nearer(const ContinuousScene& scene, const Event& event) {
    const std::uint32_t slot_a = scene.proxies.bodies[event.pair.a], slot_b = scene.proxies.bodies[event.pair.b];
    const BodyState a = motion_at(scene, movers_[mover_of_slot_[slot_a]], event.t),
                    b = motion_at(scene, movers_[mover_of_slot_[slot_b]], event.t);
    if (meeting_.points.empty()) find_points(scene, event, a, b);
    const Meeting met{meeter_of(a, scene.bodies.masses[slot_a], false), meeter_of(b, scene.bodies.masses[slot_b], false), meeting_.points};
    return met.approaches(kSlowShare * size_of(scene, event.pair) / scene.dt);
}

void Continuous::carry(const ContinuousScene& scene, const Event& event) {
    const std::uint32_t slot_a = scene.proxies.bodies[event.pair.a], slot_b = scene.proxies.bodies[event.pair.b];
    const std::uint32_t number_a = mover_of_slot_[slot_a], number_b = mover_of_slot_[slot_b];
    const Mover &a = movers_[number_a], &b = movers_[number_b];
    const bool b_gives_way = has_mass(scene.bodies.roles[slot_b]);
    if (go_together(scene, number_a, number_b) || (a.crushed && !b_gives_way)) return;
    BodyState state_a = state_at(scene, a, event.t), state_b = state_at(scene, b, event.t);
    find_points(scene, event, state_a, state_b);
    if (!come_nearer(scene, event)) return search_deeper(scene, event.pair, event.t, event.level);
    // What neither can give way to is left to contacts as far as the middle.
    const bool boards = can_board(scene, number_a, number_b) || (b_gives_way && can_board(scene, number_b, number_a));
    Choice choice;
    if (!boards && event.level + 1 < kLevels && !choose_way(scene, number_a, number_b, event.t, choice)) {
        return search_deeper(scene, event.pair, event.t, event.level);
    }
    meeting_.a = meeter_of(state_a, scene.bodies.masses[slot_a], true);
    meeting_.b = meeter_of(state_b, scene.bodies.masses[slot_b], b_gives_way);
    const bool blow = meeting_.approaches(kSlowShare * size_of(scene, event.pair) / scene.dt);
    if (blow) {
        ++counts_.impacts;
        meeting_.resolve();
        state_a.velocity = meeting_.a.velocity, state_a.spin = meeting_.a.spin;
        state_b.velocity = meeting_.b.velocity, state_b.spin = meeting_.b.spin;
    }
    note_impact(scene, event, blow);
    if (blow && b_gives_way) strike(scene, number_b, event.t, {state_b, StopCause::Partner});
    join(scene, number_a, number_b, event.t, state_a);
    if (blow && b_gives_way) search_all(scene, number_b, event.t, slot_a);
}

// What rides goes every way and turns: what may not does not ride.
bool Continuous::may_ride(const ContinuousScene& scene, std::uint32_t slot) const { return scene.bodies.masses[slot].locked == LockedAxes::None; }

bool Continuous::can_board(const ContinuousScene& scene, std::uint32_t number, std::uint32_t other) const {
    const Mover& mover = movers_[number];
    return mover.stopped && !mover.crushed && !mover.slides && mover.carrier == kNone && may_ride(scene, mover.slot) && carrier_of(scene, other) != kNone;
}

// Nobody changes without end: what stands is carried, what is carried goes a few other ways, and is crushed.
void Continuous::join(const ContinuousScene& scene, std::uint32_t number_a, std::uint32_t number_b, double t, const BodyState& state_a) {
    const Mover& b = movers_[number_b];
    const bool b_gives_way = has_mass(scene.bodies.roles[b.slot]);
    const auto board = [&](std::uint32_t number, const BodyState& state, std::uint32_t other) {
        strike(scene, number, t, {state, StopCause::Partner, 0, carrier_of(scene, other)});
        search_all(scene, number, t, kNone);
    };
    if (can_board(scene, number_a, number_b)) return board(number_a, state_a, number_b);
    if (b_gives_way && can_board(scene, number_b, number_a)) return board(number_b, state_at(scene, b, t), number_a);
    Choice choice;
    if (choose_way(scene, number_a, number_b, t, choice)) {
        if (choice.number == number_a) return take_way(scene, choice, t, state_a);
        strike(scene, number_a, t, {state_a, StopCause::Partner});
        take_way(scene, choice, t, state_at(scene, b, t));
        return search_all(scene, number_a, t, b.slot);
    }
    const auto stands = [&](const Mover& mover) {
        return mover.stopped && !mover.crushed && (mover.carrier != kNone || mover.slides || !may_ride(scene, mover.slot));
    };
    if (stands(movers_[number_a])) return crush(scene, number_a, t, state_a);
    if (stands(b)) crush(scene, number_b, t, state_at(scene, b, t));
}

void Continuous::crush(const ContinuousScene& scene, std::uint32_t number, double t, const BodyState& state) {
    Mover& mover = movers_[number];
    strike(scene, number, t, {state, StopCause::Partner});  // ends its leg
    ++counts_.crushed;
    mover.crushed = true;
    mover.slides = false;
    mover.carrier = kNone;
    note_stop(mover, t, StopCause::Crushed);
    lay_path(scene, mover);
    note_way(scene, mover.slot, mover.path);
    search_all(scene, number, t, kNone);
}

}  // namespace carom::dynamics
