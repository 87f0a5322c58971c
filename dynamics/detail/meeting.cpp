#include <carom/dynamics/detail/meeting.hpp>

#include <carom/dynamics/detail/integrator.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr int kMostSweeps = 2000;
constexpr double kSettled = 1e-14;  // of the largest impulse

dvec3 velocity_at(const Meeter& m, const dvec3& point) noexcept { return m.velocity + glm::cross(m.spin, point - m.centre); }

/// Of B against A.
dvec3 meeting_velocity(const Meeting& meeting, const dvec3& point) noexcept { return velocity_at(meeting.b, point) - velocity_at(meeting.a, point); }
double closing(const Meeting& meeting, const MeetingPoint& point) noexcept { return -glm::dot(point.normal, meeting_velocity(meeting, point.at)); }

void push(Meeter& m, const dvec3& point, const dvec3& impulse) noexcept {
    m.velocity += m.inverse_mass * impulse;
    m.spin += m.inverse_inertia * glm::cross(point - m.centre, impulse);
}
void push(Meeting& meeting, const dvec3& point, const dvec3& impulse) noexcept {
    push(meeting.a, point, -impulse);
    push(meeting.b, point, impulse);
}

double inverse_mass_along(const Meeter& m, const dvec3& point, const dvec3& direction) noexcept {
    const dvec3 turning = glm::cross(point - m.centre, direction);
    return glm::dot(direction, m.inverse_mass * direction) + glm::dot(turning, m.inverse_inertia * turning);
}
/// What the two weigh along a direction at a point; 0 where nothing gives way.
double felt_mass(const Meeting& meeting, const dvec3& point, const dvec3& direction) noexcept {
    const double inverse = inverse_mass_along(meeting.a, point, direction) + inverse_mass_along(meeting.b, point, direction);
    return inverse > 0.0 ? 1.0 / inverse : 0.0;
}

void rub(Meeting& meeting, const MeetingPoint& point) noexcept {
    if (point.friction == 0.0 || point.impulse == 0.0) return;
    const dvec3 between = meeting_velocity(meeting, point.at), sliding = between - glm::dot(between, point.normal) * point.normal;
    const double speed = glm::length(sliding);
    if (!(speed > 0.0)) return;
    const dvec3 direction = sliding / speed;
    push(meeting, point.at, -std::min(felt_mass(meeting, point.at, direction) * speed, point.friction * point.impulse) * direction);
}

}  // namespace

Meeter meeter_of(const BodyState& state, const BodyMass& mass, bool is_dynamic) noexcept {
    Meeter m{.velocity = state.velocity, .spin = state.spin, .centre = state.pose.position};
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
    for (const MeetingPoint& p : points) {
        if (closing(*this, p) > 0.0) restitution = std::min(restitution, p.restitution);
    }
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double largest = 0.0, change = 0.0;
        for (MeetingPoint& p : points) {
            const double impulse = std::max(0.0, p.impulse + felt_mass(*this, p.at, p.normal) * closing(*this, p));
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
    for (const MeetingPoint& p : points) rub(*this, p);
    return pushed;
}

}  // namespace carom::dynamics
