// Many pairs at once: sorted by kernel, run in chunks of fixed length, laid out in the order of the pairs.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/batch_boxes.hpp>
#include <carom/narrowphase/detail/batch_check.hpp>
#include <carom/narrowphase/detail/batch_memory.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace carom {
namespace {

// Pairs a chunk: enough to hide what a chunk costs, few enough to share among threads. It fixes where results lie, so that neither
// threads nor grain can change them.
constexpr std::size_t kChunk = 128;
// Pairs are run by blocks, whose manifolds wait in the chunks until all before them are counted: a block is all that this takes memory
// for. One of several kinds is longer, so that few of a kernel's lanes idle where its pairs end, and so is one of several threads, which
// wait for each other.
constexpr std::size_t kBlock = 1024, kBlockOfThread = 4096;
constexpr std::uint16_t kReused = detail::kKinds;  // in place of a kind

struct Chunk {
    detail::ManifoldList manifolds;
};

// Where the manifolds of a pair are that was run: in a chunk.
struct Place {
    std::uint32_t chunk = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    bool undecided = false;
};

}  // namespace

struct CollideScratch::Data {
    std::vector<const Shape*> shapes;  // of pairs that bring their own
    std::vector<Pose> poses;
    std::vector<NumberedPair> numbered;
    detail::BatchKinds kinds;
    std::vector<std::uint32_t> order;  // of a block's pairs to be run
    std::vector<Place> places;         // by pair of a block, and so:
    std::vector<std::size_t> starts;   // where its manifolds are to be
    std::vector<Chunk> chunks;
    detail::BoxBatch boxes;
    detail::BatchMemory memory;
};

CollideScratch::CollideScratch() : data_(std::make_unique<Data>()) {}
CollideScratch::~CollideScratch() = default;
CollideScratch::CollideScratch(CollideScratch&&) noexcept = default;
CollideScratch& CollideScratch::operator=(CollideScratch&&) noexcept = default;

struct CollideBatch {
    PlacedShapes placed;
    std::span<const NumberedPair> pairs;
    std::span<const Manifold> last;
    Executor& executor;
    CollideScratch::Data& data;
    bool alone = false;     // knows nothing of the batch before, and is not remembered
    std::size_t block = 0;  // the first pair of the one that is run

    static CollideScratch::Data& data_of(CollideScratch& scratch) {
        if (scratch.data_ == nullptr) scratch.data_ = std::make_unique<CollideScratch::Data>();  // it was moved from
        return *scratch.data_;
    }

    [[nodiscard]] detail::BatchInput input() const noexcept { return {placed, pairs}; }

    [[nodiscard]] bool is_in_order() const { return alone && executor.thread_count() == 1; }

    // @return what is wrong; nothing has changed then. Of few boxes the manifolds are found by the way: `few` says whether they were.
    [[nodiscard]] detail::PairFault look_at_all(bool& few) {
        if (placed.shapes.size() != placed.poses.size()) return {"collide: shapes and poses differ in number"};
        few = is_in_order() && detail::are_few_boxes(input());
        if (!few) return data.kinds.find(input(), {alone ? nullptr : &data.memory, last.size()}, executor);
        const bool proven = data.boxes.find(input());
        return proven || detail::named_poses_are_finite(input()) ? detail::PairFault{} : detail::kPoseNotFinite;
    }

    // Calls `with(kind, begin, end)` for neighbouring pairs of one kind among [from, to): often many.
    template <class With>
    void for_runs(std::size_t from, std::size_t to, const With& with) const {
        for (std::size_t begin = from, end = from; begin < to; begin = end) {
            const std::uint16_t kind = data.kinds.of_pair[begin];
            for (end = begin + 1; end < to && data.kinds.of_pair[end] == kind; ++end) {
            }
            with(std::size_t{kind}, begin, end);
        }
    }

    // Marks the pairs that need not be looked at, and counts the others by kind.
    [[nodiscard]] std::array<std::size_t, detail::kKinds + 1> count_kinds() {
        if (!alone) {
            data.memory.compare(placed, pairs, executor);
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                if (data.memory.reuses(i)) data.kinds.of_pair[i] = kReused;
            }
        }
        std::array<std::size_t, detail::kKinds + 1> counts{};
        for_runs(0, pairs.size(), [&](std::size_t kind, std::size_t begin, std::size_t end) { counts[kind] += end - begin; });
        return counts;
    }

    // Of the pairs [block, end) those that are to be run: a counting sort, stable, so neighbours in the order run the same kernel.
    void sort_by_kernel(std::size_t end) {
        std::array<std::uint32_t, detail::kKinds + 2> starts{};
        for_runs(block, end,
                 [&](std::size_t kind, std::size_t from, std::size_t to) { starts[kind + 1] += static_cast<std::uint32_t>(to - from); });
        for (std::size_t k = 0; k <= detail::kKinds; ++k) starts[k + 1] += starts[k];
        const std::size_t count = starts[kReused];
        data.order.resize(end - block);
        for_runs(block, end, [&](std::size_t kind, std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) data.order[starts[kind] + (i - from)] = static_cast<std::uint32_t>(i);
            starts[kind] += static_cast<std::uint32_t>(to - from);
        });
        data.order.resize(count);
    }

    void run_chunk(std::size_t index) {
        Chunk& chunk = data.chunks[index];
        chunk.manifolds.clear();
        detail::Workspace& workspace = detail::thread_workspace();
        const std::size_t end = std::min(data.order.size(), (index + 1) * kChunk);
        for (std::size_t k = index * kChunk; k < end;) {
            const std::uint16_t kind = data.kinds.of_pair[data.order[k]];
            std::size_t next = k + 1;
            while (next < end && data.kinds.of_pair[data.order[next]] == kind) ++next;
            run_kind({data.order.data() + k, next - k}, static_cast<std::uint32_t>(index), workspace);
            k = next;
        }
    }

    // Pairs of one kind, which are neighbours in the order.
    void run_kind(std::span<const std::uint32_t> chosen, std::uint32_t index, detail::Workspace& workspace) {
        Chunk& chunk = data.chunks[index];
        const detail::KernelEntry& entry = detail::kernel_of(data.kinds.of_pair[chosen.front()]);
        auto first = static_cast<std::uint32_t>(chunk.manifolds.size());
        if (entry.wide != nullptr) {
            entry.wide(input(), chosen, workspace, chunk.manifolds);
            for (const std::uint32_t i : chosen) {
                const std::uint32_t count = first < chunk.manifolds.size() && chunk.manifolds[first].pair == i ? 1u : 0u;
                data.places[i - block] = {index, first, count, false};
                first += count;
            }
            return;
        }
        for (const std::uint32_t i : chosen) {
            const CollideStatus status = detail::run_pair(input().pair(i), entry, i, workspace, chunk.manifolds);
            const auto end = static_cast<std::uint32_t>(chunk.manifolds.size());
            data.places[i - block] = {index, first, end - first, status != CollideStatus::Ok};
            first = end;
        }
    }

    // Of pairs [begin, end) of the block: their manifolds, to where they belong, and what is known of them from now on.
    void finish_pairs(std::size_t begin, std::size_t end, Manifold* out) {
        for (std::size_t i = begin; i < end; ++i) {
            const Place& place = data.places[i - block];
            const std::size_t start = data.starts[i - block];
            const bool reused = data.kinds.of_pair[i] == kReused;
            if (!reused) {
                const Manifold* from = data.chunks[place.chunk].manifolds.data() + place.first;
                std::copy(from, from + place.count, out + start);
            }
            if (alone) continue;
            if (!reused) data.memory.remember(i, pairs[i], place.count > 0, place.undecided);
            data.memory.place(i, start, place.count);
        }
        if (!alone) data.memory.carry(pairs, begin, end, std::span{data.starts}.subspan(begin - block), last, out);
    }

    // Pairs [block, end): those that are not reused are run, and their manifolds wait in the chunks.
    void run_block(std::size_t end) {
        sort_by_kernel(end);
        const std::size_t chunk_count = (data.order.size() + kChunk - 1) / kChunk;
        if (data.chunks.size() < chunk_count) data.chunks.resize(chunk_count);
        executor.parallel_for(chunk_count, 1, [&](std::size_t from, std::size_t to) {
            for (std::size_t c = from; c < to; ++c) run_chunk(c);
        });
    }

    // Their manifolds, to `out` from `start` on. @return how many pairs are undecided.
    std::size_t lay_out_block(std::size_t end, std::size_t start, std::vector<Manifold>& out) {
        std::size_t undecided = 0;
        data.starts[0] = start;
        for (std::size_t i = block; i < end; ++i) {
            Place& place = data.places[i - block];
            if (data.kinds.of_pair[i] == kReused) {
                const detail::PairRecord& record = data.memory.record(pairs[i]);
                place = {0, 0, record.count, (record.state & detail::kUndecided) != 0};
            }
            data.starts[i - block + 1] = data.starts[i - block] + place.count;
            undecided += place.undecided ? 1 : 0;
        }
        const std::size_t needed = data.starts[end - block];
        if (out.capacity() < needed) out.reserve(needed + needed / 8);  // vectors double
        if (out.size() < needed)
            out.resize(needed);  // what it held of another batch is written over, and cleared only where it is too short
        executor.parallel_for(end - block, 256,
                              [&](std::size_t from, std::size_t to) { finish_pairs(block + from, block + to, out.data()); });
        return undecided;
    }

    // @return what is wrong; nothing has changed then.
    [[nodiscard]] detail::PairFault run(std::vector<Manifold>& out, CollideCounts& counts) {
        bool few = false;
        if (const detail::PairFault fault = look_at_all(few); fault.what != nullptr) return fault;
        if (few) {
            data.boxes.give(out);
        } else if (is_in_order() && detail::are_boxes(data.kinds.of_pair)) {
            data.boxes.find(input(), out);
        } else {
            counts = run_blocks(out);
        }
        if (alone) data.memory.forget();
        return {};
    }

    // The same, with the manifolds of each pair to `take`. Alone: nothing is reused.
    [[nodiscard]] detail::PairFault run(TakeManifolds take, CollideCounts& counts) {
        bool few = false;
        if (const detail::PairFault fault = look_at_all(few); fault.what != nullptr) return fault;
        data.memory.forget();  // whatever `take` does
        if (few) {
            data.boxes.give(pairs.size(), take);
        } else if (is_in_order() && detail::are_boxes(data.kinds.of_pair)) {
            data.boxes.find(input(), take);
        } else {
            counts.undecided = take_blocks(take);
        }
        return {};
    }

    // @return how many pairs are undecided.
    std::size_t take_blocks(TakeManifolds take) {
        const std::size_t length = block_length(count_kinds());
        std::size_t undecided = 0;
        for (block = 0; block < pairs.size(); block += length) {
            const std::size_t end = std::min(pairs.size(), block + length);
            run_block(end);
            for (std::size_t i = block; i < end; ++i) {
                const Place& place = data.places[i - block];
                undecided += place.undecided ? 1 : 0;
                take(i, {data.chunks[place.chunk].manifolds.data() + place.first, place.count});
            }
        }
        return undecided;
    }

    // Makes room. @return how many pairs are run together.
    std::size_t block_length(const std::array<std::size_t, detail::kKinds + 1>& kinds) {
        const auto kinds_run =
            static_cast<std::size_t>(std::count_if(kinds.begin(), kinds.begin() + kReused, [](std::size_t n) { return n > 0; }));
        const std::size_t threads = static_cast<std::size_t>(executor.thread_count());
        const std::size_t length =
            std::min(pairs.size(), std::max<std::size_t>(kinds_run, 1) * (threads == 1 ? kBlock : threads * kBlockOfThread));
        data.places.resize(length);
        return length;
    }

    CollideCounts run_blocks(std::vector<Manifold>& out) {
        const auto kinds = count_kinds();
        const std::size_t length = block_length(kinds);
        data.starts.assign(length + 1, 0);
        CollideCounts counts{.undecided = 0, .reused = kinds[kReused]};
        std::size_t found = 0;
        for (block = 0; block < pairs.size(); block += length) {
            const std::size_t end = std::min(pairs.size(), block + length);
            run_block(end);
            counts.undecided += lay_out_block(end, found, out);
            found = data.starts[end - block];
        }
        out.resize(found);
        if (!alone) data.memory.finish(placed, out.size());
        return counts;
    }
};

CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, std::span<const Manifold> last, Executor& executor,
                      CollideScratch& scratch, std::vector<Manifold>& out) {
    CAROM_REQUIRE(last.empty() || last.data() != out.data(), ErrorCode::InvalidArgument,
                  "collide: the manifolds of the batch before are to be overwritten", CollideCounts{});
    CollideBatch batch{.placed = placed, .pairs = pairs, .last = last, .executor = executor, .data = CollideBatch::data_of(scratch)};
    CollideCounts counts;
    const detail::PairFault fault = batch.run(out, counts);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideCounts{});
    return counts;
}

CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, CollideScratch& scratch,
                      std::vector<Manifold>& out) {
    CollideBatch batch{
        .placed = placed, .pairs = pairs, .last = {}, .executor = executor, .data = CollideBatch::data_of(scratch), .alone = true};
    CollideCounts counts;
    const detail::PairFault fault = batch.run(out, counts);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideCounts{});
    return counts;
}

CollideCounts collide(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, CollideScratch& scratch,
                      TakeManifolds take) {
    CollideBatch batch{
        .placed = placed, .pairs = pairs, .last = {}, .executor = executor, .data = CollideBatch::data_of(scratch), .alone = true};
    CollideCounts counts;
    const detail::PairFault fault = batch.run(take, counts);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideCounts{});
    return counts;
}

CollideCounts collide(std::span<const ShapePair> pairs, Executor& executor, CollideScratch& scratch, std::vector<Manifold>& out) {
    const bool steady = !pairs.empty() && pairs.front().steady;
    CAROM_REQUIRE(std::ranges::all_of(pairs, [steady](const ShapePair& pair) { return pair.steady == steady; }), ErrorCode::InvalidArgument,
                  "collide: some of the pairs are steady and some are not", CollideCounts{});
    auto& data = CollideBatch::data_of(scratch);
    data.shapes.clear();
    data.poses.clear();
    data.numbered.clear();
    for (const ShapePair& pair : pairs) {
        const auto number = static_cast<std::uint32_t>(data.shapes.size());
        data.shapes.insert(data.shapes.end(), {pair.a, pair.b});
        data.poses.insert(data.poses.end(), {pair.pose_a, pair.pose_b});
        data.numbered.push_back({number, number + 1, pair.margin});
    }
    return collide({data.shapes, data.poses, steady}, data.numbered, executor, scratch, out);
}

}  // namespace carom
