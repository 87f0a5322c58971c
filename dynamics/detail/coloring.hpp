// Graph colouring of contacts: contacts of one colour share no body that moves, so they are solved side by side.
#pragma once

#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// The two rows that a contact joins; rows >= movable do not move and may be shared.
struct ContactRows {
    std::int32_t a = 0;
    std::int32_t b = 0;
};

inline constexpr std::uint32_t kMaxColors = 32;
/// Contacts between two movable rows use the first of them only, so that the rest is always left for the others.
inline constexpr std::uint32_t kMaxSharedColors = 24;

/// First-fit colouring in the order given. Contacts between two movable rows come first, then, in later colours, those with
/// one movable row: solved last, they have the last word against what cannot give way.
class Coloring {
public:
    /// @param rows     (n,); those without a movable row are left out.
    void color(std::span<const ContactRows> rows, std::int32_t movable);

    /// Contacts sorted by colour, in their order within each; those that fit no colour come last.
    [[nodiscard]] std::span<const std::uint32_t> order() const noexcept { return order_; }
    /// First index of each colour in order(), and the end: (colours + 1,).
    [[nodiscard]] std::span<const std::uint32_t> starts() const noexcept { return starts_; }
    [[nodiscard]] std::uint32_t overflow_count() const noexcept { return overflow_count_; }
    /// Gives the memory of the order back: there is none until the next color().
    void trim() noexcept { drop(order_, colors_); }

    /// For contacts that come and go one by one: the colours that no contact of the two rows has, as bits.
    [[nodiscard]] std::uint32_t open_to(ContactRows rows) const noexcept;
    void take(ContactRows rows, std::uint32_t color) noexcept;
    void give_back(ContactRows rows, std::uint32_t color) noexcept;
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(used_, colors_, order_, starts_); }

private:
    std::vector<std::uint32_t> used_;     // per row: colours taken
    std::vector<std::uint8_t> colors_;    // per contact
    std::vector<std::uint32_t> order_;
    std::vector<std::uint32_t> starts_{0};
    std::uint32_t overflow_count_ = 0;
};

}  // namespace carom::dynamics
