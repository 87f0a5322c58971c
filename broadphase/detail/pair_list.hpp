// Input checks that all methods share, and the joining of pairs found in pieces into one sorted list.
//
//   const InputCheck check = check_input(bounds, filters);
//   list.begin(pieces); find_overlaps(..., list.piece(k)); list.finish(filters);
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// @return what is wrong with the input, in words; null if nothing is.
[[nodiscard]] const char* find_fault(std::span<const FloatAabb> bounds, std::span<const ProxyFilter> filters) noexcept;

/// The pairs of a step, and the memory to sort them in. Allocates nothing once it has grown.
class PairList {
public:
    /// Starts a list that is found in `pieces` pieces, in any order and on any threads.
    void begin(std::size_t pieces);
    [[nodiscard]] PairBuffer& piece(std::size_t k) noexcept { return pieces_[k]; }

    /// Drops the pairs whose filters disagree and sorts the rest by (a, b). Indices are below filters.size().
    void finish(std::span<const ProxyFilter> filters);

    [[nodiscard]] std::span<const ProxyPair> pairs() const noexcept { return {pairs_.data(), count_}; }

private:
    std::vector<PairBuffer> pieces_;
    std::size_t piece_count_ = 0;
    std::vector<std::uint32_t> next_of_a_, next_of_b_;
    std::vector<std::uint32_t> a_by_b_;
    std::vector<ProxyPair> pairs_;
    std::size_t count_ = 0;
};

}  // namespace carom::detail
