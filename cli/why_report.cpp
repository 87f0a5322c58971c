#include <carom/cli/why_report.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace carom::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAxisNames[3] = {"x", "y", "z"};

template <class T>
std::string point_text(const glm::vec<3, T>& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

std::string line(const std::string& rung, const std::string& text) { return fmt::format("{:<12}{}\n", rung, text); }

std::string feature_text(const SupportFeature& feature) {
    return feature.kind == SupportKind::Round ? "round" : fmt::format("{} {}", to_string(feature.kind), feature.index);
}

std::string filter_text(const FilterFinding& f) {
    const std::string who = f.any_moves ? "one of them is dynamic" : "neither is dynamic";
    const std::string layers = f.layers_agree ? "layers and masks agree" : "layers and masks do not agree";
    return line("filter", fmt::format("{}; {} (A {:#x} in {:#x}, B {:#x} in {:#x}){}", who, layers, f.layer_a, f.mask_b, f.layer_b, f.mask_a,
                                      f.joined ? "; a joint of their bodies leaves contacts out" : ""));
}

std::string bounds_text(const BoundsFinding& b) {
    const std::string along = b.axis < 0 ? "the plane's normal" : kAxisNames[b.axis];
    return line("bounds", b.gap > 0.0 ? fmt::format("apart by {:.6g} m along {}", b.gap, along)
                                      : fmt::format("overlap, by {:.6g} m along {}, the least", 0.0 - b.gap, along));
}

std::string broadphase_text(const BroadphaseFinding& b) {
    const std::string who = b.method == BroadphaseMethod::Automatic ? "the list of planes" : to_string(b.method);
    return line("broadphase", fmt::format("{} {} them; {}", who, b.listed ? "lists" : "does not list", b.place));
}

std::string axis_text(const SeparatingAxis& a) {
    return line("axis", fmt::format("{} of {:.6g} m along {}, {}: {} of A, {} of B; rounding {:.1g} m", a.gap < 0.0 ? "overlap" : "gap",
                                    a.gap < 0.0 ? -a.gap : a.gap, point_text(a.normal), to_string(a.source), feature_text(a.of_a),
                                    feature_text(a.of_b), a.rounding));
}

std::string distance_text(const DistanceBounds& d) {
    if (d.cores_overlap) return line("distance", "0: the shapes (of round ones the cores) overlap");
    return line("distance", fmt::format("{:.9g} .. {:.9g} m, from A {} to B {}; last simplex of {} corners{}", d.lower, d.upper, point_text(d.on_a),
                                        point_text(d.on_b), d.simplex_a.size(), d.converged ? "" : "; stopped at its cap"));
}

std::string manifolds_text(const PairExplanation& c) {
    if (c.manifolds.empty()) return line("manifold", fmt::format("none within the margin of {:.6g} m", c.margin));
    std::string text;
    for (const Manifold& m : c.manifolds) {
        text += line("manifold", fmt::format("{} points from A's origin, normal {}{}", m.count, point_text(m.normal),
                                             m.part_a + m.part_b == 0 ? "" : fmt::format(", parts {} and {}", m.part_a, m.part_b)));
        for (const ContactPoint& p : m.used()) {
            text += line("", fmt::format("{} separation {:.6g} m, feature {:016x}", point_text(p.position), p.separation, p.feature));
        }
    }
    if (c.patch) {
        text += line("", fmt::format("cut from faces of {} and {} corners, which share {} corners", c.patch->face_a.size(),
                                     c.patch->face_b.size(), c.patch->common.size()));
    }
    return text;
}

std::string contact_text(const PairExplanation& c, bool are_meshes) {
    std::string text;
    if (are_meshes) {
        text += line("nearest", fmt::format("triangle {} of A, triangle {} of B", c.triangle, c.triangle_b));
    } else if (c.part_a + c.part_b + c.triangle != 0) {
        text += line("nearest", fmt::format("part {} of A, part {} of B, triangle {}", c.part_a, c.part_b, c.triangle));
    }
    if (c.axis) text += axis_text(*c.axis);
    if (c.distance) text += distance_text(*c.distance);
    text += line("verdict", fmt::format("{}{}", to_string(c.verdict), c.status == CollideStatus::Ok ? "" : "; collide() stopped at its cap"));
    if (c.back_face) text += line("mesh", "back face, one-sided: collide() does not look at it");
    return text + manifolds_text(c);
}

template <class T>
Json vector_json(const glm::vec<3, T>& v) {
    return Json::array({v.x, v.y, v.z});
}

Json points_json(const std::vector<dvec3>& points) {
    Json out = Json::array();
    for (const dvec3& p : points) out.push_back(vector_json(p));
    return out;
}

Json filter_json(const FilterFinding& f) {
    return {{"layer_a", f.layer_a},
            {"mask_a", f.mask_a},
            {"layer_b", f.layer_b},
            {"mask_b", f.mask_b},
            {"layers_agree", f.layers_agree},
            {"any_moves", f.any_moves},
            {"joined", f.joined}};
}

Json bounds_json(const BoundsFinding& b) { return {{"axis", b.axis < 0 ? "plane" : kAxisNames[b.axis]}, {"gap", b.gap}}; }

Json broadphase_json(const BroadphaseFinding& b) {
    return {{"method", b.method == BroadphaseMethod::Automatic ? "planes" : to_string(b.method)}, {"listed", b.listed}, {"place", b.place}};
}

Json feature_json(const SupportFeature& f) { return {{"kind", to_string(f.kind)}, {"index", f.index}}; }

Json axis_json(const SeparatingAxis& a) {
    return {{"source", to_string(a.source)}, {"normal", vector_json(a.normal)}, {"gap", a.gap},
            {"rounding", a.rounding},        {"verdict", to_string(a.verdict)}, {"of_a", feature_json(a.of_a)},
            {"of_b", feature_json(a.of_b)},  {"on_a", vector_json(a.on_a)},     {"on_b", vector_json(a.on_b)}};
}

Json distance_json(const DistanceBounds& d) {
    // JSON has no infinity: what is farther away than numbers go has no upper bound.
    const bool bounded = d.upper < std::numeric_limits<double>::infinity();
    return {{"lower", d.lower},
            {"upper", bounded ? Json(d.upper) : Json(nullptr)},
            {"on_a", vector_json(d.on_a)},
            {"on_b", vector_json(d.on_b)},
            {"cores_overlap", d.cores_overlap},
            {"converged", d.converged},
            {"simplex_a", points_json(d.simplex_a)},
            {"simplex_b", points_json(d.simplex_b)}};
}

Json manifold_json(const Manifold& m) {
    Json points = Json::array();
    for (const ContactPoint& p : m.used()) {
        points.push_back({{"position", vector_json(p.position)}, {"separation", p.separation}, {"feature", fmt::format("{:016x}", p.feature)}});
    }
    return {{"normal", vector_json(m.normal)}, {"part_a", m.part_a}, {"part_b", m.part_b}, {"points", points}};
}

Json contact_json(const PairExplanation& c) {
    Json manifolds = Json::array(), patch = nullptr;
    for (const Manifold& m : c.manifolds) manifolds.push_back(manifold_json(m));
    if (c.patch) {
        patch = {{"face_a", points_json(c.patch->face_a)}, {"face_b", points_json(c.patch->face_b)}, {"common", points_json(c.patch->common)}};
    }
    return {{"verdict", to_string(c.verdict)},
            {"margin", c.margin},
            {"part_a", c.part_a},
            {"part_b", c.part_b},
            {"triangle", c.triangle},
            {"triangle_b", c.triangle_b},
            {"back_face", c.back_face},
            {"axis", c.axis ? axis_json(*c.axis) : Json(nullptr)},
            {"distance", c.distance ? distance_json(*c.distance) : Json(nullptr)},
            {"decided", c.status == CollideStatus::Ok},
            {"manifolds", manifolds},
            {"patch", patch}};
}

Json found_json(const StepContacts& f) {
    return {{"manifolds", f.manifolds},
            {"points", f.points},
            {"least_separation", f.points == 0 ? Json(nullptr) : Json(f.least_separation)},
            {"passes", f.passes},
            {"carried", f.carried}};
}

Json pair_json(const ShapePairExplanation& p, const World& world) {
    const auto shape = [&](ShapeId id) { return Json{{"number", id.slot}, {"type", to_string(type_of(world.shape(id)))}}; };
    return {{"shape_a", shape(p.shape_a)},
            {"shape_b", shape(p.shape_b)},
            {"rung", to_string(p.rung)},
            {"filter", p.filter ? filter_json(*p.filter) : Json(nullptr)},
            {"bounds", p.bounds ? bounds_json(*p.bounds) : Json(nullptr)},
            {"broadphase", p.broadphase ? broadphase_json(*p.broadphase) : Json(nullptr)},
            {"origin", vector_json(p.pose_a.position)},
            {"found", p.found ? found_json(*p.found) : Json(nullptr)},
            {"contact", p.contact ? contact_json(*p.contact) : Json(nullptr)}};
}

}  // namespace

std::string body_text(const World& world, BodyId body) {
    std::string what = world.name(body);
    for (const ShapeId shape : world.shapes(body)) {
        const std::string type = to_string(type_of(world.shape(shape)));
        if (what.find(type) == std::string::npos) what += (what.empty() ? "" : ", ") + type;
    }
    return fmt::format("body {} ({}{}{})", body.slot, what, what.empty() ? "" : ", ", to_string(world.type(body)));
}

std::string to_text(const ContactExplanation& why, const World& world, const std::string& way) {
    std::string text;
    if (!why.pairs.empty()) {
        const ShapePairExplanation& pair = why.pairs[why.deciding];
        if (why.pairs.size() > 1) text += line("shapes", fmt::format("the pair that got highest of {}; --json has all", why.pairs.size()));
        if (pair.filter) text += filter_text(*pair.filter);
        if (pair.bounds) text += bounds_text(*pair.bounds);
        if (pair.broadphase) text += broadphase_text(*pair.broadphase);
        const auto is_mesh = [&](ShapeId id) { return type_of(world.shape(id)) == ShapeType::TriangleMesh; };
        if (pair.contact) text += contact_text(*pair.contact, is_mesh(pair.shape_a) && is_mesh(pair.shape_b));
        if (pair.found && pair.found->carried) {
            text += line("step", fmt::format("carried {} points along from a step before, the nearest at {:.6g} m", pair.found->points,
                                             pair.found->least_separation));
        }
    }
    return text + way + why.sentence + "\n";
}

nlohmann::ordered_json to_json(const ContactExplanation& why, const World& world) {
    const auto body = [&](BodyId id) {
        return Json{{"number", id.slot}, {"name", world.name(id)}, {"type", to_string(world.type(id))}};
    };
    Json pairs = Json::array();
    for (const ShapePairExplanation& pair : why.pairs) pairs.push_back(pair_json(pair, world));
    return {{"step", why.step},
            {"a", body(why.body_a)},
            {"b", body(why.body_b)},
            {"rung", to_string(why.rung)},
            {"sentence", why.sentence},
            {"disagreements", why.disagreements},
            {"deciding", why.pairs.empty() ? Json(nullptr) : Json(why.deciding)},
            {"pairs", pairs}};
}

}  // namespace carom::cli
