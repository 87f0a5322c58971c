// Casts of shapes through a world.
#include <carom/dynamics/world_cast.hpp>

#include <carom/core/check.hpp>
#include <carom/dynamics/detail/cast_targets.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

using dynamics::CastCandidate;
using dynamics::CastIndex;
using dynamics::CastMover;
using dynamics::CastTarget;

constexpr double kMostTurns = 1e9;  // [rad], of time_of_impact()
constexpr std::size_t kGrain = 8;
/// Making a hierarchy costs as much as some thirty scans of the shapes it is made of.
constexpr std::size_t kCastsForIndex = 32, kTargetsForIndex = 32;

/// The first of what is met.
class FirstMet {
public:
    explicit FirstMet(const ShapeCast& cast) : settings_(cast.settings) {}

    /// @return up to when more is wanted.
    [[nodiscard]] double until() const noexcept { return settings_.until; }

    /// @param rank  of the target: the lower of two wins a tie.
    void look(const CastMover& mover, const CastTarget& target, const Pose& pose, std::size_t rank) {
        const ShapeImpact impact = cast_shape(mover.cast->shape, mover.motion, *target.shape, pose, settings_);
        CAROM_ASSERT(impact.status != ImpactStatus::Invalid);
        if (!may_touch(impact.status) || (best_ && impact.t == settings_.until && rank > rank_)) return;
        best_ = WorldImpact{target.body, target.id, impact};
        rank_ = rank;
        settings_.until = impact.t;
    }
    [[nodiscard]] const std::optional<WorldImpact>& best() const noexcept { return best_; }

private:
    TimeOfImpactSettings settings_;
    std::optional<WorldImpact> best_;
    std::size_t rank_ = 0;
};

Status fault(ErrorCode code, const char* what) { return Error{code, what, "ShapeCast"}; }

Status validate_settings(const TimeOfImpactSettings& s) {
    if (!(s.separation >= 0.0 && s.separation <= dynamics::kMostDistance)) return fault(ErrorCode::InvalidArgument, "separation must be within 0 .. 1e30 m");
    if (!(s.tolerance >= 0.0 && s.tolerance <= dynamics::kMostDistance)) return fault(ErrorCode::InvalidArgument, "tolerance must be within 0 .. 1e30 m");
    if (s.most_checks < 1) return fault(ErrorCode::InvalidArgument, "most_checks must be at least 1");
    if (!(s.until >= 0.0 && s.until <= 1.0)) return fault(ErrorCode::InvalidArgument, "until must be within 0 .. 1");
    return {};
}

}  // namespace

Status validate(const ShapeCast& cast) {
    if (!is_convex_solid(type_of(cast.shape))) return fault(ErrorCode::WrongType, "only convex shapes are cast: no plane, mesh or compound");
    if (Status status = validate(cast.shape); !status) return status;
    const RigidMotion& m = cast.motion;
    if (!is_finite(m.start) || !is_finite(m.translation) || !is_finite(m.rotation) || !is_finite(m.pivot)) {
        return fault(ErrorCode::NotFinite, "the motion is not finite");
    }
    if (std::abs(glm::length(m.start.orientation) - 1.0) > 1e-3) return fault(ErrorCode::InvalidArgument, "the orientation is not of unit length");
    for (const dvec3& v : {m.start.position, m.translation, m.pivot}) {
        if (glm::length(v) > dynamics::kMostDistance) return fault(ErrorCode::InvalidArgument, "the motion leaves 1e30 m");
    }
    if (glm::length(m.rotation) > kMostTurns) return fault(ErrorCode::InvalidArgument, "the rotation is beyond 1e9 rad");
    return validate_settings(cast.settings);
}

void World::Impl::visit_cast_targets(FunctionRef<void(const CastTarget& target)> visit) const {
    for (const BodyId body : body_order) {
        const dynamics::BodyRecord& record = *bodies.find(body);
        if (record.quarantined) continue;
        const dvec3& centre = arrays.states[body.slot].pose.position;
        for (const ShapeId id : record.shapes) {
            const dynamics::ShapeRecord& shape = *shapes.find(id);
            visit({body, id, &shape.shape, shape.def.get(), centre, proxies.by_slot[id.slot].reach});
        }
    }
}

std::optional<WorldImpact> World::cast_shape(const ShapeCast& cast) const {
    const Status status = validate(cast);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, std::nullopt);
    const CastMover mover(cast);
    FirstMet first(cast);
    std::size_t rank = 0;
    impl_->visit_cast_targets([&](const CastTarget& target) {
        ++rank;
        if (mover.earliest(target.centre, target.reach) > first.until() || !mover.wants(target)) return;
        first.look(mover, target, impl_->body_pose(target.body) * target.def->local, rank);
    });
    return first.best();
}

std::vector<WorldImpact> World::cast_shape_all(const ShapeCast& cast) const {
    std::vector<WorldImpact> met;
    const Status status = validate(cast);
    CAROM_REQUIRE(status.ok(), status.error().code, status.error().message, met);
    const CastMover mover(cast);
    impl_->visit_cast_targets([&](const CastTarget& target) {
        if (mover.earliest(target.centre, target.reach) > cast.settings.until || !mover.wants(target)) return;
        FirstMet one(cast);
        one.look(mover, target, impl_->body_pose(target.body) * target.def->local, 0);
        if (one.best()) met.push_back(*one.best());
    });
    std::ranges::stable_sort(met, {}, [](const WorldImpact& w) { return w.impact.t; });
    return met;
}

void World::cast_shapes(std::span<const ShapeCast> casts, std::span<std::optional<WorldImpact>> out) const {
    CAROM_REQUIRE(casts.size() == out.size(), ErrorCode::InvalidArgument, "cast_shapes: spans differ in length");
    for (const ShapeCast& cast : casts) {
        const Status status = validate(cast);
        CAROM_REQUIRE(status.ok(), status.error().code, status.error().message);
    }
    std::vector<CastTarget> targets;
    std::vector<Pose> poses;
    impl_->visit_cast_targets([&](const CastTarget& target) {
        targets.push_back(target);
        poses.push_back(impl_->body_pose(target.body) * target.def->local);
    });
    Executor& executor = impl_->executor();
    std::optional<CastIndex> index;
    if (casts.size() >= kCastsForIndex && targets.size() >= kTargetsForIndex) index.emplace(targets, poses, executor);
    executor.parallel_for(casts.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        std::vector<CastCandidate> near;
        for (std::size_t k = begin; k < end; ++k) {
            const CastMover mover(casts[k]);
            FirstMet first(casts[k]);
            const auto look = [&](std::size_t i) {
                if (mover.wants(targets[i])) first.look(mover, targets[i], poses[i], i);
            };
            if (index) {
                index->along(mover, targets, near);
                for (const CastCandidate& c : near) {
                    if (c.earliest > first.until()) break;
                    look(c.target);
                }
            } else {
                for (std::size_t i = 0; i < targets.size(); ++i) {
                    if (mover.earliest(targets[i].centre, targets[i].reach) <= first.until()) look(i);
                }
            }
            out[k] = first.best();
        }
    });
}

}  // namespace carom
