#include <carom/dynamics/detail/minimum_degree.hpp>

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace carom::dynamics {
namespace {

using Row = std::int32_t;
using Rows = std::vector<Row>;

std::size_t as_index(Row row) { return static_cast<std::size_t>(row); }

std::vector<Rows> neighbours_of(Row count, std::span<const BlockEdge> edges) {
    std::vector<Rows> neighbours(as_index(count));
    for (const BlockEdge& edge : edges) {
        neighbours[as_index(edge.a)].push_back(edge.b);
        neighbours[as_index(edge.b)].push_back(edge.a);
    }
    for (Rows& rows : neighbours) {
        std::ranges::stable_sort(rows);
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    }
    return neighbours;
}

/// (degree, row), the least first: a total order.
using Queue = std::set<std::pair<std::size_t, Row>>;

/// Operations of a row that is coupled to `degree` others when it goes.
std::size_t operations_of(std::size_t degree) { return 1 + degree + degree * (degree + 1) / 2; }

/// What the rows left take at the least when one of `degree` has gone: the others are coupled with each other, so that the first of them to go takes
/// operations_of(degree - 1), the next operations_of(degree - 2), and so on; any other row takes 1.
std::size_t least_operations(std::size_t rows, std::size_t degree) {
    std::size_t sum = rows - degree;
    for (std::size_t d = 0; d < degree; ++d) sum += operations_of(d);
    return sum;
}

}  // namespace

bool order_by_minimum_degree(Row count, std::span<const BlockEdge> edges, std::size_t most_operations, EliminationOrder& order) {
    std::vector<Rows> neighbours = neighbours_of(count, edges);
    Queue queue;
    for (Row row = 0; row < count; ++row) queue.emplace(neighbours[as_index(row)].size(), row);
    order.row_at.clear();
    order.below.assign(as_index(count), {});
    order.operations = 0;
    Rows joined;
    while (!queue.empty()) {
        const auto [degree, row] = *queue.begin();
        queue.erase(queue.begin());
        order.operations += operations_of(degree);
        if (order.operations + least_operations(queue.size(), degree) > most_operations) return false;
        Rows& left = order.below[order.row_at.size()];
        left = std::move(neighbours[as_index(row)]);
        order.row_at.push_back(row);
        for (const Row other : left) {  // from now on all of them are coupled with each other
            Rows& theirs = neighbours[as_index(other)];
            queue.erase({theirs.size(), other});
            joined.clear();
            std::ranges::set_union(theirs, left, std::back_inserter(joined));
            std::erase_if(joined, [&](Row r) { return r == row || r == other; });
            theirs.swap(joined);
            queue.emplace(theirs.size(), other);
        }
    }
    return true;
}

}  // namespace carom::dynamics
