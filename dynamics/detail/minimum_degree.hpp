// An order of elimination for a sparse symmetric matrix: always the row that is coupled to the fewest others.
#pragma once

#include <carom/dynamics/detail/block_cholesky.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

struct EliminationOrder {
    std::vector<std::int32_t> row_at;                 ///< rows in the order they are eliminated
    std::vector<std::vector<std::int32_t>> below;     ///< by place in the order: rows still coupled when it goes, ascending
    std::size_t operations = 0;                       ///< of blocks in a factorisation
};

/// @return whether a factorisation takes at most `most_operations`; if not, `order` is of no use. Ties go to the lowest row.
[[nodiscard]] bool order_by_minimum_degree(std::int32_t rows, std::span<const BlockEdge> edges, std::size_t most_operations, EliminationOrder& order);

}  // namespace carom::dynamics
