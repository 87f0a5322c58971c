// Which pairs of proxies are looked at, and how far ahead.
#include <carom/dynamics/detail/proxies.hpp>
#include <carom/dynamics/detail/room.hpp>

#include <algorithm>

namespace carom::dynamics {
namespace {

constexpr std::size_t kPairGrain = 1024;
constexpr std::uint32_t kSlotsOfAPart = 256, kSlotsWorthSharing = 2048;
constexpr double kMarginShare = 0.25;  // of the smallest extent

/// Of the slots [first, last).
void list_candidates_of(const ProxySet& set, const BodyArrays& bodies, std::span<const ProxyPair> found, double dt, std::uint32_t first,
                        std::uint32_t last, std::vector<NumberedPair>& out) {
    out.clear();
    const auto may_be_kept = [&](std::uint32_t i) { return set.anchors[i].room >= 0.0 || lies_still(bodies.roles[set.bodies[i]]); };
    const auto list = [&](std::uint32_t a, std::uint32_t b, double motion) {
        const double most = kMarginShare * std::min(set.extents[a], set.extents[b]);
        const double stay = set.stay[a] + set.stay[b];         // until they are looked at again
        const double closing = set.motion[a] + motion - stay;  // the rest is of this step
        const auto in_step = [&](std::uint32_t i, double all) { return set.stay[i] > 0.0 ? set.way[i] : all; };
        const bool kept = may_be_kept(a) && may_be_kept(b);
        out.push_back(
            {a, b,
             static_cast<float>(kept ? stay + std::min(closing, most) : std::min(in_step(a, set.motion[a]) + in_step(b, motion), most))});
    };
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
                     CandidateParts& parts, std::vector<NumberedPair>& out) {
    const auto slots = static_cast<std::uint32_t>(set.by_slot.size());
    if (out.capacity() < found.size()) out.reserve(with_room(found.size()));
    if (executor.thread_count() == 1 || slots < kSlotsWorthSharing) return list_candidates_of(set, bodies, found, dt, 0, slots, out);
    const std::size_t count = (slots + kSlotsOfAPart - 1) / kSlotsOfAPart;
    if (parts.size() < count) parts.resize(count);
    executor.parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const auto first = static_cast<std::uint32_t>(k * kSlotsOfAPart);
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
            std::copy(parts[k].pairs.begin(), parts[k].pairs.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
            at += parts[k].pairs.size();
        }
    });
}

namespace {

std::uint64_t key_of(const ProxySet& set, const NumberedPair& candidate) noexcept {
    const std::uint32_t plane_bit = set.kinds[candidate.b] == ProxyKind::Plane ? 0x80000000u : 0u;  // planes sort after the rest
    return std::uint64_t{candidate.a} << 32 | (candidate.b | plane_bit);
}

}  // namespace

bool name_candidates(const ProxySet& set, double share, std::span<NumberedPair> candidates, CandidateNames& names, Executor& executor) {
    const auto is_on_its_way = [&](std::uint32_t i) { return set.anchors[i].room < 0.0 && set.motion[i] > 0.0; };
    const auto may_hit = [&](const NumberedPair& pair) {
        return (set.bounces[pair.a] | set.bounces[pair.b]) != 0 && (is_on_its_way(pair.a) || is_on_its_way(pair.b));
    };
    const auto two_boxes = [&](const NumberedPair& pair) { return (set.boxlike[pair.a] & set.boxlike[pair.b]) != 0; };
    if (std::all_of(candidates.begin(), candidates.end(), two_boxes)) {
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
            pair.slack =
                two_boxes(pair) || may_hit(pair) ? 0.0f : static_cast<float>(share * std::min(set.extents[pair.a], set.extents[pair.b]));
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
    pair.shape_a = first.shape;
    pair.shape_b = second.shape;
    pair.body_a = first.body;
    pair.body_b = second.body;
    pair.proxy_a = candidate.a;
    pair.proxy_b = candidate.b;
    return pair;
}

}  // namespace carom::dynamics
