// A contact set that changes in places.
//
//   patch_contacts(contacts, looked, found, may_end, changes);
#pragma once

#include <carom/core/function_ref.hpp>
#include <carom/dynamics/detail/carried_contacts.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace carom::dynamics {

/// What became of manifolds that were looked at anew, by number.
struct ContactChanges {
    std::vector<std::uint32_t> removed, replaced, added;
    std::vector<ContactPair> pairs;          // scratch, as are these
    std::vector<CarriedPoint> points;
    void clear() noexcept { removed.clear(), replaced.clear(), added.clear(); }
    void trim() { trim_scratch(removed), trim_scratch(replaced), trim_scratch(added), trim_scratch(pairs), trim_scratch(points); }
};

/// Puts what was found of some pairs in place of what the set has of them; all others stay as they are and where they are. Impulses go from point
/// to point as in link_manifolds(), at scale 1.
/// @param looked   of each pair that was looked at what contact_pair() gives, without manifolds; sorted by key, in the set or not
/// @param found    their manifolds, `pair` counted in `looked`
/// @param may_end  whether a pair that was not looked at has none any more
/// Cost: linear in the pairs.
void patch_contacts(ContactSet& contacts, std::span<const ContactPair> looked, std::span<const Manifold> found,
                    FunctionRef<bool(const ContactPair&)> may_end, ContactChanges& changes, Executor& executor);

}  // namespace carom::dynamics
