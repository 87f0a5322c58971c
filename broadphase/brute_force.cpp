// All pairs, many at once: the fastest method for a few hundred boxes.
#include <carom/broadphase/detail/methods.hpp>
#include <carom/broadphase/detail/overlap_kernel.hpp>
#include <carom/broadphase/detail/pair_list.hpp>
#include <carom/core/check.hpp>

#include <algorithm>

namespace carom::detail {
namespace {

constexpr std::size_t kRowsAPiece = 64;

class BruteForce final : public Broadphase {
public:
    [[nodiscard]] BroadphaseMethod method() const noexcept override { return BroadphaseMethod::BruteForce; }

    std::span<const ProxyPair> update(std::span<const FloatAabb> bounds, std::span<const ProxyFilter> filters,
                                      Executor& executor) override {
        const char* const fault = find_fault(bounds, filters);
        CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, list_.pairs());
        const std::size_t n = bounds.size();
        constexpr int kAxes[3] = {0, 1, 2};
        entries_.grow(n + Entries::kSentinels);
        for (std::size_t i = 0; i < n; ++i) {
            entries_.set(i, bounds[i], kAxes, static_cast<Tag>(i) | (filters[i].movable ? 0 : kImmovable));
        }
        entries_.close(n);
        const std::size_t pieces = (n + kRowsAPiece - 1) / kRowsAPiece;
        list_.begin(pieces);
        executor.parallel_for(pieces, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                find_overlaps(entries_, k * kRowsAPiece, std::min((k + 1) * kRowsAPiece, n), n, Order::Any, list_.piece(k));
            }
        });
        list_.finish(filters);
        return list_.pairs();
    }

private:
    Entries entries_;
    PairList list_;
};

}  // namespace

std::unique_ptr<Broadphase> make_brute_force() { return std::make_unique<BruteForce>(); }

}  // namespace carom::detail
