#include <carom/broadphase/detail/grid_level.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carom::detail {
namespace {

// Cells are this many of the longest edges of the level long, along runs and across.
constexpr double kRunEdges = 2.0;
constexpr double kRowEdges = 1.25;
// Where cells that small would hold fewer boxes than this on average they are made larger.
constexpr double kBoxesACell = 3.0;
// Boxes that share a cell, from which on a table of larger cells is given up for cells of the wanted size by hash.
constexpr double kCrowd = 40.0;
// What a thread takes at a time.
constexpr std::size_t kSlotsAPart = 4096;
static_assert(kSlotsAPart % kEntriesAtOnce == 0);

// How the lower corners lie along an axis.
struct Spread {
    double low = 0.0, high = 0.0;  // nearly all of them
    float edge = 0.0f;             // the longest
};

Spread spread_along(int axis, const CornerSpread& all, const ProxyTable& table, std::span<const std::uint32_t> slots) noexcept {
    constexpr std::size_t kSample = 4096;
    const std::size_t step = slots.size() / kSample + 1;
    const double origin = table.boxes[slots[0]].lower[axis];  // keeps the squares small
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < slots.size(); i += step) {
        const double x = static_cast<double>(table.boxes[slots[i]].lower[axis]) - origin;
        n += 1.0;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / n, deviation = std::sqrt(std::max(squares / n - mean * mean, 0.0));
    // A stray box far away must not make the cells large: it is listed in the outermost one.
    const double low = all.low[axis], high = all.high[axis];
    return {std::max(low, origin + mean - 3.0 * deviation), std::min(high, origin + mean + 3.0 * deviation), all.edge[axis]};
}

CornerSpread whole_spread(const ProxyTable& table, std::span<const std::uint32_t> slots, std::vector<CornerSpread>& spreads,
                          Executor& executor) {
    const std::size_t parts = (slots.size() + kSlotsAPart - 1) / kSlotsAPart;
    spreads.resize(parts);
    executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const std::size_t first = k * kSlotsAPart;
            spreads[k] = spread_of(table.boxes, slots.subspan(first, std::min(kSlotsAPart, slots.size() - first)));
        }
    });
    CornerSpread all = spreads[0];
    for (const CornerSpread& part : spreads) {
        all.low = glm::min(all.low, part.low);
        all.high = glm::max(all.high, part.high);
        all.edge = glm::max(all.edge, part.edge);
    }
    return all;
}

CellMap choose_cells(const CornerSpread& all, const ProxyTable& table, std::span<const std::uint32_t> slots, bool hashed,
                     double cell_scale) {
    Spread s[3] = {spread_along(0, all, table, slots), spread_along(1, all, table, slots), spread_along(2, all, table, slots)};
    CellMap map;
    const auto swap_if_narrower = [&](int i, int j) {
        if (s[map.axes[i]].high - s[map.axes[i]].low < s[map.axes[j]].high - s[map.axes[j]].low) {
            std::swap(map.axes[i], map.axes[j]);
        }
    };
    swap_if_narrower(0, 1);
    swap_if_narrower(1, 2);
    swap_if_narrower(0, 1);
    double extent[3], edge[3], count[3];
    for (int k = 0; k < 3; ++k) {
        const Spread& along = s[map.axes[k]];
        extent[k] = along.high - along.low;
        map.origin[k] = static_cast<float>(along.low);
        map.reach[k] = along.edge;
        edge[k] = std::max((k == 0 ? kRunEdges : kRowEdges) * static_cast<double>(along.edge), 1e-9 * extent[k]);
    }
    const double most = hashed ? 0x1p90 : std::max(static_cast<double>(slots.size()) / kBoxesACell, 1.0);
    for (double scale = cell_scale;; scale *= 1.125) {
        for (int k = 0; k < 3; ++k) {
            const double wanted = edge[k] > 0.0 ? std::floor(extent[k] / (scale * edge[k])) : 0.0;
            count[k] = std::min(wanted, CellMap::kMostCoordinate) + 1.0;
        }
        if (count[0] * count[1] * count[2] <= most) break;
    }
    for (int k = 0; k < 3; ++k) {
        map.per_metre[k] = extent[k] > 0.0 ? static_cast<float>(count[k] / extent[k]) : 0.0f;
        map.last[k] = static_cast<float>(count[k] - 1.0);
        map.count[k] = static_cast<std::uint32_t>(count[k]);
    }
    map.hashed = hashed;
    return map;
}

}  // namespace

void CellMap::region(int k, std::uint32_t c, FloatAabb& box) const noexcept {
    const double edge = per_metre[k] > 0.0f ? 1.0 / static_cast<double>(per_metre[k]) : 0.0;
    const double from = origin[k], low = from + c * edge, high = from + (c + 1.0) * edge + static_cast<double>(reach[k]);
    const double slack = 0x1p-20 * (std::abs(from) + (c + 1.0) * edge + static_cast<double>(reach[k]));  // far more than all rounding
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    box.lower[axes[k]] = c == 0 ? -kInfinity : static_cast<float>(low - slack);
    box.upper[axes[k]] = static_cast<float>(c) == last[k] ? kInfinity : static_cast<float>(high + slack);
}

GridLevel::Home GridLevel::home_of(const FloatAabb& box) const noexcept {
    std::uint32_t c[3];
    for (int k = 0; k < 3; ++k) c[k] = map.coordinate(k, box.lower[map.axes[k]]);
    return {map.cell(c[0], c[1], c[2]), CellMap::code(c[0], c[1], c[2])};
}

bool GridLevel::fits(const FloatAabb& box) const noexcept {
    for (int k = 0; k < 3; ++k) {
        const int axis = map.axes[k];
        if (static_cast<double>(box.upper[axis]) - static_cast<double>(box.lower[axis]) > static_cast<double>(map.reach[k])) return false;
    }
    return true;
}

double GridLevel::count_cells(const ProxyTable& table, std::span<const std::uint32_t> slots, Executor& executor) {
    const std::size_t cells = map.hashed ? std::size_t{map.mask} + 1 : std::size_t{map.count[0]} * map.count[1] * map.count[2];
    used.assign(cells, 0);
    double mates = 0.0;
    executor.parallel_for(slots.size(), kSlotsAPart, [&](std::size_t first, std::size_t last) {
        std::uint32_t* const codes = map.hashed ? code_of_.data() + first : nullptr;
        find_homes(map, table.boxes, slots.subspan(first, last - first), cell_of_.data() + first, codes);
    });
    for (std::size_t i = 0; i < slots.size(); ++i) rank_[i] = used[cell_of_[i]]++;
    for (const std::uint32_t count : used) mates += static_cast<double>(count) * count;
    return slots.empty() ? 0.0 : mates / static_cast<double>(slots.size());
}

void GridLevel::give_room() {
    begin.resize(used.size() + 1);
    std::uint32_t end = 0;
    for (std::size_t cell = 0; cell < used.size(); ++cell) {
        begin[cell] = end;
        end += slack_ == Slack::None ? used[cell] : (used[cell] + 5u) & ~3u;
    }
    begin[used.size()] = end;
    stray_begin = stray_end = end;
}

void GridLevel::build(const ProxyTable& table, std::span<const std::uint32_t> slots, Slack slack, std::vector<std::uint32_t>& place,
                      Executor& executor) {
    slack_ = slack;
    size_ = slots.size();
    cell_of_.resize(size_);
    rank_.resize(size_);
    CornerSpread all;
    if (size_ != 0) {
        all = whole_spread(table, slots, spreads_, executor);
        map = choose_cells(all, table, slots, false, cell_scale);
    }
    if (count_cells(table, slots, executor) > kCrowd) {
        const auto inner_cells = [](const CellMap& m) {
            return static_cast<double>(m.last[0]) * static_cast<double>(m.last[1]) * static_cast<double>(m.last[2]);
        };
        const CellMap crowded = map;
        map = choose_cells(all, table, slots, true, cell_scale);
        if (inner_cells(map) > 4.0 * inner_cells(crowded) + 64.0) {
            map.mask = 63;
            while (map.mask < size_ / 2) map.mask = 2 * map.mask + 1;
            code_of_.resize(size_);
        } else {
            map = crowded;  // cells of the wanted size would be as crowded
        }
        count_cells(table, slots, executor);
    }
    give_room();
    fill_cells(table, slots, place, executor);
    constexpr std::size_t kFew = 1024;
    if (slack_ == Slack::None || size_ <= kFew) return;  // the next update builds it anew, or it is not worth it
    for (std::vector<std::uint32_t>* scratch : {&cell_of_, &code_of_, &rank_, &order_}) std::vector<std::uint32_t>().swap(*scratch);
    std::vector<CornerSpread>().swap(spreads_);
}

void GridLevel::fill_cells(const ProxyTable& table, std::span<const std::uint32_t> slots, std::vector<std::uint32_t>& place,
                           Executor& executor) {
    const std::size_t total = stray_end;
    entries.grow(total + Entries::kSentinels);
    home_.resize(total);
    if (map.hashed) code.resize(total + Entries::kSentinels);
    if (slack_ == Slack::None)
        order_.resize(total);  // every place is taken below
    else
        order_.assign(total, kNobody);
    executor.parallel_for(size_, kSlotsAPart, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const std::uint32_t at = begin[cell_of_[i]] + rank_[i];
            order_[at] = slots[i];
            if (map.hashed) code[at] = code_of_[i];
            if (slack_ == Slack::None) continue;  // nothing will be moved or taken out
            home_[at] = cell_of_[i];
            place[slots[i]] = at;
        }
    });
    const std::size_t parts = (total + kSlotsAPart - 1) / kSlotsAPart;
    executor.parallel_for(parts, 1, [&](std::size_t begin_part, std::size_t end_part) {
        const std::size_t first = begin_part * kSlotsAPart, last = std::min(end_part * kSlotsAPart, total);
        fill_entries(table.boxes, order_, first, last, map.axes, entries);
        for (std::size_t at = first; at < last; ++at) {
            if (order_[at] != kNobody && table.movable[order_[at]] == 0) entries.tag[at] |= static_cast<std::int32_t>(kImmovable);
        }
    });
    entries.close(total);
}

void GridLevel::put(const ProxyTable& table, std::size_t at, std::uint32_t slot, Home home, std::vector<std::uint32_t>& place) {
    entries.set(at, table.boxes[slot], map.axes, slot | (table.movable[slot] != 0 ? 0 : kImmovable));
    if (map.hashed) code[at] = home.code;
    if (slack_ == Slack::None) return;  // nothing will be moved or taken out
    home_[at] = home.cell;
    place[slot] = static_cast<std::uint32_t>(at);
}

void GridLevel::insert(const ProxyTable& table, std::uint32_t slot, std::vector<std::uint32_t>& place) {
    ++size_;
    const Home home = home_of(table.boxes[slot]);
    if (fits(table.boxes[slot]) && begin[home.cell] + used[home.cell] < begin[home.cell + 1]) {
        put(table, begin[home.cell] + used[home.cell]++, slot, home, place);
        return;
    }
    entries.grow(stray_end + 1 + Entries::kSentinels);
    home_.resize(stray_end + 1);
    if (map.hashed) code.resize(stray_end + 1 + Entries::kSentinels);
    put(table, stray_end++, slot, home, place);
    entries.close(stray_end);
}

// The last of its cell, or of the strays, takes its place.
void GridLevel::remove(std::uint32_t slot, std::vector<std::uint32_t>& place) {
    --size_;
    const std::size_t at = place[slot];
    const std::size_t last = at >= stray_begin ? --stray_end : begin[home_[at]] + --used[home_[at]];
    for (int k = 0; k < 3; ++k) {
        entries.lower[k][at] = entries.lower[k][last];
        entries.upper[k][at] = entries.upper[k][last];
    }
    entries.tag[at] = entries.tag[last];
    if (map.hashed) code[at] = code[last];
    place[static_cast<Tag>(entries.tag[at]) & kIndexMask] = static_cast<std::uint32_t>(at);
    entries.set(last, kNowhere, map.axes, 0);
}

void GridLevel::move(const ProxyTable& table, std::uint32_t slot, std::vector<std::uint32_t>& place) {
    const std::size_t at = place[slot];
    const FloatAabb& box = table.boxes[slot];
    const Home home = home_of(box);
    if (at < stray_begin && home.cell == home_[at] && fits(box)) {
        put(table, at, slot, home, place);
        return;
    }
    remove(slot, place);
    insert(table, slot, place);
}

bool GridLevel::visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const {
    std::uint32_t first[3], last[3];
    std::size_t cells = 1;
    for (int k = 0; k < 3; ++k) {
        first[k] = map.reaching(k, box.lower[map.axes[k]]);
        last[k] = map.coordinate(k, box.upper[map.axes[k]]);
        cells *= std::size_t{last[k] - first[k]} + 1;  // each count is below 2^20, so three of them fit
    }
    const auto visit_run = [&](std::size_t from, std::size_t to, bool check, std::uint32_t wanted) {
        for (std::size_t at = from; at < to; ++at) {
            const std::uint32_t slot = static_cast<Tag>(entries.tag[at]) & kIndexMask;
            const bool there = entries.lower[0][at] <= entries.upper[0][at] && (!check || code[at] == wanted);
            if (there && overlaps(table.boxes[slot], box) && !visit(slot)) return false;
        }
        return true;
    };
    if (cells > size_ || (map.hashed && cells > 512)) return visit_run(0, stray_end, false, 0);
    for (std::uint32_t z = first[2]; z <= last[2]; ++z) {
        for (std::uint32_t y = first[1]; y <= last[1]; ++y) {
            for (std::uint32_t x = first[0]; x <= last[0]; ++x) {
                const std::uint32_t cell = map.cell(x, y, z);
                const std::size_t from = begin[cell];
                if (!visit_run(from, from + used[cell], map.hashed, CellMap::code(x, y, z))) return false;
            }
        }
    }
    return visit_run(stray_begin, stray_end, false, 0);
}

bool GridLevel::visit_run(const ProxyTable& table, std::size_t first, std::size_t last, FunctionRef<bool(const FloatAabb&)> touches,
                          FunctionRef<bool(std::uint32_t)> visit) const {
    for (std::size_t at = first; at < last; ++at) {
        const std::uint32_t slot = static_cast<Tag>(entries.tag[at]) & kIndexMask;
        const bool there = entries.lower[0][at] <= entries.upper[0][at];
        if (there && touches(table.boxes[slot]) && !visit(slot)) return false;
    }
    return true;
}

bool GridLevel::visit_where(const ProxyTable& table, FunctionRef<bool(const FloatAabb&)> touches,
                            FunctionRef<bool(std::uint32_t)> visit) const {
    if (map.hashed) return visit_run(table, 0, stray_end, touches, visit);  // the table does not say where its cells are
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    FloatAabb layer{vec3{-kInfinity}, vec3{kInfinity}};
    for (std::uint32_t z = 0; z < map.count[2]; ++z) {
        map.region(2, z, layer);
        if (!touches(layer)) continue;
        FloatAabb row = layer;
        for (std::uint32_t y = 0; y < map.count[1]; ++y) {
            map.region(1, y, row);
            if (!touches(row)) continue;
            FloatAabb box = row;
            for (std::uint32_t x = 0; x < map.count[0]; ++x) {
                const std::uint32_t cell = map.cell(x, y, z);
                if (used[cell] == 0) continue;
                map.region(0, x, box);
                if (touches(box) && !visit_run(table, begin[cell], begin[cell] + used[cell], touches, visit)) return false;
            }
        }
    }
    return visit_run(table, stray_begin, stray_end, touches, visit);
}

void GridLevel::prefetch(std::size_t at) const noexcept {
    for (int k = 0; k < 3; ++k) {
        hwy::Prefetch(&entries.lower[k][at]);
        hwy::Prefetch(&entries.upper[k][at]);
    }
    hwy::Prefetch(&entries.tag[at]);
    hwy::Prefetch(&home_[at]);
}

std::size_t GridLevel::memory() const noexcept {
    return entries.memory() + sizeof(CornerSpread) * spreads_.capacity() + sizeof(std::uint32_t) * (begin.capacity() + used.capacity() + code.capacity() + home_.capacity() +
                                                       cell_of_.capacity() + code_of_.capacity() + rank_.capacity() + order_.capacity());
}

}  // namespace carom::detail
