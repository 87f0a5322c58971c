// How still bodies are: the part of Sleepers that measures.
#include <carom/dynamics/detail/sleepers.hpp>

#include <algorithm>
#include <limits>

namespace carom::dynamics {
namespace {

/// A flight under the pull a moves some point of itself by 0.0857 a t² in the time t at the least, whatever its speed at the start (sqrt(2) - 1 squared, halved).
/// In half of the time nothing may move by more than this share of a t²: a body of which less than four fifths are borne is not still.
constexpr double kFlightShare = 1.0 / 64.0;
/// So many steps of a half at least: fewer could miss the way up and down.
constexpr std::uint32_t kLeastSteps = 4;
/// Motion that grows from one half to the next is the beginning of a fall or a slide, from this share of what counts as still on; below it is noise.
constexpr double kNoiseShare = 1.0 / 16.0;
/// What put_to_sleep() lets the last step leave unbalanced of the pull.
constexpr double kUnbalanced = 1.0 / 16.0;

/// How far a point at `reach` of the body is from where it was, at the most.
double motion_between(const Pose& from, const Pose& to, double reach) noexcept {
    const dquat turn = to.orientation * glm::conjugate(from.orientation);
    return glm::length(to.position - from.position) + 2.0 * reach * glm::length(dvec3{turn.x, turn.y, turn.z});
}

}  // namespace

dvec3 free_pull(const BodyArrays& bodies, std::size_t slot, const dvec3& gravity) noexcept {
    const double scale = bodies.traits.empty() ? 1.0 : bodies.traits[slot].gravity_scale;
    return free_moves(bodies.masses[slot].locked) * gravity * scale;
}

void Sleepers::start_anew(Stillness& s, const BodyState& state) noexcept { s = {.from = state.pose, .velocity = state.velocity, .spin = state.spin}; }

bool Sleepers::is_over(const Stillness& s) const noexcept { return 2.0 * s.since >= settings_.time && s.steps >= kLeastSteps; }

double Sleepers::most_motion(std::size_t slot, double pull) const noexcept {
    const double half = 0.5 * settings_.time, by_size = 0.5 * settings_.motion * sizes_[slot].extent;
    return pull > 0.0 ? std::min(by_size, kFlightShare * pull * half * half) : by_size;
}

void Sleepers::watch(const BodyArrays& bodies, const ProxySet& proxies, const dvec3& gravity, double dt) {
    if (!sizes_known_) list_body_sizes(proxies, bodies.roles.size(), sizes_);
    sizes_known_ = true;
    since_look_ = any_ready_ ? since_look_ + dt : 0.0;
    any_ready_ = false;
    for (std::size_t slot = 0; slot < bodies.roles.size(); ++slot) {
        if (bodies.roles[slot] == Role::Dynamic) watch_one(slot, bodies, gravity, dt);
    }
}

void Sleepers::watch_one(std::size_t slot, const BodyArrays& bodies, const dvec3& gravity, double dt) noexcept {
    Stillness& s = still_[slot];
    const BodyState& state = bodies.states[slot];
    const double reach = sizes_[slot].reach;
    s.pulled = (glm::length(state.velocity - s.velocity) + reach * glm::length(state.spin - s.spin)) / dt;
    s.velocity = state.velocity;
    s.spin = state.spin;
    s.motion = std::max(s.motion, motion_between(s.from, state.pose, reach));
    s.since += dt;
    ++s.steps;
    const double most = most_motion(slot, glm::length(free_pull(bodies, slot, gravity)));
    const bool still = sizes_[slot].extent > 0.0 && s.motion <= most;
    if (!still) s.halves = 0;
    if (still && !is_over(s)) {
        any_ready_ |= s.halves >= 2;
        return;
    }
    if (still) {
        const bool grows = s.halves > 0 && s.motion > std::max(s.before, kNoiseShare * most);
        s.halves = grows || s.halves == 0 ? 1 : 2;
        any_ready_ |= s.halves >= 2;
    }
    s.before = s.motion;
    s.from = state.pose;
    s.motion = s.since = 0.0;
    s.steps = 0;
}

bool Sleepers::rests_alone(std::size_t slot, const BodyArrays& bodies, double pull) const noexcept {
    if (pull > 0.0) return false;
    const BodyState& state = bodies.states[slot];
    const double speed = glm::length(state.velocity), turning = sizes_[slot].reach * glm::length(state.spin);
    if (speed == 0.0 && turning == 0.0) return true;
    if (bodies.traits.empty()) return false;
    const auto way = [](double v, double damping) { return v == 0.0 ? 0.0 : v / damping; };  // still to go; infinite without damping
    return way(speed, bodies.traits[slot].linear_damping) + way(turning, bodies.traits[slot].angular_damping) <= most_motion(slot, pull);
}

bool Sleepers::is_still_now(std::size_t slot, double pull) const noexcept {
    const Stillness& s = still_[slot];
    if (sizes_[slot].extent == 0.0 || (s.steps == 0 && s.halves == 0)) return false;
    const double half = 0.5 * settings_.time, most = most_motion(slot, pull);
    const double speed = glm::length(s.velocity) + sizes_[slot].reach * glm::length(s.spin);
    return speed * half <= most && (pull > 0.0 ? s.pulled <= kUnbalanced * pull : s.pulled * half * half <= most);
}

void Sleepers::add_to(StateHash& hash, std::uint32_t slot) const noexcept {
    const Stillness& s = still_[slot];
    hash.add(s.from);
    hash.add(s.motion);
    hash.add(s.before);
    hash.add(s.since);
    hash.add(s.pulled);
    hash.add(std::uint64_t{s.steps} << 8 | s.halves);
    hash.add(since_look_);
}

}  // namespace carom::dynamics
