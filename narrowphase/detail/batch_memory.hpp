// What a batch of pairs remembers of the one before: poses, how long each pair may still be carried along, and where its manifolds were.
//
//   memory.compare(placed, pairs, executor);            // which pairs have hardly moved
//   if (memory.reuses(i)) count = memory.record(pairs[i]).count;
//   memory.carry(pairs, begin, end, starts, last, out);    // their manifolds
//   memory.remember(i, pairs[i], touches, undecided);   // of the others
//   memory.place(i, starts[i], count);                  // of all
//   memory.finish(placed, manifolds);
#pragma once

#include <carom/core/executor.hpp>
#include <carom/narrowphase/detail/reuse.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace carom::detail {

class BatchMemory {
public:
    /// @return whether `pair` may name its `last`: a pair of the batch before, of the same two numbers.
    [[nodiscard]] bool knows(const NumberedPair& pair) const noexcept {
        return pair.last < records_.size() && records_[pair.last].a == pair.a && records_[pair.last].b == pair.b;
    }
    [[nodiscard]] std::size_t manifold_count() const noexcept { return manifold_count_; }

    /// Finds out which pairs need not be looked at. Everything has been checked.
    void compare(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor);
    [[nodiscard]] bool reuses(std::size_t pair) const noexcept { return reused_[pair] != 0; }
    [[nodiscard]] const PairRecord& record(const NumberedPair& pair) const noexcept { return records_[pair.last]; }

    /// Writes the manifolds of the reused pairs among [begin, end) to where they belong.
    /// @param starts  (end - begin,) at least: of each of these pairs, in `out`.
    void carry(std::span<const NumberedPair> pairs, std::size_t begin, std::size_t end, std::span<const std::size_t> starts,
               std::span<const Manifold> last, Manifold* out) const;

    /// Says what is known of pair `i`, which was looked at, from now on.
    void remember(std::size_t i, const NumberedPair& pair, bool touches, bool undecided) noexcept {
        next_[i] = record_of(pair, traits_[pair.a], traits_[pair.b], touches, undecided);
    }
    /// Says where the manifolds of pair `i` are from now on.
    void place(std::size_t i, std::size_t first, std::size_t count) noexcept {
        next_[i].first = static_cast<std::uint32_t>(first);
        next_[i].count = static_cast<std::uint32_t>(count);
    }
    /// Ends the batch: what was remembered counts from now on.
    void finish(const PlacedShapes& placed, std::size_t manifolds);
    void forget() noexcept;

private:
    std::vector<Pose> poses_;                // by shape
    std::vector<MotionLine> lines_;          // by shape: since then
    std::vector<ShapeTrait> traits_;         // by shape of this batch
    std::vector<PairRecord> records_, next_;  // by pair
    std::vector<unsigned char> reused_;      // by pair of this batch
    std::size_t manifold_count_ = 0;
};

}  // namespace carom::detail
