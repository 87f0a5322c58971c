#include <carom/dynamics/detail/explain_text.hpp>

#include <cstddef>
#include <cstdio>
#include <vector>

namespace carom {

const char* to_string(Rung rung) noexcept {
    switch (rung) {
        case Rung::SameBody: return "same body";
        case Rung::NoShapes: return "no shapes";
        case Rung::Filter: return "filter";
        case Rung::Asleep: return "asleep";
        case Rung::Joined: return "joined";
        case Rung::NoStep: return "no step";
        case Rung::OutOfStep: return "out of step";
        case Rung::Bounds: return "bounds";
        case Rung::PairLimit: return "pair limit";
        case Rung::Distance: return "distance";
        case Rung::BackFace: return "back face";
        case Rung::Margin: return "margin";
        case Rung::Touch: return "touch";
    }
    return "unknown";
}

namespace dynamics {
namespace {

constexpr const char* kAxisNames[3] = {"x", "y", "z"};

std::string metres(double length) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g m", length);
    return text;
}

std::string across(const SeparatingAxis& axis) {
    switch (axis.source) {
        case AxisSource::FaceOfA: return "over face " + std::to_string(axis.of_a.index) + " of A";
        case AxisSource::FaceOfB: return "over face " + std::to_string(axis.of_b.index) + " of B";
        case AxisSource::Edges:
            return "across edge " + std::to_string(axis.of_a.index) + " of A and edge " + std::to_string(axis.of_b.index) + " of B";
        case AxisSource::Points: return "between their closest points";
        case AxisSource::Contact: return "along the normal of contact";
    }
    return "";
}

std::string count_of(std::size_t n, const std::string& what) { return std::to_string(n) + " " + what + (n == 1 ? "" : "s"); }

std::string bounds_text(const ShapePairExplanation& pair) {
    if (pair.bounds->axis < 0) return "the bounds of one stay " + metres(pair.bounds->gap) + " above what the plane may reach in the step";
    return "their bounds are " + metres(pair.bounds->gap) + " apart along " + kAxisNames[pair.bounds->axis];
}

std::string distance_text(const PairExplanation& contact) {
    if (!contact.axis) return "no triangles of theirs are within the margin of " + metres(contact.margin);
    return "there is a gap of " + metres(contact.axis->gap) + " " + across(*contact.axis) + ", more than the margin of " +
           metres(contact.margin);
}

std::string back_face_text(const PairExplanation& contact) {
    const std::string overlap = contact.axis && contact.axis->gap < 0.0 ? ", though they overlap by " + metres(-contact.axis->gap) : "";
    return "one is a one-sided mesh and shows the other its back face" + overlap;
}

std::string margin_text(const StepContacts& found, double margin) {
    const std::string gap = "their nearest contact has a gap of " + metres(found.least_separation);
    if (found.passes) return gap + ", and what they moved by in the step did not lead them there: they pass by each other";
    return gap + "; within the margin of " + metres(margin) +
           " the solver keeps it from closing further";
}

std::string touch_text(const StepContacts& found, const PairExplanation& contact) {
    const std::string how = found.least_separation < 0.0 ? "they overlap by " + metres(-found.least_separation) : "their surfaces meet";
    return how + (contact.axis ? " " + across(*contact.axis) : "") + ", with " +
           count_of(found.points, "point") + " of contact in " + count_of(found.manifolds, "manifold");
}

std::string filter_text(const FilterFinding& filter) {
    return filter.any_moves ? "their layers and masks do not agree" : "neither is dynamic";
}

// The nodes or cells that hold a slot, from the outermost in.
std::vector<BroadphasePart> parts_around(const Broadphase& broadphase, std::uint32_t slot) {
    std::vector<BroadphasePart> parts;
    broadphase.visit_parts_of(slot, [&](const BroadphasePart& part) { parts.push_back(part); });
    return parts;
}

bool same(const BroadphasePart& a, const BroadphasePart& b) { return a.box == b.box && a.level == b.level && a.is_stray == b.is_stray; }

std::string node_text(const std::vector<BroadphasePart>& of_a, const std::vector<BroadphasePart>& of_b) {
    std::size_t shared = 0;
    while (shared < of_a.size() && shared < of_b.size() && same(of_a[shared], of_b[shared])) ++shared;
    return "their leaves, at depths " + std::to_string(of_a.back().level) + " and " + std::to_string(of_b.back().level) +
           ", have the node at depth " + std::to_string(shared == 0 ? 0 : shared - 1) + " in common";
}

std::string cell_text(const char* who, const BroadphasePart& part) {
    if (part.is_stray) return std::string(who) + " is a stray of level " + std::to_string(part.level) + ", which every search reads";
    char text[160];
    const vec3 edge = part.box.upper - part.box.lower;
    std::snprintf(text, sizeof text, "%s is in a cell of %.3g x %.3g x %.3g m of level %d with %s", who, static_cast<double>(edge.x),
                  static_cast<double>(edge.y), static_cast<double>(edge.z), part.level, count_of(part.count, "box").c_str());
    return text;
}

std::string cells_text(const BroadphasePart& a, const BroadphasePart& b) {
    if (same(a, b) && !a.is_stray) return "both are in one cell: " + cell_text("each", a);
    return cell_text("A", a) + ", " + cell_text("B", b);
}

// The interval of a box on an axis.
std::string interval_text(const FloatAabb& box, int axis) {
    return "[" + metres(static_cast<double>(box.lower[axis])) + ", " + metres(static_cast<double>(box.upper[axis])) + "]";
}

}  // namespace

std::string place_of(const Broadphase& broadphase, std::uint32_t a, std::uint32_t b, int axis) {
    const std::vector<BroadphasePart> of_a = parts_around(broadphase, a), of_b = parts_around(broadphase, b);
    if (!of_a.empty() && !of_b.empty()) {
        const bool is_tree = broadphase.method() == BroadphaseMethod::DynamicTree;
        return is_tree ? node_text(of_a, of_b) : cells_text(of_a.back(), of_b.back());
    }
    if (broadphase.method() == BroadphaseMethod::BruteForce) return "every box is held against every other";
    // Ends are sorted along one axis or all three; of the latter the one that tells most.
    bool sorted[3] = {false, false, false};
    broadphase.visit_ends([&](const BroadphaseEnd& end) { sorted[end.axis] = true; });
    int along = axis;
    for (int k = 0; k < 3 && !sorted[along]; ++k) along = k;
    return std::string("sorted along ") + kAxisNames[along] + ", A takes up " + interval_text(broadphase.box(a), along) + " and B " +
           interval_text(broadphase.box(b), along);
}

std::string sentence_of(const ContactExplanation& why) {
    if (why.rung == Rung::SameBody) return "they do not touch because shapes of one body never meet";
    if (why.rung == Rung::NoShapes) return "they do not touch because one of them has no shapes";
    const ShapePairExplanation& pair = why.pairs[why.deciding];
    if (pair.rung == Rung::Touch) return "they touch because " + touch_text(*pair.found, *pair.contact);
    if (pair.rung == Rung::Asleep && pair.found->points > 0) {
        return "they touch as they did when they fell asleep, with " + count_of(pair.found->points, "point") + " of contact; nothing that moves has come to them since";
    }
    const std::string no = "they do not touch because ";
    switch (pair.rung) {
        case Rung::Filter: return no + filter_text(*pair.filter);
        case Rung::Asleep: return no + "one of them sleeps, they did not when it fell asleep, and neither has moved since";
        case Rung::Joined: return no + "a joint of their bodies leaves contacts between them out";
        case Rung::NoStep:
            return no + (why.step == 0 ? "no step has been done yet" : "the last step looked for no contacts: no two shapes could meet");
        case Rung::OutOfStep: return no + "the last step did not know both shapes as they are: one came, changed or is quarantined";
        case Rung::Bounds: return no + bounds_text(pair);
        case Rung::PairLimit: return no + "more boxes overlap than the world's limit on pairs lets it keep";
        case Rung::BackFace: return no + back_face_text(*pair.contact);
        case Rung::Margin: return no + margin_text(*pair.found, pair.contact->margin);
        default: return no + distance_text(*pair.contact);
    }
}

}  // namespace dynamics
}  // namespace carom
