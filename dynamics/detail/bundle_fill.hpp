// Manifolds into the lanes of a bundle and impulses back out.
#pragma once

#include <carom/dynamics/detail/contact_bundle.hpp>
#include <carom/dynamics/detail/contact_kernels.hpp>
#include <carom/dynamics/detail/contact_set.hpp>

namespace carom::dynamics {

/// One manifold as a lane needs it.
struct LaneInput {
    const Manifold* manifold = nullptr;
    const ManifoldImpulses* impulses = nullptr;
    std::int32_t row_a = 0, row_b = 0;
    vec3 origin_a{0.0f}, origin_b{0.0f};  ///< the manifold's origin from the centres of mass [m]
    float friction = 0.0f, restitution = 0.0f;
    SoftContact soft;
    float push_limit = 0.0f;  ///< [m/s]
};

/// Makes every lane a no-op, bodies that never move, no mass, no impulse, in the points that a bundle of `point_count` uses.
void clear_bundle(ContactBundle& bundle, std::int32_t unmovable_row, std::size_t point_count) noexcept;

/// Fills a lane of a cleared bundle, with no more points than it was cleared for, for `prepare` to finish: normal_mass is 1 where a point is in use, separation is the
/// manifold's, and the friction impulse lies in tangent_impulse_1, tangent_impulse_2 and peak_impulse as x, y, z.
void fill_lane(ContactBundle& bundle, std::size_t lane, const LaneInput& input) noexcept;

/// Writes the accumulated impulses of all lanes to their contacts.
void store_impulses(const ContactBundle& bundle, ContactSet& contacts) noexcept;

}  // namespace carom::dynamics
