// Islands: bodies that contacts between dynamic bodies join, directly or through others. What cannot give way joins nobody.
//
//   IslandLinks links;
//   links.link(contacts, bodies.roles);
//   links.gather(contacts, bodies.roles, wanted);   // those with a manifold that is wanted
//   for (const Island& i : links.islands()) ... links.bodies(i), links.manifolds(i)
#pragma once

#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/detail/union_find.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Ranges of IslandLinks' lists.
struct Island {
    std::uint32_t first_body = 0, body_count = 0;
    std::uint32_t first_manifold = 0, manifold_count = 0;
};

/// Nothing depends on the order of the contacts.
class IslandLinks {
public:
    /// Cost: near O(pairs + slots).
    void link(const ContactSet& contacts, std::span<const Role> roles);
    /// Joins two dynamic bodies by something that is no contact.
    void join(std::uint32_t a, std::uint32_t b) noexcept { sets_.unite(a, b); }
    /// @return the lowest slot of the island that the dynamic body in `slot` belongs to.
    [[nodiscard]] std::uint32_t root(std::uint32_t slot) noexcept { return sets_.root(slot); }

    /// Lists the islands that have a manifold with wanted[m] != 0, by rising root: their bodies, by slot, and all their manifolds, in order.
    void gather(const ContactSet& contacts, std::span<const Role> roles, std::span<const unsigned char> wanted);
    [[nodiscard]] std::span<const Island> islands() const noexcept { return islands_; }
    [[nodiscard]] std::span<const std::uint32_t> bodies(const Island& i) const noexcept { return std::span{bodies_}.subspan(i.first_body, i.body_count); }
    [[nodiscard]] std::span<const std::uint32_t> manifolds(const Island& i) const noexcept {
        return std::span{manifolds_}.subspan(i.first_manifold, i.manifold_count);
    }
    /// Forgets the islands, and gives their memory back.
    void drop_islands() noexcept { drop(islands_, bodies_, manifolds_, island_of_); }
    [[nodiscard]] std::size_t memory() const noexcept { return sets_.memory() + held_by(island_of_, islands_, bodies_, manifolds_); }

private:
    static constexpr std::uint32_t kNone = ~std::uint32_t{0};

    UnionFind sets_;                        // of slots
    std::vector<std::uint32_t> island_of_;  // by root
    std::vector<Island> islands_;
    std::vector<std::uint32_t> bodies_, manifolds_;
};

}  // namespace carom::dynamics
