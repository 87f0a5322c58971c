// The ladder that a pair climbs in a step, from what the last step kept.
#include <carom/dynamics/explain.hpp>

#include <carom/core/check.hpp>
#include <carom/dynamics/detail/explain_text.hpp>
#include <carom/dynamics/detail/world_impl.hpp>

#include <algorithm>
#include <cmath>
#include <span>

namespace carom {
namespace {

using dynamics::ContactPair;
using dynamics::ProxyKind;
using dynamics::ProxySet;
using dynamics::Role;

/// Two shapes as the step lists them: the lower slot first, a plane last.
NumberedPair listed_order(const ProxySet& proxies, std::uint32_t a, std::uint32_t b) {
    const bool plane_a = proxies.kinds[a] == ProxyKind::Plane, plane_b = proxies.kinds[b] == ProxyKind::Plane;
    return plane_a || (!plane_b && b < a) ? NumberedPair{b, a} : NumberedPair{a, b};
}

bool same_contact(const Manifold& a, const Manifold& b) {
    if (a.count != b.count || a.part_a != b.part_a || a.part_b != b.part_b || a.normal != b.normal) return false;
    bool same = true;
    for (std::size_t k = 0; k < a.count; ++k) {
        const ContactPoint &p = a.points[k], &q = b.points[k];
        same &= p.position == q.position && p.separation == q.separation && p.feature == q.feature;
    }
    return same;
}

bool same_contacts(std::span<const Manifold> a, std::span<const Manifold> b) { return std::ranges::equal(a, b, same_contact); }

/// What the last step of a world kept.
struct LastStep {
    const SlotMap<dynamics::BodyRecord, BodyId>& bodies;
    const SlotMap<dynamics::ShapeRecord, ShapeId>& shapes;
    const dynamics::BodyArrays& arrays;
    const ProxySet& proxies;
    const Broadphase& broadphase;
    const dynamics::ContactSet& contacts;
    const dynamics::ContactSet& asleep;  ///< of what sleeps
    const dynamics::JointSet& joints;
    bool joints_changed = false;  ///< since the step
    bool may_sleep = false;
    double dt = 0.0;  ///< [s]
    bool looked_for_contacts = false;
    double slack_share = 0.0;  ///< of the smallest extent, that candidates were given; 0: none
    double kept_share = 0.0;  ///< of the smallest extent, that pairs whose contacts were kept may have drifted by; 0: none were
};

class PairClimb {
public:
    PairClimb(const LastStep& step, std::vector<std::string>& disagreements) : w_(step), disagreements_(disagreements) {}

    [[nodiscard]] ShapePairExplanation climb(ShapeId a, ShapeId b) const {
        ShapePairExplanation pair;
        pair.shape_a = a;
        pair.shape_b = b;
        pair.filter = filter_of(a, b);
        const bool agrees = pair.filter->any_moves && pair.filter->layers_agree, passes = agrees && !pair.filter->joined;
        if (passes && (is_idle_asleep(a, b) || is_idle_asleep(b, a))) {
            pair.rung = Rung::Asleep;
            pair.found = summary_of(contacts_of(w_.asleep, listed_order(w_.proxies, a.slot, b.slot)));
            return pair;
        }
        pair.rung = !agrees ? Rung::Filter : !passes ? Rung::Joined : !w_.looked_for_contacts ? Rung::NoStep : Rung::OutOfStep;
        if (!w_.looked_for_contacts || !known(a) || !known(b)) return pair;

        const ProxySet& proxies = w_.proxies;
        NumberedPair listed = listed_order(proxies, a.slot, b.slot);
        pair.pose_a = proxies.poses[a.slot];
        pair.pose_b = proxies.poses[b.slot];
        const bool both_planes = proxies.kinds[listed.a] == ProxyKind::Plane;
        if (both_planes) return pair;  // neither moves, or they are out of step: the filter has ended it
        pair.bounds = bounds_of(a.slot, b.slot);
        const std::optional<NumberedPair> candidate = find_candidate(listed);
        if (passes) {
            pair.broadphase = broadphase_of(listed, *pair.bounds, candidate.has_value());
            check_listing(*pair.bounds, *pair.broadphase, candidate.has_value(), listed);
            if (candidate.has_value()) listed = *candidate;
        } else if (candidate.has_value() && (!agrees || !w_.joints_changed)) {
            disagree("the filter parts the two, and yet the step listed them", listed);
        }
        add_contact(listed, pair);
        if (!passes) return pair;
        pair.rung = !candidate ? (pair.bounds->gap > 0.0 ? Rung::Bounds : Rung::PairLimit) : rung_of(pair);
        return pair;
    }

private:
    /// Whether the body of `a` sleeps, and that of `b` does nothing that could wake it.
    [[nodiscard]] bool is_idle_asleep(ShapeId a, ShapeId b) const {
        const std::uint32_t slot_a = w_.shapes.find(a)->body.slot, slot_b = w_.shapes.find(b)->body.slot;
        return w_.arrays.roles[slot_a] == Role::Asleep && !dynamics::stirs(w_.arrays, slot_b);
    }

    void disagree(const std::string& what, const NumberedPair& pair) const {
        disagreements_.push_back("shapes " + std::to_string(pair.a) + " and " + std::to_string(pair.b) + ": " + what);
    }

    [[nodiscard]] FilterFinding filter_of(ShapeId a, ShapeId b) const {
        const dynamics::ShapeRecord &of_a = *w_.shapes.find(a), &of_b = *w_.shapes.find(b);
        FilterFinding filter{of_a.def->layer, of_a.def->mask, of_b.def->layer, of_b.def->mask};
        filter.layers_agree = (filter.layer_a & filter.mask_b) != 0 && (filter.layer_b & filter.mask_a) != 0;
        filter.any_moves =
            w_.bodies.find(of_a.body)->type == BodyType::Dynamic || w_.bodies.find(of_b.body)->type == BodyType::Dynamic;
        filter.joined = w_.joints.parts(of_a.body.slot, of_b.body.slot);
        return filter;
    }

    /// Whether the last step had the shape as it is.
    [[nodiscard]] bool known(ShapeId id) const {
        const ProxySet& p = w_.proxies;
        if (id.slot >= p.kinds.size() || p.kinds[id.slot] == ProxyKind::None || p.owners[id.slot].shape != id || p.stale[id.slot] != 0) return false;
        const bool woken = w_.arrays.roles[p.bodies[id.slot]] == Role::Dynamic && !p.filters[id.slot].movable;
        if (woken) return false;
        return p.kinds[id.slot] == ProxyKind::Plane || p.listed[id.slot] != 0;
    }

    [[nodiscard]] BoundsFinding bounds_of(std::uint32_t a, std::uint32_t b) const {
        const ProxySet& p = w_.proxies;
        BoundsFinding found{p.boxes[a], p.boxes[b]};
        const bool plane_a = p.kinds[a] == ProxyKind::Plane;
        if (plane_a || p.kinds[b] == ProxyKind::Plane) {
            found.axis = -1;
            const NumberedPair listed = listed_order(p, a, b);
            found.gap = dynamics::gap_over_plane(p, w_.arrays, listed.a, listed.b, w_.dt);
            (plane_a ? found.box_a : found.box_b) = {};
            return found;
        }
        for (int k = 0; k < 3; ++k) {
            const double gap = std::max(static_cast<double>(found.box_b.lower[k]) - static_cast<double>(found.box_a.upper[k]),
                                        static_cast<double>(found.box_a.lower[k]) - static_cast<double>(found.box_b.upper[k]));
            if (k != 0 && gap <= found.gap) continue;
            found.gap = gap;
            found.axis = k;
        }
        return found;
    }

    /// What the step listed of the two: found anew, as it did.
    [[nodiscard]] std::optional<NumberedPair> find_candidate(const NumberedPair& pair) const {
        const std::uint32_t a = w_.proxies.bodies[pair.a], b = w_.proxies.bodies[pair.b];
        if (w_.joints.parts(a, b)) return {};
        if (w_.may_sleep && dynamics::Sleepers::is_idle(w_.proxies, w_.arrays, pair)) return {};
        std::optional<NumberedPair> found = dynamics::find_candidate(w_.proxies, w_.arrays, w_.broadphase.result().pairs, w_.dt, pair.a, pair.b);
        if (found && w_.slack_share > 0.0) found->slack = dynamics::slack_of(w_.proxies, w_.slack_share, *found);
        return found;
    }

    [[nodiscard]] BroadphaseFinding broadphase_of(const NumberedPair& pair, const BoundsFinding& bounds, bool is_candidate) const {
        if (bounds.axis < 0) return {BroadphaseMethod::Automatic, is_candidate, "planes are in a list of their own, held against every movable shape"};
        const PairUpdate& found = w_.broadphase.result();
        const bool listed = std::binary_search(found.pairs.begin(), found.pairs.end(), ProxyPair{pair.a, pair.b});
        return {w_.broadphase.method(), listed, dynamics::place_of(w_.broadphase, pair.a, pair.b, bounds.axis)};
    }

    /// The list must hold what overlaps, and nothing else; a plane that moves may have another velocity by now.
    void check_listing(const BoundsFinding& bounds, const BroadphaseFinding& broadphase, bool is_candidate, const NumberedPair& pair) const {
        const bool moving_plane = bounds.axis < 0 && w_.arrays.roles[w_.proxies.bodies[pair.b]] != Role::Static;
        const PairUpdate& found = w_.broadphase.result();
        const bool limited = bounds.axis >= 0 && found.status == PairStatus::LimitReached && pair.a >= found.complete_below;
        if (broadphase.listed != is_candidate && !w_.joints_changed) disagree("what the broadphase listed did not reach the narrowphase", pair);
        if (moving_plane) return;
        if (broadphase.listed && bounds.gap > 0.0) disagree("listed although the bounds are apart", pair);
        if (!broadphase.listed && !(bounds.gap > 0.0) && !limited) disagree("not listed although the bounds overlap", pair);
    }

    /// Measures the two where they were, and holds what the step has of them against it.
    void add_contact(const NumberedPair& listed, ShapePairExplanation& pair) const {
        const ProxySet& p = w_.proxies;
        const auto placed = [&](std::uint32_t a, std::uint32_t b, bool steady) {
            return ShapePair{&p.by_slot[a].shape, &p.by_slot[b].shape, p.poses[a], p.poses[b], listed.margin, steady};
        };
        const std::uint32_t a = pair.shape_a.slot, b = pair.shape_b.slot;
        if (!can_collide(type_of(p.by_slot[a].shape), type_of(p.by_slot[b].shape))) return;
        pair.contact = carom::explain(placed(a, b, false));
        if (!pair.contact->disagreement.empty()) disagree(pair.contact->disagreement, listed);
        if (!find_candidate(listed)) return;
        std::vector<Manifold> anew;
        carom::collide(placed(listed.a, listed.b, true), 0, anew);
        const ContactPair* const last = pair_of(w_.contacts, listed);
        const std::vector<Manifold> had = contacts_of(w_.contacts, listed);
        pair.found = summary_of(had);
        pair.found->passes = last != nullptr && last->passes;
        pair.found->carried = !same_contacts(anew, had);
        if (pair.found->carried && !may_be_carried(summary_of(anew), *pair.found, listed)) {
            disagree("the contacts of the step are not those of its poses", listed);
        }
    }

    static StepContacts summary_of(std::span<const Manifold> manifolds) {
        StepContacts sum;
        sum.manifolds = manifolds.size();
        for (const Manifold& m : manifolds) {
            for (const ContactPoint& point : m.used()) {
                const auto separation = static_cast<double>(point.separation);
                if (sum.points++ == 0 || separation < sum.least_separation) sum.least_separation = separation;
            }
        }
        return sum;
    }

    /// Whether contacts that were carried along may be what they are: depths too large by twice the slack, points up to the slack beyond
    /// the margin, and nothing where there is something within twice the slack of it.
    [[nodiscard]] bool may_be_carried(const StepContacts& anew, const StepContacts& had, const NumberedPair& listed) const {
        const double slack = 2.0 * std::max(static_cast<double>(listed.slack), dynamics::most_drift(w_.proxies, listed, w_.kept_share));
        const double margin = static_cast<double>(listed.margin);
        if (!(slack > 0.0)) return false;
        if (anew.points == 0 && had.points == 0) return true;
        if (anew.points == 0) return had.least_separation >= margin - slack;
        if (had.points == 0) return anew.least_separation >= margin - slack;
        // Each of the two choices of four points may have left out another corner, deeper by 30 %, and on a mesh by that twice (PlacedShapes::steady).
        constexpr double kMostOverlooked = 0.7;
        const double overlooked = kMostOverlooked * std::max(0.0, -std::max(anew.least_separation, had.least_separation));
        return std::abs(anew.least_separation - had.least_separation) <= 1.01 * slack + overlooked;
    }

    [[nodiscard]] const ContactPair* pair_of(const dynamics::ContactSet& set, const NumberedPair& listed) const {
        const std::uint64_t key = dynamics::contact_pair(w_.proxies, listed).key;
        const auto found = std::ranges::lower_bound(set.pairs, key, {}, &ContactPair::key);
        return found != set.pairs.end() && found->key == key ? &*found : nullptr;
    }

    [[nodiscard]] std::vector<Manifold> contacts_of(const dynamics::ContactSet& set, const NumberedPair& listed) const {
        std::vector<Manifold> all;
        if (const ContactPair* const pair = pair_of(set, listed)) {
            for (std::uint32_t m = 0; m < pair->manifold_count; ++m) all.push_back(set.whole(pair->first_manifold + m));
        }
        return all;
    }

    [[nodiscard]] static Rung rung_of(const ShapePairExplanation& pair) {
        const StepContacts& found = *pair.found;
        const bool is_near = !pair.contact->axis || pair.contact->axis->gap <= pair.contact->margin;
        if (found.points == 0) return pair.contact->back_face && is_near ? Rung::BackFace : Rung::Distance;
        return found.least_separation <= 0.0 ? Rung::Touch : Rung::Margin;
    }

    const LastStep& w_;
    std::vector<std::string>& disagreements_;
};

/// The gap of a pair, for telling which of several is nearest.
double gap_of(const ShapePairExplanation& pair) {
    if (pair.contact && pair.contact->axis) return pair.contact->axis->gap;
    return pair.bounds ? pair.bounds->gap : 0.0;
}

}  // namespace

ContactExplanation World::explain(BodyId a, BodyId b) const {
    const dynamics::BodyRecord *of_a = impl_->bodies.find(a), *of_b = impl_->bodies.find(b);
    CAROM_REQUIRE(of_a != nullptr && of_b != nullptr, ErrorCode::DeadId, "no such body", {});
    ContactExplanation why;
    why.body_a = a;
    why.body_b = b;
    why.step = impl_->steps;
    if (a == b || of_a->shapes.empty() || of_b->shapes.empty()) {
        why.rung = a == b ? Rung::SameBody : Rung::NoShapes;
        why.sentence = dynamics::sentence_of(why);
        return why;
    }
    const Impl& w = *impl_;
    const LastStep step{.bodies = w.bodies,
                        .shapes = w.shapes,
                        .arrays = w.arrays,
                        .proxies = w.proxies,
                        .broadphase = w.broadphase,
                        .contacts = w.contacts,
                        .asleep = w.sleepers.contacts(),
                        .joints = w.joints,
                        .joints_changed = w.joints.version() != w.joint_solver.version(),
                        .may_sleep = w.sleepers.is_on(),
                        .dt = w.last_substep * w.def.substeps,
                        .looked_for_contacts = w.looked_for_contacts,
                        .slack_share = w.names.now.empty() ? 0.0 : w.def.contact_reuse,
                        .kept_share = w.patched ? w.def.contact_reuse : 0.0};
    const PairClimb climb(step, why.disagreements);
    for (const ShapeId shape_a : of_a->shapes) {
        for (const ShapeId shape_b : of_b->shapes) {
            why.pairs.push_back(climb.climb(shape_a, shape_b));
            const ShapePairExplanation &best = why.pairs[why.deciding], &last = why.pairs.back();
            if (last.rung > best.rung || (last.rung == best.rung && gap_of(last) < gap_of(best))) why.deciding = why.pairs.size() - 1;
        }
    }
    why.rung = why.pairs[why.deciding].rung;
    why.sentence = dynamics::sentence_of(why);
    return why;
}

}  // namespace carom
