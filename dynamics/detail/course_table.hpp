// The balls of a crowd and where each of them goes, asked eight at a time who may come near somebody.
//
//   table.resize(balls);
//   table.set(k, {&course, reach});
//   table.list_near(ball, from, to, room, found);      // appends numbers, ascending
//
// In a crowd whose bodies fly by metres in a step nearly all boxes about their ways overlap, and a tree or grid of them tells nothing apart: when somebody is where tells.
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/dynamics/detail/first_chance.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom::dynamics {

class CourseTable {
public:
    /// @param count  numbers from 0 on; each is set before anybody asks.
    void resize(std::size_t count) {
        rows_.resize((count + kDoubleBundleWidth - 1) / kDoubleBundleWidth);
        count_ = count;
    }
    [[nodiscard]] std::size_t size() const noexcept { return count_; }
    /// Different numbers may be set by different threads if they lie in different bundles.
    void set(std::size_t k, const Ball& ball) noexcept;
    /// Appends all k that first_chance() gives a time up to `to` for, and mostly few others. The same at every SIMD width. Cost: some 1 ns a number.
    /// @param from  within all courses. @param to  from `from` to 1.
    void list_near(const Ball& ball, double from, double to, double room, std::vector<std::uint32_t>& found) const;
    /// Gives the memory back. It has no numbers then.
    void drop() noexcept {
        dynamics::drop(rows_);
        count_ = 0;
    }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(rows_); }

    /// Eight balls, number by number.
    struct CourseRows {
        DoubleBundle at[3], rate[3];  ///< where it would be at 0 [m], and how far it goes in a step
        DoubleBundle reach;           ///< about the centre of mass, with all that may bring it nearer [m]
    };

private:
    std::vector<CourseRows> rows_;
    std::size_t count_ = 0;
};

}  // namespace carom::dynamics
