#include <carom/dynamics/detail/contact_patch.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

/// Of each manifold its pair, and the order of those in use.
void number_manifolds(ContactSet& contacts) {
    contacts.order.clear();
    reserve_with_room(contacts.order, contacts.manifolds.size());
    contacts.patched = true;
    for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) {
        const ContactPair& pair = contacts.pairs[p];
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            contacts.manifolds[m].pair = p;
            contacts.order.push_back(m);
        }
    }
}

void begin(ContactPair& pair) noexcept {
    pair.point_count = 0;
    pair.predicted = true;
    pair.passes = pair.flies = false;  // until somebody finds that it does
}

/// Both lists by rising key. From the back, so that no second list is needed.
void merge_into(std::vector<ContactPair>& pairs, const std::vector<ContactPair>& more) {
    std::size_t left = pairs.size(), to = left + more.size();
    resize_with_room(pairs, to);
    for (std::size_t k = more.size(); k > 0;) {
        const bool is_later = left == 0 || pairs[left - 1].key < more[k - 1].key;
        pairs[--to] = is_later ? more[--k] : pairs[--left];
    }
}

}  // namespace

void ContactPatch::take(const ContactPair& looked, std::span<const Manifold> found) {
    pass_until(looked.key);
    std::vector<ContactPair>& pairs = set_.pairs;
    if (done_ < pairs.size() && pairs[done_].key == looked.key) {
        ContactPair& pair = pairs[done_++];
        found.empty() ? drop(pair) : replace(pair, found);
    } else if (!found.empty()) {
        changes_.points.clear();
        append(changes_.pairs.emplace_back(looked), found);
    }
}

void ContactPatch::finish(Executor& executor) {
    pass_until(~std::uint64_t{0});
    if (!changes_.added.empty() || !changes_.removed.empty()) {
        std::erase_if(set_.pairs, [](const ContactPair& pair) { return pair.manifold_count == 0; });
        merge_into(set_.pairs, changes_.pairs);
        number_manifolds(set_);
    }
    set_.close_up();
    sum_up(set_, executor);
}

void ContactPatch::pass_until(std::uint64_t key) {
    for (; done_ < set_.pairs.size() && set_.pairs[done_].key < key; ++done_) {
        if (may_end_(set_.pairs[done_])) drop(set_.pairs[done_]);
    }
}

void ContactPatch::drop(ContactPair& pair) {
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        set_.drop(m);
        changes_.removed.push_back(m);
    }
    pair.manifold_count = 0;
}

void ContactPatch::replace(ContactPair& pair, std::span<const Manifold> found) {
    note_points(pair);
    if (found.size() != pair.manifold_count) {
        drop(pair);
        return append(pair, found);
    }
    begin(pair);
    std::uint32_t m = pair.first_manifold;
    for (const Manifold& manifold : found) {
        put(pair, m, manifold);
        changes_.replaced.push_back(m++);
    }
}

// What the pair has, for the manifolds that come in its place.
void ContactPatch::note_points(const ContactPair& pair) {
    changes_.points.clear();
    for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
        const ContactManifold& manifold = set_.manifolds[m];
        for (std::size_t k = manifold.first_point; k < manifold.first_point + manifold.count; ++k)
            changes_.points.push_back({set_.points[k].feature, set_.impulses[k]});
    }
}

void ContactPatch::append(ContactPair& pair, std::span<const Manifold> found) {
    pair.first_manifold = static_cast<std::uint32_t>(set_.manifolds.size());
    pair.manifold_count = static_cast<std::uint32_t>(found.size());
    begin(pair);
    for (const Manifold& manifold : found) {
        const auto m = static_cast<std::uint32_t>(set_.manifolds.size());
        append_with_room(set_.manifolds);
        put(pair, m, manifold);
        changes_.added.push_back(m);
    }
}

void ContactPatch::put(ContactPair& pair, std::uint32_t m, const Manifold& found) {
    set_.put(m, found);
    pair.point_count += found.count;
    for (const ContactPoint& point : found.used()) pair.predicted = pair.predicted && point.separation > 0.0f;
    carry_impulses(found.used(), changes_.points, 1.0f, set_.impulses_of(m));
}

}  // namespace carom::dynamics
