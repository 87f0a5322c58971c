// Grids: one of a single cell size, and one with a level for each size class of boxes.
//
// Boxes that move stay where they are in memory until they leave their cell; then they take a spare place in the next one. Only the
// moved ones are searched for (Ericson, Real-Time Collision Detection, 2005, sec. 7.1-7.2, has both grids; cells by lower corner
// in memory order, spare places and the search for what began are ours).
#include <carom/broadphase/detail/grid_level.hpp>
#include <carom/broadphase/detail/method.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

namespace carom::detail {
namespace {

constexpr std::size_t kCellsAPiece = 256;
constexpr std::size_t kBoxesWorthSharing = 2048;  // fewer are searched before another core has fetched the half of them
constexpr std::size_t kMoversAPiece = 64;
constexpr std::size_t kMostLevels = 16;
constexpr int kMiddleLevel = 7;  // has the boxes of middling size
constexpr int kXyz[3] = {0, 1, 2};

class Grid final : public Method {
public:
    Grid(bool levels, double cell_scale) : by_size_(levels) {
        for (GridLevel& level : levels_) level.cell_scale = cell_scale;
    }

    [[nodiscard]] bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept override {
        return 4 * (changes.moved.size() + changes.inserted.size()) > table.live_count;
    }
    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override;
    void find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) override;
    [[nodiscard]] const PairPieces* ended() const noexcept override { return &ended_; }
    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override;
    void visit_where(const ProxyTable& table, FunctionRef<bool(const FloatAabb&)> touches,
                     FunctionRef<bool(std::uint32_t)> visit) const override {
        for (std::size_t k = 0; k < level_count_; ++k) {
            if (levels_[k].size() != 0 && !levels_[k].visit_where(table, touches, visit)) return;
        }
    }
    void visit_along(const ProxyTable& table, const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                     FunctionRef<bool(std::uint32_t)> visit) const override {
        for (std::size_t k = 0; k < level_count_; ++k) {
            if (levels_[k].size() != 0 && !levels_[k].visit_along(table, path, touches, visit)) return;
        }
    }
    void visit_parts(const ProxyTable&, FunctionRef<void(const BroadphasePart&)> visit) const override {
        for (std::size_t k = 0; k < level_count_; ++k) {
            if (levels_[k].size() != 0) levels_[k].visit_cells(static_cast<int>(k), visit);
        }
    }
    void visit_parts_of(std::uint32_t slot, FunctionRef<void(const BroadphasePart&)> visit) const override {
        visit(levels_[level_[slot]].part_at(place_[slot], level_[slot]));
    }
    [[nodiscard]] std::size_t memory() const noexcept override;

private:
    struct Piece {
        std::size_t level, first, last;
    };
    void build(const ProxyTable& table, Slack slack, Executor& executor);
    void list_live(const ProxyTable& table);
    [[nodiscard]] std::size_t level_of(const FloatAabb& box) const noexcept;
    void take_over(const ProxyTable& table, const ChangeLists& changes);
    void list_movers(const ProxyTable& table, const ChangeLists& changes);

    bool by_size_;
    int smallest_ = 0;                           // binary exponent of the first level's longest edges
    std::array<GridLevel, kMostLevels> levels_;  // of ever longer boxes; the last has all that are longer yet
    std::size_t level_count_ = 0;
    std::array<std::vector<std::uint32_t>, kMostLevels> slots_;
    std::vector<std::uint32_t> place_;  // of each slot, in its level
    std::vector<unsigned char> level_;  // of each slot
    std::vector<Piece> pieces_;
    std::vector<Mover> movers_;        // level by level, in the order of their places; then those removed
    std::vector<std::uint64_t> bits_;  // one a place
    std::vector<Tag> tags_;            // of the movers
    PairPieces ended_;
    std::size_t debt_ = 0;             // entries read beyond need since the grid was built
};

// Four times the size is one level up.
int exponent_of(float edge) noexcept { return static_cast<int>((std::bit_cast<std::uint32_t>(edge) >> 23) & 255u); }

float longest_edge(const FloatAabb& box) noexcept {
    const vec3 edges = box.upper - box.lower;
    return std::max(edges.x, std::max(edges.y, edges.z));
}

std::size_t Grid::level_of(const FloatAabb& box) const noexcept {
    if (!by_size_) return 0;
    const int level = (exponent_of(longest_edge(box)) - smallest_) >> 1;
    return static_cast<std::size_t>(std::clamp(level, 0, static_cast<int>(kMostLevels) - 1));
}

void Grid::list_live(const ProxyTable& table) {
    std::vector<std::uint32_t>& live = slots_[0];
    live.resize(table.live_count);
    std::size_t count = 0;
    for (std::size_t slot = 0; slot < table.alive.size() && count < table.live_count; ++slot) {
        live[count] = static_cast<std::uint32_t>(slot);
        count += table.alive[slot];
    }
    std::fill(level_.begin(), level_.end(), static_cast<unsigned char>(0));
}

void Grid::build(const ProxyTable& table, Slack slack, Executor& executor) {
    const std::size_t n = table.boxes.size();
    place_.resize(n);
    level_.resize(n);
    level_count_ = by_size_ ? kMostLevels : 1;
    if (by_size_) {
        std::array<std::size_t, 256> count{};
        for (std::size_t slot = 0; slot < n; ++slot)
            count[static_cast<std::size_t>(exponent_of(longest_edge(table.boxes[slot])))] += table.alive[slot];
        std::size_t below = 0;
        int middle = 0;
        while (middle < 255 && 2 * (below + count[static_cast<std::size_t>(middle)]) < table.live_count)
            below += count[static_cast<std::size_t>(middle++)];
        smallest_ = middle - 1 - 2 * kMiddleLevel;  // the upper of its level's two exponents
    }
    for (std::size_t k = 0; k < level_count_; ++k) slots_[k].clear();
    if (!by_size_) list_live(table);
    for (std::size_t slot = 0; by_size_ && slot < n; ++slot) {
        if (table.alive[slot] == 0) continue;
        level_[slot] = static_cast<unsigned char>(level_of(table.boxes[slot]));
        slots_[level_[slot]].push_back(static_cast<std::uint32_t>(slot));
    }
    for (std::size_t k = 0; k < level_count_; ++k) levels_[k].build(table, slots_[k], slack, place_, executor);
    debt_ = 0;
}

void Grid::find_all(const ProxyTable& table, Executor& executor, PairPieces& out) {
    build(table, Slack::None, executor);
    pieces_.clear();
    for (std::size_t k = 0; k < level_count_; ++k) {
        const std::size_t cells = levels_[k].size() != 0 ? levels_[k].cells() : 0;
        for (std::size_t first = 0; first < cells; first += kCellsAPiece) {
            pieces_.push_back({k, first, std::min(first + kCellsAPiece, cells)});
        }
    }
    out.begin(pieces_.size(), out.limit());
    SerialExecutor alone;
    Executor& threads = table.live_count < kBoxesWorthSharing ? alone : executor;
    threads.parallel_for(pieces_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
            const Piece& piece = pieces_[k];
            find_all_in_level(levels_[piece.level], piece.first, piece.last, out[k]);
            for (std::size_t coarser = piece.level + 1; coarser < level_count_; ++coarser) {
                if (levels_[coarser].size() == 0) continue;
                find_all_between(levels_[piece.level], piece.first, piece.last, levels_[coarser], out[k]);
            }
            out.found(out[k].size());
        }
    });
}

void Grid::take_over(const ProxyTable& table, const ChangeLists& changes) {
    place_.resize(table.boxes.size());
    level_.resize(table.boxes.size());
    for (const std::uint32_t slot : changes.removed) levels_[level_[slot]].remove(slot, place_);
    const auto insert = [&](std::uint32_t slot) {
        level_[slot] = static_cast<unsigned char>(level_of(table.boxes[slot]));
        levels_[level_[slot]].insert(table, slot, place_);
    };
    constexpr std::size_t kAhead = 8;
    for (std::size_t i = 0; i < changes.moved.size(); ++i) {
        const std::uint32_t slot = changes.moved[i];
        if (i + kAhead < changes.moved.size()) {
            const std::uint32_t later = changes.moved[i + kAhead];
            levels_[level_[later]].prefetch(place_[later]);
        }
        if (level_of(table.boxes[slot]) == level_[slot]) {
            levels_[level_[slot]].move(table, slot, place_);
        } else {
            levels_[level_[slot]].remove(slot, place_);
            insert(slot);
        }
    }
    for (const std::uint32_t slot : changes.inserted) insert(slot);
}

// In the order of their places, so that searches that follow each other read the same memory.
void Grid::list_movers(const ProxyTable& table, const ChangeLists& changes) {
    std::array<std::size_t, kMostLevels + 1> first_word{};
    for (std::size_t k = 0; k < level_count_; ++k) first_word[k + 1] = first_word[k] + levels_[k].end() / 64 + 1;
    bits_.assign(first_word[level_count_], 0);
    for (const auto& list : {changes.moved, changes.inserted}) {
        for (const std::uint32_t slot : list) {
            bits_[first_word[level_[slot]] + place_[slot] / 64] |= std::uint64_t{1} << (place_[slot] % 64);
        }
    }
    tags_.clear();
    for (std::size_t k = 0; k < level_count_; ++k) {
        for (std::size_t word = first_word[k]; word < first_word[k + 1]; ++word) {
            for (std::uint64_t left = bits_[word]; left != 0; left &= left - 1) {
                const std::size_t at = 64 * (word - first_word[k]) + static_cast<std::size_t>(std::countr_zero(left));
                levels_[k].mark(at, true);
                tags_.push_back(static_cast<Tag>(levels_[k].entries.tag[at]));
            }
        }
    }
    movers_.clear();
    constexpr std::size_t kAhead = 12;  // slots are in another order
    for (std::size_t i = 0; i < tags_.size(); ++i) {
        if (i + kAhead < tags_.size()) {
            hwy::Prefetch(&table.boxes[tags_[i + kAhead] & kIndexMask]);
            hwy::Prefetch(&table.previous[tags_[i + kAhead] & kIndexMask]);
        }
        const std::uint32_t slot = tags_[i] & kIndexMask;
        movers_.push_back(mover(table.boxes[slot], table.previous[slot], kXyz, tags_[i]));
    }
    if (!changes.want_ended) return;
    for (const std::uint32_t slot : changes.removed) {
        movers_.push_back(mover(kNowhere, table.previous[slot], kXyz, slot | (table.movable[slot] != 0 ? 0 : kImmovable)));
    }
}

void Grid::find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) {
    constexpr std::size_t kWorthBuilding = 4;  // times the boxes
    if (!levels_[0].has_slack() || debt_ > kWorthBuilding * table.live_count) {
        build(table, Slack::Some, executor);
    } else {
        take_over(table, changes);
    }
    list_movers(table, changes);
    const std::size_t pieces = (movers_.size() + kMoversAPiece - 1) / kMoversAPiece;
    out.begin(pieces, out.limit());
    ended_.begin(changes.want_ended ? pieces : 0, std::numeric_limits<std::size_t>::max());  // no more than there were
    executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
            const std::size_t first = k * kMoversAPiece;
            const std::span<const Mover> piece = std::span(movers_).subspan(first, std::min(kMoversAPiece, movers_.size() - first));
            for (std::size_t level = 0; level < level_count_; ++level) {
                if (levels_[level].size() != 0) find_changed_in_level(levels_[level], piece, out[k], changes.want_ended ? &ended_[k] : nullptr);
            }
            out.found(out[k].size());
        }
    });
    for (const Mover& m : movers_) {
        if (!(m.lower[0] <= m.upper[0])) break;  // the rest are gone
        const std::uint32_t slot = m.tag & kIndexMask;
        levels_[level_[slot]].mark(place_[slot], false);
    }
    for (std::size_t k = 0; k < level_count_; ++k) debt_ += movers_.size() * (levels_[k].strays() + 15) / 16;
}

void Grid::visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const {
    for (std::size_t k = 0; k < level_count_; ++k) {
        if (levels_[k].size() != 0 && !levels_[k].visit_near(table, box, visit)) return;
    }
}

std::size_t Grid::memory() const noexcept {
    std::size_t sum = sizeof(std::uint32_t) * place_.capacity() + level_.capacity() + sizeof(Mover) * movers_.capacity() +
                      sizeof(std::uint64_t) * bits_.capacity() + sizeof(Tag) * tags_.capacity() + sizeof(Piece) * pieces_.capacity() + ended_.memory();
    for (const GridLevel& level : levels_) sum += level.memory();
    for (const std::vector<std::uint32_t>& slots : slots_) sum += sizeof(std::uint32_t) * slots.capacity();
    return sum;
}

}  // namespace

std::unique_ptr<Method> make_uniform_grid(double cell_scale) { return std::make_unique<Grid>(false, cell_scale); }
std::unique_ptr<Method> make_hierarchical_grid(double cell_scale) { return std::make_unique<Grid>(true, cell_scale); }

}  // namespace carom::detail
