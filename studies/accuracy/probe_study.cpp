// The studies "probes": what a wheel of rays misses of what the wheel itself touches, against the time that it takes.
#include <carom/studies/accuracy/catalogue.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/ray_cast.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/random.hpp>
#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/probe.hpp>

#include <fmt/format.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr double kRadius = 0.35;  // of the wheel [m]
constexpr double kWidth = 0.2;    // [m]
constexpr double kClear = 1e-4;   // cases nearer than this to touching are left out [m]

// Turns the y axis, along which cylinders lie, into the x axis, about which wheels turn.
const dquat kOnItsSide{std::sqrt(0.5), 0.0, 0.0, -std::sqrt(0.5)};

/// One kind of ground, with wheels over it and what collide() says of them.
struct WheelCases {
    std::vector<Shape> shapes;
    std::vector<const Shape*> pointers;
    std::vector<Pose> poses;
    struct Case {
        Pose pose;
        std::vector<std::uint32_t> near;
        double separation = 0.0;  ///< of the deepest contact; infinite without any [m]
    };
    std::vector<Case> cases;
    std::size_t touching = 0;

    [[nodiscard]] PlacedShapes placed() const { return {pointers, poses}; }
    void add(Shape shape, const Pose& pose) {
        shapes.push_back(std::move(shape));
        poses.push_back(pose);
    }
};

double collide_wheel(const WheelCases& ground, const WheelCases::Case& c, const Shape& wheel, std::vector<Manifold>& scratch) {
    double least = std::numeric_limits<double>::infinity();
    const Pose pose{c.pose.position, c.pose.orientation * kOnItsSide};
    for (const std::uint32_t number : c.near) {
        scratch.clear();
        collide({&wheel, &ground.shapes[number], pose, ground.poses[number], 0.0f}, 0, scratch);
        for (const Manifold& m : scratch) {
            for (const ContactPoint& p : m.used()) least = std::min(least, static_cast<double>(p.separation));
        }
    }
    return least;
}

void add_terrain(WheelCases& out) {
    const MeshData data = diamond_square({.level = 6, .spacing = 0.25, .height = 0.6, .seed = 4711});
    out.add(*TriangleMesh::build(data.vertices, data.triangles), {});
}

void add_steps(WheelCases& out) {
    for (int i = -8; i < 8; ++i) {
        const double rise = 0.15 * (i + 8);
        out.add(Box{{5.0f, static_cast<float>(0.5 * rise + 0.5), 0.3f}}, {{0.0, 0.5 * rise - 0.5, 0.6 * i}});
    }
}

void add_rails(WheelCases& out, Random& random) {
    out.add(Box{{8.0f, 0.5f, 8.0f}}, {{0.0, -0.5, 0.0}});
    for (int i = 0; i < 60; ++i) {
        const double turn = random.range(0.0, kPi);
        const dvec3 at{random.range(-5.0, 5.0), random.range(0.0, 0.12), random.range(-5.0, 5.0)};
        out.add(Box{{1.5f, 0.02f, 0.02f}}, {at, {std::cos(turn), 0.0, std::sin(turn), 0.0}});
    }
}

// How high the ground is under a point.
double height_at(const WheelCases& ground, double x, double z) {
    double height = -1.0;
    for (std::size_t i = 0; i < ground.shapes.size(); ++i) {
        const auto hit = cast_ray(ground.shapes[i], ground.poses[i], {{x, 20.0, z}, {0.0, -1.0, 0.0}});
        if (hit) height = std::max(height, hit->point.y);
    }
    return height;
}

std::shared_ptr<const WheelCases> make_cases(const std::string& kind, std::size_t count) {
    auto out = std::make_shared<WheelCases>();
    Random random(kind == "terrain" ? 81 : kind == "steps" ? 82 : 83);
    if (kind == "terrain") add_terrain(*out);
    if (kind == "steps") add_steps(*out);
    if (kind == "rails") add_rails(*out, random);
    for (const Shape& shape : out->shapes) out->pointers.push_back(&shape);
    const Shape wheel = Cylinder{static_cast<float>(kRadius), static_cast<float>(0.5 * kWidth)};
    std::vector<Manifold> scratch;
    while (out->cases.size() < count) {
        const double x = random.range(-4.0, 4.0), z = random.range(-4.0, 4.0);
        const double yaw = random.range(0.0, 2.0 * kPi), tilt = random.range(-0.15, 0.15);
        const dquat upright{std::cos(0.5 * yaw), 0.0, std::sin(0.5 * yaw), 0.0}, leaning{std::cos(tilt), 0.0, 0.0, std::sin(tilt)};
        WheelCases::Case c{{{x, height_at(*out, x, z) + kRadius * random.range(0.85, 1.2), z}, upright * leaning}, {}, 0.0};
        const Aabb box = inflate({c.pose.position, c.pose.position}, kRadius + kWidth);
        for (std::uint32_t i = 0; i < out->shapes.size(); ++i) {
            if (overlaps(bounds(out->shapes[i], out->poses[i]), box)) c.near.push_back(i);
        }
        c.separation = collide_wheel(*out, c, wheel, scratch);
        if (std::abs(c.separation) < kClear) continue;
        out->touching += c.separation < 0.0;
        out->cases.push_back(std::move(c));
    }
    return out;
}

using Grounds = std::vector<std::shared_ptr<const WheelCases>>;

/// What decides that a ray's hit touches, and how deep.
enum class Feel { Rim, Plane };

struct ProbeKnobs {
    std::uint32_t rays = 8;
    std::uint32_t rows = 1;
    Feel feel = Feel::Rim;
};

double felt(const std::vector<ProbeContact>& contacts, Feel feel) {
    double least = std::numeric_limits<double>::infinity();
    for (const ProbeContact& c : contacts) least = std::min(least, feel == Feel::Rim ? c.separation : c.clearance);
    return least;
}

/// Runs one query a case and judges it. @param depth  measure depths rather than verdicts.
template <class Query>
Sample run(const Grounds& grounds, bool depth, const Query& query) {
    std::size_t wrong = 0, touching = 0, both = 0, all = 0;
    double seconds = 0.0, error = 0.0;
    std::vector<double> answers;
    for (const auto& ground : grounds) {
        answers.clear();
        const ThreadStopwatch watch;
        for (const WheelCases::Case& c : ground->cases) answers.push_back(query(*ground, c));
        seconds += watch.seconds();
        for (std::size_t i = 0; i < answers.size(); ++i) {
            const double exact = ground->cases[i].separation;
            wrong += (answers[i] <= 0.0) != (exact <= 0.0);
            if (answers[i] > 0.0 || exact > 0.0) continue;
            ++both;
            error += std::abs(answers[i] - exact) / kRadius;
        }
        touching += ground->touching;
        all += answers.size();
    }
    Sample sample;
    sample.time_s = seconds / static_cast<double>(all);
    sample.error = depth ? (both == 0 ? 0.0 : error / static_cast<double>(both)) : static_cast<double>(wrong) / static_cast<double>(touching);
    return sample;
}

Candidate probe_candidate(const Grounds& grounds, bool depth, const ProbeKnobs& knobs) {
    const Settings settings{{"rays", static_cast<double>(knobs.rays)},
                            {"rows", static_cast<double>(knobs.rows)},
                            {"feel", std::string(knobs.feel == Feel::Rim ? "rim" : "plane")}};
    return {"carom", settings, [=] {
                // Planes are felt from farther out: the hit may lie beyond the rim and the plane still cut the wheel.
                const RayProbe wheel{.angle = 2.0 * kPi, .rays = knobs.rays, .rows = knobs.rows, .width = knobs.rows > 1 ? kWidth : 0.0,
                                     .radius = kRadius, .reach = knobs.feel == Feel::Plane ? 0.3 * kRadius : 0.0};
                std::vector<ProbeContact> contacts;
                return run(grounds, depth, [&](const WheelCases& ground, const WheelCases::Case& c) {
                    contacts.clear();
                    probe(wheel, c.pose, ground.placed(), c.near, contacts);
                    return felt(contacts, knobs.feel);
                });
            }};
}

Candidate collide_candidate(const Grounds& grounds, bool depth) {
    return {"carom", {{"query", std::string("collide")}}, [=] {
                const Shape wheel = Cylinder{static_cast<float>(kRadius), static_cast<float>(0.5 * kWidth)};
                std::vector<Manifold> scratch;
                return run(grounds, depth,
                           [&](const WheelCases& ground, const WheelCases::Case& c) { return collide_wheel(ground, c, wheel, scratch); });
            }};
}

Study study_of(const std::string& name, const Grounds& grounds, bool depth, const StudyOptions& options) {
    std::size_t cases = 0, touching = 0;
    for (const auto& ground : grounds) {
        cases += ground->cases.size();
        touching += ground->touching;
    }
    Study study{.name = name,
                .stage = "narrowphase",
                .error = depth ? "mean error of the depth of contacts that both find, of the wheel's radius"
                               : "wrong verdicts (contacts missed, and touches where there are none), of the contacts there are",
                .unit = "1",
                .oracle = fmt::format("collide() of the wheel as a cylinder; {} places, {} of which touch", cases, touching),
                .time = "the query of one wheel, of the processor"};
    study.candidates.push_back(collide_candidate(grounds, depth));
    for (const std::uint32_t rays : {4u, 8u, 16u, 32u, 64u, 128u}) {
        if (options.quick && rays > 32) continue;
        study.candidates.push_back(probe_candidate(grounds, depth, {rays, 1, Feel::Rim}));
        study.candidates.push_back(probe_candidate(grounds, depth, {rays, 3, Feel::Rim}));
        study.candidates.push_back(probe_candidate(grounds, depth, {rays, 3, Feel::Plane}));
    }
    return study;
}

}  // namespace

std::vector<Study> probe_studies(const StudyOptions& options) {
    const std::size_t count = options.quick ? 60 : 600;
    const auto terrain = make_cases("terrain", count), steps = make_cases("steps", count), rails = make_cases("rails", count);
    std::vector<Study> studies;
    studies.push_back(study_of("probes", {terrain, steps, rails}, false, options));
    studies.push_back(study_of("probes_terrain", {terrain}, false, options));
    studies.push_back(study_of("probes_steps", {steps}, false, options));
    studies.push_back(study_of("probes_rails", {rails}, false, options));
    studies.push_back(study_of("probes_depth", {terrain, steps, rails}, true, options));
    return studies;
}

}  // namespace carom::accuracy
