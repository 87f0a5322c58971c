// Objects behind generational ids: O(1) insert, find and erase; ids of erased objects stay dead for ever.
//
//   SlotMap<Body, BodyId> bodies;
//   BodyId id = bodies.insert(Body{});
//   if (Body* body = bodies.find(id)) { ... }
#pragma once

#include <carom/core/check.hpp>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace carom {

/// Slots are reused last-erased-first, so the same calls always give the same ids. A slot whose generations are used up
/// (2^32 - 1 of them) is retired.
template <class T, class IdType>
class SlotMap {
public:
    IdType insert(T value) {
        if (free_.empty()) {
            slots_.push_back({std::move(value), 1});
            ++size_;
            return {static_cast<std::uint32_t>(slots_.size() - 1), 1};
        }
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        slots_[slot].value.emplace(std::move(value));
        ++size_;
        return {slot, slots_[slot].generation};
    }

    /// @return null if the id is dead.
    [[nodiscard]] T* find(IdType id) noexcept { return const_cast<T*>(std::as_const(*this).find(id)); }
    [[nodiscard]] const T* find(IdType id) const noexcept {
        if (!id || id.slot >= slots_.size()) return nullptr;
        const Slot& slot = slots_[id.slot];
        return slot.generation == id.generation && slot.value ? &*slot.value : nullptr;
    }

    /// @return false if the id was dead already.
    bool erase(IdType id) {
        if (find(id) == nullptr) return false;
        Slot& slot = slots_[id.slot];
        slot.value.reset();
        --size_;
        if (++slot.generation != 0) free_.push_back(id.slot);
        return true;
    }

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    /// Held, in use or not, without what the values hold elsewhere [bytes].
    [[nodiscard]] std::size_t memory() const noexcept { return slots_.capacity() * sizeof(Slot) + free_.capacity() * sizeof(free_[0]); }

private:
    struct Slot {
        std::optional<T> value;
        std::uint32_t generation = 1;
    };
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
    std::size_t size_ = 0;
};

}  // namespace carom
