// What became of two bodies on their way through the last step, from what was written down of it.
#include <carom/dynamics/explain_sweep.hpp>

#include <carom/core/check.hpp>
#include <carom/dynamics/detail/pair_sweep.hpp>
#include <carom/dynamics/detail/sweep_text.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <utility>

namespace carom {
namespace {

using dynamics::BodyStep;
using dynamics::ContactPair;
using dynamics::PairSweep;
using dynamics::PathImpact;
using dynamics::PathSearch;
using dynamics::Proxy;
using dynamics::ProxyKind;
using dynamics::ProxySet;
using dynamics::RecordedPath;
using dynamics::Role;
using dynamics::StepPaths;
using dynamics::SweptPair;

constexpr const char* kNotRecorded = "WorldDef::record_paths is off: nothing was written down";

/// What the step left to be looked at.
struct LastPaths {
    const StepPaths& paths;
    const ProxySet& proxies;
    const dynamics::BodyArrays& arrays;
    const dynamics::ContactSet& contacts;
    std::uint64_t step = 0;
};

bool is_mesh(const Shape& shape) { return type_of(shape) == ShapeType::TriangleMesh; }

/// Whether the step had contacts between the two.
bool had_contacts(const LastPaths& last, const SweptPair& pair) {
    const auto& kinds = last.proxies.kinds;
    const bool swap = kinds[pair.a] == ProxyKind::Plane || (kinds[pair.b] != ProxyKind::Plane && pair.b < pair.a);
    const NumberedPair listed = swap ? NumberedPair{pair.b, pair.a} : NumberedPair{pair.a, pair.b};
    const std::uint64_t key = dynamics::contact_pair(last.proxies, listed).key;
    const auto found = std::ranges::lower_bound(last.contacts.pairs, key, {}, &ContactPair::key);
    return found != last.contacts.pairs.end() && found->key == key && found->manifold_count > 0;
}

SweepImpact impact_of(const LastPaths& last, const PathImpact& impact) {
    const dynamics::ProxyOwner &a = last.proxies.owners[impact.a], &b = last.proxies.owners[impact.b];
    SweepImpact out{.body_a = a.body, .body_b = b.body, .shape_a = a.shape, .shape_b = b.shape};
    out.t = impact.t;
    out.status = impact.t > 0.0 && impact.status == ImpactStatus::Overlapping ? ImpactStatus::Touching : impact.status;
    out.margin = impact.margin;
    out.watched = dynamics::kRestOfLevel[impact.level];
    out.point = impact.point, out.normal = impact.normal;
    out.blow = impact.blow;
    out.pose_a = impact.pose_a * inverse(last.paths.bodies[a.body.slot].principal);
    out.pose_b = impact.pose_b * inverse(last.paths.bodies[b.body.slot].principal);
    // Found anew, from the impact before it.
    double begin = 0.0;
    for (const dynamics::PathLeg& leg : last.paths.legs) {
        if ((leg.slot == a.body.slot || leg.slot == b.body.slot) && leg.begin < impact.t) begin = std::max(begin, leg.begin);
    }
    RecordedPath path_a(last.paths, a.body.slot), path_b(last.paths, b.body.slot);
    PairSweep sweep(last.proxies, {impact.a, impact.b}, path_a, path_b);
    out.advances = sweep.looks(impact.level, begin);
    return out;
}

/// Whether the last step had the shape as it is.
bool known(const LastPaths& last, ShapeId id) {
    const ProxySet& p = last.proxies;
    return id.slot < p.kinds.size() && p.kinds[id.slot] != ProxyKind::None && p.owners[id.slot].shape == id && p.stale[id.slot] == 0 &&
           last.paths.has(p.owners[id.slot].body) && (p.kinds[id.slot] == ProxyKind::Plane || p.listed[id.slot] != 0);
}

/// Adds the impacts of bodies that are asked for, of shapes that are as they were.
template <class Wanted>
void add_impacts(const LastPaths& last, std::vector<SweepImpact>& out, const Wanted& wanted) {
    if (!last.paths.is_there) return;
    for (const PathImpact& impact : last.paths.impacts) {
        if (!known(last, impact.id_a) || !known(last, impact.id_b)) continue;
        if (wanted(last.proxies.owners[impact.a].body) || wanted(last.proxies.owners[impact.b].body))
            out.push_back(impact_of(last, impact));
    }
}

}  // namespace

/// Judges pairs; a part of the world's insides.
struct World::Impl::SweepJudge {
    const Impl& w;
    const LastPaths& last;
    SweepExplanation& why;
    RecordedPath &path_a, &path_b;
    bool brief = false;  ///< of two that stayed apart no clearance is wanted

    /// What keeps the two from being watched, as far as that is known without a search.
    [[nodiscard]] SweepReason reason_of(const SweptPair& pair) const {
        const ProxySet& p = w.proxies;
        const std::uint32_t slot_a = p.bodies[pair.a], slot_b = p.bodies[pair.b];
        const auto role = [&](std::uint32_t slot) { return last.paths.bodies[slot].role; };
        const auto either = [&](Following f) { return why.a.reason == f || why.b.reason == f; };
        if (!dynamics::has_mass(role(slot_a)) && !dynamics::has_mass(role(slot_b))) return SweepReason::NeitherDynamic;
        if (!dynamics::filters_agree(p.filters[pair.a], p.filters[pair.b])) return SweepReason::Filter;
        if (dynamics::JointSet::parts(last.paths.parted, slot_a, slot_b)) return SweepReason::Joined;
        if (either(Following::Off)) return SweepReason::Off;
        if (!either(Following::Followed)) {
            if (either(Following::Never)) return SweepReason::Never;
            return either(Following::Slow) ? SweepReason::Slow : SweepReason::Still;
        }
        const auto is_this = [&](const auto& x) { return x.a == pair.a && x.b == pair.b; };
        if (std::ranges::any_of(last.paths.deep, is_this)) return SweepReason::TooDeep;
        if (!std::ranges::any_of(last.paths.impacts, is_this) && kept_company(slot_a, slot_b)) return SweepReason::Company;
        return SweepReason::Watched;
    }

    [[nodiscard]] bool kept_company(std::uint32_t slot_a, std::uint32_t slot_b) const {
        dynamics::BodyArrays arrays;
        for (const BodyStep& body : last.paths.bodies) arrays.states.push_back(body.moved), arrays.roles.push_back(body.role);
        const auto start = [&](std::uint32_t slot) -> const Pose& { return last.paths.bodies[slot].start.pose; };
        const auto motion = [&](std::uint32_t slot) { return last.paths.bodies[slot].motion; };
        const auto parted = [](std::uint32_t, std::uint32_t) { return false; };
        const auto wake = [](std::uint32_t) {};
        const auto velocity = [&](std::uint32_t slot) -> const dvec3& { return last.paths.bodies[slot].start.velocity; };
        SerialExecutor alone;
        return w.continuous.keep_company({w.proxies, w.broadphase, arrays, last.paths.dt, alone, start, velocity, motion, parted, wake}, slot_a, slot_b);
    }

    [[nodiscard]] ShapeSweep judge(ShapeId a, ShapeId b) {
        const SweptPair pair = order(a.slot, b.slot);
        const bool swapped = pair.a != a.slot;
        PairSweep sweep(last.proxies, pair, swapped ? path_b : path_a, swapped ? path_a : path_b);
        ShapeSweep out{.shape_a = a, .shape_b = b};
        out.reason = reason_of(pair);
        const PathSearch found = sweep.first_contact();
        out.impact = found.impact;
        if (swapped) out.impact.normal = -out.impact.normal;
        PathSearch met = found;
        if (!may_touch(found.impact.status) && sweep.is_one_sided()) met = sweep.first_contact_with_both_sides();
        const bool behind = may_touch(met.impact.status) && !may_touch(found.impact.status);
        if (behind && (out.reason == SweepReason::Watched || out.reason >= SweepReason::Off)) out.reason = SweepReason::BackFace;
        if (!may_touch(found.impact.status) && !behind && !brief) out.clearance = sweep.clearance();
        if (!may_touch(met.impact.status)) return out;
        out.margin = met.bend + 2.0 * sweep.tolerance();
        if (const std::optional<double> middle = sweep.middle_met()) add_passage(out, pair, sweep, *middle, met.t);
        return out;
    }

    /// Whether something kinematic went on through what could not give way.
    [[nodiscard]] bool is_crushed(std::uint32_t proxy, std::uint32_t by) const {
        return last.paths.bodies[w.proxies.bodies[proxy]].follow.stopped == StopCause::Crushed && last.paths.bodies[w.proxies.bodies[by]].role == Role::Kinematic;
    }

    void add_passage(ShapeSweep& out, const SweptPair& pair, PairSweep& sweep, double t, double touched) {
        Passage passage{.step = last.step,
                        .t = t,
                        .touched = touched,
                        .through = !sweep.middle_is_there(),
                        .cause = out.reason,
                        .shape_a = out.shape_a,
                        .shape_b = out.shape_b};
        const bool left_to_contacts =
            passage.cause == SweepReason::Watched || passage.cause == SweepReason::Slow || passage.cause == SweepReason::Company;
        if (left_to_contacts && had_contacts(last, pair)) passage.cause = SweepReason::Pressed;
        if (is_crushed(pair.a, pair.b) || is_crushed(pair.b, pair.a)) passage.cause = SweepReason::Crushed;
        const bool a_moves = why.a.motion >= why.b.motion;
        passage.remedy = dynamics::remedy_of(passage.cause, a_moves ? "A" : "B");
        passage.sentence = dynamics::passage_text(passage, a_moves ? "A" : "B", a_moves ? "B" : "A");
        if (passage.cause == SweepReason::Watched && !is_mesh(w.proxies.by_slot[pair.a].shape)) {
            why.disagreements.push_back("shapes " + std::to_string(pair.a) + " and " + std::to_string(pair.b) +
                                        ": the middle of one came to the other although they were watched");
        }
        out.passage = std::move(passage);
    }

    /// A plane is never A, even where neither has mass.
    [[nodiscard]] SweptPair order(std::uint32_t a, std::uint32_t b) const {
        if (w.proxies.kinds[a] == ProxyKind::Plane) return {b, a};
        if (w.proxies.kinds[b] == ProxyKind::Plane) return {a, b};
        std::vector<Role> roles;
        for (const BodyStep& body : last.paths.bodies) roles.push_back(body.role);
        return dynamics::swept_order(w.proxies, roles, a, b);
    }
};

SweepExplanation World::Impl::judge_sweep(BodyId a, BodyId b, bool brief) const {
    const dynamics::BodyRecord &of_a = *bodies.find(a), &of_b = *bodies.find(b);
    SweepExplanation why{.body_a = a, .body_b = b, .step = steps, .dt = last_substep * def.substeps};
    const LastPaths last{paths, proxies, arrays, contacts, steps};
    const auto follow_of = [&](BodyId body) {
        if (!paths.is_there) return FollowFinding{.continuity = continuous.continuity(body.slot)};
        return paths.has(body) ? paths.bodies[body.slot].follow : FollowFinding{.reason = Following::OutOfStep};
    };
    why.a = follow_of(a), why.b = follow_of(b);
    why.reason = a == b                                       ? SweepReason::SameBody
                 : of_a.shapes.empty() || of_b.shapes.empty() ? SweepReason::NoShapes
                 : !paths.is_there                            ? SweepReason::NoStep
                                                              : SweepReason::OutOfStep;
    if (why.reason != SweepReason::OutOfStep || !paths.has(a) || !paths.has(b)) return why;
    RecordedPath path_a(paths, a.slot), path_b(paths, b.slot);
    SweepJudge judge{*this, last, why, path_a, path_b, brief};
    for (const ShapeId shape_a : of_a.shapes) {
        for (const ShapeId shape_b : of_b.shapes) {
            if (!known(last, shape_a) || !known(last, shape_b)) continue;
            if (proxies.kinds[shape_a.slot] == ProxyKind::Plane && proxies.kinds[shape_b.slot] == ProxyKind::Plane) continue;
            why.pairs.push_back(judge.judge(shape_a, shape_b));
        }
    }
    const auto rank = [](const ShapeSweep& s) {
        if (s.passage) return std::pair(0, s.passage->t);
        return may_touch(s.impact.status) ? std::pair(1, s.impact.t) : std::pair(2, s.clearance);
    };
    for (std::size_t i = 1; i < why.pairs.size(); ++i) {
        if (rank(why.pairs[i]) < rank(why.pairs[why.deciding])) why.deciding = i;
    }
    if (!why.pairs.empty()) why.reason = why.pairs[why.deciding].reason, why.passage = why.pairs[why.deciding].passage;
    return why;
}

SweepExplanation World::explain_sweep(BodyId a, BodyId b) const {
    const Impl& w = *impl_;
    CAROM_REQUIRE(w.bodies.find(a) != nullptr && w.bodies.find(b) != nullptr, ErrorCode::DeadId, "no such body", {});
    CAROM_REQUIRE(w.def.record_paths, ErrorCode::InvalidArgument, kNotRecorded, {});
    SweepExplanation why = w.judge_sweep(a, b, false);
    if (a != b)
        add_impacts({w.paths, w.proxies, w.arrays, w.contacts, w.steps}, why.impacts, [&](BodyId body) { return body == a || body == b; });
    why.sentence = dynamics::sentence_of(why);
    return why;
}

std::optional<Passage> World::passage(BodyId a, BodyId b) const {
    const Impl& w = *impl_;
    CAROM_REQUIRE(w.bodies.find(a) != nullptr && w.bodies.find(b) != nullptr, ErrorCode::DeadId, "no such body", std::nullopt);
    CAROM_REQUIRE(w.def.record_paths, ErrorCode::InvalidArgument, kNotRecorded, std::nullopt);
    return w.judge_sweep(a, b, true).passage;
}

StepSweeps World::sweeps() const {
    const Impl& w = *impl_;
    CAROM_REQUIRE(w.def.record_paths, ErrorCode::InvalidArgument, kNotRecorded, {});
    StepSweeps out{.step = w.steps, .dt = w.paths.dt};
    if (!w.paths.is_there) return out;
    const LastPaths last{w.paths, w.proxies, w.arrays, w.contacts, w.steps};
    for (const BodyId id : w.body_order) {
        if (!w.paths.has(id)) continue;
        const FollowFinding& follow = w.paths.bodies[id.slot].follow;
        BodySweep sweep{id, follow, {0.0}};
        bool met = false;
        for (const dynamics::PathLeg& leg : w.paths.legs) {
            met |= leg.slot == id.slot;
            if (leg.slot == id.slot && leg.begin > sweep.times.back()) sweep.times.push_back(leg.begin);
        }
        const bool fast = follow.reason == Following::Followed || follow.reason == Following::Never || follow.reason == Following::Off;
        if (!fast && !met) continue;
        if (sweep.times.back() < 1.0) sweep.times.push_back(1.0);
        out.bodies.push_back(std::move(sweep));
    }
    std::ranges::stable_sort(out.bodies, {}, [](const BodySweep& s) { return s.body.slot; });
    add_impacts(last, out.impacts, [](BodyId) { return true; });
    return out;
}

Pose World::pose_within_step(BodyId body, double t) const {
    const Impl& w = *impl_;
    CAROM_REQUIRE(w.bodies.find(body) != nullptr, ErrorCode::DeadId, "no such body", {});
    CAROM_REQUIRE(w.def.record_paths, ErrorCode::InvalidArgument, kNotRecorded, w.body_pose(body));
    CAROM_REQUIRE(t >= 0.0 && t <= 1.0, is_finite(t) ? ErrorCode::InvalidArgument : ErrorCode::NotFinite, "t must be within 0 .. 1",
                  w.body_pose(body));
    if (!w.paths.has(body)) return w.body_pose(body);
    const RecordedPath path(w.paths, body.slot);
    return path.pose_at(t) * inverse(w.paths.bodies[body.slot].principal);
}

}  // namespace carom
