#include <carom/dynamics/detail/stiff_contacts.hpp>

#include <carom/core/math.hpp>

#include <algorithm>
#include <cmath>

namespace carom::dynamics {
namespace {

/// A manifold whose normal is within 84 degrees of gravity bears weight.
constexpr double kBearing = 0.1;
/// What rests on a manifold by weight alone may be spread otherwise by friction: so much of it counts.
constexpr double kEstimateShare = 2.0 / 3.0;

struct Bearing {
    bool bears = false;
    std::uint32_t above = 0, under = 0;  // slots of bodies
};

/// Who rests on whom, where they touch or will by the end of a step's fall.
Bearing bearing_of(std::span<const ContactPoint> points, const vec3& normal, const ContactPair& pair, const dvec3& down, double reach) {
    float nearest = points[0].separation;
    for (const ContactPoint& point : points) nearest = std::min(nearest, point.separation);
    const double along = glm::dot(dvec3{normal}, down);  // the normal goes from A to B
    if (std::abs(along) < kBearing || static_cast<double>(nearest) > reach) return {};
    return along < 0.0 ? Bearing{true, pair.body_b.slot, pair.body_a.slot} : Bearing{true, pair.body_a.slot, pair.body_b.slot};
}

std::size_t room_for_weights(std::size_t slots, std::size_t manifolds) {
    return bytes_of<double>(slots) + bytes_of<std::uint64_t>(slots) + bytes_of<std::uint32_t>(slots) + bytes_of<std::uint32_t>(slots + 2) +
           bytes_of<std::uint32_t>(manifolds);
}

}  // namespace

double SagLaw::excess(const ContactPair& pair, const ProxySet& proxies, const BodyArrays& bodies, double load) const noexcept {
    const double inverse_a = bodies.masses[pair.body_a.slot].inverse_mass, inverse_b = bodies.masses[pair.body_b.slot].inverse_mass;
    const double rate = 2.0 * kPi * contact_rate / substep;
    const double stiffer = inverse_a == 0.0 || inverse_b == 0.0 ? 4.0 : 1.0;
    const double most = share * std::min(proxies.extents[pair.proxy_a()], proxies.extents[pair.proxy_b()]);
    return load * (inverse_a + inverse_b) / (stiffer * rate * rate * most);
}

bool StiffContacts::look(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const SagLaw& law,
                         std::span<const unsigned char> keep) {
    const std::size_t count = contacts.manifolds.size();
    const bool weighs = count > manifolds_before_;
    memory_.resize(bytes_of<double>(count) + bytes_of<unsigned char>(count) + (weighs ? room_for_weights(bodies.roles.size(), count) : 0));
    std::byte* next = memory_.data();
    loads_ = cut<double>(next, count), marks_ = cut<unsigned char>(next, count);
    std::ranges::fill(loads_, 0.0);
    if (weighs) add_up_weights(contacts, bodies, law, next);
    manifolds_before_ = count;
    unsigned char any = 0;
    for (std::size_t m = 0; m < count; ++m) {
        marks_[m] = 0;
        if (contacts.manifolds[m].pair == kNoPair) continue;
        const ContactPair& pair = contacts.pairs[contacts.manifolds[m].pair];
        float impulse = 0.0f;
        for (const PointImpulse& point : contacts.impulses_of(static_cast<std::uint32_t>(m))) impulse += point.normal;
        const double measured = static_cast<double>(impulse) / law.substep;
        const bool kept = (keep[pair.body_a.slot] | keep[pair.body_b.slot]) != 0;
        loads_[m] = std::max(kEstimateShare * loads_[m], measured);
        marks_[m] = law.excess(pair, proxies, bodies, loads_[m]) > (kept ? 0.5 : 1.0) ? 1 : 0;
        any |= marks_[m];
    }
    return any != 0;
}

void StiffContacts::add_up_weights(const ContactSet& contacts, const BodyArrays& bodies, const SagLaw& law, std::byte* next) {
    const double pull = glm::length(law.gravity);
    const dvec3 down = law.gravity / pull;
    const double reach = pull * law.dt * law.dt;
    const auto bearing = [&](std::uint32_t m) {
        const ContactManifold& manifold = contacts.manifolds[m];
        return manifold.pair == kNoPair ? Bearing{} : bearing_of(contacts.points_of(manifold), manifold.normal, contacts.pairs[manifold.pair], down, reach);
    };
    const auto count = static_cast<std::uint32_t>(contacts.manifolds.size());
    const std::size_t slots = bodies.roles.size();
    const std::span borne = cut<double>(next, slots);  // by slot [N]
    std::span keys = cut<std::uint64_t>(next, slots);
    std::span falling = cut<std::uint32_t>(next, slots);                                                        // slots of dynamic bodies, the highest first
    const std::span first_below = cut<std::uint32_t>(next, slots + 2), below = cut<std::uint32_t>(next, count);  // by slot, and the end: manifolds under a body
    std::ranges::fill(first_below, 0u);
    std::ranges::fill(borne, 0.0);
    for (std::uint32_t m = 0; m < count; ++m) {
        if (const Bearing b = bearing(m); b.bears) ++first_below[b.above + 2];
    }
    for (std::size_t slot = 2; slot < first_below.size(); ++slot) first_below[slot] += first_below[slot - 1];
    for (std::uint32_t m = 0; m < count; ++m) {
        if (const Bearing b = bearing(m); b.bears) below[first_below[b.above + 1]++] = m;
    }
    std::size_t resting = 0;
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
        if (bodies.roles[slot] != Role::Dynamic || first_below[slot] == first_below[slot + 1]) continue;
        keys[resting] = ordered_key(static_cast<float>(glm::dot(down, bodies.states[slot].pose.position)));
        falling[resting++] = slot;
    }
    keys = keys.first(resting), falling = falling.first(resting);
    radix_sort(keys, falling, scratch_);
    drop(scratch_.keys, scratch_.payload);  // few steps sort
    for (const std::uint32_t slot : falling) {
        const std::uint32_t begin = first_below[slot], end = first_below[slot + 1];
        const double part = (borne[slot] + pull * bodies.masses[slot].mass) / (end - begin);
        for (std::uint32_t i = begin; i < end; ++i) {
            loads_[below[i]] = part;
            borne[bearing(below[i]).under] += part;
        }
    }
}

}  // namespace carom::dynamics
