// What stands in the way of a cast, and which of it the cast may meet.
//
//   CastIndex index(targets);
//   index.along(mover, found);                          // candidates, those that may be met first foremost
//   for (const CastCandidate& c : found) if (c.earliest <= best) ...
#pragma once

#include <carom/broadphase/broadphase.hpp>
#include <carom/collision/shapes.hpp>
#include <carom/core/ids.hpp>
#include <carom/core/pose.hpp>
#include <carom/dynamics/body.hpp>
#include <carom/dynamics/world_cast.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// A shape where it stands.
struct CastTarget {
    BodyId body;
    ShapeId id;
    const Shape* shape = nullptr;
    const ShapeDef* def = nullptr;
    dvec3 centre{0.0};    ///< of a ball that holds it, world [m]
    double reach = 0.0;   ///< the ball's radius; infinite for a plane
};

/// A cast as its targets see it.
struct CastMover {
    explicit CastMover(const ShapeCast& cast);

    const ShapeCast* cast;
    RigidMotion motion;   ///< with a unit orientation
    dvec3 centre{0.0};    ///< of a ball about the shape however it turns, at the start
    double reach = 0.0;   ///< its radius, with the separation

    /// @return a time before which the two balls do not meet; above 1 where they never do.
    [[nodiscard]] double earliest(const dvec3& target_centre, double target_reach) const noexcept;
    [[nodiscard]] bool wants(const CastTarget& target) const;
};

struct CastCandidate {
    double earliest = 0.0;     ///< not met before
    std::uint32_t target = 0;  ///< by its number in the list
};

/// A hierarchy of boxes over the targets as they stand.
class CastIndex {
public:
    /// @param targets, poses  (n,) in the world; copied where they are needed.
    CastIndex(std::span<const CastTarget> targets, std::span<const Pose> poses, Executor& executor);

    /// Finds all targets that the mover may meet, sorted by `earliest` and number. Thread-safe.
    void along(const CastMover& mover, std::span<const CastTarget> targets, std::vector<CastCandidate>& out) const;

private:
    Broadphase tree_;
    dvec3 origin_{0.0};
    std::vector<std::uint32_t> unbounded_;
};

}  // namespace carom::dynamics
