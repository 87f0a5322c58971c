#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {

void ManifoldSink::add(const Patch& patch) {
    // The kernel's first shape is B where the pair was swapped; its points then move to A's origin, and the normal turns round.
    const Pose& frame = swapped_ ? pair_.pose_b : pair_.pose_a;
    const dvec3 shift = swapped_ ? pair_.pose_b.position - pair_.pose_a.position : dvec3{0.0};
    const dmat3 axes = glm::mat3_cast(frame.orientation);
    const double turn = swapped_ ? -1.0 : 1.0;

    Manifold& manifold = out_.emplace_back();
    manifold.pair = index_;
    manifold.count = static_cast<std::uint32_t>(patch.count);
    manifold.normal = vec3(turn * (axes * patch.normal));
    for (std::size_t i = 0; i < manifold.count; ++i) {
        const PatchPoint& point = patch.points[i];
        manifold.points[i] = {vec3(axes * point.position + shift), static_cast<float>(point.separation), point.feature};
    }
}

CollideStatus run_pair(const ShapePair& pair, const KernelEntry& entry, std::uint32_t index, Workspace& workspace,
                       std::vector<Manifold>& out) {
    const Pose& first = entry.swapped ? pair.pose_b : pair.pose_a;
    const Pose& second = entry.swapped ? pair.pose_a : pair.pose_b;
    const dmat3 to_world = glm::mat3_cast(first.orientation);
    const PairFrame frame{
        .first = entry.swapped ? *pair.b : *pair.a,
        .second = entry.swapped ? *pair.a : *pair.b,
        .rotation = glm::transpose(to_world) * glm::mat3_cast(second.orientation),
        .translation = (second.position - first.position) * to_world,
        .margin = static_cast<double>(pair.margin),
    };
    // Finite positions may still be so far apart that their difference is not: then they are farther apart than any margin.
    if (!is_finite(frame.translation)) return CollideStatus::Ok;
    ManifoldSink sink(pair, entry.swapped, index, out);
    return entry.function(frame, workspace, sink);
}

Workspace& thread_workspace() {
    thread_local Workspace workspace;
    return workspace;
}

}  // namespace carom::detail
