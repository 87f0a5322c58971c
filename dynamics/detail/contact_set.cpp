#include <carom/dynamics/detail/contact_set.hpp>

#include <carom/dynamics/detail/carried_contacts.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <utility>

namespace carom::dynamics {
namespace {

/// The mean is the sum until all are in. Without branches: which points overlap is anybody's guess.
void sum_up(std::span<const ContactPoint> points, ContactSummary& s) {
    s.points += points.size();
    for (const ContactPoint& point : points) {
        const double depth = point.separation < 0.0f ? -static_cast<double>(point.separation) : 0.0;
        s.touching += static_cast<std::size_t>(point.separation <= 0.0f);
        s.mean_penetration += depth;
        s.max_penetration = std::max(s.max_penetration, depth);
    }
}

void add(ContactSummary& sum, const ContactSummary& part) {
    sum.points += part.points;
    sum.touching += part.touching;
    sum.mean_penetration += part.mean_penetration;
    sum.max_penetration = std::max(sum.max_penetration, part.max_penetration);
}

void finish(ContactSummary& sum) {
    if (sum.touching > 0) sum.mean_penetration /= static_cast<double>(sum.touching);
}

void add_parts(ContactSet& contacts) {
    contacts.summary = {};
    for (const ContactSummary& part : contacts.parts) add(contacts.summary, part);
    finish(contacts.summary);
}

constexpr std::size_t kPart = 256;  // pairs worked on together, whatever the number of threads
constexpr std::size_t part_count(std::size_t pairs) { return (pairs + kPart - 1) / kPart; }

/// Calls `work` with the number of each part and the pairs [first, end) that it has.
template <class Work>
void for_parts(std::size_t pairs, Executor& executor, const Work& work) {
    executor.parallel_for(part_count(pairs), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) work(part, part * kPart, std::min(pairs, (part + 1) * kPart));
    });
}

/// Each part puts its own where it begins; then they close up.
void list_firsts(ContactSet& contacts, Executor& executor) {
    const std::vector<ContactManifold>& manifolds = contacts.manifolds;
    std::vector<std::uint32_t>& firsts = contacts.firsts;
    resize_with_room(firsts, manifolds.size() + 1);
    contacts.first_counts.assign(part_count(manifolds.size()), 0);
    for_parts(manifolds.size(), executor, [&](std::size_t part, std::size_t begin, std::size_t end) {
        std::size_t next = begin;
        for (std::size_t m = begin; m < end; ++m) {
            firsts[next] = static_cast<std::uint32_t>(m);
            next += m == 0 || manifolds[m].pair != manifolds[m - 1].pair ? 1 : 0;
        }
        contacts.first_counts[part] = static_cast<std::uint32_t>(next - begin);
    });
    std::size_t count = 0;
    for (std::size_t part = 0; part < contacts.first_counts.size(); ++part) {
        const auto from = firsts.begin() + static_cast<std::ptrdiff_t>(part * kPart);
        std::copy(from, from + contacts.first_counts[part], firsts.begin() + static_cast<std::ptrdiff_t>(count));
        count += contacts.first_counts[part];
    }
    firsts.resize(count + 1);
    firsts[count] = static_cast<std::uint32_t>(manifolds.size());
}

/// Pairs [begin, end).
ContactSummary link_part(ContactSet& contacts, FunctionRef<ContactPair(std::uint32_t candidate)> make, std::size_t begin, std::size_t end) {
    std::vector<ContactManifold>& manifolds = contacts.manifolds;
    ContactSummary sum;
    for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t first = contacts.firsts[i], next = contacts.firsts[i + 1];
        ContactPair& pair = contacts.pairs[i];
        pair = make(manifolds[first].pair);
        pair.first_manifold = first;
        pair.manifold_count = next - first;
        const std::size_t touched = sum.touching;
        for (std::uint32_t m = first; m < next; ++m) {
            manifolds[m].pair = static_cast<std::uint32_t>(i);
            pair.point_count += manifolds[m].count;
            sum_up(contacts.points_of(manifolds[m]), sum);
        }
        pair.predicted = sum.touching == touched;
    }
    return sum;
}

/// Of pairs [begin, end), which are linked.
void carry_part(ContactSet& contacts, const CarriedContacts& before, float scale, std::size_t begin, std::size_t end) {
    const std::span<const CarriedPair> old_pairs = before.pairs();
    auto old = std::ranges::lower_bound(old_pairs, contacts.pairs[begin].key, {}, &CarriedPair::key);
    for (std::size_t i = begin; i < end; ++i) {
        const ContactPair& pair = contacts.pairs[i];
        while (old != old_pairs.end() && old->key < pair.key) ++old;
        const bool known = old != old_pairs.end() && old->is(pair);
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            if (known) {
                carry_impulses(contacts.points_of(contacts.manifolds[m]), before.points_of(*old), scale, contacts.impulses_of(m));
            } else {
                std::ranges::fill(contacts.impulses_of(m), PointImpulse{});
            }
        }
    }
}

}  // namespace

void sum_up(ContactSet& contacts, Executor& executor) {
    contacts.parts.assign(part_count(contacts.manifolds.size()), {});
    for_parts(contacts.manifolds.size(), executor, [&](std::size_t part, std::size_t begin, std::size_t end) {
        ContactSummary sum;
        for (std::size_t m = begin; m < end; ++m) sum_up(contacts.points_of(contacts.manifolds[m]), sum);
        contacts.parts[part] = sum;
    });
    add_parts(contacts);
}

Manifold ContactSet::whole(std::uint32_t manifold) const noexcept {
    const ContactManifold& m = manifolds[manifold];
    Manifold out{.normal = m.normal, .pair = m.pair, .count = m.count, .part_a = m.part_a, .part_b = m.part_b};
    std::ranges::copy(points_of(m), out.points.begin());
    return out;
}

void ContactSet::append(const Manifold& manifold, std::uint32_t pair) {
    const auto m = static_cast<std::uint32_t>(manifolds.size());
    append_with_room(manifolds).pair = pair;
    put(m, manifold);
}

void ContactSet::put(std::uint32_t manifold, const Manifold& found) {
    ContactManifold& m = manifolds[manifold];
    const auto count = static_cast<std::uint8_t>(found.count);
    if (count > m.room) {
        unused_points += m.room;
        m.first_point = static_cast<std::uint32_t>(points.size());
        m.room = count;
        resize_with_room(points, points.size() + count);
        resize_with_room(impulses, points.size());
    }
    m.normal = found.normal;
    m.count = count;
    m.part_a = found.part_a, m.part_b = found.part_b;
    std::copy_n(found.points.begin(), count, points.begin() + m.first_point);
    std::fill_n(impulses.begin() + m.first_point, count, PointImpulse{});
}

void ContactSet::drop(std::uint32_t manifold) noexcept {
    unused_points += manifolds[manifold].room;
    manifolds[manifold] = {.pair = kNoPair};
}

void ContactSet::close_up() {
    constexpr std::size_t kFew = 64, kShare = 16;  // of those in use
    if (unused_points <= kFew + (points.size() - unused_points) / kShare) return;
    std::vector<ContactPoint> tight_points;
    std::vector<PointImpulse> tight_impulses;
    tight_points.reserve(with_room(points.size() - unused_points));
    tight_impulses.reserve(tight_points.capacity());
    for (ContactManifold& m : manifolds) {
        const std::size_t first = std::exchange(m.first_point, static_cast<std::uint32_t>(tight_points.size()));
        const auto move = [&](const auto& from, auto& to) {
            const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first);
            to.insert(to.end(), begin, begin + m.count);
        };
        move(points, tight_points), move(impulses, tight_impulses);
        m.room = m.count;
    }
    points.swap(tight_points), impulses.swap(tight_impulses);
    unused_points = 0;
}

void ContactSet::trim() {
    trim_kept(pairs);
    trim_kept(manifolds);
    trim_kept(points);
    trim_kept(impulses);
    trim_kept(order);
    trim_scratch(firsts);
    trim_scratch(flying);
}

void link_manifolds(ContactSet& contacts, FunctionRef<ContactPair(std::uint32_t candidate)> make, const CarriedContacts& before, float scale,
                    Executor& executor) {
    list_firsts(contacts, executor);
    const std::size_t count = contacts.firsts.size() - 1;
    resize_with_room(contacts.pairs, count);
    contacts.parts.assign(part_count(count), {});
    for_parts(count, executor, [&](std::size_t part, std::size_t begin, std::size_t end) {
        contacts.parts[part] = link_part(contacts, make, begin, end);
        carry_part(contacts, before, scale, begin, end);  // while they are in the cache
    });
    contacts.order.clear();
    contacts.patched = false;
    contacts.flying.clear();
    add_parts(contacts);
}

std::size_t ContactSet::memory() const noexcept { return held_by(pairs, manifolds, points, order, impulses, flying, firsts, first_counts, parts); }

}  // namespace carom::dynamics
