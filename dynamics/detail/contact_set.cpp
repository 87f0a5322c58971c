#include <carom/dynamics/detail/contact_set.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

void carry_pair(ContactSet& contacts, const ContactPair& pair, const ContactSet& before, const ContactPair& old_pair) {
    for (std::uint32_t m = 0; m < pair.manifold_count; ++m) {
        const Manifold& manifold = contacts.manifolds[pair.first_manifold + m];
        ManifoldImpulses& impulses = contacts.impulses[pair.first_manifold + m];
        for (std::uint32_t k = 0; k < manifold.count; ++k) {
            for (std::uint32_t om = 0; om < old_pair.manifold_count; ++om) {
                const Manifold& old = before.manifolds[old_pair.first_manifold + om];
                for (std::uint32_t ok = 0; ok < old.count; ++ok) {
                    if (old.points[ok].feature == manifold.points[k].feature) {
                        impulses[k] = before.impulses[old_pair.first_manifold + om][ok];
                    }
                }
            }
        }
    }
}

}  // namespace

void link_manifolds(ContactSet& contacts) noexcept {
    std::uint32_t next = 0;
    for (std::uint32_t i = 0; i < contacts.pairs.size(); ++i) {
        ContactPair& pair = contacts.pairs[i];
        pair.first_manifold = next;
        while (next < contacts.manifolds.size() && contacts.manifolds[next].pair == i) ++next;
        pair.manifold_count = next - pair.first_manifold;
    }
}

void carry_impulses(ContactSet& contacts, const ContactSet& before) {
    contacts.impulses.assign(contacts.manifolds.size(), ManifoldImpulses{});
    std::size_t old_index = 0;
    for (const ContactPair& pair : contacts.pairs) {
        while (old_index < before.pairs.size() && before.pairs[old_index].key < pair.key) ++old_index;
        if (old_index == before.pairs.size()) return;
        const ContactPair& old_pair = before.pairs[old_index];
        // Slots are reused: the same key with another generation is another pair.
        if (old_pair.key == pair.key && old_pair.shape_a == pair.shape_a && old_pair.shape_b == pair.shape_b) {
            carry_pair(contacts, pair, before, old_pair);
        }
    }
}

ContactSummary summarise(const ContactSet& contacts) noexcept {
    ContactSummary s;
    double sum = 0.0;
    for (const Manifold& m : contacts.manifolds) {
        for (const ContactPoint& p : m.used()) {
            ++s.points;
            if (p.separation > 0.0f) continue;
            ++s.touching;
            sum -= static_cast<double>(p.separation);
            s.max_penetration = std::max(s.max_penetration, -static_cast<double>(p.separation));
        }
    }
    if (s.touching > 0) s.mean_penetration = sum / static_cast<double>(s.touching);
    return s;
}

}  // namespace carom::dynamics
