#include <carom/broadphase/detail/intake.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <utility>

namespace carom::detail {
namespace {

constexpr std::size_t kMostSlots = (std::size_t{1} << 28) - 1;

bool is_ordered(const FloatAabb& box) noexcept {
    return (box.lower.x <= box.upper.x) & (box.lower.y <= box.upper.y) & (box.lower.z <= box.upper.z);
}

bool is_finite_box(const FloatAabb& box) noexcept {
    // The difference of two floats of either sign is finite in double.
    const double sum = (double(box.lower.x) - double(box.upper.x)) + (double(box.lower.y) - double(box.upper.y)) +
                       (double(box.lower.z) - double(box.upper.z));
    return sum - sum == 0.0;
}

}  // namespace

void Intake::Look::add(const Look& other) noexcept {
    beyond |= other.beyond;
    gone |= other.gone;
    ordered &= other.ordered;
    finite &= other.finite;
    ascending &= other.ascending;
}

Intake::Look Intake::look_at(const ProxyChanges& changes, std::size_t first, std::size_t last) const noexcept {
    Look look;
    std::uint32_t before = first == 0 ? 0 : changes.moved[first - 1];
    look.ascending = first == 0 || before < changes.moved[first];
    for (std::size_t i = first; i < last; ++i) {
        const std::uint32_t slot = changes.moved[i];
        look.ascending &= i == first || before < slot;
        before = slot;
        if (slot >= changes.bounds.size()) {
            look.beyond = true;
            continue;
        }
        look.gone |= changed_.test(slot);
        look.ordered &= is_ordered(changes.bounds[slot]);
        look.finite &= is_finite_box(changes.bounds[slot]);
    }
    return look;
}

const char* Intake::find_fault(const ProxyChanges& changes, const ProxyTable& table, Executor& executor) {
    const std::size_t n = changes.bounds.size();
    if (n != changes.filters.size()) return "bounds and filters differ in size";
    if (n > kMostSlots) return "2^28 slots or more";
    changed_.reset(std::max(n, table.boxes.size()));
    for (const std::uint32_t slot : changes.removed) {
        if (slot >= table.alive.size() || table.alive[slot] == 0) return "a removed slot is not alive";
        if (changed_.test(slot)) return "a slot is removed twice";
        changed_.set(slot);
    }
    cut_moved(changes, executor);
    executor.parallel_for(shares_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) shares_[k].look = look_at(changes, shares_[k].first, shares_[k].last);
    });
    Look all;
    for (const Share& share : shares_) all.add(share.look);
    moved_ascend_ = all.ascending;
    if (all.beyond) return "a moved slot has no bounds";
    if (all.gone) return "a slot is both moved and removed";
    if (!all.finite) return "a bound is not finite";
    return all.ordered ? nullptr : "a box has lower > upper";
}

// Stretches of the moved slots, a few for each thread. Where slots ascend, no two stretches have slots of one word of bits.
void Intake::cut_moved(const ProxyChanges& changes, Executor& executor) {
    constexpr std::size_t kFewest = 4096, kSharesAThread = 4;
    const std::size_t count = changes.moved.size(), threads = static_cast<std::size_t>(executor.thread_count());
    const std::size_t wanted = threads == 1 ? 1 : std::clamp<std::size_t>(count / kFewest, 1, kSharesAThread * threads);
    shares_.clear();
    for (std::size_t k = 1, first = 0; k <= wanted; ++k) {
        std::size_t last = k == wanted ? count : count * k / wanted;
        while (last > first && last < count && changes.moved[last] / 32 == changes.moved[last - 1] / 32) ++last;
        if (last > first) shares_.push_back({.first = first, .last = last});
        first = std::max(first, last);
    }
}

void Intake::take_moved(const ProxyChanges& changes, std::uint32_t slot, Share& share, ProxyTable& table) {
    const FloatAabb& box = changes.bounds[slot];
    const ProxyFilter& filter = changes.filters[slot];
    const bool is_new = table.alive[slot] == 0;
    const bool same_filter = !is_new && table.filters[slot] == filter && !ask_again_;
    if ((same_filter && table.boxes[slot] == box) || changed_.test(slot)) return;
    changed_.set(slot);
    table.previous[slot] = same_filter ? table.boxes[slot] : kNowhere;
    table.boxes[slot] = box;
    if (!same_filter) {
        table.filters[slot] = filter;
        table.movable[slot] = filter.movable ? 1 : 0;
        share.common_bits &= filter.layer & filter.mask;
        share.filter_changed |= !is_new;
    }
    table.alive[slot] = 1;
    if (is_new)
        inserted_[share.first + share.inserted++] = slot;
    else
        moved_[share.first + share.moved++] = slot;
}

// The removed slots are marked as changed already.
void Intake::take_over(const ProxyChanges& changes, bool ask_again, ProxyTable& table, Executor& executor) {
    const std::size_t n = std::max(changes.bounds.size(), table.boxes.size());
    if (table.boxes.size() < n) {
        table.boxes.resize(n, kNowhere);
        table.previous.resize(n, kNowhere);
        table.filters.resize(n);
        table.movable.resize(n, 0);
        table.alive.resize(n, 0);
    }
    ask_again_ = ask_again;
    removed_.assign(changes.removed.begin(), changes.removed.end());
    for (const std::uint32_t slot : removed_) {
        table.previous[slot] = std::exchange(table.boxes[slot], kNowhere);
        table.alive[slot] = 0;
    }
    moved_.resize(changes.moved.size());
    inserted_.resize(changes.moved.size());
    const auto take_share = [&](Share& share) {
        constexpr std::size_t kAhead = 12;  // slots may be anywhere in memory
        for (std::size_t i = share.first; i < share.last; ++i) {
            if (i + kAhead < share.last) {
                const std::uint32_t later = changes.moved[i + kAhead];
                hwy::Prefetch(&changes.filters[later]);
                hwy::Prefetch(&table.filters[later]);
                hwy::Prefetch(&table.boxes[later]);
                hwy::Prefetch(&table.previous[later]);
            }
            take_moved(changes, changes.moved[i], share, table);
        }
    };
    if (moved_ascend_) {
        executor.parallel_for(shares_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) take_share(shares_[k]);
        });
    } else {
        for (Share& share : shares_) take_share(share);  // a slot may be listed twice, in two of them
    }
    close_gaps();
    table.live_count += inserted_.size();
    table.live_count -= removed_.size();
}

void Intake::close_gaps() {
    std::size_t moved_count = 0, inserted_count = 0;
    filter_changed_ = false;
    const auto to_front = [](std::vector<std::uint32_t>& list, std::size_t first, std::size_t count, std::size_t& end) {
        if (first != end) std::copy_n(list.begin() + static_cast<std::ptrdiff_t>(first), count, list.begin() + static_cast<std::ptrdiff_t>(end));
        end += count;
    };
    for (const Share& share : shares_) {
        to_front(moved_, share.first, share.moved, moved_count);
        to_front(inserted_, share.first, share.inserted, inserted_count);
        common_bits_ &= share.common_bits;
        filter_changed_ |= share.filter_changed;
    }
    moved_.resize(moved_count);
    inserted_.resize(inserted_count);
}

std::size_t Intake::memory() const noexcept {
    return sizeof(std::uint32_t) * (moved_.capacity() + inserted_.capacity() + removed_.capacity() + changed_.size()) +
           sizeof(Share) * shares_.capacity();
}

}  // namespace carom::detail
