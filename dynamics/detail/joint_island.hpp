// Bodies that joints join, solved together: all rows of an island at once, by the block factor of M + Jᵀ G J, in double.
//
//   island.analyse(budget);
//   island.look(0.5);                      // rows and factor where the bodies are, for half of the substep's impulse
//   island.solve(JointGoal::Positions);    // velocities with which the joints hold at the end of the substep
//
// docs/dynamics.md derives the rows.
#pragma once

#include <carom/core/ids.hpp>
#include <carom/dynamics/detail/block_cholesky.hpp>
#include <carom/dynamics/detail/body_state.hpp>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace carom::dynamics {

struct JointBody {
    std::uint32_t slot = 0;
    const BodyMass* mass = nullptr;
    BodyState state;
    dvec3 before_velocity{0.0}, before_spin{0.0};  ///< before the kick that the solve follows
    dvec3 pushed_velocity{0.0}, pushed_spin{0.0};  ///< what the joints gave in the substep so far
    dvec3 inverse_mass{0.0};     ///< along the world's axes: 0 where it is locked
    dmat3 inverse_turn{0.0};     ///< of the inertia and the stiffening below
    dmat3 stiffening{0.0};       ///< of turning under the joints' load, as impulse: N m s for each rad/s
    double stiffness = 0.0;      ///< sum over its springs of k / m felt [1/s²]
    double damping = 0.0;        ///< and of c / m [1/s]
};

/// One end of a joint: a body of the island, or something that moves by itself or not at all.
struct JointEnd {
    static constexpr std::int32_t kFixed = -1;
    std::int32_t body = kFixed;
    dvec3 local{0.0};                    ///< anchor, from the centre of mass in principal axes; of the world in its own
    Pose start{};                        ///< of what is fixed, at the start of the step
    dvec3 velocity{0.0}, spin{0.0};
};

struct JointRow {
    JointId id;
    bool ball = false;
    double rest_length = 0.0, stiffness = 0.0, damping = 0.0;
    JointEnd a, b;
    std::int32_t edge = -1;   ///< of the factor; -1 where one end is fixed

    dvec3 arm_a{0.0}, arm_b{0.0};  ///< anchors from the centres of mass [m]
    dvec3 fixed_velocity{0.0};     ///< of what is fixed, B's side less A's [m/s]
    dvec3 direction{0.0};          ///< of a spring, from A's anchor to B's
    dvec3 gap{0.0};                ///< from A's anchor to B's [m]
    dvec3 left{0.0};               ///< of a ball joint's gap, at the end of the drift [m]
    double along = 0.0, across = 0.0;  ///< G: impulse for each m/s along and across `direction` [kg]
    double keep = 0.0;             ///< the part of it that counts from the velocity before the kick [kg]
    dvec3 push{0.0}, law{0.0};     ///< impulse at rest: by the stretch, and with the velocity before the kick; λ = -(law + G u) [N s]
    dvec3 impulse{0.0};            ///< λ of the solve, on B [N s]
    dvec3 sum{0.0};                ///< of all solves of the step
    dvec3 force{0.0};              ///< on B, of the last solve for positions [N]
    dvec3 mean_force{0.0};         ///< on B, of the step before [N]
};

enum class JointGoal : unsigned char {
    Positions,   ///< ball joints close at the end of the drift that follows
    Velocities,  ///< their anchors do not part any more
};

class JointIsland {
public:
    std::vector<JointBody> bodies;
    std::vector<JointRow> rows;
    bool alone = true;            ///< no contact holds its bodies: they turn freely between solves
    double spin_tolerance = 1e-6;  ///< of that

    /// @return whether a factorisation takes at most `most_operations` of blocks; otherwise solve() goes from row to row, some sweeps.
    bool analyse(std::size_t most_operations);
    [[nodiscard]] bool is_direct() const noexcept { return direct_; }

    /// Sets rows and factor up for the bodies where they are.
    /// @param h [s], the drift that follows. @param time [s] since the start of the step.
    /// @param share  of the springs' impulse over h that each solve gives: 0, 1/2 or 1.
    void look(double h, double time, double share);
    /// Gives the impulses of the step before for a time of h: what contacts push against.
    void warm_start(double h);
    /// Changes the velocities, by impulses that are equal and opposite.
    void solve(JointGoal goal);
    void drift();

    /// The largest gap of a ball joint, as look() found it [m].
    [[nodiscard]] double worst_gap() const noexcept;
    /// @return how many solves for positions came to no solution since the last call.
    [[nodiscard]] std::size_t take_given_up() noexcept { return std::exchange(given_up_, 0u); }
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    [[nodiscard]] BodyState drifted(const JointBody& body) const;
    [[nodiscard]] Pose pose_of(const JointEnd& end, double time) const;
    [[nodiscard]] dvec3 gap_of(const JointRow& row, const Pose& a, const Pose& b) const noexcept;
    [[nodiscard]] dvec3 velocity_of(const JointRow& row) const noexcept;
    [[nodiscard]] dvec3 velocity_before(const JointRow& row) const noexcept;
    void look_at_bodies();
    void place_rows();
    void set_up_ball(JointRow& row) const noexcept;
    void set_up_spring(JointRow& row, double share) const noexcept;
    void stiffen() noexcept;
    void slow_down() noexcept;
    void assemble();
    void predict();
    /// λ by the rows' own law at the velocities as they are, less the λ of now.
    [[nodiscard]] dvec3 missing(const JointRow& row, JointGoal goal) const noexcept;
    void refine(JointGoal goal);
    void sweep(JointGoal goal);
    void give(JointRow& row, const dvec3& impulse) noexcept;
    void close_gaps();
    /// @param share  of the arms, that gaps may have.
    [[nodiscard]] bool has_closed(double share) const noexcept;

    double h_ = 0.0, time_ = 0.0, share_ = 0.0;
    bool direct_ = false, factored_ = false, any_ball_ = false;
    BlockCholesky factor_;
    std::vector<BlockEdge> edges_;
    std::size_t given_up_ = 0;
    std::vector<JointBody> before_;  // a solve that may be taken back
    std::vector<Vector6> step_;
    std::vector<dvec3> wanted_;   // by row: missing()
    std::vector<dvec3> ahead_;    // by row: the gap at the end of the drift, less what may be left of it
    std::vector<Pose> next_;      // by body: there
};

}  // namespace carom::dynamics
