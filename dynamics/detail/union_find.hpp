// Sets of slots that grow together.
//
//   UnionFind sets;
//   sets.reset(slots);
//   sets.unite(3, 7);
//   if (sets.root(7) == 3) ...   // the lowest slot of a set
#pragma once

#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace carom::dynamics {

/// Union-find with path halving; the lowest slot of a set is its root, so nothing depends on the order of the unions.
/// Source: Tarjan and van Leeuwen, Worst-Case Analysis of Set Union Algorithms (JACM 1984).
class UnionFind {
public:
    /// Every slot below `count` is a set of its own.
    void reset(std::size_t count) {
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), 0u);
    }
    [[nodiscard]] std::size_t size() const noexcept { return parent_.size(); }
    /// @return the lowest slot of the set.
    [[nodiscard]] std::uint32_t root(std::uint32_t slot) noexcept {
        while (parent_[slot] != slot) {
            parent_[slot] = parent_[parent_[slot]];
            slot = parent_[slot];
        }
        return slot;
    }
    void unite(std::uint32_t one, std::uint32_t other) noexcept {
        const std::uint32_t a = root(one), b = root(other);
        parent_[std::max(a, b)] = std::min(a, b);
    }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(parent_); }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace carom::dynamics
