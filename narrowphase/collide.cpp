// One pair at a time.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom {

CollideStatus collide(const ShapePair& pair, std::uint32_t index, std::vector<Manifold>& out) {
    const detail::PairFault fault = detail::fault_of(pair);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideStatus::Ok);
    const detail::KernelEntry& entry = detail::kernel_for(type_of(*pair.a), type_of(*pair.b));
    return detail::run_pair(pair, entry, index, detail::thread_workspace(), out);
}

}  // namespace carom
