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
    detail::Workspace& workspace = detail::thread_workspace();
    if (entry.wide == nullptr) return detail::run_pair(pair, entry, index, workspace, out);
    const std::uint32_t only = 0;
    const std::size_t before = out.size();
    entry.wide({&pair, 1}, {&only, 1}, workspace, out);
    for (std::size_t i = before; i < out.size(); ++i) out[i].pair = index;
    return CollideStatus::Ok;
}

}  // namespace carom
