// A step whose contacts are those of the step before, but for some: they stay in their lanes, and what changed finds its own.
#include <carom/dynamics/detail/contact_solver.hpp>

#include <carom/core/check.hpp>
#include <carom/core/flush_to_zero.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstring>
#include <functional>
#include <type_traits>
#include <utility>

namespace carom::dynamics {
namespace {

static_assert(sizeof(PointLanes) % sizeof(Wide<float>) == 0 && offsetof(ContactBundle, points) % sizeof(Wide<float>) == 0);
/// A bundle has as many points as that of its lanes that has most: lanes that get more make them more, until they are laid out anew. They are counted, and not
/// the points of the bundles, since which lanes share a bundle depends on the number of threads.
constexpr std::size_t kMostGrown = 8;  // in so many bundles, one lane; each gets room for its bundle at most once
constexpr std::size_t kChangesOfAPart = 64, kGroupsOfAPart = 4;
constexpr std::size_t kNumber = sizeof(float);
constexpr std::size_t kRowsOfPoint = sizeof(PointLanes) / sizeof(Wide<float>);
constexpr std::size_t kRowsOfHead = offsetof(ContactBundle, points) / sizeof(Wide<float>);  // the last is of manifolds

/// All that a bundle has of a lane, as many points of it as `to` has.
void copy_lane(const ContactBundle& from, std::size_t source, ContactBundle& to, std::size_t lane) {
    const auto copy_rows = [&](const void* first, void* into, std::size_t rows) {
        const auto* a = static_cast<const std::byte*>(first) + source * kNumber;
        auto* b = static_cast<std::byte*>(into) + lane * kNumber;
        for (std::size_t row = 0; row < rows; ++row) std::memcpy(b + row * sizeof(Wide<float>), a + row * sizeof(Wide<float>), kNumber);
    };
    copy_rows(&from, &to, kRowsOfHead);
    copy_rows(from.points, to.points, static_cast<std::size_t>(to.point_count) * kRowsOfPoint);
}

/// Points of a lane whose push-out is limited.
std::int32_t deep_in(const ContactBundle& c, std::size_t lane, const SoftContacts& soft) {
    const float bias_rate = ((c.traits[lane] & LaneTraits::kFixed) != 0 ? soft.fixed : soft.moving).bias_rate;
    std::int32_t deep = 0;
    for (std::int32_t k = 0; k < c.point_count; ++k) {
        const PointLanes& p = c.points[static_cast<std::size_t>(k)];
        deep += p.normal_mass[lane] > 0.0f && bias_rate * p.separation[lane] < -c.push_limit[lane] ? 1 : 0;
    }
    return deep;
}

/// Whether no other lane has a body of this one that moves: what a colour promises.
[[maybe_unused]] bool is_alone(const ContactBundle& c, std::size_t lane, std::int32_t movable) {
    for (std::size_t other = 0; other < kLanesPerBundle; ++other) {
        if (other == lane) continue;
        for (const std::int32_t row : {c.row_a[lane], c.row_b[lane]}) {
            if (row < movable && (row == c.row_a[other] || row == c.row_b[other])) return false;
        }
    }
    return true;
}

}  // namespace

void ContactSolver::note_places() {
    contacts_of_row_.assign(static_cast<std::size_t>(rows_.movable), 0);
    color_of_bundle_.resize(bundles_.size());
    free_.resize(colors_.size());
    for (std::size_t c = 0; c < colors_.size(); ++c) {
        free_[c].clear();
        for (std::uint32_t b = colors_[c].first; b < colors_[c].first + colors_[c].count; ++b) {
            color_of_bundle_[b] = static_cast<std::uint8_t>(c);
            for (std::uint32_t lane = 0; lane < kLanesPerBundle; ++lane) {
                const std::uint32_t m = bundles_[b].manifold[lane];
                const Place place = b * kLanesPerBundle + lane;
                if (m == kUnusedLane) free_[c].push_back(place);
            }
        }
    }
    for (const std::uint32_t slot : shared_) ++contacts_of_row_[static_cast<std::size_t>(row_of_slot_[slot])];  // others hold it without any
    grown_ = 0;
    most_room_ = bundles_.size() / kMostGrown;
    for (const ContactRows& rows : contact_rows_) {
        for (const std::int32_t row : {rows.a, rows.b}) {
            if (row < rows_.movable) ++contacts_of_row_[static_cast<std::size_t>(row)];
        }
    }
}

// What does not move may be in many contacts of a colour. Contacts with it come in the later colours if there is room.
bool ContactSolver::take_lane(std::uint32_t manifold) {
    const ContactRows rows = contact_rows_[manifold];
    std::uint32_t open = coloring_.open_to(rows);
    while (open != 0) {
        const bool fixed = rows.a >= rows_.movable || rows.b >= rows_.movable;
        const auto color = static_cast<std::uint32_t>(fixed ? std::bit_width(open) - 1 : std::countr_zero(open));
        open &= ~(std::uint32_t{1} << color);
        if (color >= free_.size() || free_[color].empty()) continue;
        coloring_.take(rows, color);
        const std::size_t best = best_lane(color, points_of(manifold));
        places_of_[manifold] = std::exchange(free_[color][best], free_[color].back());
        free_[color].pop_back();
        return true;
    }
    return false;
}

// Where it makes the bundle's points no more, and leaves lanes of more points to others.
std::size_t ContactSolver::best_lane(std::uint32_t color, std::int32_t points) const {
    const auto cost = [&](Place place) {
        const std::int32_t has = bundles_[place / kLanesPerBundle].point_count;
        return has >= points ? has - points : kMaxManifoldPoints + points - has;
    };
    return static_cast<std::size_t>(std::ranges::min_element(free_[color], {}, cost) - free_[color].begin());
}

// To a bundle of as many points as it has by now, if there is a lane.
void ContactSolver::move_up(std::uint32_t manifold) {
    const Place from = places_of_[manifold];
    const std::int32_t points = points_of(manifold);
    const std::uint32_t color = color_of_bundle_[from / kLanesPerBundle];
    if (points <= bundles_[from / kLanesPerBundle].point_count || free_[color].empty()) return;
    const std::size_t best = best_lane(color, points);
    if (bundles_[free_[color][best] / kLanesPerBundle].point_count < points) return;
    places_of_[manifold] = std::exchange(free_[color][best], from);
    moves_.push_back({kUnusedLane, from});
}

void ContactSolver::free_lane(std::uint32_t manifold) {
    const Place place = places_of_[manifold];
    const std::uint32_t color = color_of_bundle_[place / kLanesPerBundle];
    coloring_.give_back(contact_rows_[manifold], color);
    free_[color].push_back(place);
    places_of_[manifold] = kNowhere;
    moves_.push_back({kUnusedLane, place});
}

bool ContactSolver::goes_on(std::span<const unsigned char> held, const SolverSettings& settings) const {
    return is_whole_ && settings == settings_ && std::ranges::find(held, 1) == held.end();
}

bool ContactSolver::resume(const ContactSet& contacts, const ContactChanges& changes, std::span<const unsigned char> held, const ProxySet& proxies,
                           const BodyArrays& bodies, const SolverSettings& settings, Executor& executor) {
    if (!goes_on(held, settings)) return false;
    is_whole_ = false;
    const auto flies = [&](std::uint32_t manifold) { return contacts.pairs[contacts.manifolds[manifold].pair].flies; };
    const auto is_solved = [&](std::uint32_t manifold) { return contacts.pairs[contacts.manifolds[manifold].pair].is_solved(); };
    const auto is_in_lane = [&](std::uint32_t manifold) { return manifold < places_of_.size() && places_of_[manifold] != kNowhere; };
    const auto count = [&](std::uint32_t manifold, std::uint32_t change) {
        for (const std::int32_t row : {contact_rows_[manifold].a, contact_rows_[manifold].b}) {
            if (row < rows_.movable) contacts_of_row_[static_cast<std::size_t>(row)] += change;
        }
    };
    const auto has_contact = [&](std::uint32_t manifold) {
        const auto holds = [&](std::int32_t row) { return row >= rows_.movable || contacts_of_row_[static_cast<std::size_t>(row)] > 0; };
        return holds(contact_rows_[manifold].a) && holds(contact_rows_[manifold].b);
    };
    const auto has_rows = [&](std::uint32_t m) {
        const ContactPair& pair = contacts.pairs[contacts.manifolds[m].pair];
        const auto has_row = [&](std::uint32_t slot) { return bodies.roles[slot] == Role::Static || row_of_slot_[slot] != kNoRow; };
        return !pair.is_solved() || (has_row(pair.body_a.slot) && has_row(pair.body_b.slot));
    };
    if (!std::ranges::all_of(changes.replaced, has_rows) || !std::ranges::all_of(changes.added, has_rows)) return false;
    if (!std::exchange(places_known_, true)) note_places();
    for (const std::uint32_t p : contacts.flying) {  // what begins to fly loses its row
        const ContactPair& pair = contacts.pairs[p];
        for (std::uint32_t m = pair.first_manifold; m < pair.first_manifold + pair.manifold_count; ++m) {
            if (is_in_lane(m)) return false;
        }
    }
    point_count_ = contacts.summary.points;
    rows_.resize(slot_of_row_.size() + 1);
    begin_rows(proxies, bodies, executor);
    turning_.finish(rows_);
    fill_changed_rows(contacts, changes, executor);
    if (grown_ > most_room_) return false;  // each may need room of its own
    moves_.shorten(0);
    moves_.reserve(changes.replaced.size() + changes.removed.size() + changes.added.size());
    places_of_.resize(contacts.manifolds.size(), kNowhere);
    for (const std::uint32_t m : changes.replaced) {
        if (flies(m)) continue;
        if (!is_in_lane(m) && is_solved(m)) return false;  // it flew or passed, and nothing held it
        if (!is_in_lane(m)) continue;
        move_up(m);
        moves_.push_back({m, places_of_[m]});
    }
    for (const std::uint32_t m : changes.removed) {
        if (!is_in_lane(m)) continue;
        count(m, ~std::uint32_t{0});
        free_lane(m);
    }
    for (const std::uint32_t m : changes.added) {
        if (flies(m)) continue;
        count(m, 1);
        if (!take_lane(m)) return false;
        moves_.push_back({m, places_of_[m]});
    }
    if (!std::ranges::all_of(changes.removed, has_contact)) return false;
    for (const std::uint32_t m : changes.removed) contact_rows_[m] = {static_cast<std::int32_t>(slot_of_row_.size()), static_cast<std::int32_t>(slot_of_row_.size())};
    fill_moves(contacts, proxies, bodies, executor);
    moves_.release();
    deep_count_ = 0;
    for (const ContactBundle& bundle : bundles_) deep_count_ += static_cast<std::size_t>(bundle.deep);
    is_whole_ = true;
    return true;
}

// Removed ones keep their rows until their lanes are free.
void ContactSolver::fill_changed_rows(const ContactSet& contacts, const ContactChanges& changes, Executor& executor) {
    contact_rows_.resize(contacts.manifolds.size());
    kinds_.resize(contacts.manifolds.size());
    for (const std::vector<std::uint32_t>* some : {&changes.replaced, &changes.added}) {
        executor.parallel_for(some->size(), kChangesOfAPart, [&](std::size_t begin, std::size_t end) {
            std::size_t grown = 0;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t m = (*some)[i];
                const std::int32_t points = some == &changes.added ? 0 : points_of(m);
                contact_rows_[m] = rows_of(contacts.pairs[contacts.manifolds[m].pair]);
                kinds_[m] = kind_of(contact_rows_[m], contacts.solved_points(m));
                grown += points_of(m) > points ? 1 : 0;
            }
            if (grown > 0) std::atomic_ref(grown_).fetch_add(grown, std::memory_order_relaxed);
        });
    }
}

void ContactSolver::make_room(ContactBundle& bundle, std::int32_t points) {
    if (room_made_ == more_points_.size()) more_points_.push_back(std::make_unique<MorePoints>());
    MorePoints& room = *more_points_[room_made_++];
    std::fill(std::copy(bundle.points, bundle.points + bundle.point_count, room.begin()), room.end(), PointLanes{});
    bundle.points = room.data();
    bundle.point_count = points;
}

// A lane that was freed may be taken again: what comes to it last is all that counts, whoever does it first. And its bundle gets its room before.
void ContactSolver::order_moves() {
    ScratchList<std::uint32_t> last_move(moves_.pool());  // by place, of those in moves_
    last_move.resize(bundles_.size() * kLanesPerBundle);
    for (std::uint32_t i = 0; i < moves_.size(); ++i) last_move[moves_[i].place] = i;
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < moves_.size(); ++i) {
        if (last_move[moves_[i].place] == i) moves_[kept++] = moves_[i];
    }
    moves_.shorten(kept);
    last_move.release();
    for (const Move& move : moves_) {
        ContactBundle& to = bundles_[move.place / kLanesPerBundle];
        const std::int32_t points = move.manifold == kUnusedLane ? 0 : points_of(move.manifold);
        if (to.point_count < points) make_room(to, points);
    }
}

// Sixteen side by side, as prepare() does it, and then each to its place.
void ContactSolver::fill_group(std::size_t first, std::size_t count, const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies) {
    const auto row = [&](std::uint32_t m) {
        const ContactPair& pair = contacts.pairs[contacts.manifolds[m].pair];
        return row_of(contacts, m, side_of(pair.proxy_a(), proxies, bodies), side_of(pair.proxy_b(), proxies, bodies), proxies);
    };
    ContactBundle some{};
    std::array<PointLanes, kMaxManifoldPoints> points_of_some{};
    some.points = points_of_some.data();
    for (std::size_t lane = 0; lane < kLanesPerBundle; ++lane) {
        const std::uint32_t m = some.manifold[lane] = lane < count ? moves_[first + lane].manifold : kUnusedLane;
        put_row(some, lane, m == kUnusedLane ? unused_row() : row(m));
    }
    prepare_bundles({&some, 1}, {contacts.points, contacts.impulses, rows_, soft_});
    for (std::size_t lane = 0; lane < count; ++lane) {
        Move& move = moves_[first + lane];
        ContactBundle& to = bundles_[move.place / kLanesPerBundle];
        const std::size_t into = move.place % kLanesPerBundle;
        const std::int32_t deep = deep_in(to, into, soft_);
        copy_lane(some, lane, to, into);
        move.deep = deep_in(to, into, soft_) - deep;
    }
}

void ContactSolver::fill_moves(const ContactSet& contacts, const ProxySet& proxies, const BodyArrays& bodies, Executor& executor) {
    order_moves();
    const std::size_t groups = (moves_.size() + kLanesPerBundle - 1) / kLanesPerBundle;
    executor.parallel_for(groups, kGroupsOfAPart, [&](std::size_t begin, std::size_t end) {
        const FlushToZero no_denormals;  // as in prepare()
        for (std::size_t group = begin; group < end; ++group) {
            const std::size_t first = group * kLanesPerBundle;
            fill_group(first, std::min<std::size_t>(kLanesPerBundle, moves_.size() - first), contacts, proxies, bodies);
        }
    });
    for (const Move& move : moves_) {
        ContactBundle& to = bundles_[move.place / kLanesPerBundle];
        to.deep += move.deep;
        CAROM_ASSERT(is_alone(to, move.place % kLanesPerBundle, rows_.movable));
    }
}

void ContactSolver::trim() {
    if (!layouts_.take_seldom()) return;
    drop(lane_order_, lanes_, places_);
    coloring_.trim();
    constexpr std::size_t kShare = 32, kFew = 16;  // of what is in use, to spare: these are the largest lists
    const auto is_loose = [](const auto& list) { return list.capacity() > list.size() + list.size() / kShare + kFew; };
    const auto tighten = [](auto& list) {
        std::remove_reference_t<decltype(list)> tighter;
        tighter.reserve(list.size());
        tighter.assign(list.begin(), list.end());
        list.swap(tighter);
    };
    if (is_loose(bundles_)) tighten(bundles_);
    if (is_loose(points_)) {
        const PointLanes* const was = points_.data();
        const auto* const end = was + points_.size();
        const std::less<> before;
        const auto is_dealt_out = [&](const PointLanes* p) { return !before(p, was) && before(p, end); };  // others have room of their own
        std::vector<std::size_t> firsts(bundles_.size(), points_.size());
        for (std::size_t b = 0; b < bundles_.size(); ++b) {
            if (is_dealt_out(bundles_[b].points)) firsts[b] = static_cast<std::size_t>(bundles_[b].points - was);
        }
        tighten(points_);
        for (std::size_t b = 0; b < bundles_.size(); ++b) {
            if (firsts[b] < points_.size()) bundles_[b].points = points_.data() + firsts[b];
        }
    }
}

std::size_t ContactSolver::memory() const noexcept {
    std::size_t sum = rules_.memory() + rolling_.memory() + slender_.memory() + turning_.memory() + round_.memory() + parts_.memory() + coloring_.memory();
    sum += held_by(is_left_out_, is_slender_, slot_of_row_, row_of_slot_, shared_, color_parts_, contact_rows_, kinds_, places_, lane_order_, colors_, lanes_);
    sum += held_by(bundles_, points_, more_points_, places_of_, free_, color_of_bundle_, contacts_of_row_, phases_, tasks_);
    for (const std::vector<Place>& places : free_) sum += held_by(places);
    return sum + more_points_.size() * sizeof(MorePoints);
}

}  // namespace carom::dynamics
