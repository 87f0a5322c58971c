// Runs of boxes against one box, many at once: what the kernels of brute force, sweep-and-prune and the grids share.
//
//   scan_begun(entries, first, last, MovedBox(mover), out);     // inside a kernel file, after core/lanes.hpp

// This guard lets the file through once for each target.
#if defined(CAROM_BROADPHASE_SCAN_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROM_BROADPHASE_SCAN_HPP
#undef CAROM_BROADPHASE_SCAN_HPP
#else
#define CAROM_BROADPHASE_SCAN_HPP
#endif

#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/core/lanes.hpp>

HWY_BEFORE_NAMESPACE();
namespace carom::detail::HWY_NAMESPACE {
namespace {

using namespace carom::HWY_NAMESPACE;

// Adds the pairs of `mine` with the lanes of `hit`, without a branch on how many there are.
HWY_INLINE void add_pairs(Ints mine, Ints others, Mask hit, PairBuffer& out) {
    out.make_room(kLanes);
    store_unaligned(mine, out.next_first());
    out.added(compress_store(others, hit, out.next_second()));
}

// One box in every lane.
struct WideBox {
    Floats lower0, lower1, lower2, upper0, upper1, upper2;
    HWY_INLINE WideBox(const float lower[3], const float upper[3])
        : lower0(lower[0]), lower1(lower[1]), lower2(lower[2]), upper0(upper[0]), upper1(upper[1]), upper2(upper[2]) {}
};

// Where the entries' arrays are: in registers, as the compiler must think that stores of pairs could change the vectors.
struct EntryView {
    const float *lower0, *lower1, *lower2, *upper0, *upper1, *upper2;
    const std::int32_t* tag;
    HWY_INLINE EntryView(const Entries& e)
        : lower0(e.lower[0].data()),
          lower1(e.lower[1].data()),
          lower2(e.lower[2].data()),
          upper0(e.upper[0].data()),
          upper1(e.upper[1].data()),
          upper2(e.upper[2].data()),
          tag(e.tag.data()) {}
};

// Entries j .. j + kLanes - 1 that overlap the box.
HWY_INLINE Mask overlapping(const EntryView& e, std::size_t j, const WideBox& box) {
    return (load_unaligned(e.lower0 + j) <= box.upper0) & (load_unaligned(e.upper0 + j) >= box.lower0) &
           (load_unaligned(e.lower1 + j) <= box.upper1) & (load_unaligned(e.upper1 + j) >= box.lower1) &
           (load_unaligned(e.lower2 + j) <= box.upper2) & (load_unaligned(e.upper2 + j) >= box.lower2);
}

// Pairs of the box with entries j in [first, last) where counts(j) is true. Reads up to kLanes - 1 entries beyond.
template <class F>
HWY_INLINE void scan(const EntryView& e, std::size_t first, std::size_t last, const WideBox& box, Tag tag, PairBuffer& out, F counts) {
    for (std::size_t j = first; j < last; j += kLanes) {
        Mask hit = overlapping(e, j, box);
        if (none(hit)) continue;
        if (last - j < kLanes) hit = hit & first_lanes(static_cast<int>(last - j));
        const Ints tags = load_unaligned(e.tag + j), mine{static_cast<std::int32_t>(tag)};
        hit = hit & counts(j) & ((tags & mine & Ints{static_cast<std::int32_t>(kImmovable)}) == Ints{0});
        const Ints index{static_cast<std::int32_t>(kIndexMask)};
        add_pairs(mine & index, tags & index, hit, out);
    }
}

// A box now and before.
struct MovedBox {
    WideBox now, before;
    Tag tag;
    HWY_INLINE explicit MovedBox(const Mover& m) : now(m.lower, m.upper), before(m.old_lower, m.old_upper), tag(m.tag) {}
};

// Pairs that began with entries in [first, last), as find_begun tells.
HWY_INLINE void scan_begun(const EntryView& e, std::size_t first, std::size_t last, const MovedBox& box, PairBuffer& out) {
    for (std::size_t j = first; j < last; j += kLanes) {
        Mask hit = overlapping(e, j, box.now);
        if (none(hit)) continue;
        if (last - j < kLanes) hit = hit & first_lanes(static_cast<int>(last - j));
        const Ints tags = load_unaligned(e.tag + j), mine{static_cast<std::int32_t>(box.tag)};
        const Mask stood_still = (tags & Ints{static_cast<std::int32_t>(kMoved)}) == Ints{0};
        const Ints index{static_cast<std::int32_t>(kIndexMask)};
        // Of two that moved, each would find the other: the lesser does.
        hit = hit & select(stood_still, !overlapping(e, j, box.before), (mine & index) < (tags & index));
        hit = hit & ((tags & mine & Ints{static_cast<std::int32_t>(kImmovable)}) == Ints{0});
        if (any(hit)) add_pairs(mine & index, tags & index, hit, out);
    }
}

// The same, and the pairs that ended with entries that stood still.
HWY_INLINE void scan_changed(const EntryView& e, std::size_t first, std::size_t last, const MovedBox& box, PairBuffer& begun,
                             PairBuffer& ended) {
    for (std::size_t j = first; j < last; j += kLanes) {
        const Mask there = first_lanes(static_cast<int>(last - j < kLanes ? last - j : kLanes));
        const Mask now = overlapping(e, j, box.now) & there, before = overlapping(e, j, box.before) & there;
        if (none(now | before)) continue;
        const Ints tags = load_unaligned(e.tag + j), mine{static_cast<std::int32_t>(box.tag)};
        const Ints index{static_cast<std::int32_t>(kIndexMask)};
        const Mask may_meet = (tags & mine & Ints{static_cast<std::int32_t>(kImmovable)}) == Ints{0};
        const Mask stood_still = may_meet & ((tags & Ints{static_cast<std::int32_t>(kMoved)}) == Ints{0});
        // Of two that moved, each would find the other: the lesser does.
        const Mask both_moved = may_meet & !stood_still & ((mine & index) < (tags & index));
        const Mask begins = now & ((stood_still & !before) | both_moved), ends = before & !now & stood_still;
        if (any(begins)) add_pairs(mine & index, tags & index, begins, begun);
        if (any(ends)) add_pairs(mine & index, tags & index, ends, ended);
    }
}

}  // namespace
}  // namespace carom::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
