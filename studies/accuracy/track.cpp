#include <carom/studies/accuracy/track.hpp>

#include <carom/studies/accuracy/study.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {

Track follow(Engine& engine, const SceneBodies& bodies, std::span<const double> times, double dt) {
    const auto steps = std::lround(times.front() / dt);
    Track track;
    track.states.resize(bodies.moving.size());
    for (std::size_t t = 0; t < times.size(); ++t) {
        const ThreadStopwatch watch;
        for (long i = 0; i < steps; ++i) engine.step(dt);
        track.seconds += watch.seconds();
        for (std::size_t i = 0; i < track.states.size(); ++i) {
            const Pose mass = engine.pose(i) * inverse(bodies.moving[i].shape_in_mass);
            track.states[i].push_back({mass.position, mass.orientation, engine.velocity(i), engine.spin(i)});
        }
    }
    return track;
}

bool is_finite(const Track& track) {
    return std::ranges::all_of(track.states, [](const auto& states) {
        return std::ranges::all_of(states, [](const oracle::FreeBodyState& s) {
            return carom::is_finite(s.position) && carom::is_finite(s.orientation) && carom::is_finite(s.velocity) && carom::is_finite(s.spin);
        });
    });
}

std::vector<double> even_times(double spacing, int count) {
    std::vector<double> times;
    for (int i = 1; i <= count; ++i) times.push_back(i * spacing);
    return times;
}

}  // namespace carom::accuracy
