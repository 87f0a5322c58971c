#include <carom/dynamics/detail/sleep_contacts.hpp>

#include <algorithm>
#include <utility>

namespace carom::dynamics {
namespace {

void append(ContactSet& to, const ContactSet& from, const ContactPair& pair) {
    const auto index = static_cast<std::uint32_t>(to.pairs.size());
    const auto first = static_cast<std::uint32_t>(to.manifolds.size());
    to.pairs.push_back(pair);
    to.pairs.back().first_manifold = first;
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        const auto number = static_cast<std::uint32_t>(to.manifolds.size());
        to.append(from.whole(m), index);
        std::ranges::copy(from.impulses_of(m), to.impulses_of(number).begin());
    }
}

}  // namespace

void ContactMover::move(ContactSet& from, ContactSet& to, FunctionRef<bool(const ContactPair&)> goes) {
    stay_.clear();
    joined_.clear();
    std::size_t next = 0;  // of `to`
    for (const ContactPair& pair : from.pairs) {
        if (!goes(pair)) {
            append(stay_, from, pair);
            continue;
        }
        for (; next < to.pairs.size() && to.pairs[next].key < pair.key; ++next) append(joined_, to, to.pairs[next]);
        append(joined_, from, pair);
    }
    for (; next < to.pairs.size(); ++next) append(joined_, to, to.pairs[next]);
    std::swap(from, stay_);
    std::swap(to, joined_);
}

}  // namespace carom::dynamics
