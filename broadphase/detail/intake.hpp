// What an update is told: checked as a whole before anything changes, then taken over into the table. Threads share the moved slots.
//
//   if (const char* fault = intake.find_fault(changes, table, executor)) return fault;
//   intake.take_over(changes, ask_again, table, executor);
//   method.find_moved(table, intake.lists(), executor, pieces);
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/detail/proxy_table.hpp>
#include <carom/broadphase/detail/slot_bits.hpp>
#include <carom/core/executor.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::detail {

class Intake {
public:
    /// @return what is wrong with the changes, or null. Must come before take_over of the same changes.
    [[nodiscard]] const char* find_fault(const ProxyChanges& changes, const ProxyTable& table, Executor& executor);

    /// `ask_again`: what a callback says of a slot may change whenever the slot is listed, so each counts as if its filter had changed.
    void take_over(const ProxyChanges& changes, bool ask_again, ProxyTable& table, Executor& executor);

    [[nodiscard]] ChangeLists lists() const noexcept { return {moved_, inserted_, removed_}; }
    [[nodiscard]] const SlotBits& changed() const noexcept { return changed_; }
    /// Of a slot that stays: it may have pairs that its box alone does not account for.
    [[nodiscard]] bool filter_changed() const noexcept { return filter_changed_; }
    /// In every layer and every mask since the last clear.
    [[nodiscard]] std::uint64_t common_bits() const noexcept { return common_bits_; }
    void clear() noexcept { common_bits_ = ~std::uint64_t{0}; }
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    struct Look {
        bool beyond = false, gone = false, ordered = true, finite = true;
        bool ascending = true;
        void add(const Look& other) noexcept;
    };
    /// A stretch of the moved slots, and what came of it: its lists begin where it does.
    struct Share {
        std::size_t first = 0, last = 0;
        Look look{};
        std::size_t moved = 0, inserted = 0;
        std::uint64_t common_bits = ~std::uint64_t{0};
        bool filter_changed = false;
    };
    void cut_moved(const ProxyChanges& changes, Executor& executor);
    [[nodiscard]] Look look_at(const ProxyChanges& changes, std::size_t first, std::size_t last) const noexcept;
    void take_moved(const ProxyChanges& changes, std::uint32_t slot, Share& share, ProxyTable& table);
    void close_gaps();

    std::vector<std::uint32_t> moved_, inserted_, removed_;
    SlotBits changed_;
    std::vector<Share> shares_;
    bool moved_ascend_ = false, ask_again_ = false, filter_changed_ = false;
    std::uint64_t common_bits_ = ~std::uint64_t{0};
};

}  // namespace carom::detail
