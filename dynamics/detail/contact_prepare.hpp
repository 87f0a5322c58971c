// Contacts into the lanes of bundles, ready for the passes, and impulses back out.
//
//   put_row(bundle, lane, row);                                                  // of all lanes
//   prepare_bundles(bundles, {points, impulses, bodies, soft});
//   ... passes ...
//   store_impulses(bundles, manifolds, impulses);
//
// Rows of memory become lanes by 128-bit loads and transposes, sixteen manifolds at a time.
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_set.hpp>

#include <cstddef>
#include <cstring>
#include <span>

namespace carom::dynamics {

/// What a lane needs of a manifold beside its points: one cache line, four rows of four.
struct alignas(64) ManifoldRow {
    float normal[3] = {0.0f, 1.0f, 0.0f};
    float push_limit = 0.0f;       ///< overlap is removed at this speed at most [m/s]
    float origin_a[3] = {};        ///< the manifold's origin from A's centre of mass [m]
    float friction = 0.0f;
    float origin_b[3] = {};        ///< and from B's
    std::int32_t round = 0;        ///< 1: A is a ball about its centre of mass; 2: B is; both: the bits of the float 1 / (2 × distance of their centres) [1/m]
    std::int32_t row_a = 0, row_b = 0;
    std::int32_t first_point = 0;
    std::int32_t count = 0;        ///< points in use; and kMeetsFixed where one of the two cannot give way
    static constexpr std::int32_t kMeetsFixed = 8;
};

/// Until a bundle is prepared, the rows of its lanes lie where the masses and what follows come to be: written manifold by manifold and read bundle by bundle, they
/// need no memory of their own.
static_assert(offsetof(ContactBundle, manifold) - offsetof(ContactBundle, a) >= kLanesPerBundle * sizeof(ManifoldRow));
inline std::byte* rows_in(ContactBundle& bundle) noexcept { return reinterpret_cast<std::byte*>(&bundle) + offsetof(ContactBundle, a); }
inline void put_row(ContactBundle& bundle, std::size_t lane, const ManifoldRow& row) noexcept {
    std::memcpy(rows_in(bundle) + lane * sizeof(ManifoldRow), &row, sizeof(ManifoldRow));
}

struct PrepareInput {
    std::span<const ContactPoint> points;
    std::span<const PointImpulse> impulses;
    const SolverBodies& bodies;
    SoftContacts soft;
};

/// Fills bundles, of which only `manifold` is set and each lane has its row (an unused one no points and rows that never move), with what the passes read: lever
/// arms, effective masses, and the impulses to start from along the tangents.
void prepare_bundles(std::span<ContactBundle> bundles, const PrepareInput& input);

/// Takes the gap that the last pass found for each point's separation, here and in the contacts: the next step begins where this one ended.
/// @param soft  as they were prepared
void carry_gaps(std::span<ContactBundle> bundles, std::span<const ContactManifold> manifolds, std::span<ContactPoint> points, const SoftContacts& soft);

/// Effective masses anew, of bundles with a row that is 1 in `changed`: the inverse inertias of these have changed.
void renew_masses(std::span<ContactBundle> bundles, const SolverBodies& bodies, std::span<const unsigned char> changed);

/// Writes the accumulated impulses of all lanes to their contacts.
void store_impulses(std::span<const ContactBundle> bundles, std::span<const ContactManifold> manifolds, std::span<PointImpulse> impulses);

}  // namespace carom::dynamics
