// One bit a slot: which were changed.
//
//   bits.reset(count); bits.set(slot); if (bits.test(slot)) ...
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::detail {

class SlotBits {
public:
    /// All zero, for slots below `count`.
    void reset(std::size_t count) { words_.assign(count / 32 + 2, 0); }
    void set(std::uint32_t slot) noexcept { words_[slot >> 5] |= std::int32_t(std::uint32_t{1} << (slot & 31u)); }
    [[nodiscard]] bool test(std::uint32_t slot) const noexcept {
        return ((static_cast<std::uint32_t>(words_[slot >> 5]) >> (slot & 31u)) & 1u) != 0;
    }
    /// Calls use(slot) for each slot that is set, ascending.
    template <class F>
    void for_each(F use) const {
        for (std::size_t k = 0; k < words_.size(); ++k) {
            for (auto left = static_cast<std::uint32_t>(words_[k]); left != 0; left &= left - 1) {
                use(static_cast<std::uint32_t>(32 * k) + static_cast<std::uint32_t>(std::countr_zero(left)));
            }
        }
    }
    [[nodiscard]] const std::int32_t* words() const noexcept { return words_.data(); }
    [[nodiscard]] std::size_t size() const noexcept { return words_.size(); }

private:
    std::vector<std::int32_t> words_;
};

}  // namespace carom::detail
