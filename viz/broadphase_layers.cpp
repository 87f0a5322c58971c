#include <carom/viz/broadphase_layers.hpp>

#include <carom/core/check.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace carom {
namespace {

constexpr Color kBox{96, 106, 124, 255};
constexpr Color kEmptier{70, 120, 220, 255}, kFuller{220, 50, 40, 255}, kStray{150, 60, 190, 255};
constexpr Color kLowerEnd{40, 160, 80, 255}, kUpperEnd{226, 132, 20, 255}, kAxis{30, 36, 52, 255};
constexpr Color kRoot{40, 70, 140, 255}, kLeaf{60, 170, 110, 255};

Aabb moved(const FloatAabb& box, const dvec3& by) { return {dvec3(box.lower) + by, dvec3(box.upper) + by}; }

// Boxes may end at infinity, where there is nothing to draw.
void append_edges(DebugLayer& layer, const FloatAabb& box, const dvec3& by, Color color) {
    constexpr float kMost = std::numeric_limits<float>::max();
    for (int k = 0; k < 3; ++k) {
        if (!(box.lower[k] >= -kMost && box.upper[k] <= kMost)) return;
    }
    append_box_edges(layer, moved(box, by), Pose{}, color, BodyId{});
}

void append_cells(DebugLayer& layer, const std::vector<BroadphasePart>& parts, const dvec3& by) {
    std::size_t most = 1;
    for (const BroadphasePart& part : parts) most = std::max(most, part.count);
    for (const BroadphasePart& part : parts) {
        const double share = most > 1 ? static_cast<double>(part.count - 1) / static_cast<double>(most - 1) : 0.0;
        append_edges(layer, part.box, by, part.is_stray ? kStray : mix(kEmptier, kFuller, share));
    }
}

void append_tree(DebugLayer& layer, const std::vector<BroadphasePart>& parts, const dvec3& by, int depth) {
    for (const BroadphasePart& part : parts) {
        if (part.level <= depth) append_edges(layer, part.box, by, mix(kRoot, kLeaf, static_cast<double>(part.level) / std::max(depth, 1)));
    }
}

// Each axis runs along an edge of the box around all, from its lower corner.
void append_axes(DebugLayer& layer, const Broadphase& broadphase, const FloatAabb& around, const dvec3& by) {
    bool drawn[3] = {false, false, false};
    broadphase.visit_ends([&](const BroadphaseEnd& end) {
        vec3 at = around.lower;
        at[end.axis] = end.value;
        layer.points.push_back({vec3(dvec3(at) + by), end.is_upper ? kUpperEnd : kLowerEnd, BodyId{}});
        if (std::exchange(drawn[end.axis], true)) return;
        vec3 far = around.lower;
        far[end.axis] = around.upper[end.axis];
        layer.lines.push_back({vec3(dvec3(around.lower) + by), vec3(dvec3(far) + by), kAxis, BodyId{}});
    });
}

}  // namespace

void append_broadphase_layers(DebugFrame& frame, const Broadphase& broadphase, const dvec3& origin, int depth) {
    CAROM_REQUIRE(is_finite(origin), ErrorCode::NotFinite, "the origin is not finite");
    CAROM_REQUIRE(depth >= 0, ErrorCode::InvalidArgument, "depth must not be negative");
    if (broadphase.live_count() == 0) return;
    const dvec3 by = origin - frame.origin;
    const auto add = [&](const char* name, DebugLayer layer) {
        layer.name = name;
        if (!layer.empty()) frame.layers.push_back(std::move(layer));
    };
    DebugLayer bounds, cells, axes{.on_top = true}, tree;
    FloatAabb around{vec3{std::numeric_limits<float>::max()}, vec3{std::numeric_limits<float>::lowest()}};
    broadphase.visit_where([](const FloatAabb&) { return true; },
                           [&](std::uint32_t slot) {
                               const FloatAabb box = broadphase.box(slot);
                               around = {glm::min(around.lower, box.lower), glm::max(around.upper, box.upper)};
                               append_edges(bounds, box, by, kBox);
                               return true;
                           });
    std::vector<BroadphasePart> parts;
    broadphase.visit_parts([&](const BroadphasePart& part) { parts.push_back(part); });
    if (broadphase.method() == BroadphaseMethod::DynamicTree) {
        append_tree(tree, parts, by, depth);
    } else {
        append_cells(cells, parts, by);
    }
    append_axes(axes, broadphase, around, by);
    add(kBroadphaseBounds, std::move(bounds));
    add(kBroadphaseCells, std::move(cells));
    add(kBroadphaseAxes, std::move(axes));
    add(kBroadphaseTree, std::move(tree));
}

void append_broadphase_layers(DebugFrame& frame, const World& world) {
    append_broadphase_layers(frame, world.broadphase(), world.broadphase_origin());
}

}  // namespace carom
