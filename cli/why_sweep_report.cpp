#include <carom/cli/why_sweep_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace carom::cli {
namespace {

using Json = nlohmann::ordered_json;

// Of passages in earlier steps so many are told one by one.
constexpr std::size_t kMostTold = 3;
// And so many impacts.
constexpr std::size_t kMostMet = 8;

std::string line(const std::string& rung, const std::string& text) { return fmt::format("{:<12}{}\n", rung, text); }

std::string point_text(const dvec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

std::string body_name(const World& world, BodyId body) {
    const std::string& name = world.name(body);
    return fmt::format("body {}{}", body.slot, name.empty() ? "" : " (" + name + ")");
}

std::string why_not(const FollowFinding& f) {
    switch (f.reason) {
        case Following::NoStep:
            return "no step has been done yet, or the last one looked for no contacts";
        case Following::OutOfStep:
            return "the last step did not know it, or it is quarantined";
        case Following::NoShapes:
            return "it has no shapes";
        case Following::Static:
            return "it is static";
        case Following::Asleep:
            return "it sleeps";
        case Following::Still:
            return "it did not move";
        case Following::Slow:
            return fmt::format("it came no farther than {:.6g} m, and up to {:.6g} m are left to contacts", f.motion, f.limit);
        case Following::Never:
            return fmt::format("its continuity is never, though it came up to {:.6g} m, more than {:.6g} m", f.motion, f.limit);
        case Following::Off:
            return fmt::format("continuous collision is off, though it came up to {:.6g} m, more than {:.6g} m", f.motion, f.limit);
        case Following::Followed:
            break;
    }
    return "";
}

std::string stop_text(const FollowFinding& f) {
    switch (f.stopped) {
        case StopCause::None:
            return "";
        case StopCause::Impacts:
            return fmt::format("; stopped at t = {:.6g}, for it may have no more (ContinuousSettings::most_impacts)", f.stopped_at);
        case StopCause::Budget:
            return fmt::format("; stopped at t = {:.6g}, for the step had come to its budget of impacts or searches", f.stopped_at);
        case StopCause::Partner:
            return fmt::format("; stopped at t = {:.6g} at what had stopped before", f.stopped_at);
        case StopCause::Depth:
            return fmt::format("; stopped at t = {:.6g}, too deep in what it touched", f.stopped_at);
        case StopCause::Crushed:
            return fmt::format("; crushed at t = {:.6g} by something kinematic, with which it could not go along", f.stopped_at);
    }
    return "";
}

std::string follow_text(const FollowFinding& f) {
    const std::string met = fmt::format("{} impact{}{}", f.impacts, f.impacts == 1 ? "" : "s", stop_text(f));
    if (f.reason != Following::Followed)
        return "not followed: " + why_not(f) + (f.impacts + (f.stopped != StopCause::None) > 0 ? "; " + met : "");
    return fmt::format("followed: it came up to {:.6g} m{}, {}; {}", f.motion,
                       f.continuity == Continuity::Always && f.motion <= f.limit ? ", and its continuity is always"
                                                                                 : fmt::format(", more than {:.6g} m", f.limit),
                       f.flew ? "by itself" : "held by contacts or joints", met);
}

std::string sweep_text(const ShapeSweep& s) {
    switch (s.impact.status) {
        case ImpactStatus::Separated:
            return fmt::format("separated all the way, by at least {:.6g} m", s.clearance);
        case ImpactStatus::Overlapping:
            return "overlapping from the start of the step on";
        case ImpactStatus::Touching:
            return fmt::format("touching at t = {:.6g} of the step, not before; within {:.3g} m, at {}, normal {}", s.impact.t, s.margin,
                               point_text(s.impact.point), point_text(s.impact.normal));
        case ImpactStatus::Clamped:
            return fmt::format("clamped at t = {:.6g} of the step: not before, and what is later is not known", s.impact.t);
        case ImpactStatus::Invalid:
            break;
    }
    return "not answered";
}

std::string impact_text(const SweepImpact& impact, const World& world) {
    return fmt::format(
        "{} and {} at t = {:.6g}: {}, within {:.3g} m, {}{}", body_name(world, impact.body_a), body_name(world, impact.body_b), impact.t,
        to_string(impact.status), impact.margin, impact.blow ? "struck apart" : "stopped",
        impact.watched < 1.0 ? fmt::format(", watched as {:.2g} of the thickness, for they touched before", impact.watched) : "");
}

// What is static meets whatever comes to it: of such a one only the impacts with the other are told.
bool is_of_a_mover(const SweepImpact& impact, const SweepExplanation& sweep, const World& world) {
    const auto is_of = [&](BodyId body) { return world.type(body) != BodyType::Static && (impact.body_a == body || impact.body_b == body); };
    return is_of(sweep.body_a) || is_of(sweep.body_b);
}

bool has_a_way(const SweepExplanation& sweep) {
    const auto fast = [](const FollowFinding& f) {
        return f.reason == Following::Followed || f.reason == Following::Off || f.reason == Following::Never;
    };
    return !sweep.pairs.empty() && (fast(sweep.a) || fast(sweep.b));
}

Json vector_json(const dvec3& v) { return Json::array({v.x, v.y, v.z}); }

// JSON has no infinity.
Json length_json(double length) { return length < std::numeric_limits<double>::infinity() ? Json(length) : Json(nullptr); }

Json follow_json(const FollowFinding& f) {
    return {{"reason", to_string(f.reason)},
            {"continuity", to_string(f.continuity)},
            {"motion", length_json(f.motion)},
            {"limit", length_json(f.limit)},
            {"flew", f.flew},
            {"impacts", f.impacts},
            {"stopped", to_string(f.stopped)},
            {"stopped_at", f.stopped == StopCause::None ? Json(nullptr) : Json(f.stopped_at)}};
}

Json pair_json(const ShapeSweep& s) {
    const bool met = may_touch(s.impact.status);
    return {{"shape_a", s.shape_a.slot},
            {"shape_b", s.shape_b.slot},
            {"reason", to_string(s.reason)},
            {"status", to_string(s.impact.status)},
            {"t", met ? Json(s.impact.t) : Json(nullptr)},
            {"margin", met ? length_json(s.margin) : Json(nullptr)},
            {"point", met ? vector_json(s.impact.point) : Json(nullptr)},
            {"normal", met ? vector_json(s.impact.normal) : Json(nullptr)},
            {"clearance", met ? Json(nullptr) : length_json(s.clearance)}};
}

Json impact_json(const SweepImpact& impact) {
    return {{"body_a", impact.body_a.slot},
            {"body_b", impact.body_b.slot},
            {"shape_a", impact.shape_a.slot},
            {"shape_b", impact.shape_b.slot},
            {"t", impact.t},
            {"status", to_string(impact.status)},
            {"margin", length_json(impact.margin)},
            {"watched", impact.watched},
            {"point", vector_json(impact.point)},
            {"normal", vector_json(impact.normal)},
            {"blow", impact.blow},
            {"advances", impact.advances}};
}

}  // namespace

std::string way_text(const SweepExplanation& sweep, const World& world) {
    if (sweep.reason == SweepReason::NoStep) return "";
    std::string text = line("way of A", follow_text(sweep.a)) + line("way of B", follow_text(sweep.b));
    if (!sweep.pairs.empty()) text += line("sweep", sweep_text(sweep.pairs[sweep.deciding]));
    std::string rung = "met";
    std::size_t told = 0, all = 0;
    for (const SweepImpact& impact : sweep.impacts) {
        if (!is_of_a_mover(impact, sweep, world)) continue;
        if (++all > kMostMet) continue;
        ++told;
        text += line(rung, impact_text(impact, world));
        rung = "";
    }
    if (all > told) text += line("", fmt::format("and {} more impacts; --json has all", all - told));
    return text;
}

std::string way_sentences(const SweepExplanation& sweep, const std::vector<Passage>& passages) {
    std::string text;
    const bool met = !sweep.pairs.empty() && may_touch(sweep.pairs[sweep.deciding].impact.status);
    if (sweep.passage || (has_a_way(sweep) && (met || passages.empty()))) text = sweep.sentence + "\n";
    std::size_t told = 0;
    for (const Passage& passage : passages) {
        if (passage.step == sweep.step) continue;  // told above
        if (told++ < kMostTold) text += passage.sentence + "\n";
    }
    if (told > kMostTold)
        text += fmt::format("and {} more passages up to step {}; --json has all\n", told - kMostTold, passages.back().step);
    return text;
}

Json to_json(const SweepExplanation& sweep) {
    Json pairs = Json::array(), impacts = Json::array();
    for (const ShapeSweep& pair : sweep.pairs) pairs.push_back(pair_json(pair));
    for (const SweepImpact& impact : sweep.impacts) impacts.push_back(impact_json(impact));
    return {{"reason", to_string(sweep.reason)},
            {"sentence", sweep.sentence},
            {"a", follow_json(sweep.a)},
            {"b", follow_json(sweep.b)},
            {"deciding", sweep.pairs.empty() ? Json(nullptr) : Json(sweep.deciding)},
            {"pairs", pairs},
            {"impacts", impacts}};
}

Json to_json(const std::vector<Passage>& passages) {
    Json out = Json::array();
    for (const Passage& p : passages) {
        out.push_back({{"step", p.step},
                       {"t", p.t},
                       {"touched", p.touched},
                       {"through", p.through},
                       {"cause", to_string(p.cause)},
                       {"remedy", p.remedy},
                       {"sentence", p.sentence}});
    }
    return out;
}

}  // namespace carom::cli
