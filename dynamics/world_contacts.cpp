// Contacts that a step keeps of the step before: which they are, and what is looked at instead. docs/step.md, Collide.
#include <carom/dynamics/detail/world_impl.hpp>

#include <limits>

namespace carom {

using dynamics::Role;

namespace {

constexpr std::size_t kMostLooked = 3;      // contacts are kept where at most one candidate in so many has to be looked at
constexpr std::size_t kPairsOfAPart = 1024;  // that a thread looks through together
constexpr std::size_t kMostUnused = 64;     // manifolds, beside an eighth of those in use
constexpr std::uint64_t kLongestKept = 64;  // steps, after which a pair is looked at in any case; a power of two

}  // namespace

dynamics::CalmRule World::Impl::calm_rule() const {
    return {def.relax ? 0.5 * def.contact_reuse : 0.0,
            census.bouncing_shapes > 0 ? dynamics::kSlowestImpact : std::numeric_limits<double>::infinity()};
}

// Leaves those of the candidates that have to be looked at, where the contacts of the others are kept; else all of them.
bool World::Impl::choose_looked(double dt) {
    if (!contacts_held || calm_rule().share == 0.0 || dt / def.substeps != last_substep) return false;
    const std::size_t most = candidates.size() / kMostLooked;
    if (proxies.moved.size() * kMostLooked > proxies.by_slot.size()) return false;
    if (contacts.manifolds.size() > kMostUnused + contacts.manifold_count() + contacts.manifold_count() / 8)
        return false;  // closes the ranks
    const auto tracked = [&](std::uint32_t body) {
        return arrays.roles[body] == Role::Static || (solver.holds(body) && displaced[body] == 0);
    };
    const auto keeps = [&](const NumberedPair& pair) {
        const bool due = ((pair.a + pair.b + steps) & (kLongestKept - 1)) == 0;
        return !due && (proxies.calm[pair.a] & proxies.calm[pair.b]) != 0 &&
               proxies.drift[pair.a] + proxies.drift[pair.b] <= dynamics::most_drift(proxies, pair, def.contact_reuse) &&
               tracked(proxies.bodies[pair.a]) && tracked(proxies.bodies[pair.b]);
    };
    if (threads().thread_count() == 1) {
        dynamics::ScratchList<std::uint32_t> looked(scratch);
        looked.resize(most);
        std::size_t count = 0;
        for (std::uint32_t i = 0; i < candidates.size(); ++i) {
            if (keeps(candidates[i])) continue;
            if (count == most) return false;
            looked[count++] = i;
        }
        for (std::size_t k = 0; k < count; ++k) candidates[k] = candidates[looked[k]];
        candidates.shorten(count);
        return true;
    }
    const std::size_t parts = (candidates.size() + kPairsOfAPart - 1) / kPairsOfAPart;
    if (candidate_parts.size() < parts) candidate_parts.resize(parts);
    threads().parallel_for(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
            std::vector<NumberedPair>& some = candidate_parts[part].pairs;
            some.clear();
            const std::size_t first = part * kPairsOfAPart, last = std::min(first + kPairsOfAPart, candidates.size());
            for (std::size_t i = first; i < last; ++i) {
                if (!keeps(candidates[i])) some.push_back(candidates[i]);
            }
        }
    });
    std::size_t count = 0;
    for (std::size_t part = 0; part < parts; ++part) count += candidate_parts[part].pairs.size();
    if (count > most) return false;
    candidates.shorten(count);
    NumberedPair* next = candidates.data();
    for (std::size_t part = 0; part < parts; ++part) next = std::ranges::copy(candidate_parts[part].pairs, next).out;
    return true;
}

// Looks at those, and at no others.
void World::Impl::patch_contacts(dynamics::Step& step) {
    solver.carry_gaps(contacts, threads());
    const auto may_end = [&](const dynamics::ContactPair& pair) { return (proxies.calm[pair.proxy_a()] & proxies.calm[pair.proxy_b()]) == 0; };
    dynamics::ContactPatch patch(contacts, may_end, contact_changes);
    const auto take = [&](std::size_t i, std::span<const Manifold> found) { patch.take(dynamics::contact_pair(proxies, candidates[i]), found); };
    const CollideCounts counts = collide(PlacedShapes{proxies.shapes, proxies.poses, true}, candidates, threads(), collide_scratch, take);
    patch.finish(threads());
    step.report.undecided = counts.undecided;
    step.report.reused = step.report.pairs - candidates.size();
    candidates.release();
    names.now.clear();  // the narrowphase remembers other contacts
}

// What a step that finds its contacts anew takes over of those of the step before.
void World::Impl::take_over_contacts(dynamics::Step& step) {
    step.run(Stage::Collide, [&] { previous.take(contacts, threads()); });
    if (!carries) last_manifolds.clear();  // no pair of this step will be told from one of the last
}

}  // namespace carom
