// The joints of a step: which bodies they join to islands, and who moves those.
//
//   solver.gather(joints, bodies, budget);
//   solver.begin(joints, bodies, {contacts, direct.held()}, step);
//   solver.run_alone(bodies, executor);            // islands that no contact holds: over the whole step, in double
//   ... solver.warm_start(contact_solver, executor)   // the others live in the contact solver's rows: with its WarmStart,
//   ... solver.solve(contact_solver, k, executor)     // after each pass of its Solve,
//   ... solver.relax(contact_solver, k, executor)     // and of its Relax
//   solver.finish(joints);
#pragma once

#include <carom/core/executor.hpp>
#include <carom/dynamics/detail/contact_solver.hpp>
#include <carom/dynamics/detail/joint_island.hpp>
#include <carom/dynamics/detail/joint_set.hpp>
#include <carom/dynamics/detail/union_find.hpp>
#include <carom/dynamics/step_report.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

struct JointStep {
    dvec3 gravity{0.0};  ///< [m/s²]
    double dt = 0.0;     ///< [s]
    int substeps = 8;
    double spin_tolerance = 1e-6;
    std::size_t budget = 0;  ///< operations of blocks that a factorisation of an island may take
    [[nodiscard]] double substep() const noexcept { return dt / substeps; }
};

/// What may hold a body beside its joints.
struct OtherHolds {
    const ContactSet& contacts;
    std::span<const unsigned char> direct;  ///< by slot: 1 where the direct solve has moved the body; empty where nowhere
};

class JointSolver {
public:
    /// Notes who is joined. Where nothing changed since the last call this is one look at each joint.
    void gather(const JointSet& joints, const BodyArrays& bodies, std::size_t budget);
    /// By slot: 1 for dynamic bodies with joints; empty where there are none.
    [[nodiscard]] std::span<const unsigned char> jointed() const noexcept { return islands_.empty() ? std::span<const unsigned char>{} : std::span<const unsigned char>{jointed_}; }

    /// Sets the islands up for a step and finds those whose bodies have contacts.
    void begin(const JointSet& joints, const BodyArrays& bodies, const OtherHolds& others, const JointStep& step);
    /// Moves the bodies of islands without contacts.
    void run_alone(BodyArrays& bodies, Executor& executor);

    /// Slots of the bodies that contact solver and joints share.
    [[nodiscard]] std::span<const std::uint32_t> shared() const noexcept { return shared_; }
    void warm_start(ContactSolver& contacts, Executor& executor);
    /// @param substep  0 .. substeps - 1
    void solve(ContactSolver& contacts, int substep, Executor& executor);
    void relax(ContactSolver& contacts, int substep, Executor& executor);

    /// Writes the impulses to the joints.
    void finish(JointSet& joints);
    /// Nobody is joined: for worlds without joints.
    void clear() noexcept;

    /// @return whether run_alone() moved the body in `slot`.
    [[nodiscard]] bool holds(std::uint32_t slot) const noexcept { return slot < alone_.size() && alone_[slot] != 0; }
    /// JointSet::version() of the joints it knows.
    [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
    [[nodiscard]] const JointCounts& counts() const noexcept { return counts_; }
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    void rebuild(const JointSet& joints, const BodyArrays& bodies, std::size_t budget);
    template <class Act>
    void for_each_shared(Executor& executor, const Act& act);
    [[nodiscard]] bool is_active(const JointDef& def, const BodyArrays& bodies) const noexcept;
    [[nodiscard]] JointEnd end_of(BodyId body, const dvec3& anchor, const BodyArrays& bodies) const;
    void fill(JointIsland& island, const JointSet& joints, const BodyArrays& bodies) const;
    void kick(JointIsland& island, const BodyArrays& bodies, double h) const;
    void run_alone(JointIsland& island, BodyArrays& bodies) const;
    void read_rows(JointIsland& island, const ContactSolver& contacts, bool kicked) const;
    static void write_rows(const JointIsland& island, ContactSolver& contacts);

    JointStep step_;
    std::uint64_t version_ = 0;
    std::vector<unsigned char> active_;   // by the joints' order
    std::vector<JointIsland> islands_;
    std::vector<unsigned char> jointed_, alone_;  // by slot
    UnionFind sets_;                              // of slots
    std::vector<std::int32_t> local_;             // by slot: place in its island
    std::vector<std::uint32_t> shared_;
    const BodyArrays* bodies_ = nullptr;          // of the step
    JointCounts counts_;
};

}  // namespace carom::dynamics
