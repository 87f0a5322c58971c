#include <carom/dynamics/detail/recorded_paths.hpp>

#include <carom/dynamics/detail/continuous.hpp>

#include <algorithm>

namespace carom::dynamics {

RecordedPath::RecordedPath(const StepPaths& paths, std::uint32_t slot) : mass_(paths.bodies[slot].mass), dt_(paths.dt) {
    const BodyStep& body = paths.bodies[slot];
    const PathSettings settings = path_settings(paths.sizes[slot], paths.dt);
    for (const PathLeg& leg : paths.legs) {
        if (leg.slot == slot && (leg.end > leg.begin || leg.end == 1.0))
            legs_.push_back({leg.begin, leg.end, leg.flight, leg.ride, leg.flies, leg.rides, {}}), legs_.back().path.go(leg.whole);
    }
    if (legs_.empty()) {
        Leg& whole = legs_.emplace_back();
        whole.flies = body.flies;
        whole.flight = {body.start, body.motion};
        const bool moves = body.role == Role::Dynamic || body.role == Role::Kinematic;
        whole.path.go(moves ? chord(body.start.pose, body.moved.pose, paths.dt * body.moved.spin) : PathPiece{.start = body.moved.pose});
    }
    for (Leg& leg : legs_) {
        if (leg.rides) leg.path.ride(leg.ride, leg.begin, settings);
        if (leg.flies) leg.path.fly(leg.flight, mass_, leg.begin, settings);
    }
}

Pose RecordedPath::pose_at(double t) const {
    const auto leg = std::find_if(legs_.begin(), legs_.end() - 1, [&](const Leg& l) { return t < l.end; });
    if (leg->rides) return leg->ride.motion(t, dt_).pose;
    if (!leg->flies) return dynamics::pose_at(leg->path.piece(BodyPath::kWhole), t);
    BodyState state = leg->flight.start;
    if (t > leg->begin) integrate_free(state, mass_, leg->flight.motion, (t - leg->begin) * dt_);
    return state.pose;
}

bool touch_along(RecordedPath& a, RecordedPath& b, PathSearch& search, Cores& cores, double begin) {
    auto leg_a = a.legs().begin(), leg_b = b.legs().begin();
    search.from = begin;
    while (begin < 1.0) {
        while (leg_a->end <= begin) ++leg_a;  // the last ends at 1
        while (leg_b->end <= begin) ++leg_b;
        const double end = std::min(leg_a->end, leg_b->end);
        search.a.path = &leg_a->path, search.b.path = &leg_b->path;
        if (touch(search, begin, end, cores)) return true;
        begin = end;
    }
    return false;
}

}  // namespace carom::dynamics
