// Who may meet whom, and when: the searches of the continuous stage.
#include <carom/dynamics/detail/continuous.hpp>

#include <carom/collision/aabb.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace carom::dynamics {
namespace {

constexpr std::size_t kFastPart = 4096, kAskers = 32;        // what one thread does at a time: pairs, and bodies
constexpr std::size_t kCrowdLooks = 4;                       // for so many shapes one is asked for before it is a crowd
constexpr std::size_t kProbes = 4096;                        // that are looked at together
constexpr std::size_t kManyBounds = 256, kManySearches = 4;  // so many are worth several threads

}  // namespace

void Continuous::list_fast_pairs(const ContinuousScene& scene, std::span<const ProxyPair> found) {
    const std::size_t parts = (found.size() + kFastPart - 1) / kFastPart;
    if (fast_pairs_.size() < parts) fast_pairs_.resize(parts);
    for (FastPairs& part : fast_pairs_) part.pairs.clear();
    scene.executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            for (const ProxyPair& pair : found.subspan(k * kFastPart, std::min(kFastPart, found.size() - k * kFastPart))) {
                const std::uint32_t a = scene.proxies.bodies[pair.a], b = scene.proxies.bodies[pair.b];
                if ((is_fast_[a] | is_fast_[b]) != 0 && (is_stray_[a] | is_stray_[b]) == 0)
                    fast_pairs_[k].pairs.push_back({pair.a, pair.b});
            }
        }
    });
}

void Continuous::search_from_start(const ContinuousScene& scene) {
    const PairUpdate& found = scene.broadphase.result();
    const bool complete = found.status == PairStatus::Complete;
    if (complete) list_fast_pairs(scene, found.pairs);
    if (crowds_at_start(scene, complete)) list_courses(scene);
    const bool all_ask = crowd_ || !complete;
    if (!all_ask) {
        scene.executor.parallel_for(fast_pairs_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                std::erase_if(fast_pairs_[k].pairs, [&](const Pair& pair) {
                    return keep_company(scene, scene.proxies.bodies[pair.a], scene.proxies.bodies[pair.b]) ||
                           !may_meet(scene, pair.a, pair.b);
                });
                for (Pair& pair : fast_pairs_[k].pairs) pair = order(scene, pair.a, pair.b);
            }
        });
        for (const FastPairs& part : fast_pairs_) search_some(scene, part.pairs, 0.0);
        if (strays_.empty() && scene.proxies.planes.empty()) return;
    }
    search_first(scene, all_ask);
}

SweptPair swept_order(const ProxySet& proxies, const std::vector<Role>& roles, std::uint32_t p, std::uint32_t q) {
    const auto mass = [&](std::uint32_t proxy) { return has_mass(roles[proxies.bodies[proxy]]); };
    const auto mesh = [&](std::uint32_t proxy) { return type_of(proxies.by_slot[proxy].shape) == ShapeType::TriangleMesh; };
    const double size_p = proxies.extents[p], size_q = proxies.extents[q];
    const bool larger = size_q > size_p || (size_q == size_p && q < p);
    const bool swap = mass(p) != mass(q) ? mass(q) : mesh(p) != mesh(q) ? mesh(p) : larger;
    return swap ? SweptPair{q, p} : SweptPair{p, q};
}

double swept_size(const ProxySet& proxies, const SweptPair& pair) {
    return std::min(proxies.extents[pair.a],
                    proxies.kinds[pair.b] == ProxyKind::Plane ? std::numeric_limits<double>::infinity() : proxies.extents[pair.b]);
}

// Of somebody who is struck here everybody is asked for, whoever else asked: what was found before goes by his old path.
void Continuous::search_first(const ContinuousScene& scene, bool all_ask) {
    for (const std::uint32_t slot : fast_) (void)mover_of(scene, slot);
    const std::size_t parts = (fast_.size() + kAskers - 1) / kAskers;
    if (finders_.size() < parts) finders_.resize(parts);
    const auto list = [&](std::uint32_t slot, Finder& finder) {
        const Ask ask = all_ask || is_stray_[slot] != 0 ? Ask::Everybody : Ask::StraysOnly;
        const Mover& mover = movers_[mover_of_slot_[slot]];
        for (std::uint32_t k = first_proxy_[slot]; k < first_proxy_[slot + 1]; ++k) {
            const std::uint32_t p = proxies_[k];
            for_each_near(scene, mover, p, ask, 0.0, 1.0, finder.near, [&](std::uint32_t q) {
                const std::uint32_t other = scene.proxies.bodies[q];
                const bool other_asks = is_fast_[other] != 0 && other < slot;
                if (!other_asks && !keep_company(scene, slot, other)) finder.pairs.push_back(order(scene, p, q));
            });
        }
    };
    scene.executor.parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            finders_[k].pairs.clear();
            for (const std::uint32_t slot : std::span{fast_}.subspan(k * kAskers, std::min(kAskers, fast_.size() - k * kAskers)))
                list(slot, finders_[k]);
        }
    });
    std::vector<Pair> pairs;  // what is struck lists others
    for (std::size_t k = 0; k < parts; ++k) pairs.insert(pairs.end(), finders_[k].pairs.begin(), finders_[k].pairs.end());
    search_some(scene, pairs, 0.0);
}

void Continuous::search_around(const ContinuousScene& scene, std::span<const Around> around, double from) {
    if (!crowd_ && !no_crowd_ && (looks_ += around.size()) > proxies_.size() / kCrowdLooks) {
        no_crowd_ = !may_crowd(scene);
        if (!no_crowd_) list_courses(scene);
    }
    if (finders_.size() < around.size()) finders_.resize(around.size());
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Finder& finder = finders_[i];
            finder.pairs.clear();
            const Mover& mover = movers_[around[i].mover];
            for (std::uint32_t k = first_proxy_[mover.slot]; k < first_proxy_[mover.slot + 1]; ++k) {
                const std::uint32_t p = proxies_[k];
                for_each_near(scene, mover, p, Ask::Everybody, from, 1.0, finder.near, [&](std::uint32_t q) {
                    const std::uint32_t other = scene.proxies.bodies[q];
                    if (other != around[i].skip && !stay_together(scene, mover.slot, other)) finder.pairs.push_back(order(scene, p, q));
                });
            }
        }
    };
    crowd_ ? list(0, around.size()) : scene.executor.parallel_for(around.size(), 1, list);  // what a table tells is told in a microsecond
    std::vector<Pair> pairs = std::exchange(finders_[0].pairs, {});                         // what is struck lists others
    for (std::size_t i = 1; i < around.size(); ++i) pairs.insert(pairs.end(), finders_[i].pairs.begin(), finders_[i].pairs.end());
    search_some(scene, pairs, from);
    finders_[0].pairs.swap(pairs);
}

// Of a body with a hundred in its way the first one that it meets gives it another way, so mostly one of a hundred times of impact is of any use.
void Continuous::search_some(const ContinuousScene& scene, std::span<const Pair> pairs, double from) {
    std::vector<Probe> probes = std::exchange(probes_, {});  // likewise
    for (std::size_t first = 0; first < pairs.size(); first += kProbes) {
        probes.clear();
        for (const Pair& pair : pairs.subspan(first, std::min(kProbes, pairs.size() - first))) {
            const std::uint32_t a = mover_of(scene, scene.proxies.bodies[pair.a]), b = mover_of(scene, scene.proxies.bodies[pair.b]);
            if (!go_together(scene, a, b)) probes.push_back({pair, movers_[a].version, movers_[b].version});
        }
        const auto bound = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) probes[i].chance = first_chance_of(scene, probes[i].pair, from);
        };
        probes.size() < kManyBounds ? bound(0, probes.size()) : scene.executor.parallel_for(probes.size(), kManyBounds / 4, bound);
        look_together(scene, probes, from);
        for (const Probe& probe : probes) {
            if (is_current(scene, probe.pair, probe.version_a, probe.version_b))
                take(scene, probe, from);  // who was struck since has asked for all
        }
    }
    probes_.swap(probes);
}

// On one thread who takes the answers asks. Meshes have hulls made for them then.
void Continuous::look_together(const ContinuousScene& scene, std::span<Probe> probes, double from) {
    if (scene.executor.thread_count() == 1) return;
    const auto has_hull = [&](const Probe& probe) { return type_of(scene.proxies.by_slot[probe.pair.a].shape) == ShapeType::TriangleMesh; };
    at_once_.clear();
    for (std::uint32_t i = 0; i < probes.size(); ++i) {
        if (probes[i].chance <= from && !has_hull(probes[i])) at_once_.push_back(i);
    }
    if (at_once_.size() < kManySearches) return;
    scene.executor.parallel_for(at_once_.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) look(scene, probes[at_once_[i]], from);
    });
}

// Paths that a search makes finer are one thread's: others take copies.
void Continuous::look(const ContinuousScene& scene, Probe& probe, double from) {
    PathSearch search = search_of(scene, probe.pair, from, 0);
    BodyPath copies[2];
    int copied = 0;
    for (PathShape* shape : {&search.a, &search.b}) {
        if (!shape->path->can_split(BodyPath::kWhole)) continue;
        copies[copied] = *shape->path;
        shape->path = &copies[copied++];
    }
    probe.met = touch(search, from, 1.0, cores_);
    probe.answer = search;
}

void Continuous::take(const ContinuousScene& scene, const Probe& probe, double from) {
    if (++chance_count_ > most_chances_) budget_ = 0;
    if (probe.chance == kNoChance) return;
    if (probe.chance > from) {
        chances_.push_back({probe.chance, from, probe.pair, probe.version_a, probe.version_b});
        std::push_heap(chances_.begin(), chances_.end(), Chance::later);
    } else if (probe.answer) {
        take_answer(scene, probe.pair, *probe.answer, probe.met, 0.0);
    } else {
        search(scene, probe.pair, from, 0);
    }
}

bool Continuous::is_current(const ContinuousScene& scene, const Pair& pair, std::uint32_t version_a, std::uint32_t version_b) const {
    const auto version = [&](std::uint32_t proxy) { return movers_[mover_of_slot_[scene.proxies.bodies[proxy]]].version; };
    return version(pair.a) == version_a && version(pair.b) == version_b;
}

void Continuous::take_chance(const ContinuousScene& scene) {
    std::pop_heap(chances_.begin(), chances_.end(), Chance::later);
    const Chance chance = chances_.back();
    chances_.pop_back();
    if (is_current(scene, chance.pair, chance.version_a, chance.version_b)) search(scene, chance.pair, chance.from, 0, chance.t);
}

double Continuous::first_chance_of(const ContinuousScene& scene, const Pair& pair, double from) const {
    const Proxy &a = scene.proxies.by_slot[pair.a], &b = scene.proxies.by_slot[pair.b];
    const std::uint32_t body_a = scene.proxies.bodies[pair.a], body_b = scene.proxies.bodies[pair.b];
    const Mover &mover_a = movers_[mover_of_slot_[body_a]], &mover_b = movers_[mover_of_slot_[body_b]];
    const Ball ball{&mover_a.course, a.reach};
    const double room = kSweepRoomShare * size_of(scene, pair);
    const Role role = scene.bodies.roles[body_b];
    const PathPiece& way = mover_b.path.piece(BodyPath::kWhole);
    if (scene.proxies.kinds[pair.b] != ProxyKind::Plane) {
        if (role == Role::Static) return first_chance(ball, bounds(b.shape, scene.proxies.poses[pair.b]), from, room);
        const Ball other{&mover_b.course, b.reach};
        const double by_balls = first_chance(ball, other, from, room);
        if (by_balls > from || role != Role::Kinematic) return by_balls;
        return first_chance(ball, other, bounds(b.shape, way.start * b.local.get()), from, room);  // walls and floors are large and thin
    }
    if (way.rotation != dvec3{0.0}) return from;  // seldom, and the search is short
    const Pose pose = way.start * b.local.get();
    const Plane& plane = std::get<Plane>(b.shape);
    const dvec3 n(plane.normal);
    const double length = glm::length(n);
    return first_chance(ball, mover_b.course, transform_point(pose, (static_cast<double>(plane.offset) / (length * length)) * n),
                        rotate(pose.orientation, n / length), from, room);
}

PathSearch Continuous::search_of(const ContinuousScene& scene, const Pair& pair, double from, int level) {
    const Proxy &a = scene.proxies.by_slot[pair.a], &b = scene.proxies.by_slot[pair.b];
    const std::uint32_t body_a = scene.proxies.bodies[pair.a], body_b = scene.proxies.bodies[pair.b];
    Mover &mover_a = movers_[mover_of_slot_[body_a]], &mover_b = movers_[mover_of_slot_[body_b]];
    PathSearch search{.a = {&mover_a.path, &a.shape, &a.local.get(), a.reach}, .b = {&mover_b.path, &b.shape, &b.local.get(), b.reach}};
    search.level = level;
    search.from = from;
    search.tolerance = kSweepToleranceShare * size_of(scene, pair);
    const bool is_plane = scene.proxies.kinds[pair.b] == ProxyKind::Plane;
    if (is_plane || scene.bodies.roles[body_b] == Role::Static)
        search.still = is_plane ? kEverywhere : bounds(b.shape, scene.proxies.poses[pair.b]);
    return search;
}

void Continuous::search(const ContinuousScene& scene, const Pair& pair, double from, int level, double earliest) {
    if (go_together(scene, mover_of(scene, scene.proxies.bodies[pair.a]), mover_of(scene, scene.proxies.bodies[pair.b]))) return;
    PathSearch search = search_of(scene, pair, from, level);
    const bool met = touch(search, from, 1.0, cores_);
    take_answer(scene, pair, search, met, earliest);
}

void Continuous::take_answer(const ContinuousScene& scene, const Pair& pair, const PathSearch& answer, bool met, double earliest) {
    if (++counts_.pairs > most_pairs_) budget_ = 0;
    pieces_left_ -= answer.pieces;
    if (pieces_left_ < 0) budget_ = 0;
    if (!met) return;
    counts_.clamped += answer.impact.status == ImpactStatus::Clamped ? 1 : 0;
    const double t = std::max(answer.t, earliest), from = answer.from;
    const int level = answer.level;
    // What touches from the start is the solver's.
    if (t == from && (from == 0.0 || level > 0))
        return search_deeper(scene, pair, from, from == 0.0 ? std::max(level, kLevelOfContacts - 1) : level);
    const auto version = [&](std::uint32_t proxy) { return movers_[mover_of_slot_[scene.proxies.bodies[proxy]]].version; };
    events_.push_back({t, pair, level, version(pair.a), version(pair.b), answer.impact, answer.bend});
    std::push_heap(events_.begin(), events_.end(), Event::later);
}

}  // namespace carom::dynamics
