#include <carom/viz/sweep_layers.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/core/check.hpp>
#include <carom/dynamics/explain_sweep.hpp>
#include <carom/viz/shape_geometry.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

namespace carom {
namespace {

constexpr Color kImpact{200, 30, 30, 255}, kFirstLook{170, 190, 220, 255}, kLastLook{30, 50, 110, 255};
constexpr std::uint8_t kVolumeOpacity = 26, kGhostOpacity = 120;

class SweepPainter {
public:
    SweepPainter(const World& world, const dvec3& origin, const SweepLayerSettings& settings)
        : world_(world), origin_(origin), settings_(settings) {
        ghosts.on_top = steps.on_top = true;
        ghosts.point_size = 12.0f;
        steps.line_width = 1.0f;
    }

    DebugLayer volumes, ghosts, steps;

    void paint_way(const BodySweep& sweep) {
        const bool followed = sweep.follow.reason == Following::Followed || sweep.times.size() > 2;
        if (!wants(sweep.body) || (!followed && settings_.bodies.empty())) return;
        const int copies = copies_of(sweep);
        std::vector<double> times = sweep.times;
        for (int k = 1; k + 1 < copies; ++k) times.push_back(static_cast<double>(k) / (copies - 1));
        std::ranges::stable_sort(times);
        dvec3 last{0.0};
        for (std::size_t i = 0; i < times.size(); ++i) {
            const Pose at = world_.pose_within_step(sweep.body, times[i]);
            paint_body(volumes, sweep.body, at, kVolumeOpacity);
            if (i > 0) line(volumes, last, at.position, opaque(sweep.body), sweep.body);
            last = at.position;
        }
    }

    void paint_impact(const SweepImpact& impact) {
        if (!wants(impact.body_a) && !wants(impact.body_b)) return;
        for (const auto& [body, pose] : {std::pair(impact.body_a, impact.pose_a), std::pair(impact.body_b, impact.pose_b)}) {
            if (world_.type(body) == BodyType::Static) continue;
            paint_body(ghosts, body, pose, kGhostOpacity);
            for (std::size_t k = 0; k < impact.advances.size(); ++k)
                paint_look(body, impact.advances[k], static_cast<double>(k + 1) / static_cast<double>(impact.advances.size()));
        }
        if (impact.normal == dvec3{0.0}) return;
        const double length = 0.5 * std::min(extent_of(impact.body_a), extent_of(impact.body_b));
        ghosts.points.push_back({vec3(impact.point - origin_), kImpact, impact.body_a});
        line(ghosts, impact.point, impact.point + (length < std::numeric_limits<double>::infinity() ? length : 1.0) * impact.normal,
             kImpact, impact.body_a);
        char text[48];
        std::snprintf(text, sizeof text, "t = %.4g%s", impact.t, impact.blow ? "" : ", stopped");
        ghosts.texts.push_back({vec3(impact.point - origin_), text, kImpact, impact.body_a});
    }

private:
    [[nodiscard]] bool wants(BodyId body) const {
        return settings_.bodies.empty() || std::ranges::find(settings_.bodies, body) != settings_.bodies.end();
    }
    [[nodiscard]] static Color opaque(BodyId body) { return palette(body.slot); }

    [[nodiscard]] double extent_of(BodyId body) const {
        double extent = std::numeric_limits<double>::infinity();
        for (const ShapeId shape : world_.shapes(body)) extent = std::min(extent, smallest_extent(world_.shape(shape)));
        return extent;
    }
    /// So many that one is at most half an extent from the next.
    [[nodiscard]] int copies_of(const BodySweep& sweep) const {
        const double wanted = std::ceil(2.0 * sweep.follow.motion / extent_of(sweep.body));
        return wanted >= 2.0 ? static_cast<int>(std::min(wanted, static_cast<double>(settings_.most_copies))) : 2;
    }

    void line(DebugLayer& layer, const dvec3& from, const dvec3& to, Color color, BodyId body) {
        layer.lines.push_back({vec3(from - origin_), vec3(to - origin_), color, body});
    }

    void for_each_bounded(BodyId body, const Pose& at, const auto& visit) {
        for (const ShapeId id : world_.shapes(body)) {
            if (type_of(world_.shape(id)) == ShapeType::Plane) continue;
            Pose pose = at * world_.shape_def(id).local;
            pose.position -= origin_;
            visit(world_.shape(id), pose);
        }
    }
    void paint_body(DebugLayer& layer, BodyId body, const Pose& at, std::uint8_t opacity) {
        Color color = palette(body.slot);
        color.a = opacity;
        for_each_bounded(body, at, [&](const Shape& shape, const Pose& pose) {
            append_shape(layer, shape, pose, {.color = color, .second = color, .body = body, .segments = settings_.segments});
        });
    }
    void paint_look(BodyId body, double t, double share) {
        for_each_bounded(body, world_.pose_within_step(body, t), [&](const Shape& shape, const Pose& pose) {
            append_box_edges(steps, bounds(shape, Pose{}), pose, mix(kFirstLook, kLastLook, share), body);
        });
    }

    const World& world_;
    dvec3 origin_;
    const SweepLayerSettings& settings_;
};

}  // namespace

void append_sweep_layers(DebugFrame& frame, const World& world, const SweepLayerSettings& settings) {
    CAROM_REQUIRE(world.settings().record_paths, ErrorCode::InvalidArgument, "WorldDef::record_paths is off: nothing was written down");
    CAROM_REQUIRE(settings.most_copies >= 2 && settings.most_copies <= 256, ErrorCode::InvalidArgument,
                  "most_copies must be within 2..256");
    CAROM_REQUIRE(settings.segments >= 4 && settings.segments <= 256 && settings.segments % 4 == 0, ErrorCode::InvalidArgument,
                  "segments must be a multiple of 4 within 4..256");
    CAROM_REQUIRE(std::ranges::all_of(settings.bodies, [&](BodyId body) { return world.is_alive(body); }), ErrorCode::DeadId,
                  "no such body");
    const StepSweeps sweeps = world.sweeps();
    SweepPainter painter(world, frame.origin, settings);
    for (const BodySweep& sweep : sweeps.bodies) painter.paint_way(sweep);
    for (const SweepImpact& impact : sweeps.impacts) painter.paint_impact(impact);
    for (auto& [name, layer] : {std::pair<const char*, DebugLayer&>(kSweepVolumes, painter.volumes),
                                {kSweepGhosts, painter.ghosts},
                                {kSweepSteps, painter.steps}}) {
        if (layer.empty()) continue;
        layer.name = name;
        frame.layers.push_back(std::move(layer));
    }
}

}  // namespace carom
