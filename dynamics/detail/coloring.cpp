#include <carom/dynamics/detail/coloring.hpp>

#include <carom/dynamics/detail/room.hpp>

#include <array>
#include <bit>

namespace carom::dynamics {
namespace {

constexpr std::uint8_t kNoColor = kMaxColors, kLeftOut = kMaxColors + 1;

/// Takes the first colour in [from, end) that the mask does not hold.
std::uint8_t take_color(std::uint32_t taken, unsigned from, unsigned end) {
    const auto color = static_cast<unsigned>(std::countr_zero(~taken & (~std::uint32_t{0} << from)));
    return color < end ? static_cast<std::uint8_t>(color) : kNoColor;
}

std::uint32_t bit_of(std::uint8_t color) { return color < kMaxColors ? std::uint32_t{1} << color : 0u; }

}  // namespace

void Coloring::color(std::span<const ContactRows> rows, std::int32_t movable) {
    used_.assign(static_cast<std::size_t>(movable), 0);
    resize_scratch(colors_, rows.size());
    unsigned shared_colors = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].a >= movable || rows[i].b >= movable) continue;
        std::uint32_t& a = used_[static_cast<std::size_t>(rows[i].a)];
        std::uint32_t& b = used_[static_cast<std::size_t>(rows[i].b)];
        colors_[i] = take_color(a | b, 0, kMaxSharedColors);
        a |= bit_of(colors_[i]);
        b |= bit_of(colors_[i]);
        if (colors_[i] != kNoColor && colors_[i] >= shared_colors) shared_colors = colors_[i] + 1u;
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].a < movable && rows[i].b < movable) continue;
        if (rows[i].a >= movable && rows[i].b >= movable) {
            colors_[i] = kLeftOut;
            continue;
        }
        std::uint32_t& row = used_[static_cast<std::size_t>(rows[i].a < movable ? rows[i].a : rows[i].b)];
        colors_[i] = take_color(row, shared_colors, kMaxColors);
        row |= bit_of(colors_[i]);
    }

    std::array<std::uint32_t, kMaxColors + 3> counts{};
    for (const std::uint8_t color : colors_) ++counts[color + 1u];
    starts_.assign(1, 0);
    for (std::uint32_t c = 0; c < kMaxColors && counts[c + 1] != 0; ++c) starts_.push_back(starts_.back() + counts[c + 1]);
    for (std::size_t c = 1; c < counts.size(); ++c) counts[c] += counts[c - 1];
    resize_scratch(order_, counts[kLeftOut]);
    overflow_count_ = counts[kLeftOut] - starts_.back();
    for (std::uint32_t i = 0; i < rows.size(); ++i) {
        if (colors_[i] != kLeftOut) order_[counts[colors_[i]]++] = i;
    }
}

std::uint32_t Coloring::open_to(ContactRows rows) const noexcept {
    std::uint32_t taken = 0;
    for (const std::int32_t row : {rows.a, rows.b}) taken |= static_cast<std::size_t>(row) < used_.size() ? used_[static_cast<std::size_t>(row)] : 0;
    return ~taken;
}

void Coloring::take(ContactRows rows, std::uint32_t color) noexcept {
    for (const std::int32_t row : {rows.a, rows.b}) {
        if (static_cast<std::size_t>(row) < used_.size()) used_[static_cast<std::size_t>(row)] |= std::uint32_t{1} << color;
    }
}

void Coloring::give_back(ContactRows rows, std::uint32_t color) noexcept {
    for (const std::int32_t row : {rows.a, rows.b}) {
        if (static_cast<std::size_t>(row) < used_.size()) used_[static_cast<std::size_t>(row)] &= ~(std::uint32_t{1} << color);
    }
}

}  // namespace carom::dynamics
