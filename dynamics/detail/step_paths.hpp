// How bodies moved in a step and what they met: what the continuous stage writes down where WorldDef::record_paths is on.
#pragma once

#include <carom/core/ids.hpp>
#include <carom/dynamics/detail/body_path.hpp>
#include <carom/dynamics/detail/body_sizes.hpp>
#include <carom/dynamics/detail/body_state.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>
#include <carom/dynamics/explain_sweep.hpp>

#include <cstdint>
#include <vector>

namespace carom::dynamics {

/// A body before the continuous stage.
struct BodyStep {
    BodyState start;  ///< of one that flew; else its pose alone
    BodyState moved;  ///< as the solver left it
    FreeMotion motion;
    BodyMass mass;
    Pose principal;
    Role role = Role::Absent;
    bool flies = false;  ///< all the way: nothing has moved it since
    FollowFinding follow;
};

/// A part of a body's path, of those that had impacts.
struct PathLeg {
    std::uint32_t slot = 0;
    double begin = 0.0, end = 1.0;
    bool flies = false;
    bool rides = false;  ///< along `ride`; if neither, along `whole`
    Flight flight;       ///< from `begin` on
    Ride ride;
    PathPiece whole;
};

struct PathImpact {
    double t = 0.0;
    std::uint32_t a = 0, b = 0;  ///< proxies
    ShapeId id_a, id_b;          ///< and who they were
    int level = 0;
    ImpactStatus status = ImpactStatus::Separated;
    double margin = 0.0;
    dvec3 point{0.0}, normal{0.0};
    bool blow = false;
    Pose pose_a, pose_b;  ///< of the principal frames, before the impact
};

/// Two shapes, by their proxies, that were too deep in each other to be watched.
struct DeepPair {
    std::uint32_t a = 0, b = 0;
};

struct StepPaths {
    bool is_there = false;  ///< the last step looked for contacts
    double dt = 0.0;
    std::vector<BodyStep> bodies;  // by slot
    std::vector<BodyId> ids;       // by slot
    std::vector<BodySize> sizes;   // by slot
    std::vector<PathLeg> legs;     // of a body in the order of their times
    std::vector<PathImpact> impacts;
    std::vector<DeepPair> deep;
    std::vector<std::uint64_t> parted;  // JointSet::parted()

    [[nodiscard]] std::size_t memory() const noexcept { return held_by(bodies, ids, sizes, legs, impacts, deep, parted); }
    /// @return whether the step had this body, and it is not quarantined.
    [[nodiscard]] bool has(BodyId body) const noexcept {
        return is_there && body.slot < bodies.size() && ids[body.slot] == body && bodies[body.slot].role != Role::Absent;
    }
};

}  // namespace carom::dynamics
