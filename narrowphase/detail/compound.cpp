// A compound against anything: its parts near the other shape, each by the kernel of its own type.
#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/narrowphase/detail/kernels.hpp>
#include <carom/narrowphase/detail/plane_form.hpp>
#include <carom/narrowphase/detail/workspace.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <limits>

namespace carom::detail {
namespace {

// What rounding may do to a point that goes from one frame of the pair to the other, as a share of its coordinates: the turn, the shift,
// and boxes of single precision that were rounded outward already.
constexpr double kFramePad = 1e-14;

dmat3 absolute(const dmat3& m) noexcept { return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])}; }

// The box of a box of the second shape's frame, in the frame of the first.
Aabb carried(const PairFrame& pair, const Aabb& box) noexcept {
    const dvec3 centre = pair.to_first(0.5 * (box.lower + box.upper)), half = absolute(pair.rotation) * (0.5 * (box.upper - box.lower));
    const dvec3 far = glm::abs(box.lower) + glm::abs(box.upper) + glm::abs(pair.translation);
    const double pad = kFramePad * (far.x + far.y + far.z);
    return inflate({centre - half, centre + half}, pad);
}

// The second shape's box in its own frame; nothing is known of a plane's.
Aabb own_box(const Shape& shape) {
    if (const CompoundPtr* compound = std::get_if<CompoundPtr>(&shape)) return (*compound)->local_bounds();
    if (const TriangleMeshPtr* mesh = std::get_if<TriangleMeshPtr>(&shape)) return (*mesh)->local_bounds();
    return bounds(shape, Pose{});
}

// A part of the compound, which is first in `pair`, against the second shape, in the order that the part's kernel wants.
CollideStatus touch_part(const PairFrame& pair, std::uint32_t index, Workspace& workspace, ManifoldSink& sink) {
    const CompoundPart& part = as<CompoundPtr>(pair.first)->parts()[index];
    const KernelEntry& entry = kernel_for(type_of(part.shape), type_of(pair.second));
    const dmat3 turn = glm::mat3_cast(part.pose.orientation);
    const dvec3& origin = part.pose.position;
    if (entry.swapped) {
        const PairFrame frame{pair.second, part.shape, glm::transpose(pair.rotation) * turn, (origin - pair.translation) * pair.rotation,
                              pair.margin, pair.steady};
        ManifoldSink inner = sink.of_part(pair.rotation, pair.translation, true, index);
        return entry.function(frame, workspace, inner);
    }
    const PairFrame frame{part.shape, pair.second, glm::transpose(turn) * pair.rotation, (pair.translation - origin) * turn, pair.margin, pair.steady};
    ManifoldSink inner = sink.of_part(turn, origin, false, index);
    return entry.function(frame, workspace, inner);
}

}  // namespace

CollideStatus compound_any(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    CollideStatus status = CollideStatus::Ok;
    const Compound& compound = *as<CompoundPtr>(pair.first);
    compound.overlap(inflate(carried(pair, own_box(pair.second)), pair.margin), [&](std::uint32_t part) {
        if (touch_part(pair, part, workspace, sink) != CollideStatus::Ok) status = CollideStatus::Undecided;
        return true;
    });
    return status;
}

CollideStatus compound_plane(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink) {
    // Each part's kernel rejects what is too far above; the parts' number is small next to the work of the few that touch.
    const Compound& compound = *as<CompoundPtr>(pair.first);
    for (std::uint32_t part = 0; part < compound.parts().size(); ++part) touch_part(pair, part, workspace, sink);
    return CollideStatus::Ok;
}

}  // namespace carom::detail
