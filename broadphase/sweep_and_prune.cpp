// Sweep and prune in cells: boxes sorted along one axis, dealt out to cells of the other two, swept many at once.
//
// Along the axis on which the centres spread most the boxes are sorted by their lower ends; a sweep then tests each box
// against those that begin before it ends (Baraff 1992; Ericson, Real-Time Collision Detection, 2005, sec. 7.5). One axis
// alone leaves hundreds of candidates a box in a pile, so the other two are cut into strips, and a box is listed in each
// cell that it touches. A pair is reported in the first cell that both touch: on each axis, the first strip of one of them.
#include <carom/broadphase/detail/method.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/core/radix_sort.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace carom::detail {
namespace {

// Strips are this many box edges wide, in the root mean square. With that n boxes of any sizes make at most
// n (1 + 1/2 + 1/2 + 1/4) entries in cells, the last term by Cauchy and Schwarz, and the open outer strips only save some.
constexpr double kStripEdges = 2.0;
// Fewer boxes a cell than this would be mostly sentinels.
constexpr double kBoxesACell = 16.0;
constexpr std::size_t kEntriesAPiece = 512;

// How the centres lie on one axis.
struct Spread {
    double mean = 0.0;
    double variance = 0.0;
    double edge = 0.0;  // root mean square
    double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
};

// Of the boxes whose centre is in [low, high].
Spread spread_within(std::span<const FloatAabb> bounds, int axis, double low, double high) noexcept {
    const double origin = 0.5 * (double(bounds[0].lower[axis]) + double(bounds[0].upper[axis]));  // keeps the squares small
    double n = 0.0, sum = 0.0, squares = 0.0, edges = 0.0;
    Spread s;
    for (const FloatAabb& box : bounds) {
        const double lower = box.lower[axis], upper = box.upper[axis];
        const double centre = 0.5 * (lower + upper);
        if (centre < low || centre > high) continue;
        n += 1.0;
        sum += centre - origin;
        squares += (centre - origin) * (centre - origin);
        edges += (upper - lower) * (upper - lower);
        s.low = std::min(s.low, centre);
        s.high = std::max(s.high, centre);
    }
    const double mean = sum / n;
    s.mean = origin + mean;
    s.variance = std::max(squares / n - mean * mean, 0.0);
    s.edge = std::sqrt(edges / n);
    return s;
}

// A few boxes far away would make the strips so wide that all others share one: they are left out of the count, twice if need be.
Spread spread(std::span<const FloatAabb> bounds, int axis) noexcept {
    constexpr double kFar = 10.0;  // deviations
    Spread s = spread_within(bounds, axis, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity());
    for (int i = 0; i < 2; ++i) {
        const double far = kFar * std::sqrt(s.variance);
        if (s.mean - s.low <= far && s.high - s.mean <= far) break;
        s = spread_within(bounds, axis, s.mean - far, s.mean + far);
    }
    return s;
}

// Cuts an axis into strips; the outermost ones are open.
class Strips {
public:
    Strips() = default;
    /// @param most  how many strips at most, >= 1.
    Strips(const Spread& s, double most) noexcept {
        const double count = std::floor(std::min(std::max(wanted(s), 1.0), most));
        count_ = static_cast<std::size_t>(count);
        last_ = count - 1.0;
        origin_ = s.mean - reach(s);
        per_metre_ = reach(s) > 0.0 ? count / (2.0 * reach(s)) : 0.0;
    }
    /// How many strips there would be without a limit.
    static double wanted(const Spread& s) noexcept {
        return reach(s) > 0.0 ? 2.0 * reach(s) / std::max(kStripEdges * s.edge, 1e-9 * reach(s)) : 1.0;
    }
    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    /// Never decreases as x grows, so boxes that overlap share a strip.
    [[nodiscard]] std::uint32_t of(float x) const noexcept {
        const double strip = (static_cast<double>(x) - origin_) * per_metre_;
        return static_cast<std::uint32_t>(std::min(std::max(strip, 0.0), last_));
    }

private:
    // Half the stretch that is cut up: a little more than an even distribution's. A stray box far away costs nothing.
    static double reach(const Spread& s) noexcept { return 2.0 * std::sqrt(std::max(s.variance, 0.0)); }

    std::size_t count_ = 1;
    double last_ = 0.0;
    double origin_ = 0.0;
    double per_metre_ = 0.0;
};

// The cells that a box touches: these strips of the two axes, the last ones included.
struct CellRange {
    std::uint32_t first[2];
    std::uint32_t last[2];
};

class SweepAndPrune final : public Method {
public:
    // The sweep is made anew each time; only its order is kept.
    [[nodiscard]] bool prefers_all(const ProxyTable&, const ChangeLists&) const noexcept override { return true; }

    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override {
        list_live(table);
        std::size_t end = 0;
        if (!bounds_.empty()) {
            choose_axes(bounds_);
            sort_along_axis(bounds_);
            end = list_in_cells(bounds_);
        } else {
            order_.clear();
        }
        const std::size_t pieces = (end + kEntriesAPiece - 1) / kEntriesAPiece;
        out.begin(pieces, out.limit());
        executor.parallel_for(pieces, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last && !out.is_full(); ++k) {
                find_overlaps(entries_, k * kEntriesAPiece, std::min((k + 1) * kEntriesAPiece, end), end, Order::Sorted, out[k]);
                out.found(out[k].size());
            }
        });
    }

    void find_moved(const ProxyTable& table, const ChangeLists&, Executor& executor, PairPieces& out) override {
        find_all(table, executor, out);
    }

    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override {
        // Boxes by their lower ends: those that begin after the wanted one ends are left out.
        const int axis = axes_[0];
        for (const std::uint32_t i : order_) {
            if (bounds_[i].lower[axis] > box.upper[axis]) return;
            if (overlaps(table.boxes[slot_of_[i]], box) && !visit(slot_of_[i])) return;
        }
    }

    void visit_ends(const ProxyTable& table, FunctionRef<void(const BroadphaseEnd&)> visit) const override {
        for (const std::uint32_t i : order_) visit({axes_[0], table.boxes[slot_of_[i]].lower[axes_[0]], false, slot_of_[i]});
    }
    [[nodiscard]] std::size_t memory() const noexcept override {
        return entries_.memory() + sizeof(FloatAabb) * bounds_.capacity() +
               sizeof(std::uint64_t) * (keys_.capacity() + sort_keys_.capacity() + next_.capacity() + scratch_.keys.capacity()) +
               sizeof(std::uint32_t) * (order_.capacity() + slot_of_.capacity() + scratch_.payload.capacity()) +
               sizeof(CellRange) * cells_.capacity();
    }

private:
    void list_live(const ProxyTable& table);
    void choose_axes(std::span<const FloatAabb> bounds);
    void sort_along_axis(std::span<const FloatAabb> bounds);
    bool mend_order();
    std::size_t list_in_cells(std::span<const FloatAabb> bounds);

    int axes_[3] = {0, 1, 2};          // swept, and the two that are cut
    Strips strips_[2];                 // of axes_[1] and axes_[2]
    std::vector<std::uint64_t> keys_;  // (ordered lower end << 32) | box, ascending after the sort
    std::vector<std::uint64_t> sort_keys_;
    std::vector<std::uint32_t> order_;
    RadixScratch scratch_;
    std::vector<CellRange> cells_;   // of each box
    std::vector<std::size_t> next_;  // where each cell's next entry goes
    std::vector<FloatAabb> bounds_;  // of live slots, in their order
    std::vector<std::uint32_t> slot_of_;
    std::vector<Tag> tags_;
    Entries entries_;
};

void SweepAndPrune::list_live(const ProxyTable& table) {
    bounds_.clear();
    slot_of_.clear();
    tags_.clear();
    for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
        if (table.alive[slot] == 0) continue;
        bounds_.push_back(table.boxes[slot]);
        slot_of_.push_back(static_cast<std::uint32_t>(slot));
        tags_.push_back(static_cast<Tag>(slot) | (table.movable[slot] != 0 ? 0 : kImmovable));
    }
}

void SweepAndPrune::choose_axes(std::span<const FloatAabb> bounds) {
    const Spread s[3] = {spread(bounds, 0), spread(bounds, 1), spread(bounds, 2)};
    int axes[3] = {0, 1, 2};
    const auto swap_if_narrower = [&](int i, int j) {
        if (s[axes[i]].variance < s[axes[j]].variance) std::swap(axes[i], axes[j]);
    };
    swap_if_narrower(0, 1);
    swap_if_narrower(1, 2);
    swap_if_narrower(0, 1);
    for (int k = 0; k < 3; ++k) axes_[k] = axes[k];
    const Spread &s1 = s[axes[1]], &s2 = s[axes[2]];
    const double most = std::max(static_cast<double>(bounds.size()) / kBoxesACell, 1.0);
    const double wanted1 = std::max(Strips::wanted(s1), 1.0), wanted2 = std::max(Strips::wanted(s2), 1.0);
    const double scale = std::sqrt(std::min(most / (wanted1 * wanted2), 1.0));  // where memory says no, both give way alike
    strips_[0] = Strips(s1, std::max(wanted1 * scale, 1.0));
    strips_[1] = Strips(s2, std::max(most / static_cast<double>(strips_[0].count()), 1.0));
}

// The order of the step before is nearly right in most scenes; the order that results does not depend on it.
void SweepAndPrune::sort_along_axis(std::span<const FloatAabb> bounds) {
    const std::size_t n = bounds.size();
    const int axis = axes_[0];
    if (order_.size() == n) {
        for (std::size_t i = 0; i < n; ++i) {
            keys_[i] = (std::uint64_t{ordered_key(bounds[order_[i]].lower[axis])} << 32) | order_[i];
        }
        if (mend_order()) {
            for (std::size_t i = 0; i < n; ++i) order_[i] = static_cast<std::uint32_t>(keys_[i]);
            return;
        }
    }
    keys_.resize(n);
    order_.resize(n);
    sort_keys_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        sort_keys_[i] = ordered_key(bounds[i].lower[axis]);
        order_[i] = static_cast<std::uint32_t>(i);
    }
    radix_sort(sort_keys_, order_, scratch_);
}

// Insertion sort, given up where a radix sort would be faster. @return whether it came to an end.
bool SweepAndPrune::mend_order() {
    std::size_t moves = 4 * keys_.size();
    for (std::size_t i = 1; i < keys_.size(); ++i) {
        const std::uint64_t key = keys_[i];
        std::size_t place = i;
        for (; place > 0 && keys_[place - 1] > key; --place) {
            if (moves-- == 0) return false;
            keys_[place] = keys_[place - 1];
        }
        keys_[place] = key;
    }
    return true;
}

// @return the end of the last cell's entries.
std::size_t SweepAndPrune::list_in_cells(std::span<const FloatAabb> bounds) {
    const std::size_t n = bounds.size();
    const std::size_t columns = strips_[1].count(), cells = strips_[0].count() * columns;
    cells_.resize(n);
    next_.assign(cells, 0);
    for (std::size_t i = 0; i < n; ++i) {
        CellRange& range = cells_[i];
        for (int k = 0; k < 2; ++k) {
            range.first[k] = strips_[k].of(bounds[i].lower[axes_[k + 1]]);
            range.last[k] = strips_[k].of(bounds[i].upper[axes_[k + 1]]);
        }
        for (std::size_t r = range.first[0]; r <= range.last[0]; ++r) {
            for (std::size_t c = range.first[1]; c <= range.last[1]; ++c) ++next_[r * columns + c];
        }
    }
    std::size_t end = 0;
    for (std::size_t& next : next_) end += std::exchange(next, end) + Entries::kSentinels;
    entries_.grow(end);
    for (const std::uint32_t box : order_) {
        const CellRange range = cells_[box];
        const Tag tag = tags_[box];
        for (std::size_t r = range.first[0]; r <= range.last[0]; ++r) {
            const Tag row_tag = tag | (r == range.first[0] ? 0 : kNotHome1);
            for (std::size_t c = range.first[1]; c <= range.last[1]; ++c) {
                const Tag cell_tag = row_tag | (c == range.first[1] ? 0 : kNotHome2);
                entries_.set(next_[r * columns + c]++, bounds[box], axes_, cell_tag);
            }
        }
    }
    for (const std::size_t next : next_) entries_.close(next);
    return end;
}

}  // namespace

std::unique_ptr<Method> make_sweep_and_prune() { return std::make_unique<SweepAndPrune>(); }

}  // namespace carom::detail
