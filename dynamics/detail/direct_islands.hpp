// The direct escalation: which islands of a step are solved as one convex problem, and solving them.
//
//   direct.solve(world, choice, executor);      // before the soft solver prepares: moves the bodies of the islands that converge
//   if (direct.holds(slot)) ...                 // it did: the soft solver and the free integrator leave the body alone
#pragma once

#include <carom/core/executor.hpp>
#include <carom/dynamics/contact_method.hpp>
#include <carom/dynamics/detail/direct_newton.hpp>
#include <carom/dynamics/detail/direct_setup.hpp>
#include <carom/dynamics/detail/island_links.hpp>
#include <carom/dynamics/detail/sequential_impulses.hpp>
#include <carom/dynamics/detail/stiff_contacts.hpp>
#include <carom/dynamics/step_report.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace carom::dynamics {

struct DirectChoice {
    ContactMethod method = ContactMethod::Automatic;
    std::size_t budget = 0;  ///< operations of blocks that a factorisation may take
};

class DirectIslands {
public:
    /// @param pool  for what choose() needs meanwhile.
    explicit DirectIslands(ScratchPool& pool) noexcept : stiff_(pool) {}

    /// Finds the islands whose contacts would sag too far, or all of them with ContactMethod::Direct and ContactMethod::Impulses.
    /// @return whether there are any that solve() should try.
    bool choose(const DirectWorld& world, const DirectStep& step, const DirectChoice& choice);
    /// Solves those. Where a solve converges it moves the bodies and writes the impulses; otherwise the bodies stay as they are, and the soft
    /// solver begins without impulses.
    void solve(const DirectWorld& world, const DirectStep& step, Executor& executor);
    /// Nothing is held: for steps that look for no contacts.
    void clear() noexcept;

    /// @return whether the body in `slot` was moved in this step.
    [[nodiscard]] bool holds(std::uint32_t slot) const noexcept { return slot < held_.size() && held_[slot] != 0; }
    /// The same for all slots; empty where none is.
    [[nodiscard]] std::span<const unsigned char> held() const noexcept { return any_held_ ? std::span<const unsigned char>{held_} : std::span<const unsigned char>{}; }
    [[nodiscard]] const DirectCounts& counts() const noexcept { return counts_; }
    /// Gives back what steps seldom have use for, but for what is remembered of islands.
    void trim() noexcept;
    [[nodiscard]] std::size_t memory() const noexcept;

private:
    /// What an island keeps from step to step, under its root.
    struct Memory {
        std::uint32_t root = 0;
        std::uint64_t last_step = 0;   // that it was looked at
        std::uint64_t wait_until = 0;  // it is left to the soft solver before this step
        std::uint64_t wait = 0;        // that many steps the last time
        bool rested = false;           // in the step before, solved softly
        bool too_large = false;        // the last time that its graph was looked at
        std::uint64_t refused_until = 0;  // and is taken to be, before this step, unless it has shrunk from so many bodies and contacts between them
        std::size_t refused_bodies = 0, refused_joints = 0;
        bool analysed = false;
        std::vector<std::uint32_t> slots;    // what the analysis was made for
        std::vector<ContactLink> links;
        std::vector<double> loads;  // that the stiffness of each manifold was chosen for [N]
        DirectProblem problem;
        DirectNewton newton;
        SequentialImpulses impulses;
        IslandStiffness stiffness;
        DirectResult result;
    };
    struct Task {
        Island island;
        Memory* memory = nullptr;
    };
    [[nodiscard]] bool list_tasks(const DirectWorld& world, const DirectStep& step, const DirectChoice& choice);
    Memory& memory_of(std::uint32_t root);
    void consider(const Island& island, const DirectWorld& world, const DirectStep& step, const DirectChoice& choice);
    void take_if_stiff(const Island& island, const IslandShape& shape, const DirectWorld& world, const DirectStep& step, const DirectChoice& choice);
    void forget_lost_loads(std::span<const std::uint32_t> bodies, std::span<const std::uint32_t> manifolds, double weight, const DirectWorld& world) const;
    [[nodiscard]] bool was_held(std::span<const std::uint32_t> bodies) const;
    /// The island is put down for sequential impulses, unless it bounces.
    void put_down(const Island& island, const DirectWorld& world, const DirectStep& step);
    /// @return whether it converged.
    static bool solve_directly(Memory& memory, const IslandLists& island, const DirectWorld& world, const DirectStep& step);
    static void solve_by_impulses(Memory& memory, const IslandLists& island, const DirectWorld& world, const DirectStep& step);
    [[nodiscard]] bool analyse(Memory& memory, const Island& island, const DirectWorld& world, std::size_t budget);
    void leave_alone(Memory& memory, std::uint64_t most) const noexcept;

    std::uint64_t step_ = 0;
    ContactMethod method_ = ContactMethod::Automatic;
    IslandLinks links_;
    Uses gathers_;
    StiffContacts stiff_;
    std::vector<unsigned char> all_;  // marks of every manifold, with ContactMethod::Direct
    std::vector<unsigned char> held_, held_before_;  // by slot
    std::vector<std::int32_t> local_of_slot_;
    std::vector<std::unique_ptr<Memory>> memories_;  // by rising root
    std::vector<Task> tasks_;
    std::vector<ContactLink> new_links_;
    bool any_held_ = false;
    DirectCounts counts_;
};

}  // namespace carom::dynamics
