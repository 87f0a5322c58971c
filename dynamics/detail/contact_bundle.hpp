// Contacts as the solver sees them: sixteen manifolds side by side, one lane each.
//
// All lanes of a bundle belong to one colour: no two of them share a body that can move, so they are solved at once, and
// bundles of a colour in any order, with the same result. The layout is sixteen wide whatever the machine's width: narrower
// machines walk a bundle in two, four or more parts, and get the same bits.
#pragma once

#include <carom/core/bundle.hpp>
#include <carom/core/types.hpp>
#include <carom/dynamics/detail/scratch_pool.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::dynamics {

inline constexpr int kLanesPerBundle = kBundleWidth;
template <class T>
using Wide = std::array<T, kLanesPerBundle>;

/// What the solver reads and writes of a body: four rows of four floats. Relative to the body's pose at the start of the step.
struct alignas(64) SolverBody {
    float velocity[4] = {};              ///< x y z, unused [m/s]
    float spin[4] = {};                  ///< x y z, unused [rad/s]
    float shift[4] = {};                 ///< change of position since the start of the step [m]
    float turn[4] = {0, 0, 0, 1};        ///< change of orientation, quaternion x y z w
};

/// Inverse mass and inverse inertia in world axes, constant over the step but for bodies that turn fast (turning_rows.hpp).
struct alignas(32) SolverMass {
    float diagonal[4] = {};  ///< Ixx Iyy Izz and the inverse mass
    float others[4] = {};    ///< Ixy Ixz Iyz, and the square of the spin that is fast [rad²/s²]
};

/// What a substep starts from, before any impulse of its contacts, and the kick that each brings.
struct alignas(64) SolverBase {
    float velocity[4] = {};    ///< x y z, unused [m/s]
    float spin[4] = {};        ///< x y z, unused [rad/s]
    float kick[4] = {};        ///< change of velocity a substep, contacts apart: x y z, 0 [m/s]
    float turn[4] = {};        ///< change of spin a substep: x y z, 0 [rad/s]
};

/// A vector of each lane in its manifold's frame: along the normal and along its two tangents (see contact_lanes.hpp).
struct alignas(64) FrameVectors {
    Wide<float> n{}, t1{}, t2{};
};

struct alignas(64) PointLanes {
    FrameVectors a, b;                   ///< contact point from each body's centre of mass [m]
    Wide<float> separation{};            ///< at the start of the step [m]
    Wide<float> normal_mass{};           ///< effective mass along the normal; zero in unused lanes and points
    Wide<float> tangent_mass{};          ///< 1 / largest eigenvalue of the tangent plane's inverse mass
    Wide<float> normal_impulse{};        ///< accumulated over a substep [N s]
    Wide<float> tangent_impulse_1{}, tangent_impulse_2{};
    Wide<float> gap{};                   ///< separation where the bodies are, as the last pass found it [m]
};

/// A body's inverse mass and, in the manifold's frame, its inverse inertia: its diagonal and what lies beside it.
struct alignas(64) FrameMass {
    FrameVectors diagonal;
    Wide<float> n1{}, n2{}, t12{};
    Wide<float> inverse_mass{};
};

/// What passes make of a lane, a bit each.
struct LaneTraits {
    static constexpr std::int32_t kBallA = 1, kBallB = 2;  ///< the body is a ball: its contact point does not turn with it
    static constexpr std::int32_t kFixed = 4;              ///< one of the two cannot give way: the contact is stiffer
};

struct alignas(64) ContactBundle {
    Wide<std::int32_t> row_a{}, row_b{};  ///< rows of SolverBody; unused lanes point at the row that never moves
    Wide<float> nx{}, ny{}, nz{};         ///< normal from A to B
    FrameMass a, b;
    Wide<float> friction{};
    Wide<float> curvature{};              ///< of two balls: 1 / (2 × distance of their centres) [1/m]; 0 elsewhere
    Wide<std::int32_t> traits{};          ///< bits of LaneTraits
    Wide<float> push_limit{};             ///< overlap is removed at this speed at most [m/s]
    Wide<std::uint32_t> manifold{};       ///< index of the manifold; kUnusedLane where there is none
    PointLanes* points = nullptr;         ///< as many as some lane has: most manifolds have one or two of four
    std::int32_t point_count = 0;         ///< the largest of its lanes
    std::int32_t deep = 0;                ///< points whose push-out is limited
};
static_assert(offsetof(ContactBundle, manifold) % sizeof(Wide<float>) == 0, "lanes are loaded from where they are aligned");
inline constexpr std::uint32_t kUnusedLane = ~std::uint32_t{0};

/// The bodies in contact of one step. Rows [0, movable) are dynamic, then come kinematic ones, the last never moves.
struct SolverBodies {
    explicit SolverBodies(ScratchPool& pool) noexcept : memory(pool) {}
    /// Anything is in them. The first `before` bytes of their memory are for what is done with before they are filled.
    void resize(std::size_t count, std::size_t before = 0) {
        release();  // which spans are of, should there be no memory
        const std::size_t turning = static_cast<std::size_t>(movable);
        memory.resize(std::max(before, bytes_of<SolverBody>(count) + bytes_of<SolverBase>(count) + bytes_of<SolverMass>(count) + bytes_of<dquat>(turning)));
        std::byte* next = memory.data();
        bodies = cut<SolverBody>(next, count), bases = cut<SolverBase>(next, count), masses = cut<SolverMass>(next, count);
        turns = cut<dquat>(next, turning);
    }
    void release() noexcept {
        bodies = {}, bases = {}, masses = {}, turns = {};
        memory.release();
    }

    ScratchList<std::byte> memory;
    std::span<SolverBody> bodies;
    std::span<SolverBase> bases;
    std::span<SolverMass> masses;
    std::span<dquat> turns;  ///< (movable,) of what turns fast (turning_rows.hpp)
    std::int32_t movable = 0;
};

/// A range of bundles without a shared movable body.
struct Color {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
};

}  // namespace carom::dynamics
