// A contact set that changes in places.
//
//   ContactPatch patch(contacts, may_end, changes);
//   for (each pair that was looked at, by rising key) patch.take(pair, found);
//   patch.finish(executor);
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
    std::vector<ContactPair> pairs;          // scratch, as are these: those that the set did not have
    std::vector<CarriedPoint> points;
    void clear() noexcept { removed.clear(), replaced.clear(), added.clear(), pairs.clear(); }
    void trim() { trim_scratch(removed), trim_scratch(replaced), trim_scratch(added), trim_scratch(pairs), trim_scratch(points); }
    [[nodiscard]] std::size_t memory() const noexcept { return held_by(removed, replaced, added, pairs, points); }
};

/// Puts what was found of some pairs in place of what the set has of them; all others stay as they are and where they are. Impulses go from point
/// to point as in link_manifolds(), at scale 1. Cost: linear in the pairs.
class ContactPatch {
public:
    using MayEnd = FunctionRef<bool(const ContactPair&)>;
    /// @param may_end  whether a pair that is not looked at has none any more
    ContactPatch(ContactSet& contacts, MayEnd may_end, ContactChanges& changes) : set_(contacts), may_end_(may_end), changes_(changes) {
        changes_.clear();
        set_.flying.clear();
    }

    /// @param looked  what contact_pair() gives, without manifolds, of a pair in the set or not; later than those before it
    /// @param found   all manifolds that it has now
    void take(const ContactPair& looked, std::span<const Manifold> found);
    /// After the last one: until then the set is not whole.
    void finish(Executor& executor);

private:
    void pass_until(std::uint64_t key);
    void drop(ContactPair& pair);
    void replace(ContactPair& pair, std::span<const Manifold> found);
    void append(ContactPair& pair, std::span<const Manifold> found);
    void put(ContactPair& pair, std::uint32_t m, const Manifold& found);
    void note_points(const ContactPair& pair);

    ContactSet& set_;
    MayEnd may_end_;
    ContactChanges& changes_;
    std::size_t done_ = 0;  // pairs of the set
};

}  // namespace carom::dynamics
