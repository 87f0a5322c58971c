#include <carom/narrowphase/detail/moving_boxes.hpp>
#include <carom/narrowphase/detail/moving_core.hpp>
#include <carom/narrowphase/detail/proximity.hpp>
#include <carom/narrowphase/detail/slide_cores.hpp>
#include <carom/narrowphase/detail/sweep_parts.hpp>
#include <carom/narrowphase/detail/turning_plane.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom::detail {
namespace {

/// The different points of a core that the closest point lies between.
struct Feature {
    std::array<std::uint32_t, 4> points{};
    int count = 0;

    Feature(const std::array<std::uint32_t, 4>& numbers, std::uint32_t used) noexcept {
        for (std::uint32_t i = 0; i < used; ++i) {
            if (std::find(points.begin(), points.begin() + count, numbers[i]) == points.begin() + count)
                points[static_cast<std::size_t>(count++)] = numbers[i];
        }
    }
    [[nodiscard]] dvec3 edge(const ConvexCore& core) const noexcept { return core.place(points[1]) - core.place(points[0]); }
};

/// @return a turn with which a plane may part the two for long: that of the features which their closest points lie on.
/// @param closest  of the moment; it knows no features of curved shapes.
dvec3 turn_with_features(const Moment& now, const DistanceCache& closest) noexcept {
    const dvec3 &turn_a = now.pair.a.rotation, &turn_b = now.pair.b.rotation;
    const Feature a(closest.a, closest.count), b(closest.b, closest.count);
    if (a.count == 2 && b.count == 2) return turn_with_edges(now, a.edge(now.a), b.edge(now.b));
    if (a.count == 0) return now.a.curved() ? turn_b : turn_a;
    if (a.count > b.count) return turn_a;
    return b.count > 1 ? turn_b : dvec3{0.0};
}

/// @return when the balls about the two pivots first come near; kNoContact where they never do.
double balls_meet(const MovingPair& pair, double separation) noexcept {
    const double radius = pair.a.reach + pair.a.radius + pair.b.reach + pair.b.radius + separation;
    const SweepPath path{-pair.along, radius + 4.0 * pair.rounding(), glm::length(pair.between) + radius};
    return sweep_point(path, pair.between).t;
}

/// The closest points of a moment, or about that, and what may be made of them.
struct Closest {
    dvec3 touch{0.0};    ///< of B; over a plane A's lowest point
    BoxAxis axis;        ///< across which they were looked at, if so
    double upper = 0.0;  ///< they are at most this far apart
};

class ImpactSearch {
public:
    ImpactSearch(const MovingPair& pair, const TimeOfImpactSettings& settings, double until, DistanceCache* cache) noexcept
        : pair_(pair),
          settings_(settings),
          until_(until),
          closest_(cache != nullptr ? cache : &own_),
          is_plane_(pair.b.is_plane()),
          are_boxes_(pair.a.is_box() && pair.b.is_box()),
          stands_(pair.a.rotation == dvec3{0.0} && pair.b.rotation == dvec3{0.0}) {
        separation_ = settings.separation / pair.unit;
        rounding_ = pair.rounding();
        const double radii = pair.a.radius + pair.b.radius;
        near_ = std::max(settings.tolerance / pair.unit, 1e-9 * (pair.a.reach + pair.b.reach + radii));
        least_ = radii + rounding_ + separation_ * (1.0 + 0x1p-50);
    }

    Impact run() noexcept {
        const bool slides_boxes = are_boxes_ && stands_ && separation_ == 0.0;
        if (slides_boxes && slide_boxes()) return impact_;
        if (!is_plane_) {
            t_ = balls_meet(pair_, separation_);
            if (t_ <= until_ && stands_) slide();
        }
        while (t_ <= until_) {
            ++impact_.checks;
            if (check()) return impact_;
        }
        impact_.t = until_;
        return impact_;
    }

private:
    static constexpr double kInfinity = std::numeric_limits<double>::infinity();

    /// In closed form. @return whether that is the answer; it is not where the two are near each other at the start, or touch at edges all but parallel.
    bool slide_boxes() noexcept {
        ++impact_.checks;
        const ConvexCore a = pair_.a.core(0.0, dvec3{0.0}), b = pair_.b.core(0.0, pair_.between);
        const BoxAxes axes({a.half, a.axes, b.half, b.axes, b.centre - a.centre});
        const BoxSlide slide = axes.slide(pair_.along, until_, rounding_);
        if (slide.passes) {
            impact_.t = until_;
            return true;
        }
        if (!slide.axis.exists()) return false;
        const double enough = near_ + 4.0 * rounding_;
        const BoxTouch touch = axes.touch(slide.axis, slide.t * pair_.along, enough);
        if (!(touch.distance <= enough)) return false;
        impact_ = {ImpactStatus::Touching, slide.t, pair_.unit * (a.centre + touch.on_b), axes.normal(slide.axis), impact_.checks};
        return true;
    }

    /// As far as GJK goes with shapes that do not turn.
    void slide() noexcept {
        const ConvexCore a = pair_.a.core(t_, dvec3{0.0}), b = pair_.b.core(t_, pair_.between + t_ * pair_.along);
        if (a.curved() || b.curved()) return;
        const Slide slide = slide_cores({a, b, pair_.along, t_, until_, least_, near_});
        t_ = slide.passes ? kInfinity : slide.t;
        *closest_ = slide.closest;
        if (slide.normal != dvec3{0.0}) last_ = slide.normal;
        ++impact_.checks;
    }

    /// Moves t on. @return whether that is the end of the search.
    bool check() noexcept {
        const dvec3 between = pair_.between + t_ * pair_.along;
        Moment now{pair_, pair_.a.core(t_, dvec3{0.0}), pair_.b.core(t_, between), between, 1.0 - t_};
        impact_.t = t_;
        Closest found;
        if (!are_boxes_ || stands_ || !look_at_boxes(now, found)) look_closely(now, found);
        if (now.gap > least_ && found.upper - separation_ > near_) {
            if (impact_.checks >= settings_.most_checks) {
                impact_.status = ImpactStatus::Clamped;
                return true;
            }
            const double step = longest_step(now, turn_of(now, found));
            if (step >= now.rest) {
                t_ = kInfinity;
                return false;
            }
            if (t_ + step > t_) {
                t_ += step;
                return false;
            }
        }
        impact_.status = t_ > 0.0 || now.gap > least_ ? ImpactStatus::Touching : ImpactStatus::Overlapping;
        if (impact_.status == ImpactStatus::Touching) impact_.point = pair_.unit * found.touch, impact_.normal = now.normal;
        return true;
    }

    /// @return one with which a plane may part the two for long.
    [[nodiscard]] dvec3 turn_of(const Moment& now, const Closest& found) const noexcept {
        if (is_plane_) return pair_.b.rotation;  // it is the plane that parts them: seen from it, no point of it moves
        const BoxAxis& axis = found.axis;
        if (!axis.exists()) return turn_with_features(now, *closest_);
        if (axis.b == BoxAxis::kNone) return pair_.a.rotation;
        return axis.a == BoxAxis::kNone ? pair_.b.rotation : turn_with_edges(now, now.a.axes[axis.a], now.b.axes[axis.b]);
    }

    [[nodiscard]] double longest_step(const Moment& now, const dvec3& turn) const noexcept {
        // Up to a gap that counts as touching: where rounding hides the gap, the closest points cost three times as much.
        const double free = now.gap - least_, left = std::min(0.5 * near_, 0.5 * free);
        const auto safe = [&](const dvec3& with, double known) {
            const TurningPlane plane(now, with);
            return safe_step([&](double s) { return plane.gap(s, least_ + left); }, free - left, plane.slope(), now.rest, known);
        };
        const double step = safe(turn, 0.0);
        return step < now.rest && turn != dvec3{0.0} && !is_plane_ ? std::max(step, safe(dvec3{0.0}, step)) : step;
    }

    /// By their fifteen axes. @return whether that is enough: it is not where they are near and none of these tells how near.
    bool look_at_boxes(Moment& now, Closest& found) noexcept {
        const dvec3 middle_a = now.a.centre, middle_b = now.b.centre - now.between, between = now.b.centre - now.a.centre;
        const dvec3 &turn_a = pair_.a.rotation, &turn_b = pair_.b.rotation;
        const BoxAxes axes({now.a.half, now.a.axes, now.b.half, now.b.axes, between});
        const double spin = glm::length(turn_a) + glm::length(turn_b);
        const dvec3 along = pair_.along + glm::cross(turn_b, middle_b) - glm::cross(turn_a, middle_a);
        const BoxAxis axis = axes.longest({along, turn_a, turn_b, 0.25 * spin * spin * (pair_.a.reach + pair_.b.reach)}, least_);
        if (!axis.exists()) return false;
        now.part_by(axes.normal(axis));
        last_ = now.normal;
        if (now.gap - least_ > near_) {
            found.upper = kInfinity;
        } else {
            const BoxTouch touch = axes.touch(axis, dvec3{0.0}, near_ + separation_ - rounding_);
            found.touch = now.a.centre + touch.on_b;
            found.upper = touch.distance + rounding_;
            if (found.upper - separation_ > near_) return false;
        }
        found.axis = axis;
        return true;
    }

    void look_closely(Moment& now, Closest& found) noexcept {
        if (is_plane_) {
            now.part_by(-pair_.b.normal_at(t_));
            found.touch = now.low_a + pair_.a.radius * now.normal;
            found.upper = glm::dot(now.normal, now.b.centre - found.touch);
            return;
        }
        const CorePair cores{now.a, now.b, pair_.unit, rounding_};
        // Points and normal of round shapes are right to the root of the tolerance.
        const Proximity p = find_proximity(cores, {.tolerance = 1e-11}, closest_);
        // Round shapes that all but touch have no closest points; what parted them last still may.
        if (p.normal != dvec3{0.0}) last_ = p.normal;
        const dvec3 way = p.on_a - p.on_b;
        const double length = glm::length(way);
        found.touch = p.on_b + pair_.b.radius * (length > 16.0 * rounding_ ? way / length : -last_);
        found.upper = p.upper - (pair_.a.radius + pair_.b.radius);
        if (t_ > 0.0 && found.upper - separation_ <= near_) {
            now.normal = last_;  // there it ends, whatever the gap
        } else {
            now.part_by(last_);
        }
    }

    const MovingPair& pair_;
    const TimeOfImpactSettings& settings_;
    const double until_;
    DistanceCache own_;
    DistanceCache* const closest_;
    const bool is_plane_, are_boxes_, stands_;  // neither turns
    double separation_ = 0.0, rounding_ = 0.0;
    double near_ = 0.0;   // gaps up to this, beyond the separation, count as touching
    double least_ = 0.0;  // gaps of the cores up to this are none
    double t_ = 0.0;      // no contact before
    dvec3 last_{0.0};     // the last normal
    Impact impact_;
};

}  // namespace

Impact find_impact(const MovingPair& pair, const TimeOfImpactSettings& settings, double until, DistanceCache* cache) noexcept {
    return ImpactSearch(pair, settings, until, cache).run();
}

}  // namespace carom::detail
