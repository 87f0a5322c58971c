// One grid: boxes of like size, each listed once, in the cell of its lower corner.
//
//   level.build(table, slots, Slack::None, place, executor);
//   find_all_in_level(level, first, last, out);          // pairs within the level
//   level.move(...); find_changed_in_level(level, movers, begun, ended);
//
// A box overlaps only boxes whose lower corners lie between its own lower corner less `reach`, the longest edge of the level,
// and its upper corner. Cells in a row along the first axis are neighbours in memory, so a search reads a few short runs.
// Each cell has room to spare where boxes are to move; boxes that find none, and boxes longer than `reach`, are strays, which every
// search reads.
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/broadphase/detail/proxy_table.hpp>
#include <carom/core/executor.hpp>
#include <carom/core/function_ref.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::detail {

/// How corners map to cells. Where the boxes are spread too thinly for a table of all cells, cells are dealt out to a table by hash.
struct CellMap {
    static constexpr double kMostCoordinate = 1048575.0;
    int axes[3] = {0, 1, 2};  ///< runs go along the first
    float origin[3] = {};
    float per_metre[3] = {};
    float last[3] = {};   ///< greatest coordinate of a cell; everything beyond counts as in it
    float reach[3] = {};  ///< no box of the level is longer, but for strays
    std::uint32_t count[3] = {1, 1, 1};
    bool hashed = false;
    std::uint32_t mask = 0;  ///< of the hash

    /// Never decreases as x grows, whatever is rounded.
    [[nodiscard]] std::uint32_t coordinate(int k, float x) const noexcept {
        float c = (x - origin[k]) * per_metre[k];
        c = c < last[k] ? c : last[k];
        c = c > 0.0f ? c : 0.0f;
        return static_cast<std::uint32_t>(static_cast<std::int32_t>(c));
    }
    /// Where boxes of the cells c along an axis may lie, rounded outward; open at the ends of the grid.
    void region(int k, std::uint32_t c, FloatAabb& box) const noexcept;
    /// The least coordinate of any box that overlaps one whose lower end is x.
    [[nodiscard]] std::uint32_t reaching(int k, float lower) const noexcept {
        const float size = (lower < 0.0f ? -lower : lower) + reach[k];
        return coordinate(k, (lower - reach[k]) - kRounding * size);
    }
    static constexpr float kRounding = 0x1p-22f;  ///< of sizes: more than two differences of them round by
    [[nodiscard]] std::uint32_t cell(std::uint32_t x, std::uint32_t y, std::uint32_t z) const noexcept {
        if (!hashed) return (z * count[1] + y) * count[0] + x;
        std::uint32_t h = x * 0x9e3779b1u ^ y * 0x85ebca77u ^ z * 0xc2b2ae3du;
        h ^= h >> 15;
        return (h * 0x2c1b3c6du >> 7) & mask;
    }
    /// Tells cells apart that share an entry of the table and are near each other.
    [[nodiscard]] static std::uint32_t code(std::uint32_t x, std::uint32_t y, std::uint32_t z) noexcept {
        return (x & 0x7ffu) | (y & 0x7ffu) << 11 | (z & 0x3ffu) << 22;
    }
};

enum class Slack { None, Some };

/// The least box around the lower corners of boxes, and their longest edges, each rounded upward.
struct CornerSpread {
    vec3 low{0.0f}, high{0.0f}, edge{0.0f};
};

class GridLevel {
public:
    /// Lists the boxes of these slots anew. place[slot] becomes where each is.
    void build(const ProxyTable& table, std::span<const std::uint32_t> slots, Slack slack, std::vector<std::uint32_t>& place,
               Executor& executor);
    [[nodiscard]] bool has_slack() const noexcept { return slack_ == Slack::Some; }

    /// Whether a box is short enough to be listed in a cell.
    [[nodiscard]] bool fits(const FloatAabb& box) const noexcept;
    void insert(const ProxyTable& table, std::uint32_t slot, std::vector<std::uint32_t>& place);
    void remove(std::uint32_t slot, std::vector<std::uint32_t>& place);
    /// The box is no longer what it was.
    void move(const ProxyTable& table, std::uint32_t slot, std::vector<std::uint32_t>& place);
    /// Asks for the memory of an entry that will be changed soon.
    void prefetch(std::size_t at) const noexcept;
    /// Marks a box as moved in this update, or takes the mark off.
    void mark(std::size_t at, bool moved) noexcept {
        const Tag tag = static_cast<Tag>(entries.tag[at]);
        entries.tag[at] = static_cast<std::int32_t>(moved ? tag | kMoved : tag & ~kMoved);
    }

    /// Visits every slot whose box overlaps `box`, each once, until `visit` says no. @return whether it never did.
    bool visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const;

    /// The same for every slot for whose box `touches` is true; it is true of any region around such a box.
    bool visit_where(const ProxyTable& table, FunctionRef<bool(const FloatAabb&)> touches, FunctionRef<bool(std::uint32_t)> visit) const;

    /// The same of boxes that the path may meet (grid_walk.cpp), in about the order in which it does.
    bool visit_along(const ProxyTable& table, const SweepPath& path, FunctionRef<bool(const FloatAabb&)> touches,
                     FunctionRef<bool(std::uint32_t)> visit) const;

    /// The occupied cells; then the strays, each by itself.
    void visit_cells(int level, FunctionRef<void(const BroadphasePart&)> visit) const;
    /// @return the cell of the box at a place, or the stray that it is.
    [[nodiscard]] BroadphasePart part_at(std::size_t at, int level) const;

    [[nodiscard]] std::size_t size() const noexcept { return size_; }
    [[nodiscard]] std::size_t cells() const noexcept { return used.size(); }
    [[nodiscard]] std::size_t end() const noexcept { return stray_end; }
    [[nodiscard]] std::size_t strays() const noexcept { return stray_end - stray_begin; }
    [[nodiscard]] std::size_t memory() const noexcept;

    double cell_scale = 1.0;  ///< of the edges of cells

    // Read by the kernels.
    CellMap map;
    Entries entries;                   ///< cell by cell, then the strays
    std::vector<std::uint32_t> begin;  ///< (cells + 1,) of each cell's room
    std::vector<std::uint32_t> used;   ///< (cells,) entries from `begin` on
    std::vector<std::uint32_t> code;   ///< of each entry, where cells are hashed
    std::size_t stray_begin = 0, stray_end = 0;

private:
    struct Home {
        std::uint32_t cell, code;
    };
    /// Whole runs of entries, each box asked for.
    bool visit_run(const ProxyTable& table, std::size_t first, std::size_t last, FunctionRef<bool(const FloatAabb&)> touches,
                   FunctionRef<bool(std::uint32_t)> visit) const;
    /// Calls visit_cells(first, last) with the cells of each layer that the path may have to do with, until it says no.
    template <class F>
    bool walk_layers(const SweepPath& path, F visit_cells) const;
    [[nodiscard]] Home home_of(const FloatAabb& box) const noexcept;
    /// Counts the boxes of each cell into `used` and numbers them there. @return the mean number of boxes that share a box's cell.
    double count_cells(const ProxyTable& table, std::span<const std::uint32_t> slots, Executor& executor);
    void fill_cells(const ProxyTable& table, std::span<const std::uint32_t> slots, std::vector<std::uint32_t>& place, Executor& executor);
    void give_room();
    void put(const ProxyTable& table, std::size_t at, std::uint32_t slot, Home home, std::vector<std::uint32_t>& place);

    std::size_t size_ = 0;
    Slack slack_ = Slack::None;
    std::vector<std::uint32_t> home_;               // the cell of each entry
    std::vector<std::uint32_t> cell_of_, code_of_, rank_;  // of each slot of the list, while the level is built
    std::vector<std::uint32_t> order_;                     // the slots cell by cell
    std::vector<CornerSpread> spreads_;
};

/// The cells of boxes by their lower corners, and the codes of these cells where they are hashed.
void find_homes(const CellMap& map, std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots, std::uint32_t* cell,
                std::uint32_t* code);

/// Entry k becomes the box of order[k], with the slot for its tag, for k in [first, last); kNobody stands for a box that overlaps
/// nothing. Entries are written up to the next multiple of kEntriesAtOnce.
inline constexpr std::uint32_t kNobody = ~std::uint32_t{0};
inline constexpr std::size_t kEntriesAtOnce = 16;
void fill_entries(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> order, std::size_t first, std::size_t last,
                  const int axes[3], Entries& entries);

/// Of the boxes of these slots, one at least.
[[nodiscard]] CornerSpread spread_of(std::span<const FloatAabb> boxes, std::span<const std::uint32_t> slots);

/// Pairs of the boxes in cells [first, last) with each other and those in later cells of the level, which was just built; each once.
void find_all_in_level(const GridLevel& level, std::size_t first, std::size_t last, PairBuffer& out);

/// Pairs of the boxes in cells [first, last) of `finer` with those of a level of longer boxes.
void find_all_between(const GridLevel& finer, std::size_t first, std::size_t last, const GridLevel& coarser, PairBuffer& out);

/// As find_begun, of the level's entries, and where `ended` is there the pairs with entries not tagged kMoved that overlapped before and
/// do not now. The movers' axes are x, y, z; one that is nowhere now was removed, one that was nowhere before is new: one of the two it must be somewhere.
void find_changed_in_level(const GridLevel& level, std::span<const Mover> movers, PairBuffer& begun, PairBuffer* ended);

}  // namespace carom::detail
