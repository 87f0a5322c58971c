#include <carom/dynamics/detail/cast_targets.hpp>

#include <carom/broadphase/queries.hpp>
#include <carom/collision/aabb.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace carom::dynamics {
namespace {

constexpr double kNever = 2.0;

/// No pairs are wanted of it: two are enough for it to stop looking for more.
constexpr BroadphaseSettings kBoxesOnly{.method = BroadphaseMethod::DynamicTree, .pair_limit = 1};

Aabb box_of(const CastMover& mover) {
    if (mover.motion.rotation == dvec3{0.0}) return inflate(bounds(mover.cast->shape, mover.motion.start), mover.cast->settings.separation);
    return {mover.centre - mover.reach, mover.centre + mover.reach};
}

}  // namespace

CastMover::CastMover(const ShapeCast& of) : cast(&of), motion(of.motion) {
    motion.start.orientation = glm::normalize(of.motion.start.orientation);
    const bool turns = motion.rotation != dvec3{0.0};
    centre = turns ? transform_point(motion.start, motion.pivot) : motion.start.position;
    reach = bounding_radius(of.shape) + (turns ? glm::length(motion.pivot) : 0.0) + of.settings.separation;
}

double CastMover::earliest(const dvec3& target_centre, double target_reach) const noexcept {
    const dvec3 away = centre - target_centre;
    const auto size = [](const dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    // Poses are right to an ulp of their distance from the world's origin; what rounding may do here is less than what is added below.
    const double radius = reach + target_reach + 0x1p-48 * (size(centre) + size(target_centre));
    const double away_sq = glm::dot(away, away);
    const double c = away_sq * (1.0 - 1e-12) - radius * radius * (1.0 + 1e-12);
    if (!(c > 0.0)) return 0.0;
    const double a = glm::dot(motion.translation, motion.translation), b = glm::dot(away, motion.translation);
    if (b >= 0.0) return kNever;
    const double root_sq = b * b - a * c;
    if (root_sq < 0.0) return kNever;
    const double t = c / (std::sqrt(root_sq) - b) * (1.0 - 1e-12);
    return t <= 1.0 ? t : kNever;
}

bool CastMover::wants(const CastTarget& target) const {
    const CastFilter& filter = cast->filter;
    if ((filter.layer & target.def->mask) == 0 || (target.def->layer & filter.mask) == 0) return false;
    if (filter.ignored == target.body) return false;
    return filter.wanted == nullptr || filter.wanted(filter.context, target.body, target.id);
}

CastIndex::CastIndex(std::span<const CastTarget> targets, std::span<const Pose> poses, Executor& executor) : tree_(kBoxesOnly) {
    std::vector<Aabb> exact(targets.size());
    executor.parallel_for(targets.size(), 64, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (is_bounded(*targets[i].shape)) exact[i] = bounds(*targets[i].shape, poses[i]);
        }
    });
    const Aabb all = std::accumulate(exact.begin(), exact.end(), Aabb{}, [](const Aabb& a, const Aabb& b) { return merge(a, b); });
    if (!is_empty(all)) origin_ = 0.5 * all.lower + 0.5 * all.upper;
    std::vector<FloatAabb> boxes(targets.size());
    std::vector<std::uint32_t> bounded;
    for (std::uint32_t i = 0; i < targets.size(); ++i) {
        if (!is_bounded(*targets[i].shape)) {
            unbounded_.push_back(i);
            continue;
        }
        bounded.push_back(i);
        boxes[i] = round_outward(exact[i], origin_);
    }
    const std::vector<ProxyFilter> filters(targets.size());
    tree_.update({.bounds = boxes, .filters = filters, .moved = bounded}, executor);
}

void CastIndex::along(const CastMover& mover, std::span<const CastTarget> targets, std::vector<CastCandidate>& out) const {
    out.clear();
    for (const std::uint32_t i : unbounded_) out.push_back({0.0, i});
    const Aabb box = box_of(mover);
    const dvec3 lower = box.lower - origin_, upper = box.upper - origin_, &along = mover.motion.translation;
    const double slack = 0x1p-44 * (glm::length(lower) + glm::length(upper) + glm::length(along));
    query_swept_box(tree_, lower - slack, upper + slack, along, [&](std::uint32_t i) {
        const double earliest = mover.earliest(targets[i].centre, targets[i].reach);
        if (earliest <= 1.0) out.push_back({earliest, i});
        return true;
    });
    std::ranges::stable_sort(out, [](const CastCandidate& a, const CastCandidate& b) {
        return a.earliest != b.earliest ? a.earliest < b.earliest : a.target < b.target;
    });
}

}  // namespace carom::dynamics
