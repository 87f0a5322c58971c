#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {

void ManifoldSink::add(const Patch& patch) {
    Manifold& manifold = out_.emplace_back();
    manifold.pair = index_;
    manifold.count = static_cast<std::uint32_t>(patch.count);
    manifold.normal = vec3(turn_ * (axes_ * patch.normal));
    for (std::size_t i = 0; i < manifold.count; ++i) {
        const PatchPoint& point = patch.points[i];
        manifold.points[i] = {vec3(axes_ * point.position + shift_), static_cast<float>(point.separation), point.feature};
    }
}

CollideStatus run_pair(const ShapePair& pair, const KernelEntry& entry, std::uint32_t index, Workspace& workspace,
                       std::vector<Manifold>& out) {
    const Pose& first = entry.swapped ? pair.pose_b : pair.pose_a;
    const Pose& second = entry.swapped ? pair.pose_a : pair.pose_b;
    const dmat3 to_world = glm::mat3_cast(first.orientation);
    const dvec3 between = second.position - first.position;
    const PairFrame frame{
        .first = entry.swapped ? *pair.b : *pair.a,
        .second = entry.swapped ? *pair.a : *pair.b,
        .rotation = glm::mat3_cast(glm::conjugate(first.orientation) * second.orientation),
        .translation = between * to_world,
        .margin = static_cast<double>(pair.margin),
    };
    // Finite positions may still be so far apart that their difference is not: then they are farther apart than any margin.
    if (!is_finite(frame.translation)) return CollideStatus::Ok;
    // Of a swapped pair the kernel's first shape is B; its points move to A's origin, and the normal turns round.
    ManifoldSink sink(to_world, entry.swapped ? -between : dvec3{0.0}, entry.swapped, index, out);
    return entry.function(frame, workspace, sink);
}

Workspace& thread_workspace() {
    thread_local Workspace workspace;
    return workspace;
}

}  // namespace carom::detail
