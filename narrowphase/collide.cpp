// One pair at a time.
#include <carom/core/check.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/box_lanes.hpp>
#include <carom/narrowphase/detail/check_pair.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <array>
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
    const Box *const box_a = std::get_if<Box>(pair.a), *const box_b = std::get_if<Box>(pair.b);
    if (box_a != nullptr && box_b != nullptr) {
        // Two boxes as many are, for the same bits; the other kernels for many have those of one pair.
        const std::array<const Shape*, 2> shapes{pair.a, pair.b};
        const std::array<Pose, 2> poses{pair.pose_a, pair.pose_b};
        const std::array<detail::BoxLine, 2> boxes{detail::box_line(*box_a, pair.pose_a), detail::box_line(*box_b, pair.pose_b)};
        const NumberedPair numbered{0, 1, pair.margin};
        const std::uint32_t only = 0;
        entry.wide({{shapes, poses}, boxes, {&numbered, 1}}, {&only, 1}, workspace, found);
    } else {
        status = detail::run_pair(pair, entry, index, workspace, found);
    }
    for (const Manifold& manifold : found.manifolds()) out.emplace_back(manifold).pair = index;
    return status;
}

}  // namespace carom
