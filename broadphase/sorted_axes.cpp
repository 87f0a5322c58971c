// Persistent sweep-and-prune: the ends of all boxes stay sorted along three axes.
//
// A box that moves a little passes a few ends; where its lower end passes another's upper end downward, or its upper end
// another's lower end upward, the two may have begun to overlap (Baraff 1992; Cohen et al. 1995, "I-COLLIDE"; Terdiman 2007,
// "Sweep-and-prune", for the arrays). Best where few boxes move little. Lower ends come before upper ends of the same value, so
// boxes that touch overlap.
#include <carom/broadphase/detail/method.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/core/radix_sort.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

constexpr std::size_t kEntriesAPiece = 256;

/// (ordered value, upper or not, slot): sorts as a number.
using End = std::uint64_t;
End end_of(float value, bool upper, std::uint32_t slot) noexcept {
    const float no_sign = value + 0.0f;  // zeros of both signs are one value
    return (End{ordered_key(no_sign)} << 32) | (End{upper} << 31) | slot;
}
bool is_upper(End end) noexcept { return ((end >> 31) & 1u) != 0; }
std::uint32_t slot_of(End end) noexcept { return static_cast<std::uint32_t>(end) & 0x7fffffffu; }

class SortedAxes final : public Method {
public:
    // A mover passes the more ends the more boxes there are, and a new box passes a good part of all.
    [[nodiscard]] bool prefers_all(const ProxyTable& table, const ChangeLists& changes) const noexcept override {
        return 4 * changes.moved.size() > table.live_count || 64 * changes.inserted.size() > table.live_count + 512;
    }
    void find_all(const ProxyTable& table, Executor& executor, PairPieces& out) override;
    void find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) override;
    void visit_near(const ProxyTable& table, const FloatAabb& box, FunctionRef<bool(std::uint32_t)> visit) const override {
        for (const End end : axis_[0].ends) {
            const std::uint32_t slot = slot_of(end);
            if (is_upper(end)) continue;
            if (table.boxes[slot].lower.x > box.upper.x) return;
            if (overlaps(table.boxes[slot], box) && !visit(slot)) return;
        }
    }
    void visit_ends(const ProxyTable& table, FunctionRef<void(const BroadphaseEnd&)> visit) const override {
        for (int k = 0; k < 3; ++k) {
            for (const End end : axis_[k].ends) {
                const FloatAabb& box = table.boxes[slot_of(end)];
                visit({k, is_upper(end) ? box.upper[k] : box.lower[k], is_upper(end), slot_of(end)});
            }
        }
    }
    [[nodiscard]] std::size_t memory() const noexcept override {
        std::size_t sum = entries_.memory() + sizeof(std::uint64_t) * scratch_.keys.capacity() +
                          sizeof(std::uint32_t) * (payload_.capacity() + scratch_.payload.capacity());
        for (const Axis& axis : axis_) sum += sizeof(End) * axis.ends.capacity() + sizeof(std::uint32_t) * axis.place.capacity();
        return sum;
    }

private:
    struct Axis {
        std::vector<End> ends;             // ascending
        std::vector<std::uint32_t> place;  // of each slot's lower and upper end
    };
    [[nodiscard]] int widest_axis(const ProxyTable& table) const noexcept;
    void forget(const ProxyTable& table, Axis& axis);
    void shift(const ProxyTable& table, Axis& axis, End end, PairBuffer& out);

    Axis axis_[3];
    Entries entries_;
    std::vector<std::uint32_t> payload_;
    RadixScratch scratch_;
};

int SortedAxes::widest_axis(const ProxyTable& table) const noexcept {
    int best = 0;
    double most = -1.0;
    for (int k = 0; k < 3; ++k) {
        double sum = 0.0, squares = 0.0, n = 0.0, origin = 0.0;
        for (std::size_t slot = 0; slot < table.boxes.size(); ++slot) {
            if (table.alive[slot] == 0) continue;
            if (n == 0.0) origin = double(table.boxes[slot].lower[k]);
            const double x = double(table.boxes[slot].lower[k]) - origin;
            sum += x;
            squares += x * x;
            n += 1.0;
        }
        const double variance = n > 0.0 ? squares / n - (sum / n) * (sum / n) : 0.0;
        if (variance > most) {
            most = variance;
            best = k;
        }
    }
    return best;
}

void SortedAxes::find_all(const ProxyTable& table, Executor& executor, PairPieces& out) {
    const std::size_t slots = table.boxes.size();
    for (int k = 0; k < 3; ++k) {
        Axis& axis = axis_[k];
        axis.ends.clear();
        axis.place.resize(2 * slots);
        for (std::size_t i = 0; i < slots; ++i) {
            if (table.alive[i] == 0) continue;
            const auto slot = static_cast<std::uint32_t>(i);
            axis.ends.push_back(end_of(table.boxes[i].lower[k], false, slot));
            axis.ends.push_back(end_of(table.boxes[i].upper[k], true, slot));
        }
        payload_.resize(axis.ends.size());
        radix_sort(axis.ends, payload_, scratch_);
        for (std::size_t i = 0; i < axis.ends.size(); ++i) {
            axis.place[2 * slot_of(axis.ends[i]) + is_upper(axis.ends[i])] = static_cast<std::uint32_t>(i);
        }
    }
    const int swept = widest_axis(table);
    const int axes[3] = {swept, (swept + 1) % 3, (swept + 2) % 3};
    entries_.grow(table.live_count + Entries::kSentinels);
    std::size_t n = 0;
    for (const End end : axis_[swept].ends) {
        if (is_upper(end)) continue;
        const std::uint32_t slot = slot_of(end);
        entries_.set(n++, table.boxes[slot], axes, slot | (table.movable[slot] != 0 ? 0 : kImmovable));
    }
    entries_.close(n);
    const std::size_t pieces = (n + kEntriesAPiece - 1) / kEntriesAPiece;
    out.begin(pieces, out.limit());
    executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end && !out.is_full(); ++k) {
            find_overlaps(entries_, k * kEntriesAPiece, std::min((k + 1) * kEntriesAPiece, n), n, Order::Sorted, out[k]);
            out.found(out[k].size());
        }
    });
}

// Takes out the ends of slots that are free now.
void SortedAxes::forget(const ProxyTable& table, Axis& axis) {
    std::size_t kept = 0;
    for (const End end : axis.ends) {
        if (table.alive[slot_of(end)] == 0) continue;
        axis.place[2 * slot_of(end) + is_upper(end)] = static_cast<std::uint32_t>(kept);
        axis.ends[kept++] = end;
    }
    axis.ends.resize(kept);
}

// Moves an end from where it stands to where it belongs. Of a pair that begins to overlap some lower end must pass an upper end downward,
// or the upper one the lower one upward, whatever else moved before or moves after; the boxes are the final ones.
void SortedAxes::shift(const ProxyTable& table, Axis& axis, End end, PairBuffer& out) {
    const std::uint32_t slot = slot_of(end);
    const bool upper = is_upper(end);
    std::size_t at = axis.place[2 * slot + upper];
    const auto meet = [&](std::uint32_t other) {
        if (!out.is_full() && other != slot && (table.movable[slot] | table.movable[other]) != 0 &&
            overlaps(table.boxes[slot], table.boxes[other])) {
            out.add(slot, other);
        }
    };
    const auto put = [&](End passed, std::size_t place) {
        axis.ends[place] = passed;
        axis.place[2 * slot_of(passed) + is_upper(passed)] = static_cast<std::uint32_t>(place);
    };
    for (; at > 0 && axis.ends[at - 1] > end; --at) {
        if (!upper && is_upper(axis.ends[at - 1])) meet(slot_of(axis.ends[at - 1]));
        put(axis.ends[at - 1], at);
    }
    for (; at + 1 < axis.ends.size() && axis.ends[at + 1] < end; ++at) {
        if (upper && !is_upper(axis.ends[at + 1])) meet(slot_of(axis.ends[at + 1]));
        put(axis.ends[at + 1], at);
    }
    put(end, at);
}

void SortedAxes::find_moved(const ProxyTable& table, const ChangeLists& changes, Executor& executor, PairPieces& out) {
    out.begin(3, out.limit());
    executor.parallel_for(3, 1, [&](std::size_t begin, std::size_t last) {
        for (std::size_t k = begin; k < last; ++k) {
            Axis& axis = axis_[k];
            const auto along = static_cast<int>(k);
            axis.place.resize(2 * table.boxes.size());
            if (!changes.removed.empty()) forget(table, axis);
            for (const std::uint32_t slot : changes.inserted) {
                for (const bool upper : {false, true}) {
                    axis.place[2 * slot + upper] = static_cast<std::uint32_t>(axis.ends.size());
                    axis.ends.push_back(~End{0} << 31 | End{upper} << 31 | slot);  // beyond all others
                }
            }
            for (const auto& list : {changes.moved, changes.inserted}) {
                for (const std::uint32_t slot : list) {
                    shift(table, axis, end_of(table.boxes[slot].lower[along], false, slot), out[k]);
                    shift(table, axis, end_of(table.boxes[slot].upper[along], true, slot), out[k]);
                }
            }
            out.found(out[k].size());
        }
    });
    // A box that counted for nothing before, though it was there, has its filter changed: no end of it need pass another.
    for (const std::uint32_t slot : changes.moved) {
        if (table.previous[slot] != kNowhere) continue;
        for (std::uint32_t other = 0; other < table.boxes.size() && !out[0].is_full(); ++other) {
            const bool meets = (table.movable[slot] | table.movable[other]) != 0 && overlaps(table.boxes[slot], table.boxes[other]);
            if (meets && other != slot) out[0].add(slot, other);
        }
    }
    if (out[0].is_full()) out.found(out[0].size());
}

}  // namespace

std::unique_ptr<Method> make_sorted_axes() { return std::make_unique<SortedAxes>(); }

}  // namespace carom::detail
