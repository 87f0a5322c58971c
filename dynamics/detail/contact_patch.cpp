#include <carom/dynamics/detail/contact_patch.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

class Patch {
public:
    Patch(ContactSet& contacts, std::span<const Manifold> found, ContactChanges& changes) : set_(contacts), found_(found), changes_(changes) {}

    /// Manifolds [first, end) of `found` are all that the pair has now.
    void replace(ContactPair& pair, std::uint32_t first, std::uint32_t end) {
        note_points(pair);
        if (end - first != pair.manifold_count) {
            drop(pair);
            return append(pair, first, end);
        }
        begin(pair);
        for (std::uint32_t m = pair.first_manifold; first < end; ++m, ++first) {
            const std::uint32_t number = set_.manifolds[m].pair;
            put(pair, m, first);
            set_.manifolds[m].pair = number;
            changes_.replaced.push_back(m);
        }
    }

    void drop(const ContactPair& pair) {
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            set_.manifolds[m] = Manifold{};
            set_.manifolds[m].pair = kNoPair;
            set_.impulses[m] = {};
            changes_.removed.push_back(m);
        }
    }

    void add(ContactPair& pair, std::uint32_t first, std::uint32_t end) {
        changes_.points.clear();
        append(pair, first, end);
    }

private:
    /// What the pair has, for the manifolds that come in its place.
    void note_points(const ContactPair& pair) {
        changes_.points.clear();
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            for (std::size_t k = 0; k < set_.manifolds[m].count; ++k) changes_.points.push_back({set_.manifolds[m].points[k].feature, set_.impulses[m][k]});
        }
    }

    void append(ContactPair& pair, std::uint32_t first, std::uint32_t end) {
        pair.first_manifold = static_cast<std::uint32_t>(set_.manifolds.size());
        pair.manifold_count = end - first;
        begin(pair);
        for (; first < end; ++first) {
            const auto m = static_cast<std::uint32_t>(set_.manifolds.size());
            set_.manifolds.emplace_back();
            set_.impulses.emplace_back();
            put(pair, m, first);
            changes_.added.push_back(m);
        }
    }

    static void begin(ContactPair& pair) noexcept {
        pair.point_count = 0;
        pair.predicted = true;
        pair.passes = pair.flies = false;  // until somebody finds that it does
    }

    void put(ContactPair& pair, std::uint32_t m, std::uint32_t from) {
        set_.manifolds[m] = found_[from];
        pair.point_count += found_[from].count;
        for (const ContactPoint& point : found_[from].used()) pair.predicted = pair.predicted && point.separation > 0.0f;
        carry_impulses(found_[from], changes_.points, 1.0f, set_.impulses[m]);
    }

    ContactSet& set_;
    std::span<const Manifold> found_;
    ContactChanges& changes_;
};

/// Of each manifold its pair, and the order of those in use.
void number_manifolds(ContactSet& contacts) {
    contacts.order.clear();
    for (std::uint32_t p = 0; p < contacts.pairs.size(); ++p) {
        const ContactPair& pair = contacts.pairs[p];
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            contacts.manifolds[m].pair = p;
            contacts.order.push_back(m);
        }
    }
}

}  // namespace

void patch_contacts(ContactSet& contacts, std::span<const ContactPair> looked, std::span<const Manifold> found,
                    FunctionRef<bool(const ContactPair&)> may_end, ContactChanges& changes, Executor& executor) {
    changes.clear();
    changes.pairs.clear();
    contacts.flying.clear();
    Patch patch(contacts, found, changes);
    std::vector<ContactPair>& pairs = contacts.pairs;
    std::size_t p = 0, kept = 0;  // pairs of the set that are done, and of these the first that is still to be copied
    const auto copy_up_to = [&](std::size_t end) {
        changes.pairs.insert(changes.pairs.end(), pairs.begin() + static_cast<std::ptrdiff_t>(kept), pairs.begin() + static_cast<std::ptrdiff_t>(end));
        kept = end;
    };
    const auto end_pair = [&] {
        copy_up_to(p);
        patch.drop(pairs[p]);
        kept = ++p;
    };
    const auto pass_until = [&](std::uint64_t key) {
        while (p < pairs.size() && pairs[p].key < key) may_end(pairs[p]) ? end_pair() : static_cast<void>(++p);
    };
    std::uint32_t next = 0;  // in `found`
    for (std::uint32_t k = 0; k < looked.size(); ++k) {
        const std::uint32_t first = next;
        while (next < found.size() && found[next].pair == k) ++next;
        pass_until(looked[k].key);
        const bool known = p < pairs.size() && pairs[p].key == looked[k].key;
        if (known) {
            next > first ? patch.replace(pairs[p++], first, next) : end_pair();
        } else if (next > first) {
            copy_up_to(p);
            changes.pairs.push_back(looked[k]);
            patch.add(changes.pairs.back(), first, next);
        }
    }
    pass_until(~std::uint64_t{0});
    if (!changes.added.empty() || !changes.removed.empty()) {
        copy_up_to(pairs.size());
        std::swap(pairs, changes.pairs);
        number_manifolds(contacts);
    }
    sum_up(contacts, executor);
}

}  // namespace carom::dynamics
