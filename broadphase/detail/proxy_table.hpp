// The live boxes of a broadphase, as every method reads them.
//
//   for (const std::uint32_t slot : changes.moved) use(table.boxes[slot], table.previous[slot]);
#pragma once

#include <carom/broadphase/proxy.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace carom::detail {

/// Overlaps nothing.
inline constexpr FloatAabb kNowhere{vec3{std::numeric_limits<float>::infinity()}, vec3{-std::numeric_limits<float>::infinity()}};

struct ProxyTable {
    std::vector<FloatAabb> boxes;     ///< by slot; kNowhere where the slot is free
    std::vector<FloatAabb> previous;  ///< of moved and removed slots: the box before, kNowhere if it counted for nothing
    std::vector<ProxyFilter> filters;
    std::vector<unsigned char> movable;  ///< 1 or 0, of live slots
    std::vector<unsigned char> alive;    ///< 1 or 0
    std::size_t live_count = 0;

    void clear() noexcept {
        boxes.clear();
        previous.clear();
        filters.clear();
        movable.clear();
        alive.clear();
        live_count = 0;
    }
    [[nodiscard]] std::size_t memory() const noexcept {
        return sizeof(FloatAabb) * (boxes.capacity() + previous.capacity()) + sizeof(ProxyFilter) * filters.capacity() + movable.capacity() +
               alive.capacity();
    }
};

/// Changes of one update, each slot in one list at most.
struct ChangeLists {
    std::span<const std::uint32_t> moved;  ///< live before and now
    std::span<const std::uint32_t> inserted;
    std::span<const std::uint32_t> removed;
    bool want_ended = false;  ///< Method::ended will be asked
};

}  // namespace carom::detail
