#include <carom/dynamics/detail/meeting.hpp>

#include <carom/dynamics/detail/integrator.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr int kMostSweeps = 2000;
constexpr double kSettled = 1e-14;  // of the largest impulse

dvec3 arm_of(const Meeter& m, const dvec3& point) noexcept { return point - m.centre; }
dvec3 velocity_at(const Meeter& m, const dvec3& point) noexcept { return m.velocity + glm::cross(m.spin, arm_of(m, point)); }

/// Of B against A.
dvec3 meeting_velocity(const Meeting& meeting, const dvec3& point) noexcept {
    return velocity_at(meeting.b, point) - velocity_at(meeting.a, point);
}
double closing(const Meeting& meeting, const MeetingPoint& point) noexcept {
    return -glm::dot(point.normal, meeting_velocity(meeting, point.at));
}

Struck<BlowBody> struck(Meeter& m, const dvec3& point) noexcept { return {m, arm_of(m, point)}; }
double mass_at(const Meeting& meeting, const MeetingPoint& p) noexcept {
    return felt_mass({meeting.a, arm_of(meeting.a, p.at)}, {meeting.b, arm_of(meeting.b, p.at)}, p.normal);
}
void push(Meeting& meeting, const dvec3& point, const dvec3& impulse) noexcept {
    push(struck(meeting.a, point), struck(meeting.b, point), impulse);
}

}  // namespace

Meeter meeter_of(const BodyState& state, const BodyMass& mass, bool is_dynamic) noexcept {
    Meeter m;
    m.velocity = state.velocity, m.spin = state.spin;
    m.centre = state.pose.position;
    if (!is_dynamic) return m;
    m.inverse_mass = mass.inverse_mass * free_moves(mass.locked);
    m.inverse_inertia = world_inverse_inertia(state, mass);
    return m;
}

bool Meeting::approaches(double slow) const noexcept {
    return std::any_of(points.begin(), points.end(), [&](const MeetingPoint& p) { return closing(*this, p) > slow; });
}

int Meeting::resolve() {
    double restitution = 1.0;
    for (MeetingPoint& p : points) {
        p.mass = mass_at(*this, p);
        if (closing(*this, p) > 0.0) restitution = std::min(restitution, p.restitution);
    }
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double largest = 0.0, change = 0.0;
        for (MeetingPoint& p : points) {
            const double impulse = stopping_impulse(p.impulse, p.mass, -closing(*this, p));
            push(*this, p.at, (impulse - p.impulse) * p.normal);
            change = std::max(change, std::abs(impulse - p.impulse));
            largest = std::max(largest, impulse);
            p.impulse = impulse;
        }
        if (change <= kSettled * largest) break;
    }
    int pushed = 0;
    for (MeetingPoint& p : points) {
        push(*this, p.at, restitution * p.impulse * p.normal);
        p.impulse *= 1.0 + restitution;
        pushed += p.impulse > 0.0;
    }
    for (const MeetingPoint& p : points) {
        if (p.friction == 0.0 || p.impulse == 0.0) continue;
        rub(struck(a, p.at), struck(b, p.at), p.normal, meeting_velocity(*this, p.at), p.friction * p.impulse, 0.0);
    }
    return pushed;
}

}  // namespace carom::dynamics
