// Many pairs at once: sorted by kernel, run in chunks of fixed length, laid out in the order of the pairs.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <algorithm>
#include <array>

namespace carom {
namespace {

// Pairs a chunk: enough to hide what a chunk costs, few enough to share among threads. It fixes where results lie, so that neither
// threads nor grain can change them.
constexpr std::size_t kChunk = 128;
constexpr std::size_t kKinds = static_cast<std::size_t>(kShapeTypeCount) * static_cast<std::size_t>(kShapeTypeCount);

std::size_t kind_of(const ShapePair& pair) noexcept {
    return pair.a->index() * static_cast<std::size_t>(kShapeTypeCount) + pair.b->index();
}

struct Chunk {
    std::vector<Manifold> manifolds;
    std::size_t undecided = 0;
};

// Where the manifolds of a pair are: in a chunk at first, then in the result.
struct Place {
    std::uint32_t chunk = 0;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

}  // namespace

struct CollideScratch::Data {
    std::vector<std::uint32_t> order;
    std::vector<Place> places;
    std::vector<std::size_t> starts;
    std::vector<Chunk> chunks;
};

CollideScratch::CollideScratch() : data_(std::make_unique<Data>()) {}
CollideScratch::~CollideScratch() = default;
CollideScratch::CollideScratch(CollideScratch&&) noexcept = default;
CollideScratch& CollideScratch::operator=(CollideScratch&&) noexcept = default;

struct CollideBatch {
    std::span<const ShapePair> pairs;
    Executor& executor;
    CollideScratch::Data& data;

    static CollideScratch::Data& data_of(CollideScratch& scratch) {
        if (scratch.data_ == nullptr) scratch.data_ = std::make_unique<CollideScratch::Data>();  // it was moved from
        return *scratch.data_;
    }

    // Counting sort, stable: neighbours in the order run the same kernel.
    void sort_by_kernel() {
        std::array<std::uint32_t, kKinds + 1> starts{};
        for (const ShapePair& pair : pairs) ++starts[kind_of(pair) + 1];
        for (std::size_t k = 0; k < kKinds; ++k) starts[k + 1] += starts[k];
        data.order.resize(pairs.size());
        for (std::size_t i = 0; i < pairs.size(); ++i) data.order[starts[kind_of(pairs[i])]++] = static_cast<std::uint32_t>(i);
    }

    void run_chunk(std::size_t index) {
        Chunk& chunk = data.chunks[index];
        chunk.manifolds.clear();
        chunk.undecided = 0;
        detail::Workspace& workspace = detail::thread_workspace();
        const std::size_t end = std::min(pairs.size(), (index + 1) * kChunk);
        for (std::size_t k = index * kChunk; k < end;) {
            const std::size_t kind = kind_of(pairs[data.order[k]]);
            std::size_t last = k + 1;
            while (last < end && kind_of(pairs[data.order[last]]) == kind) ++last;
            run_kind({data.order.data() + k, last - k}, static_cast<std::uint32_t>(index), workspace);
            k = last;
        }
    }

    // Pairs of one kind, which are neighbours in the order.
    void run_kind(std::span<const std::uint32_t> chosen, std::uint32_t index, detail::Workspace& workspace) {
        Chunk& chunk = data.chunks[index];
        const ShapePair& example = pairs[chosen.front()];
        const detail::KernelEntry& entry = detail::kernel_for(type_of(*example.a), type_of(*example.b));
        auto first = static_cast<std::uint32_t>(chunk.manifolds.size());
        if (entry.wide != nullptr) {
            entry.wide(pairs, chosen, workspace, chunk.manifolds);
            for (const std::uint32_t i : chosen) {
                const std::uint32_t count = first < chunk.manifolds.size() && chunk.manifolds[first].pair == i ? 1u : 0u;
                data.places[i] = {index, first, count};
                first += count;
            }
            return;
        }
        for (const std::uint32_t i : chosen) {
            const CollideStatus status = detail::run_pair(pairs[i], entry, i, workspace, chunk.manifolds);
            const auto end = static_cast<std::uint32_t>(chunk.manifolds.size());
            data.places[i] = {index, first, end - first};
            first = end;
            if (status != CollideStatus::Ok) ++chunk.undecided;
        }
    }

    CollideCounts run(std::vector<Manifold>& out) {
        sort_by_kernel();
        const std::size_t chunk_count = (pairs.size() + kChunk - 1) / kChunk;
        if (data.chunks.size() < chunk_count) data.chunks.resize(chunk_count);
        data.places.resize(pairs.size());
        executor.parallel_for(chunk_count, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = begin; c < end; ++c) run_chunk(c);
        });

        data.starts.resize(pairs.size() + 1);
        data.starts[0] = 0;
        for (std::size_t i = 0; i < pairs.size(); ++i) data.starts[i + 1] = data.starts[i] + data.places[i].count;
        out.resize(data.starts.back());
        executor.parallel_for(pairs.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Place& place = data.places[i];
                const Manifold* from = data.chunks[place.chunk].manifolds.data() + place.first;
                std::copy(from, from + place.count, out.data() + data.starts[i]);
            }
        });
        CollideCounts counts;
        for (std::size_t c = 0; c < chunk_count; ++c) counts.undecided += data.chunks[c].undecided;
        return counts;
    }
};

CollideCounts collide(std::span<const ShapePair> pairs, Executor& executor, CollideScratch& scratch, std::vector<Manifold>& out) {
    for (const ShapePair& pair : pairs) {
        const detail::PairFault fault = detail::fault_of(pair);
        CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideCounts{});
    }
    return CollideBatch{pairs, executor, CollideBatch::data_of(scratch)}.run(out);
}

}  // namespace carom
