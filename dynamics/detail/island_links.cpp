#include <carom/dynamics/detail/island_links.hpp>

#include <utility>

namespace carom::dynamics {
namespace {

/// The dynamic body of a pair, either where both are.
std::uint32_t dynamic_slot(const ContactPair& pair, std::span<const Role> roles) {
    return roles[pair.body_a.slot] == Role::Dynamic ? pair.body_a.slot : pair.body_b.slot;
}

}  // namespace

void IslandLinks::link(const ContactSet& contacts, std::span<const Role> roles) {
    sets_.reset(roles.size());
    for (const ContactPair& pair : contacts.pairs) {
        if (roles[pair.body_a.slot] != Role::Dynamic || roles[pair.body_b.slot] != Role::Dynamic) continue;
        sets_.unite(pair.body_a.slot, pair.body_b.slot);
    }
}

void IslandLinks::gather(const ContactSet& contacts, std::span<const Role> roles, std::span<const unsigned char> wanted) {
    island_of_.assign(sets_.size(), kNone);
    islands_.clear();
    for (std::size_t m = 0; m < wanted.size(); ++m) {
        if (wanted[m] != 0 && contacts.manifolds[m].pair != kNoPair) island_of_[root(dynamic_slot(contacts.pairs[contacts.manifolds[m].pair], roles))] = 0;
    }
    for (std::uint32_t& island : island_of_) {
        if (island == kNone) continue;
        island = static_cast<std::uint32_t>(islands_.size());
        islands_.emplace_back();
    }
    const auto island_of = [&](std::uint32_t slot) { return island_of_[root(slot)]; };
    const auto each_body = [&](const auto& act) {
        for (std::uint32_t slot = 0; slot < roles.size(); ++slot) {
            if (roles[slot] != Role::Dynamic) continue;
            if (const std::uint32_t island = island_of(slot); island != kNone) act(islands_[island], slot);
        }
    };
    const auto each_manifold = [&](const auto& act) {
        for (std::uint32_t m = 0; m < contacts.manifolds.size(); ++m) {
            if (contacts.manifolds[m].pair == kNoPair) continue;
            const std::uint32_t island = island_of(dynamic_slot(contacts.pairs[contacts.manifolds[m].pair], roles));
            if (island != kNone) act(islands_[island], m);
        }
    };
    each_body([](Island& island, std::uint32_t) { ++island.body_count; });
    each_manifold([](Island& island, std::uint32_t) { ++island.manifold_count; });
    std::uint32_t body = 0, manifold = 0;
    for (Island& island : islands_) {
        island.first_body = body;
        island.first_manifold = manifold;
        body += std::exchange(island.body_count, 0u);
        manifold += std::exchange(island.manifold_count, 0u);
    }
    bodies_.resize(body);
    manifolds_.resize(manifold);
    each_body([&](Island& island, std::uint32_t slot) { bodies_[island.first_body + island.body_count++] = slot; });
    each_manifold([&](Island& island, std::uint32_t m) { manifolds_[island.first_manifold + island.manifold_count++] = m; });
}

}  // namespace carom::dynamics
