// Contacts that change sets: those of islands that fall asleep or wake, with their impulses.
//
//   mover.move(contacts, asleep, [&](const ContactPair& pair) { return sleeps(pair); });
#pragma once

#include <carom/core/function_ref.hpp>
#include <carom/dynamics/detail/contact_set.hpp>
#include <carom/dynamics/detail/room.hpp>

namespace carom::dynamics {

class ContactMover {
public:
    /// Takes the pairs of which `goes` is true out of `from` and puts them into `to`; both stay sorted by key. Cost: linear in the two sets; allocates
    /// nothing once warm.
    void move(ContactSet& from, ContactSet& to, FunctionRef<bool(const ContactPair&)> goes);
    [[nodiscard]] std::size_t memory() const noexcept { return stay_.memory() + joined_.memory(); }

private:
    ContactSet stay_, joined_;
};

}  // namespace carom::dynamics
