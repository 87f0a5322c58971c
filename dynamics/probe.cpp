#include <carom/dynamics/probe.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/core/check.hpp>

namespace carom {
namespace {

/// The shapes of a world, side by side.
struct ShapeList {
    std::vector<const Shape*> shapes;
    std::vector<Pose> poses;
    std::vector<Aabb> boxes;
    std::vector<BodyId> bodies;
    std::vector<ShapeId> ids;
    std::vector<std::uint64_t> layers;
};

ShapeList list_shapes(const World& world) {
    ShapeList list;
    for (const BodyId body : world.bodies()) {
        if (world.is_quarantined(body)) continue;
        for (const ShapeId id : world.shapes(body)) {
            list.shapes.push_back(&world.shape(id));
            list.poses.push_back(world.shape_pose(id));
            list.boxes.push_back(bounds(world.shape(id), list.poses.back()));
            list.bodies.push_back(body);
            list.ids.push_back(id);
            list.layers.push_back(world.shape_def(id).layer);
        }
    }
    return list;
}

}  // namespace

void probe(const World& world, std::span<const WorldProbe> probes, Executor& executor, std::vector<WorldProbeContact>& out) {
    for (const WorldProbe& p : probes) {
        CAROM_REQUIRE(world.is_alive(p.body), ErrorCode::DeadId, "a probe's body is not alive");
        const Status status = validate(p.probe);
        CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
        CAROM_REQUIRE(is_finite(world.pose(p.body)), ErrorCode::NotFinite, "the pose of a probe's body is not finite");
    }
    const ShapeList list = list_shapes(world);
    std::vector<PlacedProbe> placed;
    std::vector<std::uint32_t> near;
    for (const WorldProbe& p : probes) {
        const Pose pose = world.pose(p.body);
        const Aabb box = bounds(p.probe, pose);
        const auto first = static_cast<std::uint32_t>(near.size());
        for (std::uint32_t i = 0; i < list.shapes.size(); ++i) {
            if (list.bodies[i] != p.body && (list.layers[i] & p.mask) != 0 && overlaps(list.boxes[i], box)) near.push_back(i);
        }
        placed.push_back({p.probe, pose, first, static_cast<std::uint32_t>(near.size()) - first});
    }
    std::vector<ProbeContact> contacts;
    probe(placed, {list.shapes, list.poses}, near, executor, contacts);
    out.clear();
    for (const ProbeContact& contact : contacts) out.push_back({list.bodies[contact.shape], list.ids[contact.shape], contact});
}

}  // namespace carom
