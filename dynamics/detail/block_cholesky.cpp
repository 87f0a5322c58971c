#include <carom/dynamics/detail/block_cholesky.hpp>

#include <carom/core/check.hpp>
#include <carom/dynamics/detail/minimum_degree.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

std::size_t as_index(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace

bool BlockCholesky::analyse(std::int32_t rows, std::span<const BlockEdge> edges, std::size_t most_operations) {
    EliminationOrder order;
    operations_ = 0;
    if (!order_by_minimum_degree(rows, edges, most_operations, order)) return false;
    operations_ = order.operations;
    row_at_ = std::move(order.row_at);
    columns_ = std::move(order.below);
    position_.resize(row_at_.size());
    for (std::int32_t p = 0; p < rows; ++p) position_[as_index(row_at_[as_index(p)])] = p;
    lay_out(edges);
    return true;
}

void BlockCholesky::lay_out(std::span<const BlockEdge> edges) {
    starts_.assign(1, 0);
    rows_.clear();
    for (std::vector<std::int32_t>& column : columns_) {
        for (std::int32_t& row : column) row = position_[as_index(row)];
        std::ranges::stable_sort(column);
        rows_.insert(rows_.end(), column.begin(), column.end());
        starts_.push_back(static_cast<std::int32_t>(rows_.size()));
    }
    const auto find = [&](std::int32_t row, std::int32_t column) {
        const auto begin = rows_.begin() + starts_[as_index(column)], end = rows_.begin() + starts_[as_index(column) + 1];
        const auto found = std::lower_bound(begin, end, row);
        CAROM_ASSERT(found != end && *found == row);
        return static_cast<std::int32_t>(found - rows_.begin());
    };
    targets_.clear();
    for (const std::vector<std::int32_t>& column : columns_) {
        for (std::size_t i = 0; i < column.size(); ++i) {
            for (std::size_t k = i + 1; k < column.size(); ++k) targets_.push_back(find(column[k], column[i]));
        }
    }
    places_.clear();
    for (const BlockEdge& edge : edges) {
        const std::int32_t a = position_[as_index(edge.a)], b = position_[as_index(edge.b)];
        places_.push_back(a > b ? BlockPlace{find(a, b), false} : BlockPlace{find(b, a), true});
    }
    diagonals_.resize(columns_.size());
    values_.resize(rows_.size());
    scratch_.resize(columns_.size());
}

void BlockCholesky::clear() noexcept {
    std::ranges::fill(diagonals_, Block6{});
    std::ranges::fill(values_, Block6{});
}

bool BlockCholesky::factorise() noexcept { return dynamics::factorise({diagonals_, values_, starts_, rows_, targets_}); }

void BlockCholesky::solve(std::span<Vector6> x) noexcept {
    for (std::size_t p = 0; p < scratch_.size(); ++p) scratch_[p] = x[as_index(row_at_[p])];
    dynamics::solve({diagonals_, values_, starts_, rows_, targets_}, scratch_);
    for (std::size_t p = 0; p < scratch_.size(); ++p) x[as_index(row_at_[p])] = scratch_[p];
}

std::size_t BlockCholesky::memory() const noexcept {
    std::size_t sum = held_by(position_, row_at_, starts_, rows_, targets_, places_, diagonals_, values_, scratch_, columns_);
    for (const std::vector<std::int32_t>& column : columns_) sum += held_by(column);
    return sum;
}

}  // namespace carom::dynamics
