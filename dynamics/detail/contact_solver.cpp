#include <carom/dynamics/detail/contact_solver.hpp>

#include <carom/dynamics/detail/bundle_fill.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/dynamics/detail/part_surface.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

constexpr std::size_t kBodyGrain = 128;
constexpr std::size_t kBundleGrain = 4;

void set(float (&out)[4], const dvec3& v) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

dvec3 as_dvec3(const float (&v)[4]) { return {v[0], v[1], v[2]}; }

/// The double of what the float row held at the start: differences against it keep the low bits of the state.
dvec3 rounded(const dvec3& v) { return dvec3{vec3{v}}; }

}  // namespace

void ContactSolver::prepare(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies,
                            const SolverSettings& settings, Executor& executor) {
    settings_ = settings;
    const double h = settings.substep();
    const double frequency = settings.contact_rate / h;
    soft_ = soft_contact(frequency, settings.damping, h);
    soft_static_ = soft_contact(2.0 * frequency, settings.damping, h);

    assign_rows(contacts, proxies, bodies);
    fill_rows(bodies, executor);
    list_contact_rows(contacts, proxies);
    coloring_.color(contact_rows_, rows_.movable);
    sort_by_points(contacts);
    lay_out_bundles();
    executor.parallel_for(bundles_.size(), kBundleGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) fill_bundle(bundles_[i], contacts, proxies, bodies);
        dynamics::prepare(std::span{bundles_}.subspan(begin, end - begin), rows_);
    });
    count_deep(contacts);
}

void ContactSolver::assign_rows(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies) {
    constexpr std::int32_t kTouched = -2;
    row_of_slot_.assign(bodies.roles.size(), kNoRow);
    for (const ContactPair& pair : contacts.pairs) {
        if (pair.manifold_count == 0) continue;
        for (const std::uint32_t proxy : {pair.proxy_a, pair.proxy_b}) {
            const std::uint32_t slot = proxy_at(proxies, proxy).body;
            if (bodies.roles[slot] != Role::Static) row_of_slot_[slot] = kTouched;
        }
    }
    slot_of_row_.clear();
    for (const Role role : {Role::Dynamic, Role::Kinematic}) {
        for (std::uint32_t slot = 0; slot < row_of_slot_.size(); ++slot) {
            if (row_of_slot_[slot] != kTouched || bodies.roles[slot] != role) continue;
            row_of_slot_[slot] = static_cast<std::int32_t>(slot_of_row_.size());
            slot_of_row_.push_back(slot);
        }
        if (role == Role::Dynamic) rows_.movable = static_cast<std::int32_t>(slot_of_row_.size());
    }
}

void ContactSolver::fill_rows(const BodyArrays& bodies, Executor& executor) {
    const std::size_t count = slot_of_row_.size();
    rows_.bodies.assign(count + 1, SolverBody{});
    rows_.masses.assign(count + 1, SolverMass{});
    gyroscopic_.resize(static_cast<std::size_t>(rows_.movable));
    executor.parallel_for(count, kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const BodyState& state = bodies.states[slot_of_row_[row]];
            set(rows_.bodies[row].velocity, state.velocity);
            set(rows_.bodies[row].spin, state.spin);
            if (row >= static_cast<std::size_t>(rows_.movable)) continue;
            const BodyMass& mass = bodies.masses[slot_of_row_[row]];
            const dmat3 inertia = world_inverse_inertia(state, mass);
            SolverMass& m = rows_.masses[row];
            set(m.diagonal, {inertia[0][0], inertia[1][1], inertia[2][2]});
            m.diagonal[3] = static_cast<float>(mass.inverse_mass);
            set(m.others, {inertia[0][1], inertia[0][2], inertia[1][2]});
            gyroscopic_[row] = vec3{gyroscopic_change(state, mass, settings_.dt) / static_cast<double>(settings_.substeps)};
        }
    });
}

void ContactSolver::list_contact_rows(const ContactSet& contacts, const ProxySet& proxies) {
    contact_rows_.resize(contacts.manifolds.size());
    pair_of_.resize(contacts.manifolds.size());
    const auto last = static_cast<std::int32_t>(slot_of_row_.size());
    for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) {
        const ContactPair& pair = contacts.pairs[p];
        const std::int32_t a = row_of_slot_[proxy_at(proxies, pair.proxy_a).body];
        const std::int32_t b = row_of_slot_[proxy_at(proxies, pair.proxy_b).body];
        for (std::uint32_t m = 0; m < pair.manifold_count; ++m) {
            contact_rows_[pair.first_manifold + m] = {a == kNoRow ? last : a, b == kNoRow ? last : b};
            pair_of_[pair.first_manifold + m] = p;
        }
    }
}

void ContactSolver::sort_by_points(const ContactSet& contacts) {
    const std::span<const std::uint32_t> order = coloring_.order();
    const std::span<const std::uint32_t> starts = coloring_.starts();
    lane_order_.clear();
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        for (std::uint32_t points = kMaxManifoldPoints; points > 0; --points) {
            for (std::uint32_t i = starts[c]; i < starts[c + 1]; ++i) {
                if (contacts.manifolds[order[i]].count == points) lane_order_.push_back(order[i]);
            }
        }
    }
    lane_order_.insert(lane_order_.end(), order.begin() + starts.back(), order.end());
}

void ContactSolver::lay_out_bundles() {
    colors_.clear();
    const std::span<const std::uint32_t> starts = coloring_.starts();
    std::uint32_t bundle_count = 0;
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        const std::uint32_t bundles = (starts[c + 1] - starts[c] + kLanesPerBundle - 1) / kLanesPerBundle;
        colors_.push_back({bundle_count, bundles});
        bundle_count += bundles;
    }
    first_overflow_bundle_ = bundle_count;
    bundles_.resize(bundle_count + coloring_.overflow_count());
    for (std::size_t c = 0; c + 1 < starts.size(); ++c) {
        for (std::uint32_t b = 0; b < colors_[c].count; ++b) {
            for (std::uint32_t lane = 0; lane < kLanesPerBundle; ++lane) {
                const std::uint32_t i = starts[c] + b * kLanesPerBundle + lane;
                bundles_[colors_[c].first + b].manifold[lane] = i < starts[c + 1] ? lane_order_[i] : kUnusedLane;
            }
        }
    }
    for (std::uint32_t i = 0; i < coloring_.overflow_count(); ++i) {
        ContactBundle& bundle = bundles_[first_overflow_bundle_ + i];
        bundle.manifold.fill(kUnusedLane);
        bundle.manifold[0] = lane_order_[starts.back() + i];
    }
}

void ContactSolver::fill_bundle(ContactBundle& bundle, const ContactSet& contacts, const ProxySet& proxies,
                                const BodyArrays& bodies) const {
    std::size_t point_count = 0;
    for (const std::uint32_t m : bundle.manifold) {
        if (m != kUnusedLane) point_count = std::max<std::size_t>(point_count, contacts.manifolds[m].count);
    }
    clear_bundle(bundle, static_cast<std::int32_t>(slot_of_row_.size()), point_count);
    for (std::size_t lane = 0; lane < kLanesPerBundle; ++lane) {
        const std::uint32_t m = bundle.manifold[lane];
        if (m == kUnusedLane) continue;
        const ContactPair& pair = contacts.pairs[pair_of_[m]];
        const Proxy& a = proxy_at(proxies, pair.proxy_a);
        const Proxy& b = proxy_at(proxies, pair.proxy_b);
        const Pose& pose_a = bodies.states[a.body].pose;
        const dvec3 origin = transform_point(pose_a, a.local.position);
        LaneInput in;
        in.manifold = &contacts.manifolds[m];
        in.impulses = &contacts.impulses[m];
        in.row_a = contact_rows_[m].a;
        in.row_b = contact_rows_[m].b;
        in.origin_a = vec3{origin - pose_a.position};
        in.origin_b = vec3{origin - bodies.states[b.body].pose.position};
        // What never moves needs no lever arm of its own, which may be as long as the world and lose the contact's digits.
        if (bodies.roles[a.body] == Role::Static) in.origin_a = in.origin_b;
        if (bodies.roles[b.body] == Role::Static) in.origin_b = in.origin_a;
        in.push_limit = static_cast<float>(settings_.max_push * std::min(a.extent, b.extent) / settings_.dt);
        const Surface surface_a = surface_of(a, in.manifold->part_a), surface_b = surface_of(b, in.manifold->part_b);
        in.friction = std::sqrt(surface_a.friction * surface_b.friction);
        in.restitution = std::max(surface_a.restitution, surface_b.restitution);
        in.soft = in.row_a >= rows_.movable || in.row_b >= rows_.movable ? soft_static_ : soft_;
        fill_lane(bundle, lane, in);
    }
}

void ContactSolver::count_deep(const ContactSet& contacts) {
    deep_count_ = 0;
    for (const ContactBundle& bundle : bundles_) {
        for (std::size_t lane = 0; lane < kLanesPerBundle; ++lane) {
            if (bundle.manifold[lane] == kUnusedLane) continue;
            for (const ContactPoint& p : contacts.manifolds[bundle.manifold[lane]].used()) {
                deep_count_ += bundle.bias_rate[lane] * p.separation < -bundle.push_limit[lane];
            }
        }
    }
}

void ContactSolver::integrate_velocities() {
    const vec3 kick{settings_.gravity * settings_.substep()};
    for (std::size_t row = 0; row < gyroscopic_.size(); ++row) {
        SolverBody& body = rows_.bodies[row];
        for (int k = 0; k < 3; ++k) {
            body.velocity[k] += kick[k];
            body.spin[k] += gyroscopic_[row][k];
        }
    }
}

template <class Pass>
void ContactSolver::for_each_color(Executor& executor, const Pass& pass) {
    const std::span<ContactBundle> all{bundles_};
    for (const Color& color : colors_) {
        const std::span<ContactBundle> bundles = all.subspan(color.first, color.count);
        executor.parallel_for(bundles.size(), kBundleGrain, [&](std::size_t begin, std::size_t end) {
            pass(bundles.subspan(begin, end - begin));
        });
    }
    pass(all.subspan(first_overflow_bundle_));
}

void ContactSolver::warm_start(Executor& executor) {
    for_each_color(executor, [&](std::span<ContactBundle> bundles) { dynamics::warm_start(bundles, rows_); });
}

void ContactSolver::solve(bool bias, Executor& executor) {
    const SolveSettings settings{.inverse_h = static_cast<float>(1.0 / settings_.substep()),
                                 .bias = bias};
    for_each_color(executor, [&](std::span<ContactBundle> bundles) { dynamics::solve(bundles, rows_, settings); });
}

void ContactSolver::integrate_positions(Executor& executor) {
    const auto h = static_cast<float>(settings_.substep());
    executor.parallel_for(slot_of_row_.size(), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        advance(rows_, begin, end, h);
    });
}

void ContactSolver::restitute(Executor& executor) {
    // A body at rest falls by g dt in a step: anything up to a few times that is no impact.
    const auto threshold = static_cast<float>(4.0 * glm::length(settings_.gravity) * settings_.dt);
    for_each_color(executor, [&](std::span<ContactBundle> bundles) { dynamics::restitute(bundles, rows_, threshold); });
}

void ContactSolver::store(BodyArrays& bodies, ContactSet& contacts, Executor& executor) const {
    executor.parallel_for(static_cast<std::size_t>(rows_.movable), kBodyGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const SolverBody& r = rows_.bodies[row];
            BodyState& state = bodies.states[slot_of_row_[row]];
            state.velocity += as_dvec3(r.velocity) - rounded(state.velocity);
            state.spin += as_dvec3(r.spin) - rounded(state.spin);
            state.pose.position += as_dvec3(r.shift);
            const dquat turn{r.turn[3], r.turn[0], r.turn[1], r.turn[2]};
            state.pose.orientation = glm::normalize(turn * state.pose.orientation);
        }
    });
    executor.parallel_for(bundles_.size(), kBundleGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) store_impulses(bundles_[i], contacts);
    });
}

}  // namespace carom::dynamics
