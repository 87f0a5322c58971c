// A contact set that changes in places.
#include <carom/dynamics/detail/contact_set.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

class Patch {
public:
    Patch(ContactSet& contacts, std::span<const Manifold> found, ContactChanges& changes) : set_(contacts), found_(found), changes_(changes) {}

    /// Manifolds [first, end) of `found` are all that the pair has now.
    void replace(ContactPair& pair, std::uint32_t first, std::uint32_t end) {
        const std::uint32_t count = end - first;
        if (count == pair.manifold_count) {
            for (std::uint32_t m = 0; m < count; ++m) {
                ManifoldImpulses impulses;
                carry_impulses(found_[first + m], impulses, set_, pair, 1.0f);
                carried().push_back(impulses);
            }
            for (std::uint32_t m = 0; m < count; ++m) put(pair.first_manifold + m, first + m, carried()[m]);
            carried().clear();
            for (std::uint32_t m = 0; m < count; ++m) changes_.replaced.push_back(pair.first_manifold + m);
            return;
        }
        const ContactPair old = pair;
        append(pair, first, end, &old);
        drop(old);
    }

    void drop(const ContactPair& pair) {
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            set_.manifolds[m] = Manifold{};
            set_.manifolds[m].pair = kNoPair;
            set_.impulses[m] = {};
            changes_.removed.push_back(m);
        }
    }

    /// @param old  where impulses come from; null: from nowhere
    void append(ContactPair& pair, std::uint32_t first, std::uint32_t end, const ContactPair* old) {
        pair.first_manifold = static_cast<std::uint32_t>(set_.manifolds.size());
        pair.manifold_count = end - first;
        for (std::uint32_t m = first; m < end; ++m) {
            ManifoldImpulses impulses{};
            if (old != nullptr) carry_impulses(found_[m], impulses, set_, *old, 1.0f);
            changes_.added.push_back(static_cast<std::uint32_t>(set_.manifolds.size()));
            set_.manifolds.push_back(found_[m]);
            set_.impulses.push_back(impulses);
        }
    }

private:
    [[nodiscard]] std::vector<ManifoldImpulses>& carried() noexcept { return changes_.impulses; }

    void put(std::uint32_t m, std::uint32_t from, const ManifoldImpulses& impulses) {
        const std::uint32_t pair = set_.manifolds[m].pair;
        set_.manifolds[m] = found_[from];
        set_.manifolds[m].pair = pair;
        set_.impulses[m] = impulses;
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
                    FunctionRef<bool(const ContactPair&)> may_end, ContactChanges& changes) {
    changes.clear();
    changes.pairs.clear();
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
            patch.append(changes.pairs.back(), first, next, nullptr);
        }
    }
    pass_until(~std::uint64_t{0});
    if (!changes.added.empty() || !changes.removed.empty()) {
        copy_up_to(pairs.size());
        std::swap(pairs, changes.pairs);
        number_manifolds(contacts);
    }
    sum_up(contacts);
}

}  // namespace carom::dynamics
