// Many pairs at once.
#include <carom/core/check.hpp>
#include <carom/narrowphase/detail/convex_query.hpp>

namespace carom {
namespace {

constexpr std::size_t kChunk = 256;  // pairs; it fixes which of them run side by side, though not their bits

detail::PairFault find_fault(const PlacedShapes& placed, std::span<const NumberedPair> pairs) noexcept {
    if (placed.shapes.size() != placed.poses.size()) return {"distance: shapes and poses differ in number"};
    double residue = 0.0;
    for (const NumberedPair& pair : pairs) {
        if (pair.a >= placed.shapes.size() || pair.b >= placed.shapes.size()) return {"distance: a pair names a shape beyond the last"};
        const Shape *const a = placed.shapes[pair.a], *const b = placed.shapes[pair.b];
        if (a == nullptr || b == nullptr) return {"distance: a shape is null"};
        if (const detail::PairFault fault = detail::query_fault(*a, *b); fault.what != nullptr) return fault;
        residue += detail::finite_residue(placed.poses[pair.a]) + detail::finite_residue(placed.poses[pair.b]);
    }
    return residue != 0.0 ? detail::PairFault{"distance: a pose is not finite", ErrorCode::NotFinite} : detail::PairFault{};
}

}  // namespace

void distance(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::span<DistanceCache> caches,
              std::vector<DistanceResult>& out, const DistanceSettings& settings) {
    const detail::PairFault fault = find_fault(placed, pairs);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what);
    CAROM_REQUIRE(caches.empty() || caches.size() == pairs.size(), ErrorCode::InvalidArgument, "distance: caches and pairs differ in number");
    const char* const wrong = detail::settings_fault(settings);
    CAROM_REQUIRE(wrong == nullptr, ErrorCode::InvalidArgument, wrong);
    out.resize(pairs.size());
    executor.parallel_for(pairs.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const NumberedPair& p = pairs[i];
            out[i] = detail::pair_distance(*placed.shapes[p.a], placed.poses[p.a], *placed.shapes[p.b], placed.poses[p.b], settings,
                                           caches.empty() ? nullptr : &caches[i]);
        }
    });
}

void overlaps(const PlacedShapes& placed, std::span<const NumberedPair> pairs, Executor& executor, std::vector<Overlap>& out) {
    const detail::PairFault fault = find_fault(placed, pairs);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what);
    out.resize(pairs.size());
    executor.parallel_for(pairs.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const NumberedPair& p = pairs[i];
            out[i] = detail::pair_overlaps(*placed.shapes[p.a], placed.poses[p.a], *placed.shapes[p.b], placed.poses[p.b], nullptr);
        }
    });
}

}  // namespace carom
