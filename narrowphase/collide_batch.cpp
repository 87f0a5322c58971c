// Many pairs at once: sorted by kernel, run in ranges, laid out in the order of the pairs.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom {

struct CollideScratch::Data {};
CollideScratch::CollideScratch() : data_(std::make_unique<Data>()) {}
CollideScratch::~CollideScratch() = default;
CollideScratch::CollideScratch(CollideScratch&&) noexcept = default;
CollideScratch& CollideScratch::operator=(CollideScratch&&) noexcept = default;

CollideCounts collide(std::span<const ShapePair> pairs, Executor&, CollideScratch&, std::vector<Manifold>& out) {
    for (const ShapePair& pair : pairs) {
        const char* fault = detail::fault_of(pair);
        CAROM_REQUIRE(fault == nullptr, ErrorCode::InvalidArgument, fault, CollideCounts{});
    }
    out.clear();
    CollideCounts counts;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const detail::KernelEntry& entry = detail::kernel_for(type_of(*pairs[i].a), type_of(*pairs[i].b));
        const CollideStatus status =
            detail::run_pair(pairs[i], entry, static_cast<std::uint32_t>(i), detail::thread_workspace(), out);
        if (status != CollideStatus::Ok) ++counts.undecided;
    }
    return counts;
}

}  // namespace carom
