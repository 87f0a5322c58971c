// What a factorisation in blocks spends its time in, through the machine's SIMD lanes: the same bits at every width.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::dynamics {

inline constexpr int kBlockSize = 6;
/// Columns are padded so that they fill whole registers; the padding stays zero.
inline constexpr int kBlockStride = 8;

/// A 6 x 6 matrix, column after column.
struct alignas(64) Block6 {
    std::array<double, kBlockSize * kBlockStride> entries{};
    [[nodiscard]] double& at(int row, int column) noexcept { return entries[static_cast<std::size_t>(column * kBlockStride + row)]; }
    [[nodiscard]] double at(int row, int column) const noexcept { return entries[static_cast<std::size_t>(column * kBlockStride + row)]; }
};
struct alignas(64) Vector6 {
    std::array<double, kBlockStride> entries{};
    [[nodiscard]] double& operator[](std::size_t i) noexcept { return entries[i]; }
    [[nodiscard]] double operator[](std::size_t i) const noexcept { return entries[i]; }
};

/// A symmetric matrix of blocks, and then its factor, by columns in the order of elimination.
struct BlockColumns {
    std::span<Block6> diagonals;            ///< (n,)
    std::span<Block6> values;               ///< below the diagonal
    std::span<const std::int32_t> starts;   ///< of the columns in `values` and `rows`: (n + 1,)
    std::span<const std::int32_t> rows;     ///< of each value, ascending within a column
    std::span<const std::int32_t> targets;  ///< for every two values of a column, in order: the value that their product is taken from
};

/// Puts L with L Lᵀ = H in place of H; the blocks on its diagonal have the reciprocals of their own diagonals there.
/// @return false where a pivot is not positive: H is not positive definite to rounding.
[[nodiscard]] bool factorise(const BlockColumns& columns) noexcept;

/// x <- (L Lᵀ)⁻¹ x, with x in the order of elimination.
void solve(const BlockColumns& factor, std::span<Vector6> x) noexcept;

}  // namespace carom::dynamics
