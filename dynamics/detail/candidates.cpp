// Which pairs of proxies are looked at, and how far ahead.
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr std::size_t kPairGrain = 1024;
constexpr std::uint32_t kSlotsOfAPart = 256, kSlotsWorthSharing = 2048;
constexpr double kMarginShare = 0.25;  // of the smallest extent

/// Whether the shape lay still when candidates were listed: who has mass may have fallen asleep since.
bool lay_still(const ProxySet& set, const BodyArrays& bodies, std::uint32_t i) {
    const Role role = bodies.roles[set.bodies[i]];
    return has_mass(role) ? !set.filters[i].movable : lies_still(role);
}

/// @param motion  how far b may come
NumberedPair candidate_of(const ProxySet& set, const BodyArrays& bodies, std::uint32_t a, std::uint32_t b, double motion) {
    const auto may_be_kept = [&](std::uint32_t i) { return set.anchors[i].room >= 0.0 || lay_still(set, bodies, i); };
    const double most = kMarginShare * std::min(set.extents[a], set.extents[b]);
    const double stay = set.stay[a] + set.stay[b];         // until they are looked at again
    const double closing = set.motion[a] + motion - stay;  // the rest is of this step
    const auto in_step = [&](std::uint32_t i, double all) { return set.stay[i] > 0.0 ? set.way[i] : all; };
    const bool kept = may_be_kept(a) && may_be_kept(b);
    return {a, b, static_cast<float>(kept ? stay + std::min(closing, most) : std::min(in_step(a, set.motion[a]) + in_step(b, motion), most))};
}

/// Of the slots [first, last).
template <class List>
void list_candidates_of(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt, std::uint32_t first,
                        std::uint32_t last, List& out) {
    const auto list = [&](std::uint32_t a, std::uint32_t b, double motion) { out.push_back(candidate_of(set, bodies, a, b, motion)); };
    auto next =
        std::lower_bound(found.begin(), found.end(), first, [](const ProxyPair& pair, std::uint32_t slot) { return pair.a < slot; });
    for (std::uint32_t i = first; i < last; ++i) {
        if (set.kinds[i] != ProxyKind::Bounded) continue;
        for (; next != found.end() && next->a == i; ++next) {
            if (set.bodies[i] != set.bodies[next->b]) list(i, next->b, set.motion[next->b]);
        }
        if (!set.filters[i].movable) continue;
        for (const std::uint32_t p : set.planes) {
            if (!filters_agree(set.filters[i], set.filters[p])) continue;
            if (gap_over_plane(set, bodies, i, p, dt) <= 0.0) list(i, p, motion_of_plane(set, bodies, p, i, dt));
        }
    }
}

}  // namespace

void list_candidates(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt, Executor& executor,
                     CandidateParts& parts, ScratchList<NumberedPair>& out) {
    const auto slots = static_cast<std::uint32_t>(set.by_slot.size());
    out.shorten(0);
    out.reserve(found.size());
    if (executor.thread_count() == 1 || slots < kSlotsWorthSharing) return list_candidates_of(set, bodies, found, dt, 0, slots, out);
    const std::size_t count = (slots + kSlotsOfAPart - 1) / kSlotsOfAPart;
    if (parts.size() < count) parts.resize(count);
    executor.parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto first = static_cast<std::uint32_t>(k * kSlotsOfAPart);
            parts[k].pairs.clear();
            list_candidates_of(set, bodies, found, dt, first, std::min(first + kSlotsOfAPart, slots), parts[k].pairs);
        }
    });
    std::size_t size = 0;
    for (std::size_t k = 0; k < count; ++k) size += parts[k].pairs.size();
    out.resize(size);
    executor.parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
        std::size_t at = 0;
        for (std::size_t k = 0; k < begin; ++k) at += parts[k].pairs.size();
        for (std::size_t k = begin; k < end; ++k) {
            std::copy(parts[k].pairs.begin(), parts[k].pairs.end(), out.begin() + at);
            at += parts[k].pairs.size();
        }
    });
}

std::optional<NumberedPair> find_candidate(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt,
                                           std::uint32_t a, std::uint32_t b) {
    if (set.bodies[a] == set.bodies[b]) return {};
    if (set.kinds[b] != ProxyKind::Plane) {
        const auto less = [](const ProxyPair& x, const ProxyPair& y) { return x.a != y.a ? x.a < y.a : x.b < y.b; };
        if (!std::binary_search(found.begin(), found.end(), ProxyPair{a, b}, less)) return {};
        return candidate_of(set, bodies, a, b, set.motion[b]);
    }
    if (!set.filters[a].movable || !filters_agree(set.filters[a], set.filters[b]) || !(gap_over_plane(set, bodies, a, b, dt) <= 0.0)) return {};
    return candidate_of(set, bodies, a, b, motion_of_plane(set, bodies, b, a, dt));
}

namespace {

std::uint64_t key_of(const ProxySet& set, const NumberedPair& candidate) noexcept {
    const std::uint32_t plane_bit = set.kinds[candidate.b] == ProxyKind::Plane ? ContactPair::kPlane : 0u;  // planes sort after the rest
    return std::uint64_t{candidate.a} << 32 | (candidate.b | plane_bit);
}

bool are_two_boxes(const ProxySet& set, const NumberedPair& pair) noexcept { return (set.boxlike[pair.a] & set.boxlike[pair.b]) != 0; }

}  // namespace

float slack_of(const ProxySet& set, double share, const NumberedPair& pair) noexcept {
    const auto is_on_its_way = [&](std::uint32_t i) { return set.anchors[i].room < 0.0 && set.motion[i] > 0.0; };
    const bool may_hit = (set.bounces[pair.a] | set.bounces[pair.b]) != 0 && (is_on_its_way(pair.a) || is_on_its_way(pair.b));
    return are_two_boxes(set, pair) || may_hit ? 0.0f : static_cast<float>(share * std::min(set.extents[pair.a], set.extents[pair.b]));
}

bool name_candidates(const ProxySet& set, double share, std::span<NumberedPair> candidates, CandidateNames& names, Executor& executor) {
    if (std::all_of(candidates.begin(), candidates.end(), [&](const NumberedPair& pair) { return are_two_boxes(set, pair); })) {
        names.now.clear();
        return false;
    }
    std::swap(names.before, names.now);
    names.now.resize(candidates.size());
    const std::vector<CandidateName>& before = names.before;
    executor.parallel_for(candidates.size(), kPairGrain, [&](std::size_t begin, std::size_t end) {
        auto old = std::ranges::lower_bound(before, key_of(set, candidates[begin]), {}, &CandidateName::key);
        for (std::size_t k = begin; k < end; ++k) {
            NumberedPair& pair = candidates[k];
            const CandidateName name{key_of(set, pair), set.versions[pair.a], set.versions[pair.b]};
            names.now[k] = name;
            pair.slack = slack_of(set, share, pair);
            while (old != before.end() && old->key < name.key) ++old;
            const bool same =
                old != before.end() && old->key == name.key && old->version_a == name.version_a && old->version_b == name.version_b;
            pair.last = same ? static_cast<std::uint32_t>(old - before.begin()) : kNewPair;
        }
    });
    return true;
}

ContactPair contact_pair(const ProxySet& set, const NumberedPair& candidate) noexcept {
    const ProxyOwner &first = set.owners[candidate.a], &second = set.owners[candidate.b];
    ContactPair pair;
    pair.key = key_of(set, candidate);
    pair.generation_a = first.shape.generation;
    pair.generation_b = second.shape.generation;
    pair.body_a = first.body;
    pair.body_b = second.body;
    return pair;
}

}  // namespace carom::dynamics
