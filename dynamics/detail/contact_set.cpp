#include <carom/dynamics/detail/contact_set.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

/// The n-th point of the pair that has the feature, n from 0; null where there are not so many.
const PointImpulse* find_impulse(const ContactSet& set, const ContactPair& pair, std::uint64_t feature, int n) {
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        for (std::size_t k = 0; k < set.manifolds[m].count; ++k) {
            if (set.manifolds[m].points[k].feature == feature && n-- == 0) return &set.impulses[m][k];
        }
    }
    return nullptr;
}

bool has_same_points(const Manifold& a, const Manifold& b) {
    if (a.count != b.count) return false;
    bool same = true;
    for (std::size_t k = 0; k < a.count; ++k) same &= a.points[k].feature == b.points[k].feature;
    return same;
}

void carry_manifold(const Manifold& manifold, ManifoldImpulses& impulses, const ContactSet& before,
                    const ContactPair& old_pair, float scale) {
    // Nearly always: one manifold, and its points in the order they had.
    if (old_pair.manifold_count == 1 && has_same_points(manifold, before.manifolds[old_pair.first_manifold])) {
        const ManifoldImpulses& old = before.impulses[old_pair.first_manifold];
        for (std::size_t k = 0; k < manifold.count; ++k) impulses[k] = {scale * old[k].normal, scale * old[k].friction};
        return;
    }
    for (std::size_t k = 0; k < manifold.count; ++k) {
        const std::uint64_t feature = manifold.points[k].feature;
        int twins = 0;
        for (std::size_t earlier = 0; earlier < k; ++earlier) twins += manifold.points[earlier].feature == feature;
        if (const PointImpulse* old = find_impulse(before, old_pair, feature, twins)) {
            impulses[k] = {scale * old->normal, scale * old->friction};
        }
    }
}

/// The mean is the sum until all are in.
void sum_up(const Manifold& manifold, ContactSummary& s) {
    for (const ContactPoint& p : manifold.used()) {
        ++s.points;
        if (p.separation > 0.0f) continue;
        const double depth = -static_cast<double>(p.separation);
        ++s.touching;
        s.mean_penetration += depth;
        s.max_penetration = std::max(s.max_penetration, depth);
    }
}

}  // namespace

void link_manifolds(ContactSet& contacts, FunctionRef<ContactPair(std::uint32_t candidate)> make) {
    contacts.pairs.clear();
    contacts.summary = {};
    const auto count = static_cast<std::uint32_t>(contacts.manifolds.size());
    for (std::uint32_t first = 0, next = 0; first < count; first = next) {
        const std::uint32_t candidate = contacts.manifolds[first].pair;
        const auto index = static_cast<std::uint32_t>(contacts.pairs.size());
        for (; next < count && contacts.manifolds[next].pair == candidate; ++next) {
        }
        for (std::uint32_t m = first; m < next; ++m) {
            contacts.manifolds[m].pair = index;
            sum_up(contacts.manifolds[m], contacts.summary);
        }
        ContactPair& pair = contacts.pairs.emplace_back(make(candidate));
        pair.first_manifold = first;
        pair.manifold_count = next - first;
    }
    if (contacts.summary.touching > 0) contacts.summary.mean_penetration /= static_cast<double>(contacts.summary.touching);
}

void carry_impulses(ContactSet& contacts, const ContactSet& before, float scale) {
    contacts.impulses.assign(contacts.manifolds.size(), ManifoldImpulses{});
    std::size_t old_index = 0;
    for (const ContactPair& pair : contacts.pairs) {
        while (old_index < before.pairs.size() && before.pairs[old_index].key < pair.key) ++old_index;
        if (old_index == before.pairs.size()) return;
        const ContactPair& old_pair = before.pairs[old_index];
        // Slots are reused: the same key with another generation is another pair.
        if (old_pair.key == pair.key && old_pair.shape_a == pair.shape_a && old_pair.shape_b == pair.shape_b) {
            for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
                carry_manifold(contacts.manifolds[m], contacts.impulses[m], before, old_pair, scale);
            }
        }
    }
}

}  // namespace carom::dynamics
