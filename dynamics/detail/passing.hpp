// Predicted contacts that the motion of the step does not lead to.
//
//   passing.find(contacts, changes, proxies, bodies, motion, executor);
//   for (const ContactPair& pair : contacts.pairs) if (pair.passes) ...    // solved by nobody
//
// A contact of two shapes that do not touch yet is a half-space: beyond its plane the one must not come, wherever on the plane it gets there. Corners and
// edges that slip past each other never meet, though each crosses the plane that stands between their nearest points as the step begins: a cart that
// drives at 6 m/s some mm above a crate would take it along. So where the two are about to cross the plane, and are not faces that look at each other, or
// move sideways far beside their width, they are followed on their way through the step, each by itself: by the screw that its velocity, its spin and gravity make. What then
// stays apart has no contact in this step.
#pragma once

#include <carom/core/executor.hpp>
#include <carom/dynamics/detail/contact_patch.hpp>
#include <carom/dynamics/detail/first_touch.hpp>
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

class Passing {
public:
    /// Sets ContactPair::passes, and their impulses to 0.
    ///
    /// Looked at are pairs that do not touch, and do not lie on one another: nearer than |a| dt², a the pull, and no faster than four times that in the step. Planes are left out, whose contacts
    /// are exact for what does not turn, and pairs of two meshes.
    /// Accuracy: pushes of the step are not foreseen: what they bring together in it overlaps by the way that they move it at most, and is found so by the
    /// next. A turn is taken for one about the spin at the step's start. What comes nearer than 1e-9 of the sizes touches.
    /// @param changes  null: all pairs; else those with manifolds that were replaced or added
    /// Cost: a look at each pair; for each that may pass some 10 ns a point, or a search for a time of impact (some 2 µs; 5 with meshes). The same bits on
    /// every number of threads.
    void find(ContactSet& contacts, const ContactChanges* changes, const ProxySet& proxies, const BodyArrays& bodies, const Motion& motion, Executor& executor);

    /// Of the last find(), the pairs that pass.
    [[nodiscard]] std::span<const std::uint32_t> pairs() const noexcept { return found_; }

    void clear() noexcept { found_.clear(); }
    void trim();
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(found_); }

private:
    [[nodiscard]] bool passes(const ContactPair& pair, const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, const Motion& motion);

    std::vector<std::uint32_t> found_;  // while they are looked for: all that are apart
    Cores cores_;                       // of two meshes, which are left out: it stays empty, whoever shares it
};

}  // namespace carom::dynamics
