// The searches of a grid level.
#include <carom/core/simd_targets.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE <carom/broadphase/detail/grid_kernel.cpp>
#include <hwy/foreach_target.h>

#include <carom/broadphase/detail/grid_level.hpp>
#include <carom/core/lanes.hpp>

#include <carom/broadphase/detail/cell_lanes.hpp>
#include <carom/broadphase/detail/scan.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

// Cells by coordinate, both ends included.
struct CellRange {
    std::uint32_t first[3], last[3];
};

HWY_INLINE CellRange cells_near(const CellMap& map, const float lower[3], const float upper[3]) {
    CellRange r;
    for (int k = 0; k < 3; ++k) {
        r.first[k] = map.reaching(k, lower[k]);
        r.last[k] = map.coordinate(k, upper[k]);
    }
    return r;
}

// Whether looking at every entry costs less than looking the cells up.
HWY_INLINE bool is_wide(const GridLevel& g, const CellRange& r) {
    std::size_t cells = 1;
    for (int k = g.map.hashed ? 0 : 1; k < 3; ++k) cells *= std::size_t{r.last[k] - r.first[k]} + 1;
    return cells > g.size() / static_cast<std::size_t>(kLanes) + 8;
}

// Calls scan(first, last, code) for the runs of a row of cells; the code is for hashed cells alone.
template <class F>
HWY_INLINE void for_runs_of_row(const GridLevel& g, std::uint32_t x0, std::uint32_t x1, std::uint32_t y, std::uint32_t z, F run) {
    if (!g.map.hashed) {
        const std::uint32_t row = g.map.cell(0, y, z), last = row + x1;
        run(std::size_t{g.begin[row + x0]}, std::size_t{g.begin[last]} + g.used[last], 0u);
        return;
    }
    for (std::uint32_t x = x0; x <= x1; ++x) {
        const std::uint32_t cell = g.map.cell(x, y, z);
        if (g.used[cell] != 0) run(std::size_t{g.begin[cell]}, std::size_t{g.begin[cell]} + g.used[cell], CellMap::code(x, y, z));
    }
}

HWY_INLINE Mask in_cell(const GridLevel& g, std::size_t j, std::uint32_t code) {
    const auto* const codes = reinterpret_cast<const std::int32_t*>(g.code.data());
    return load_unaligned(codes + j) == Ints{static_cast<std::int32_t>(code)};
}

// Box of entry i.
HWY_INLINE void read_box(const Entries& e, std::size_t i, float lower[3], float upper[3]) {
    for (int k = 0; k < 3; ++k) {
        lower[k] = e.lower[k][i];
        upper[k] = e.upper[k][i];
    }
}

template <bool hashed>
HWY_INLINE void scan_run(const GridLevel& g, std::size_t first, std::size_t last, std::uint32_t code, const WideBox& box, Tag tag,
                         PairBuffer& out) {
    if constexpr (!hashed) {
        scan(g.entries, first, last, box, tag, out, [](std::size_t) { return first_lanes(kLanes); });
    } else {
        scan(g.entries, first, last, box, tag, out, [&](std::size_t j) { return in_cell(g, j, code); });
    }
}

// Of hashed cells box by box: the cells of the table that a box needs are nowhere near each other.
void all_in_hashed_level(const GridLevel& g, std::size_t begin, std::size_t end, PairBuffer& out) {
    const Entries& e = g.entries;
    for (std::size_t i = begin; i < end && !out.is_full(); ++i) {
        float lower[3], upper[3];
        read_box(e, i, lower, upper);
        if (!(lower[0] <= upper[0])) continue;  // room to spare
        const Tag tag = static_cast<Tag>(e.tag[i]);
        const WideBox box(lower, upper);
        const CellRange r = cells_near(g.map, lower, upper);
        const std::uint32_t x = g.map.coordinate(0, lower[0]);
        const std::uint32_t y = g.map.coordinate(1, lower[1]);
        const std::uint32_t z = g.map.coordinate(2, lower[2]);
        // The rest of its own cell, the cells after it in its row, the rows after it in its layer, the layers after that.
        const std::uint32_t own = g.map.cell(x, y, z);
        const auto run = [&](std::size_t first, std::size_t last, std::uint32_t code) {
            scan_run<true>(g, first, last, code, box, tag, out);
        };
        run(i + 1, std::size_t{g.begin[own]} + g.used[own], CellMap::code(x, y, z));
        if (x < r.last[0]) for_runs_of_row(g, x + 1, r.last[0], y, z, run);
        for (std::uint32_t layer = z; layer <= r.last[2]; ++layer) {
            for (std::uint32_t row = layer == z ? y + 1 : r.first[1]; row <= r.last[1]; ++row) {
                for_runs_of_row(g, r.first[0], r.last[0], row, layer, run);
            }
        }
    }
}

// Pairs of one box with the vector of entries at j, those of `there`.
struct RunVector {
    Floats lower0, lower1, lower2, upper0, upper1, upper2;
    Ints tags;
    Mask there, movable;
    HWY_INLINE RunVector(const EntryView& e, std::size_t j, std::size_t last)
        : lower0(load_unaligned(e.lower0 + j)),
          lower1(load_unaligned(e.lower1 + j)),
          lower2(load_unaligned(e.lower2 + j)),
          upper0(load_unaligned(e.upper0 + j)),
          upper1(load_unaligned(e.upper1 + j)),
          upper2(load_unaligned(e.upper2 + j)),
          tags(load_unaligned(e.tag + j)),
          there(first_lanes(static_cast<int>(last - j < kLanes ? last - j : kLanes))),
          movable(there & ((tags & Ints{static_cast<std::int32_t>(kImmovable)}) == Ints{0})) {
        tags = tags & Ints{static_cast<std::int32_t>(kIndexMask)};
    }
    // Entries that overlap entry i and may be paired with it.
    HWY_INLINE Mask overlapping(const EntryView& e, std::size_t i, Mask partners) const {
        return partners & (lower0 <= Floats{e.upper0[i]}) & (upper0 >= Floats{e.lower0[i]}) & (lower1 <= Floats{e.upper1[i]}) &
               (upper1 >= Floats{e.lower1[i]}) & (lower2 <= Floats{e.upper2[i]}) & (upper2 >= Floats{e.lower2[i]});
    }
    // Writes the pairs of entry i whatever their number: whether there are any is hard to foresee, and a wrong guess costs more.
    HWY_INLINE std::size_t add(const EntryView& e, std::size_t i, Mask hit, std::int32_t* first, std::int32_t* second) const {
        store_unaligned(Ints{e.tag[i] & static_cast<std::int32_t>(kIndexMask)}, first);
        return compress_store(tags, hit, second);
    }
    // Those that entry i may be paired with: of two boxes one at least can move.
    HWY_INLINE Mask partners(const EntryView& e, std::size_t i) const {
        return (static_cast<Tag>(e.tag[i]) & kImmovable) != 0 ? movable : there;
    }
};

// Pairs of boxes [first, last) of a cell with later entries up to `run_last`, where the cell's own row ends.
HWY_INLINE void scan_own_row(const EntryView& e, std::size_t first, std::size_t last, std::size_t run_last, PairBuffer& out) {
    for (std::size_t j = first; j < run_last; j += kLanes) {
        const RunVector run(e, j, run_last);
        const Ints places = lane_numbers() + Ints{static_cast<std::int32_t>(j)};
        const std::size_t end = last > j + kLanes ? j + kLanes : last;
        out.make_room((end - first + 1) * kLanes);
        std::int32_t *to_first = out.next_first(), *to_second = out.next_second();
        std::size_t found = 0;
        for (std::size_t i = first; i < end; ++i) {
            const Mask hit = run.overlapping(e, i, run.partners(e, i)) & (places > Ints{static_cast<std::int32_t>(i)});
            found += run.add(e, i, hit, to_first + found, to_second + found);
        }
        out.added(found);
    }
}

// Up to this many boxes of a cell are looked at together: as many as a word has bits.
constexpr std::size_t kBatch = 64;

// Which rows and layers each box of a batch reaches.
struct BatchReach {
    alignas(64) std::int32_t first_row[kBatch], last_row[kBatch], last_layer[kBatch];
    HWY_INLINE void set(const CellMap& map, const EntryView& e, std::size_t first, std::size_t last) {
        const WideMap rows(map, 1), layers(map, 2);
        for (std::size_t i = 0; i < last - first; i += kLanes) {
            store(rows.reaching(load_unaligned(e.lower1 + first + i)), first_row + i);
            store(rows.coordinate(load_unaligned(e.upper1 + first + i)), last_row + i);
            store(layers.coordinate(load_unaligned(e.upper2 + first + i)), last_layer + i);
        }
    }
    HWY_INLINE std::uint64_t reaching(std::size_t count, std::uint32_t row, std::uint32_t layer) const {
        const Ints wanted_row{static_cast<std::int32_t>(row)}, wanted_layer{static_cast<std::int32_t>(layer)};
        std::uint64_t boxes = 0;
        for (std::size_t i = 0; i < count; i += kLanes) {
            const Mask reaches =
                (load(first_row + i) <= wanted_row) & (load(last_row + i) >= wanted_row) & (load(last_layer + i) >= wanted_layer);
            boxes |= std::uint64_t{bits(reaches)} << i;
        }
        return count == kBatch ? boxes : boxes & ((std::uint64_t{1} << count) - 1);
    }
};

// Pairs of those boxes from `first` on whose bits are set with the entries of a run. Each vector of the run is loaded once for all.
HWY_INLINE void scan_other_row(const EntryView& e, std::size_t first, std::uint64_t boxes, std::size_t run_first, std::size_t run_last,
                               PairBuffer& out) {
    for (std::size_t j = run_first; j < run_last; j += kLanes) {
        const RunVector run(e, j, run_last);
        out.make_room((kBatch + 1) * kLanes);
        std::int32_t *to_first = out.next_first(), *to_second = out.next_second();
        std::size_t found = 0;
        for (std::uint64_t left = boxes; left != 0; left &= left - 1) {
            const std::size_t i = first + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
            const Mask hit = run.overlapping(e, i, run.partners(e, i));
            found += run.add(e, i, hit, to_first + found, to_second + found);
        }
        out.added(found);
    }
}

// A batch of boxes of a cell with what comes after it: the rest of its row, the rows after it in its layer, the layers after that.
HWY_INLINE void all_of_batch(const GridLevel& g, const EntryView& e, std::size_t cell, std::size_t first, std::size_t last,
                             PairBuffer& out) {
    BatchReach reach;
    reach.set(g.map, e, first, last);
    float upper0 = e.upper0[first], lower0 = e.lower0[first];
    std::int32_t first_row = reach.first_row[0], last_row = reach.last_row[0], last_layer = reach.last_layer[0];
    for (std::size_t i = 1; i < last - first; ++i) {
        upper0 = e.upper0[first + i] > upper0 ? e.upper0[first + i] : upper0;
        lower0 = e.lower0[first + i] < lower0 ? e.lower0[first + i] : lower0;
        first_row = reach.first_row[i] < first_row ? reach.first_row[i] : first_row;
        last_row = reach.last_row[i] > last_row ? reach.last_row[i] : last_row;
        last_layer = reach.last_layer[i] > last_layer ? reach.last_layer[i] : last_layer;
    }
    const std::uint32_t x0 = g.map.reaching(0, lower0), x1 = g.map.coordinate(0, upper0);
    const auto place = static_cast<std::uint32_t>(cell);
    const std::uint32_t x = place % g.map.count[0], y = place / g.map.count[0] % g.map.count[1],
                        z = place / g.map.count[0] / g.map.count[1];
    const std::size_t row_last = cell + (x1 - x);
    scan_own_row(e, first, last, std::size_t{g.begin[row_last]} + g.used[row_last], out);
    for (std::uint32_t layer = z; layer <= static_cast<std::uint32_t>(last_layer); ++layer) {
        const std::uint32_t from = layer == z ? y + 1 : static_cast<std::uint32_t>(first_row);
        for (std::uint32_t row = from; row <= static_cast<std::uint32_t>(last_row); ++row) {
            const std::uint64_t boxes = reach.reaching(last - first, row, layer);
            const std::uint32_t start = g.map.cell(0, row, layer), end = start + x1;
            scan_other_row(e, first, boxes, g.begin[start + x0], std::size_t{g.begin[end]} + g.used[end], out);
        }
    }
}

void all_in_table(const GridLevel& g, std::size_t begin, std::size_t end, PairBuffer& out) {
    const EntryView e(g.entries);
    for (std::size_t cell = begin; cell < end; ++cell) {
        const std::size_t last = std::size_t{g.begin[cell]} + g.used[cell];
        for (std::size_t first = g.begin[cell]; first < last && !out.is_full(); first += kBatch) {
            all_of_batch(g, e, cell, first, last - first < kBatch ? last : first + kBatch, out);
        }
    }
}

// All cells of the range and the strays.
template <class F>
HWY_INLINE void for_runs_of_range(const GridLevel& g, const CellRange& r, F run) {
    for (std::uint32_t z = r.first[2]; z <= r.last[2]; ++z) {
        for (std::uint32_t y = r.first[1]; y <= r.last[1]; ++y) for_runs_of_row(g, r.first[0], r.last[0], y, z, run);
    }
}

void all_of_level(const GridLevel& g, std::size_t begin, std::size_t end, PairBuffer& out) {
    if (g.map.hashed) {
        all_in_hashed_level(g, g.begin[begin], g.begin[end], out);
    } else {
        all_in_table(g, begin, end, out);
    }
}

void all_between(const GridLevel& finer, std::size_t begin, std::size_t end, const GridLevel& g, PairBuffer& out) {
    for (std::size_t i = finer.begin[begin]; i < finer.begin[end] && !out.is_full(); ++i) {
        float lower_here[3], upper_here[3], lower[3], upper[3];
        read_box(finer.entries, i, lower_here, upper_here);
        if (!(lower_here[0] <= upper_here[0])) continue;
        for (int k = 0; k < 3; ++k) {  // from the axes of one level to those of the other
            for (int m = 0; m < 3; ++m) {
                if (finer.map.axes[m] != g.map.axes[k]) continue;
                lower[k] = lower_here[m];
                upper[k] = upper_here[m];
            }
        }
        const Tag tag = static_cast<Tag>(finer.entries.tag[i]);
        const WideBox box(lower, upper);
        const CellRange r = cells_near(g.map, lower, upper);
        if (is_wide(g, r)) {
            scan_run<false>(g, 0, g.end(), 0, box, tag, out);
        } else if (g.map.hashed) {
            for_runs_of_range(g, r, [&](std::size_t first, std::size_t last, std::uint32_t code) {
                scan_run<true>(g, first, last, code, box, tag, out);
            });
        } else {
            for_runs_of_range(
                g, r, [&](std::size_t first, std::size_t last, std::uint32_t) { scan_run<false>(g, first, last, 0, box, tag, out); });
        }
    }
}

HWY_INLINE Mover turned(const Mover& m, const int axes[3]) {
    Mover t;
    for (int k = 0; k < 3; ++k) {
        t.lower[k] = m.lower[axes[k]];
        t.upper[k] = m.upper[axes[k]];
        t.old_lower[k] = m.old_lower[axes[k]];
        t.old_upper[k] = m.old_upper[axes[k]];
    }
    t.tag = m.tag;
    return t;
}

HWY_INLINE std::size_t count_rows(const CellRange& r) {
    return std::size_t{r.last[1] - r.first[1] + 1} * (r.last[2] - r.first[2] + 1);
}

// Around where the box was and is, if it did not go far: then one search does for both.
HWY_INLINE bool cells_of_way(const CellMap& map, const Mover& m, CellRange& range) {
    float lower[3], upper[3];
    for (int k = 0; k < 3; ++k) {
        lower[k] = m.old_lower[k] < m.lower[k] ? m.old_lower[k] : m.lower[k];
        upper[k] = m.old_upper[k] > m.upper[k] ? m.old_upper[k] : m.upper[k];
    }
    range = cells_near(map, lower, upper);
    return count_rows(range) <= 2 * count_rows(cells_near(map, m.lower, m.upper));
}

// Calls scan(first, last) for the entries that a box may overlap, some maybe twice.
template <class F>
HWY_INLINE void for_runs_near(const GridLevel& g, const CellRange& r, F scan_run) {
    if (is_wide(g, r)) return scan_run(std::size_t{0}, g.stray_begin);
    for_runs_of_range(g, r, [&](std::size_t first, std::size_t last, std::uint32_t) { scan_run(first, last); });
}

// A pair found twice is one pair once the list is sorted.
void changed_of_level(const GridLevel& g, std::span<const Mover> movers, PairBuffer& begun, PairBuffer* ended) {
    const EntryView e(g.entries);
    for (const Mover& unturned : movers) {
        if (begun.is_full()) return;
        const Mover m = turned(unturned, g.map.axes);
        const MovedBox box(m);
        if (ended == nullptr) {
            const auto find = [&](std::size_t first, std::size_t last) { scan_begun(e, first, last, box, begun); };
            for_runs_near(g, cells_near(g.map, m.lower, m.upper), find);
            find(g.stray_begin, g.stray_end);
            continue;
        }
        const auto find = [&](std::size_t first, std::size_t last) { scan_changed(e, first, last, box, begun, *ended); };
        const bool is_now = m.lower[0] <= m.upper[0], was_before = m.old_lower[0] <= m.old_upper[0];
        CellRange way;
        if (is_now && was_before && cells_of_way(g.map, m, way)) {
            for_runs_near(g, way, find);
        } else {
            if (is_now) for_runs_near(g, cells_near(g.map, m.lower, m.upper), find);
            if (was_before) for_runs_near(g, cells_near(g.map, m.old_lower, m.old_upper), find);
        }
        find(g.stray_begin, g.stray_end);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace carom::detail {

HWY_EXPORT(all_of_level);
HWY_EXPORT(all_between);
HWY_EXPORT(changed_of_level);

void find_all_in_level(const GridLevel& level, std::size_t first, std::size_t last, PairBuffer& out) {
    HWY_DYNAMIC_DISPATCH(all_of_level)(level, first, last, out);
}
void find_all_between(const GridLevel& finer, std::size_t first, std::size_t last, const GridLevel& coarser, PairBuffer& out) {
    HWY_DYNAMIC_DISPATCH(all_between)(finer, first, last, coarser, out);
}
void find_changed_in_level(const GridLevel& level, std::span<const Mover> movers, PairBuffer& begun, PairBuffer* ended) {
    HWY_DYNAMIC_DISPATCH(changed_of_level)(level, movers, begun, ended);
}

}  // namespace carom::detail

#endif  // HWY_ONCE
