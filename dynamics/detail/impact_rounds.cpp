// What happens at the time of an impact: rounds of reflection and friction, until nobody approaches.
#include <carom/dynamics/detail/impacts.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr double kSettledShare = 1e-15;  // of the fastest body's speed: where the impulses of a round have settled
constexpr double kStillShare = 1e-9;     // of the same: slower does not slide
constexpr int kMostSweeps = 400;

}  // namespace

bool Impacts::bounce(std::uint32_t bouncer, double time) {
    frontier_.clear();
    for (const std::uint32_t f : {bouncers_[bouncer].a, bouncers_[bouncer].b}) {
        if (flyers_[f].dynamic) frontier_.push_back(f);
    }
    bool any = false;
    for (; budget_ > 0; any = true) {
        gather(time);
        if (active_.empty()) break;
        reflect();
        commit(time);
    }
    return any;
}

// The contacts that approach, from the frontier on: each brings its bodies in.
void Impacts::gather(double time) {
    now_ = time;
    ++round_;
    active_.clear();
    for (const std::uint32_t f : frontier_) flyers_[f].round = round_;
    for (std::size_t next = 0; next < frontier_.size(); ++next) {
        const Flyer& flyer = flyers_[frontier_[next]];
        budget_ -= flyer.end - flyer.first;
        for (std::uint32_t i = flyer.first; i < flyer.end; ++i) {
            Bouncer& bouncer = bouncers_[touching_[i]];
            if (bouncer.round == round_) continue;
            bouncer.round = round_;
            if (!activate(bouncer, time)) continue;
            active_.push_back(touching_[i]);
            for (const std::uint32_t other : {bouncer.a, bouncer.b}) {
                if (!flyers_[other].dynamic || flyers_[other].round == round_) continue;
                flyers_[other].round = round_;
                frontier_.push_back(other);
            }
        }
    }
    for (const std::uint32_t f : frontier_) {
        Flyer& flyer = flyers_[f];
        flyer.old_velocity = flyer.velocity;
        flyer.old_spin = flyer.spin;
    }
}

bool Impacts::activate(Bouncer& bouncer, double time) const noexcept {
    const Flyer& a = flyers_[bouncer.a];
    const Flyer& b = flyers_[bouncer.b];
    if (bouncer.two_spheres) bouncer.normal = glm::normalize(between_at(bouncer, time));
    const dvec3 apart = (b.center - a.center) + (b.path(time) - a.path(time));
    const dvec3 drift = time * (b.pull - a.pull);
    bool any = false;
    for (std::uint32_t k = 0; k < bouncer.count; ++k) {
        Point& point = bouncer.points[k];
        point.active = false;
        if (gap_at(bouncer, point, time) > bouncer.touch) continue;
        // The point is on a sphere where there is one: that is where its arm stays.
        const bool on_b = bouncer.radius_a == 0.0 && bouncer.radius_b > 0.0;
        point.arm_a = bouncer.two_spheres ? bouncer.radius_a * bouncer.normal : on_b ? point.rb + apart : point.ra;
        point.arm_b = bouncer.two_spheres ? -bouncer.radius_b * bouncer.normal : on_b ? point.rb : point.ra - apart;
        point.drift = glm::dot(bouncer.normal, drift);
        point.before = point.drift + glm::dot(bouncer.normal, meeting_velocity(bouncer, point));
        point.active = point.before < -slow_;
        point.impulse = 0.0;
        if (!point.active) continue;
        point.mass = felt_mass(bouncer, point, bouncer.normal);
        point.active = point.mass > 0.0;
        any |= point.active;
    }
    return any;
}

dvec3 Impacts::meeting_velocity(const Bouncer& bouncer, const Point& point) const noexcept {
    const Flyer& a = flyers_[bouncer.a];
    const Flyer& b = flyers_[bouncer.b];
    return (b.velocity - a.velocity) + (glm::cross(b.spin, point.arm_b) - glm::cross(a.spin, point.arm_a));
}

double Impacts::felt_mass(const Bouncer& bouncer, const Point& point, const dvec3& direction) const noexcept {
    return dynamics::felt_mass({flyers_[bouncer.a], point.arm_a}, {flyers_[bouncer.b], point.arm_b}, direction);
}

void Impacts::push(const Bouncer& bouncer, const Point& point, const dvec3& impulse) noexcept {
    dynamics::push({flyers_[bouncer.a], point.arm_a}, {flyers_[bouncer.b], point.arm_b}, impulse);
}

template <class Visit>
void Impacts::for_each_active(const Visit& visit) {
    for (const std::uint32_t i : active_) {
        for (std::uint32_t k = 0; k < bouncers_[i].count; ++k) {
            if (bouncers_[i].points[k].active) visit(bouncers_[i], bouncers_[i].points[k]);
        }
    }
}

// First the least impulses that stop every approach, by projected Gauss-Seidel; then as much again times e.
void Impacts::reflect() {
    const auto approach = [&](const Bouncer& bouncer, const Point& point) {
        return point.drift + glm::dot(bouncer.normal, meeting_velocity(bouncer, point));
    };
    bool settled = false;
    for (int sweep = 0; sweep < kMostSweeps && !settled; ++sweep) {
        settled = true;
        for_each_active([&](Bouncer& bouncer, Point& point) {
            --budget_;
            const double wanted = stopping_impulse(point.impulse, point.mass, approach(bouncer, point));
            const double change = wanted - point.impulse;
            settled &= std::abs(change) <= kSettledShare * fastest_ * point.mass;
            point.impulse = wanted;
            push(bouncer, point, change * bouncer.normal);
        });
    }
    double least = 1.0;
    for_each_active([&](Bouncer& bouncer, Point& point) {
        least = std::min(least, bouncer.restitution);
        push(bouncer, point, bouncer.restitution * point.impulse * bouncer.normal);
    });
    // The work of the impulses: J times the mean of the velocities before and after. With one e it is never above 0.
    double work = 0.0, spent = 0.0;
    for_each_active([&](Bouncer& bouncer, Point& point) {
        work += 0.5 * (1.0 + bouncer.restitution) * point.impulse * (point.before + approach(bouncer, point));
        spent += point.impulse * std::abs(point.before);
    });
    const bool gains = work > 1e-12 * spent;
    for_each_active([&](Bouncer& bouncer, Point& point) {
        double restitution = bouncer.restitution;
        if (gains) {
            push(bouncer, point, (least - restitution) * point.impulse * bouncer.normal);
            restitution = least;
        }
        point.impulse *= 1.0 + restitution;
        count_ += point.impulse > 0.0;
    });
    for_each_active([&](Bouncer& bouncer, Point& point) { rub(bouncer, point); });
}

void Impacts::rub(const Bouncer& bouncer, const Point& point) noexcept {
    if (bouncer.friction == 0.0 || point.impulse == 0.0) return;
    Flyer &a = flyers_[bouncer.a], &b = flyers_[bouncer.b];
    const dvec3 meeting = meeting_velocity(bouncer, point) + now_ * (b.pull - a.pull);
    dynamics::rub({a, point.arm_a}, {b, point.arm_b}, bouncer.normal, meeting, bouncer.friction * point.impulse, kStillShare * fastest_);
}

// The paths go on from where the bodies are: as if they had come there at the new velocities.
void Impacts::commit(double time) noexcept {
    for (const std::uint32_t f : frontier_) {
        Flyer& flyer = flyers_[f];
        if (flyer.velocity == flyer.old_velocity && flyer.spin == flyer.old_spin) continue;
        flyer.shift -= time * (flyer.velocity - flyer.old_velocity);
        flyer.turn -= time * (flyer.spin - flyer.old_spin);
        flyer.last = time;
        flyer.hit = true;
    }
}

}  // namespace carom::dynamics
