// Many pairs at once.
#include <carom/core/check.hpp>
#include <carom/narrowphase/detail/convex_query.hpp>
#include <carom/narrowphase/detail/finite_poses.hpp>
#include <carom/narrowphase/detail/pair_lanes.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

namespace carom {
namespace {

constexpr std::size_t kChunk = 256;  // pairs whose lane results lie on the stack at once; no bits depend on it

// The sum of a pose's numbers, which is finite only where all of them are; where it is not, they still may be.
double sum_of(const Pose& p) noexcept {
    const dquat& q = p.orientation;
    return ((p.position.x + p.position.y) + (p.position.z + q.x)) + ((q.y + q.z) + q.w);
}

// What is wrong with one pair, or nothing.
detail::PairFault find_fault(const PlacedShapes& placed, const NumberedPair& pair) noexcept {
    if (pair.a >= placed.shapes.size() || pair.b >= placed.shapes.size()) return {"distance: a pair names a shape beyond the last"};
    const Shape *const a = placed.shapes[pair.a], *const b = placed.shapes[pair.b];
    if (a == nullptr || b == nullptr) return {"distance: a shape is null"};
    return detail::query_fault(*a, placed.poses[pair.a], *b, placed.poses[pair.b]);
}

// The bounded shapes that need no other look; hulls are looked at for null.
bool plainly_fit(const Shape* shape) noexcept {
    if (shape == nullptr) return false;
    const ConvexHullPtr* const hull = std::get_if<ConvexHullPtr>(shape);
    return hull != nullptr ? *hull != nullptr : is_convex_solid(type_of(*shape));
}

detail::PairFault find_fault(const PlacedShapes& placed, std::span<const NumberedPair> pairs) noexcept {
    if (placed.shapes.size() != placed.poses.size()) return {"distance: shapes and poses differ in number"};
    const std::size_t count = placed.shapes.size();
    // All poses in one go, unless few of them are asked for; those of null shapes are not to be read, which the second look minds.
    const bool finite = count <= 8 * pairs.size() && detail::poses_are_finite(placed.poses);
    for (const NumberedPair& p : pairs) {
        const bool fit = p.a < count && p.b < count && plainly_fit(placed.shapes[p.a]) && plainly_fit(placed.shapes[p.b]) &&
                         (finite || is_finite(sum_of(placed.poses[p.a]) + sum_of(placed.poses[p.b])));
        if (fit) continue;
        if (const detail::PairFault fault = find_fault(placed, p); fault.what != nullptr) return fault;
    }
    return {};
}

// What many pairs at once take, sorted by the kernel that takes them.
struct Chunk {
    std::array<detail::LaneBoxes, kChunk> boxes;
    std::array<detail::LaneCores, kChunk> cores;
    std::array<std::uint16_t, kChunk> box_of, core_of;  // pair in the chunk
    std::array<Overlap, kChunk> of_boxes;
    std::array<detail::LaneResult, kChunk> of_cores;
    std::size_t box_count = 0, core_count = 0;
    std::size_t leading = 0;  // pairs of boxes before the first other one
};
// Kept from call to call, since clearing it takes as long as the work.
Chunk& thread_chunk() {
    thread_local Chunk chunk;
    return chunk;
}

// @return whether the lanes take shapes of this kind.
bool lane_core(const Shape& shape, detail::LaneCore& core) noexcept {
    if (const ConvexHullPtr* hull = std::get_if<ConvexHullPtr>(&shape)) {
        const auto points = (*hull)->vertex_bundles();
        core = {points.data(), static_cast<std::uint32_t>(points.size()), vec3{0.0f}, 1.0001f * static_cast<float>((*hull)->reach()), 0.0f};
        return true;
    }
    if (const Box* box = std::get_if<Box>(&shape)) {
        const vec3& h = box->half_extents;
        core = {nullptr, 0, h, h.x + h.y + h.z, 0.0f};
        return true;
    }
    if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
        core = {nullptr, 0, {0.0f, capsule->half_segment, 0.0f}, capsule->half_segment, capsule->radius};
        return true;
    }
    const Sphere* sphere = std::get_if<Sphere>(&shape);
    if (sphere != nullptr) core = {nullptr, 0, vec3{0.0f}, 0.0f, sphere->radius};
    return sphere != nullptr;
}

// One batch: its pairs, and who takes them.
class Batch {
public:
    Batch(const PlacedShapes& placed, std::span<const NumberedPair> pairs) : placed_(placed), pairs_(pairs) {}

    /// Pairs that have been checked; two boxes are for no lanes, which take longer than they do alone.
    void sort(std::size_t first, std::size_t count, Chunk& chunk) const noexcept {
        chunk.box_count = chunk.core_count = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const NumberedPair& p = pairs_[first + i];
            if (!are_boxes(placed_.shapes[p.a], placed_.shapes[p.b])) add_cores(i, p, chunk);
        }
    }
    /// Pairs that have not, two boxes for their own kernel. Whether the poses of boxes are finite is left to that: it proves nothing of others.
    /// @return whether all is well so far; what is not is left out.
    [[nodiscard]] bool sort_and_check(std::size_t first, std::size_t count, Chunk& chunk) const noexcept {
        chunk.leading = add_leading_boxes(first, count, chunk.boxes.data());
        chunk.box_count = chunk.leading;
        chunk.core_count = 0;
        bool fit = true;
        for (std::size_t i = chunk.leading; i < count; ++i) {
            const NumberedPair& p = pairs_[first + i];
            const Shape *const a = shape(p.a), *const b = shape(p.b);
            if (are_boxes(a, b)) {
                chunk.box_of[chunk.box_count] = static_cast<std::uint16_t>(i);
                chunk.boxes[chunk.box_count++] = boxes_of(p, a, b);
            } else if (plainly_fit(a) && plainly_fit(b) && has_finite_poses(i + first)) {
                add_cores(i, p, chunk);
            } else {
                fit = fit && find_fault(placed_, p).what == nullptr;
            }
        }
        return fit;
    }
    [[nodiscard]] bool has_finite_poses(std::size_t i) const noexcept {
        const NumberedPair& p = pairs_[i];
        return is_finite(sum_of(placed_.poses[p.a]) + sum_of(placed_.poses[p.b])) || find_fault(placed_, p).what == nullptr;
    }

    [[nodiscard]] DistanceResult distance_of(std::size_t i, const DistanceSettings& settings, DistanceCache* cache) const noexcept {
        const NumberedPair& p = pairs_[i];
        return detail::pair_distance(*placed_.shapes[p.a], placed_.poses[p.a], *placed_.shapes[p.b], placed_.poses[p.b], settings, cache);
    }
    [[nodiscard]] Overlap verdict_of(std::size_t i) const noexcept {
        const NumberedPair& p = pairs_[i];
        return detail::pair_overlaps(*placed_.shapes[p.a], placed_.poses[p.a], *placed_.shapes[p.b], placed_.poses[p.b], nullptr);
    }

private:
    // @return null for none.
    [[nodiscard]] const Shape* shape(std::uint32_t number) const noexcept {
        return number < placed_.shapes.size() ? placed_.shapes[number] : nullptr;
    }
    [[nodiscard]] static bool are_boxes(const Shape* a, const Shape* b) noexcept {
        return a != nullptr && b != nullptr && std::holds_alternative<Box>(*a) && std::holds_alternative<Box>(*b);
    }
    [[nodiscard]] detail::LaneBoxes boxes_of(const NumberedPair& p, const Shape* a, const Shape* b) const noexcept {
        return {{&placed_.poses[p.a], &placed_.poses[p.b]}, &std::get_if<Box>(a)->half_extents, &std::get_if<Box>(b)->half_extents};
    }
    std::size_t add_leading_boxes(std::size_t first, std::size_t count, detail::LaneBoxes* to) const noexcept {
        const Batch self = *this;  // which no write to `to` changes
        for (std::size_t i = 0; i < count; ++i) {
            const NumberedPair& p = self.pairs_[first + i];
            const Shape *const a = self.shape(p.a), *const b = self.shape(p.b);
            if (!are_boxes(a, b)) return i;
            to[i] = self.boxes_of(p, a, b);
        }
        return count;
    }

    void add_cores(std::size_t i, const NumberedPair& p, Chunk& chunk) const noexcept {
        detail::LaneCores& cores = chunk.cores[chunk.core_count];
        cores.place = {&placed_.poses[p.a], &placed_.poses[p.b]};
        if (lane_core(*placed_.shapes[p.a], cores.a) && lane_core(*placed_.shapes[p.b], cores.b)) {
            chunk.core_of[chunk.core_count++] = static_cast<std::uint16_t>(i);
        }
    }

    PlacedShapes placed_;
    std::span<const NumberedPair> pairs_;
};

void find_distances(const Batch& batch, std::size_t first, std::span<DistanceResult> out, const DistanceSettings& settings) {
    Chunk& chunk = thread_chunk();
    std::array<detail::LaneResult, kChunk>& results = chunk.of_cores;
    batch.sort(first, out.size(), chunk);
    detail::search_cores({chunk.cores.data(), chunk.core_count}, detail::LaneGoal::Distance, results.data());
    std::size_t next = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const bool searched = next < chunk.core_count && chunk.core_of[next] == i;
        detail::LaneResult* const found = searched ? &results[next++] : nullptr;
        if (found != nullptr && found->verdict == Overlap::Overlapping) {
            out[i] = {};
            out[i].status = DistanceStatus::Overlap;
            out[i].iterations = found->rounds;
        } else {
            out[i] = batch.distance_of(first + i, settings, found != nullptr ? &found->simplex : nullptr);
            if (found != nullptr) out[i].iterations += found->rounds;
        }
    }
}

// @return whether the pairs are fit to be asked about; where they are not, verdicts mean nothing.
bool find_verdicts(const Batch& batch, std::size_t first, std::span<Overlap> out) {
    Chunk& chunk = thread_chunk();
    auto& of_boxes = chunk.of_boxes;
    auto& of_cores = chunk.of_cores;
    if (!batch.sort_and_check(first, out.size(), chunk)) return false;
    detail::overlap_boxes({chunk.boxes.data(), chunk.box_count}, of_boxes.data());
    if (chunk.box_count < out.size()) {
        detail::search_cores({chunk.cores.data(), chunk.core_count}, detail::LaneGoal::Verdict, of_cores.data());
        std::ranges::fill(out, Overlap::Undecided);
        for (std::size_t k = 0; k < chunk.core_count; ++k) out[chunk.core_of[k]] = of_cores[k].verdict;
    }
    std::copy_n(of_boxes.begin(), chunk.leading, out.begin());
    for (std::size_t k = chunk.leading; k < chunk.box_count; ++k) out[chunk.box_of[k]] = of_boxes[k];
    for (auto undecided = out.begin(); (undecided = std::find(undecided, out.end(), Overlap::Undecided)) != out.end(); ++undecided) {
        const auto i = static_cast<std::size_t>(undecided - out.begin());
        if (!batch.has_finite_poses(first + i)) return false;
        out[i] = batch.verdict_of(first + i);
    }
    return true;
}

}  // namespace

void distance(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::span<DistanceCache> caches,
              std::vector<DistanceResult>& out, const DistanceSettings& settings) {
    const detail::PairFault fault = find_fault(placed, pairs);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what);
    CAROM_REQUIRE(caches.empty() || caches.size() == pairs.size(), ErrorCode::InvalidArgument,
                  "distance: caches and pairs differ in number");
    const char* const wrong = detail::settings_fault(settings);
    CAROM_REQUIRE(wrong == nullptr, ErrorCode::InvalidArgument, wrong);
    out.resize(pairs.size());
    const Batch batch(placed, pairs);
    executor.parallel_for(pairs.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        if (!caches.empty()) {
            for (std::size_t i = begin; i < end; ++i) out[i] = batch.distance_of(i, settings, &caches[i]);
            return;
        }
        for (std::size_t i = begin; i < end; i += kChunk) {
            find_distances(batch, i, std::span(out).subspan(i, std::min(kChunk, end - i)), settings);
        }
    });
}

void overlaps(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::vector<Overlap>& out) {
    std::atomic<bool> fit{placed.shapes.size() == placed.poses.size()};
    // What is found is kept apart until all pairs have turned out to be fit; the call after this takes over the buffer that `out` has now.
    thread_local std::vector<Overlap> spare;
    std::vector<Overlap> found = std::move(spare);
    if (fit) {
        found.resize(pairs.size());
        const Batch batch(placed, pairs);
        executor.parallel_for(pairs.size(), kChunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; i += kChunk) {
                if (!find_verdicts(batch, i, std::span(found).subspan(i, std::min(kChunk, end - i))))
                    fit.store(false, std::memory_order_relaxed);
            }
        });
    }
    const detail::PairFault fault = fit ? detail::PairFault{} : find_fault(placed, pairs);
    if (fault.what == nullptr) out.swap(found);
    spare = std::move(found);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what);
}

}  // namespace carom
