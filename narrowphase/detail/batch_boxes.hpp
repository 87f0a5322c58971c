// Pairs of boxes alone, on one thread: manifolds come in the order of the pairs, and need no other place.
//
//   if (are_few_boxes(input) && boxes.find(input)) boxes.give(out);      // and all poses are finite
//   else if (kinds are found && are_boxes(kinds)) boxes.find(input, out);
#pragma once

#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/manifold_list.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// Pairs that are worked on together: the manifolds of no more are held where they go to a function, but for those of few pairs.
inline constexpr std::size_t kBoxBlock = 256, kFewBoxes = 1024;

/// @return whether the pairs are plain, of boxes alone, and kFewBoxes at most: they may be found before anything else is looked at.
[[nodiscard]] bool are_few_boxes(const BatchInput& input) noexcept;
/// @return whether all pairs are of two boxes.
[[nodiscard]] bool are_boxes(std::span<const std::uint16_t> kinds) noexcept;

class BoxBatch {
public:
    /// Finds the manifolds of few pairs, and holds them. @return whether their poses are known to be finite.
    [[nodiscard]] bool find(const BatchInput& input);
    /// Gives away what it holds.
    void give(std::vector<Manifold>& out) { found_.exchange(out); }
    void give(std::size_t pairs, TakeManifolds take) { give(0, pairs, take); }

    /// The same for pairs that have been checked, whose manifolds go where they belong at once or by blocks.
    void find(const BatchInput& input, std::vector<Manifold>& out);
    void find(const BatchInput& input, TakeManifolds take);

private:
    bool find(const BatchInput& input, std::size_t begin, std::size_t count, ManifoldList& found);
    void give(std::size_t begin, std::size_t end, TakeManifolds take) const;

    std::vector<std::uint32_t> order_;  // numbers of a block's pairs, as they come: those of the last one stay
    ManifoldList found_;
};

}  // namespace carom::detail
