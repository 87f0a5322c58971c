// Where a body goes in a step: a screw, or as fine a chain of screws as somebody asks for.
//
//   BodyPath path;
//   path.fly(flight, mass, 0.0, {dt, reach, most_bend});
//   if (path.can_split(node)) auto [earlier, later] = path.split(node);
//   RigidMotion motion = shape_motion(cut(path.piece(node), 0.25, 0.5), proxy.local);
//
// Times are fractions of the step. Each piece is a screw through two poses of the integrator, with as many turns as the spin makes, and the bound by which
// the body may be elsewhere in between. Pieces are split where a coarse one is not enough, so that what stays far from everything has one.
#pragma once

#include <carom/collision/aabb.hpp>
#include <carom/dynamics/detail/integrator.hpp>
#include <carom/narrowphase/time_of_impact.hpp>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace carom::dynamics {

struct PathPiece {
    double begin = 0.0, end = 1.0;
    Pose start{};             ///< of the principal frame
    dvec3 translation{0.0};   ///< of the centre of mass [m]
    dvec3 rotation{0.0};      ///< [rad]
    double sway = 0.0;        ///< the centre of mass is no farther from where the screw has it [m]
    double bend = 0.0;        ///< nor any point of the body [m]
};

/// A body that nothing touches.
struct Flight {
    BodyState start;
    FreeMotion motion;
};

/// A body that goes along with another as if it were fixed to it.
struct Ride {
    PathPiece carrier;  ///< the other's screw, over the whole step
    Pose local{};       ///< of the principal frame, in that of the other

    /// @return the state at `t` of what had the state `start` at `since`: its velocity and spin, against the other, turn with that.
    [[nodiscard]] BodyState after(const BodyState& start, double since, double t, double dt) const noexcept;
    /// @return how it goes at `t`: the state whose velocity and spin are those of the way [m/s], [rad/s].
    [[nodiscard]] BodyState motion(double t, double dt) const noexcept;
};

/// How finely a path may be cut.
struct PathSettings {
    double dt = 0.0;         ///< of the whole step [s]
    double reach = 0.0;      ///< of the body from its centre of mass [m]
    double most_bend = 0.0;  ///< pieces that bend less are not split [m]
    dvec3 out_of_round{std::numeric_limits<double>::infinity()};  ///< of the body about its principal axes (body_sizes.hpp) [m]
};

/// @return the screw from one pose to the other, whose turns are those nearest to `turning` [rad].
[[nodiscard]] PathPiece chord(const Pose& from, const Pose& to, const dvec3& turning) noexcept;

class BodyPath {
public:
    static constexpr std::uint32_t kWhole = 0;

    /// Takes the path from `begin` to 1 of a body that is at `flight.start` at `begin`. Sway and bend are bounds: by the largest acceleration and the largest change
    /// of the spin that there can be. Of a body that nothing twists, symmetric about an axis about which its shapes are round, the path is one screw: the axis turns about the
    /// angular momentum at an even rate. How the body turns about its own axis meanwhile is left out.
    /// @param mass  stays alive as long as the path is split.
    /// @param arrived  where the integrator has it at 1, if somebody knows; else null.
    void fly(const Flight& flight, const BodyMass& mass, double begin, const PathSettings& settings, const BodyState* arrived = nullptr);
    /// Takes the path from `begin` to 1 of a body that is carried: of its pieces the turn is exact, and the arc of the centre of mass lies within their sway.
    void ride(const Ride& ride, double begin, const PathSettings& settings);
    /// Takes one piece, which is not split.
    void go(const PathPiece& piece);

    /// @return a piece by its number; kWhole is the path as one.
    [[nodiscard]] const PathPiece& piece(std::uint32_t number) const noexcept { return nodes_[number].piece; }
    [[nodiscard]] bool can_split(std::uint32_t number) const noexcept;
    /// @return the two halves, which are made the first time.
    std::pair<std::uint32_t, std::uint32_t> split(std::uint32_t number);

    /// @return how the body that flies moves at 1.
    [[nodiscard]] const BodyState& end() const noexcept { return nodes_.front().to; }

    /// @return a box about all that is ever within `reach` of the centre of mass.
    [[nodiscard]] Aabb box(double reach) const noexcept;

private:
    struct Node {
        PathPiece piece;
        BodyState from, to;
        std::uint32_t halves = 0;  ///< the first of the two; 0: not made
        int depth = 0;
    };
    [[nodiscard]] BodyState after(BodyState state, double share) const noexcept;
    void add(const BodyState& from, const BodyState& to, double begin, double end, int depth);
    void add_ride(double begin, double end, int depth);

    Flight flight_;
    Ride ride_;
    const BodyMass* mass_ = nullptr;  // null of what does not fly
    bool rides_ = false;
    PathSettings settings_;
    double most_pull_ = 0.0;    // [m/s²]
    double most_change_ = 0.0;  // of the spin [rad/s²]
    bool is_round_ = false;     // about the axis about which it is symmetric, and nothing twists it
    std::vector<Node> nodes_;
};

/// @return where the piece has the principal frame, at a time within it.
[[nodiscard]] Pose pose_at(const PathPiece& piece, double t) noexcept;
/// @return the part of a piece between two times within it.
[[nodiscard]] PathPiece cut(const PathPiece& piece, double begin, double end) noexcept;
/// @return how a shape that is placed by `local` in the principal frame moves.
[[nodiscard]] RigidMotion shape_motion(const PathPiece& piece, const Pose& local) noexcept;
/// @return a box about all that is within `reach` of the centre of mass.
[[nodiscard]] Aabb box_of(const PathPiece& piece, double reach) noexcept;

}  // namespace carom::dynamics
