// Sparse Cholesky factor of a symmetric matrix of 6 x 6 blocks, one row of blocks a body: H = L Lᵀ.
//
//   BlockCholesky factor;
//   if (factor.analyse(bodies, edges, 100'000)) {
//       factor.clear(); factor.diagonal(0).add(h00); ...; if (factor.factorise()) factor.solve(x);
//   }
#pragma once

#include <carom/dynamics/detail/block_kernels.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// Two rows of blocks that share an entry: a != b. An edge may be listed more than once.
struct BlockEdge {
    std::int32_t a = 0;
    std::int32_t b = 0;
    friend bool operator==(const BlockEdge&, const BlockEdge&) = default;
};

/// Where an edge's entry is stored: as the block of (row of a, column of b), or transposed.
struct BlockPlace {
    std::int32_t index = 0;
    bool transposed = false;
};

/// The order by minimum degree and the positions of the factor's blocks are found once for a graph; numbers change as often as one likes.
/// The same input gives the same bits. Sources: George and Liu, The Evolution of the Minimum Degree Ordering Algorithm (SIAM Review 1989);
/// the factor looks to the right, column by column (Davis, Direct Methods for Sparse Linear Systems, 2006, sec. 4).
class BlockCholesky {
public:
    /// Orders the rows and lays out the factor.
    /// @param most_operations  of blocks that a factorisation may take.
    /// @return whether it can do with so many: if not, this holds nothing, and finding that out took no longer than as many set operations.
    [[nodiscard]] bool analyse(std::int32_t rows, std::span<const BlockEdge> edges, std::size_t most_operations);

    /// Products and triangular solves of blocks that a factorisation takes.
    [[nodiscard]] std::size_t operations() const noexcept { return operations_; }
    [[nodiscard]] std::size_t blocks() const noexcept { return values_.size(); }

    /// Sets all entries to zero.
    void clear() noexcept;
    /// The block on the diagonal, of which only the lower triangle counts.
    [[nodiscard]] Block6& diagonal(std::int32_t row) noexcept {
        return diagonals_[static_cast<std::size_t>(position_[static_cast<std::size_t>(row)])];
    }
    [[nodiscard]] BlockPlace place(std::size_t edge) const noexcept { return places_[edge]; }
    [[nodiscard]] Block6& block(std::int32_t index) noexcept { return values_[static_cast<std::size_t>(index)]; }

    /// Replaces the entries by those of the factor. @return false where the matrix is not positive definite to rounding.
    [[nodiscard]] bool factorise() noexcept;
    /// Solves H x = b in place, by the factor. @param x  (rows,) in the rows' own order.
    void solve(std::span<Vector6> x) noexcept;
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    void lay_out(std::span<const BlockEdge> edges);

    std::vector<std::int32_t> position_;  // of each row in the order
    std::vector<std::int32_t> row_at_;    // and back
    std::vector<std::int32_t> starts_;    // of the columns in rows_ and values_: (rows + 1,)
    std::vector<std::int32_t> rows_;      // positions below the diagonal, ascending within a column
    std::vector<std::int32_t> targets_;   // of each product of two blocks of one column, in the order of factorise()
    std::vector<BlockPlace> places_;      // of edges
    std::vector<Block6> diagonals_, values_;
    std::vector<Vector6> scratch_;
    std::vector<std::vector<std::int32_t>> columns_;  // below the diagonal, as the ordering found them
    std::size_t operations_ = 0;
};

}  // namespace carom::dynamics
