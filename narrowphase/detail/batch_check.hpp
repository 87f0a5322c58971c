// What is wrong with a batch of pairs, and of which kind each is.
//
//   BatchKinds kinds;                                             // kept between batches
//   if (const PairFault fault = kinds.find(input, before, executor); fault.what != nullptr) ...
//   kernel_of(kinds.of_pair[i])
#pragma once

#include <carom/core/executor.hpp>
#include <carom/narrowphase/detail/batch_memory.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/kernel.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace carom::detail {

inline constexpr PairFault kPoseNotFinite{"collide: a pose is not finite", ErrorCode::NotFinite};

/// The kind of a pair is that of its two types in their order.
inline constexpr std::size_t kKinds = static_cast<std::size_t>(kShapeTypeCount) * static_cast<std::size_t>(kShapeTypeCount);
[[nodiscard]] constexpr std::size_t kind_of(std::size_t type_a, std::size_t type_b) noexcept {
    return type_a * static_cast<std::size_t>(kShapeTypeCount) + type_b;
}
[[nodiscard]] const KernelEntry& kernel_of(std::size_t kind) noexcept;

/// @return whether nothing is wrong with a pair's own numbers, and it names no pair of the batch before.
[[nodiscard]] inline bool is_plain(const NumberedPair& p, std::size_t shapes) noexcept {
    // Bits of floats from 0 up are in their order.
    constexpr auto kMost = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
    const auto margin = std::bit_cast<std::uint32_t>(p.margin), slack = std::bit_cast<std::uint32_t>(p.slack);
    return std::max(p.a, p.b) < shapes && std::max(margin, slack) <= kMost && p.last == kNewPair;
}

/// What pairs may name of the batch before: nothing where there is no memory.
struct BatchBefore {
    const BatchMemory* memory = nullptr;
    std::size_t manifolds = 0;  ///< that the caller gives back
};

class BatchKinds {
public:
    /// Looks at shapes and pairs, and at the poses that pairs name.
    /// @return what is wrong with the first pair that has something, poses last; `of_pair` means nothing then.
    [[nodiscard]] PairFault find(const BatchInput& input, const BatchBefore& before, Executor& executor);

    std::vector<std::uint16_t> of_pair;

private:
    void look_at_types(std::span<const Shape* const> shapes, Executor& executor);
    [[nodiscard]] bool poses_are_fit(const BatchInput& input, Executor& executor) const;
    [[nodiscard]] PairFault look_at_pair(const BatchInput& input, const BatchBefore& before, std::size_t i);
    [[nodiscard]] bool look_at_pairs(const BatchInput& input, const BatchBefore& before, std::size_t begin, std::size_t end);

    std::vector<unsigned char> types_;  // by shape
};

}  // namespace carom::detail
