#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/kernel.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

namespace carom::detail {

namespace {

// A feature's name among those of all parts. Two points share a name by accident once in 2^64.
std::uint64_t name_in_parts(std::uint64_t feature, std::uint64_t parts) noexcept { return scrambled(feature + scrambled(parts)); }

}  // namespace

ManifoldSink ManifoldSink::of_part(const dmat3& axes, const dvec3& origin, bool swapped, std::uint32_t part) const noexcept {
    ManifoldSink inner(axes_ * axes, shift_ + axes_ * origin, false, index_, out_);
    inner.turn_ = swapped ? -turn_ : turn_;
    inner.part_a_ = part_a_;
    inner.part_b_ = part_b_;
    inner.parts_ = (parts_ << 32) | (part + 1u);
    // The first shape of this kernel is A unless the pair was swapped.
    (turn_ > 0.0 ? inner.part_a_ : inner.part_b_) = part;
    return inner;
}

void ManifoldSink::add(const Patch& patch) {
    Manifold& manifold = out_.add();
    manifold.pair = index_;
    manifold.part_a = static_cast<std::uint16_t>(part_a_);
    manifold.part_b = static_cast<std::uint16_t>(part_b_);
    manifold.count = static_cast<std::uint32_t>(patch.count);
    manifold.normal = vec3(turn_ * (axes_ * patch.normal));
    for (std::size_t i = 0; i < manifold.count; ++i) {
        const PatchPoint& point = patch.points[i];
        manifold.points[i] = {vec3(axes_ * point.position + shift_), static_cast<float>(point.separation),
                              parts_ != 0 ? name_in_parts(point.feature, parts_) : point.feature};
    }
}

CollideStatus run_pair(const ShapePair& pair, const KernelEntry& entry, std::uint32_t index, Workspace& workspace,
                       ManifoldList& out) {
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
        .steady = pair.steady,
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
