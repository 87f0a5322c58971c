#include <carom/narrowphase/detail/batch_memory.hpp>

#include <algorithm>
#include <bit>

namespace carom::detail {
namespace {

constexpr std::size_t kWidth = kBundleWidth;
constexpr std::size_t kGrain = 512;

// Pairs [begin, end), at most sixteen.
ReuseBundle bundle_of(std::span<const NumberedPair> pairs, std::size_t begin, std::size_t end) noexcept {
    ReuseBundle bundle;
    for (std::size_t lane = 0; lane < kWidth; ++lane) {
        bundle.slack.lane[lane] = -1.0f;
        if (begin + lane >= end || pairs[begin + lane].last == kNewPair) continue;
        const NumberedPair& pair = pairs[begin + lane];
        bundle.a.lane[lane] = static_cast<std::int32_t>(pair.a);
        bundle.b.lane[lane] = static_cast<std::int32_t>(pair.b);
        bundle.last.lane[lane] = static_cast<std::int32_t>(pair.last);
        bundle.margin.lane[lane] = pair.margin;
        if (pair.slack > 0.0f) bundle.slack.lane[lane] = pair.slack;
    }
    return bundle;
}

PairRecord drifted(PairRecord record, const DriftBundle& drift, std::size_t lane) noexcept {
    for (int k = 0; k < 3; ++k) {
        record.shift[k] = drift.shift[k].lane[lane];
        record.turn[k] = drift.turn[k].lane[lane];
    }
    record.rest = drift.rest.lane[lane];
    --record.state;
    return record;
}

void set_move(MoveBundle& bundle, std::size_t lane, std::size_t from, std::size_t to, const NumberedPair& pair, std::size_t number) noexcept {
    bundle.from.lane[lane] = static_cast<std::int32_t>(from);
    bundle.to.lane[lane] = static_cast<std::int32_t>(to);
    bundle.a.lane[lane] = static_cast<std::int32_t>(pair.a);
    bundle.b.lane[lane] = static_cast<std::int32_t>(pair.b);
    bundle.pair.lane[lane] = static_cast<std::int32_t>(number);
}

}  // namespace

void BatchMemory::compare(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor) {
    const std::size_t count = placed.shapes.size(), known = std::min(poses_.size(), count);
    lines_.resize(count);
    traits_.resize(count);
    executor.parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            if (placed.shapes[k] == nullptr) continue;
            traits_[k] = trait_of(*placed.shapes[k]);
            if (k < known) lines_[k] = motion_line(*placed.shapes[k], poses_[k], placed.poses[k]);
        }
    });
    next_.resize(pairs.size());
    reused_.assign(pairs.size(), 0);
    if (records_.empty()) return;
    executor.parallel_for(pairs.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = begin; first < end; first += kWidth) {
            DriftBundle drift;
            const std::uint32_t found = find_reusable(lines_, bundle_of(pairs, first, end), records_, drift);
            for (std::uint32_t left = found; left != 0; left &= left - 1) {
                const auto lane = static_cast<std::size_t>(std::countr_zero(left));
                const std::size_t i = first + lane;
                reused_[i] = 1;
                next_[i] = drifted(records_[pairs[i].last], drift, lane);
            }
        }
    });
}

void BatchMemory::carry(std::span<const NumberedPair> pairs, std::size_t begin, std::size_t end, std::span<const std::size_t> starts,
                        std::span<const Manifold> last, Manifold* out) const {
    MoveBundle moves;
    std::size_t count = 0;
    const auto flush = [&] {
        for (std::size_t lane = count; lane < kWidth; ++lane) set_move(moves, lane, 0, kNoMove, {}, 0);
        if (count > 0) move_manifolds(lines_, {&moves, 1}, last, out);
        count = 0;
    };
    for (std::size_t i = begin; i < end; ++i) {
        if (!reuses(i)) continue;
        const PairRecord& from = record(pairs[i]);
        for (std::size_t k = 0; k < from.count; ++k) {
            set_move(moves, count, from.first + k, starts[i - begin] + k, pairs[i], i);
            if (++count == kWidth) flush();
        }
    }
    flush();
}

void BatchMemory::finish(const PlacedShapes& placed, std::size_t manifolds) {
    std::swap(records_, next_);
    poses_.assign(placed.poses.begin(), placed.poses.end());
    manifold_count_ = manifolds;
}

void BatchMemory::forget() noexcept {
    records_.clear();
    poses_.clear();
    manifold_count_ = 0;
}

}  // namespace carom::detail
