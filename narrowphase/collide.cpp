// One pair at a time.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <variant>

namespace carom {

CollideStatus collide(const ShapePair& pair, std::uint32_t index, std::vector<Manifold>& out) {
    const detail::PairFault fault = detail::fault_of(pair);
    CAROM_REQUIRE(fault.what == nullptr, fault.code, fault.what, CollideStatus::Ok);
    const detail::KernelEntry& entry = detail::kernel_for(type_of(*pair.a), type_of(*pair.b));
    detail::Workspace& workspace = detail::thread_workspace();
    detail::ManifoldList& found = workspace.alone;
    found.clear();
    CollideStatus status = CollideStatus::Ok;
    if (std::holds_alternative<Box>(*pair.a) && std::holds_alternative<Box>(*pair.b)) {
        detail::box_box_single(pair, index, workspace, found);  // the other kernels for many have the bits of those for one
    } else {
        status = detail::run_pair(pair, entry, index, workspace, found);
    }
    for (const Manifold& manifold : found.manifolds()) out.emplace_back(manifold).pair = index;
    return status;
}

}  // namespace carom
