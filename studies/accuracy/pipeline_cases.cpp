#include <carom/studies/accuracy/pipeline_cases.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/oracle/penetration.hpp>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace carom::accuracy {
namespace {

constexpr double kGravity = 9.81;
constexpr double kSpacing = 0.1;      // of the times [s]
constexpr double kQuiet = 0.5;        // of the run's end that Jitter looks at [s]
constexpr double kSlope = kPi / 6.0, kSlideFriction = 0.3;
constexpr double kHeld = 0.5;         // tangent of the slope that holds
constexpr double kBallRadius = 0.25, kDrop = 1.0, kRestitution = 0.8;
constexpr int kColumn = 8, kRows = 8, kPileLayers = 5;

dquat turn_about_z(double angle) { return {std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle)}; }

// A fixed box whose upper face passes through the origin, turned about z. No plane: other engines of the comparison are given none.
void add_ground(World& world, double slope, const ShapeDef& def) {
    constexpr double kHalf = 0.5;
    const dquat turn = turn_about_z(slope);
    const BodyId ground = world.create_body({.type = BodyType::Static, .position = rotate(turn, dvec3{0.0, -kHalf, 0.0}), .orientation = turn});
    world.add_shape(ground, Box{{20.0f, static_cast<float>(kHalf), 20.0f}}, def);
}

void add_box(World& world, const Pose& pose, const vec3& half, float friction) {
    const BodyId body = world.create_body({.position = pose.position, .orientation = pose.orientation});
    world.add_shape(body, Box{half}, {.friction = friction});
}

World on_slope(const WorldDef& def, double slope, float friction) {
    World world(def);
    add_ground(world, slope, {.friction = friction});
    const dquat turn = turn_about_z(slope);
    add_box(world, {rotate(turn, dvec3{0.0, 0.25, 0.0}), turn}, vec3{0.5f, 0.25f, 0.5f}, friction);
    return world;
}

World with_ball(const WorldDef& def) {
    World world(def);
    const auto bouncy = static_cast<float>(kRestitution);
    add_ground(world, 0.0, {.friction = 0.0f, .restitution = bouncy});
    const BodyId ball = world.create_body({.position = {0.0, kBallRadius + kDrop, 0.0}});
    world.add_shape(ball, Sphere{static_cast<float>(kBallRadius)}, {.friction = 0.0f, .restitution = bouncy});
    return world;
}

// A cone of 12 sides and a flat lid, 0.1 m high, that leans by 0.2 rad and turns about its own axis at 30 rad/s, three times what keeps it up.
World with_top(const WorldDef& def) {
    World world(def);
    add_ground(world, 0.0, {.friction = 0.6f});
    std::vector<vec3> corners{{0.0f, 0.0f, 0.0f}};
    for (int i = 0; i < 12; ++i) {
        const double angle = 2.0 * kPi * i / 12.0;
        corners.emplace_back(static_cast<float>(0.3 * std::cos(angle)), 0.1f, static_cast<float>(0.3 * std::sin(angle)));
    }
    const dquat lean = turn_about_z(0.2);
    const BodyId top = world.create_body({.orientation = lean, .angular_velocity = rotate(lean, dvec3{0.0, 30.0, 0.0})});
    world.add_shape(top, *ConvexHull::build(corners), {.friction = 0.6f});
    return world;
}

World with_column(const WorldDef& def) {
    World world(def);
    add_ground(world, 0.0, {.friction = 0.6f});
    for (int i = 0; i < kColumn; ++i) add_box(world, {{0.0, 0.5 + i, 0.0}}, vec3{0.5f}, 0.6f);
    return world;
}

World with_pyramid(const WorldDef& def) {
    World world(def);
    add_ground(world, 0.0, {.friction = 0.6f});
    for (int row = 0; row < kRows; ++row) {
        for (int i = 0; i < kRows - row; ++i) {
            add_box(world, {{1.0625 * (i - 0.5 * (kRows - row - 1)), 0.5 + row, 0.0}}, vec3{0.5f}, 0.6f);
        }
    }
    return world;
}

World with_pile(const WorldDef& def) {
    World world(def);
    add_ground(world, 0.0, {.friction = 0.6f});
    for (const double side : {-1.0, 1.0}) {
        const BodyId wall_x = world.create_body({.type = BodyType::Static, .position = {1.5 * side, 2.0, 0.0}});
        world.add_shape(wall_x, Box{{0.25f, 2.0f, 1.75f}});
        const BodyId wall_z = world.create_body({.type = BodyType::Static, .position = {0.0, 2.0, 1.5 * side}});
        world.add_shape(wall_z, Box{{1.75f, 2.0f, 0.25f}});
    }
    Random random(9021);
    for (int i = 0; i < 6 * kPileLayers; ++i) {
        const double x = 0.7 * (i % 3 - 1) + random.range(-0.04, 0.04), z = 0.8 * ((i / 3) % 2 - 0.5) + random.range(-0.04, 0.04);
        const double angle = random.range(-0.4, 0.4), lean = random.range(-0.2, 0.2);
        const dquat about_y{std::cos(0.5 * angle), 0.0, std::sin(0.5 * angle), 0.0};
        add_box(world, {{x, 0.5 + 0.7 * (i / 6), z}, about_y * turn_about_z(lean)}, vec3{0.25f}, 0.6f);
    }
    return world;
}

World make_world(PipelineKind kind, WorldDef def) {
    def.gravity = {0.0, -kGravity, 0.0};
    switch (kind) {
        case PipelineKind::Slide: return on_slope(def, kSlope, static_cast<float>(kSlideFriction));
        case PipelineKind::Bounce: return with_ball(def);
        case PipelineKind::Top: return with_top(def);
        case PipelineKind::Creep: return on_slope(def, std::atan(kHeld), 0.6f);
        case PipelineKind::Column: return with_column(def);
        case PipelineKind::Pyramid: return with_pyramid(def);
        case PipelineKind::Pile: return with_pile(def);
    }
    return World(def);
}

// Flights from the ground, each at e times the speed of the one before.
double height_of_ball(double t) {
    const double first = std::sqrt(2.0 * kDrop / kGravity);
    if (t < first) return kDrop - 0.5 * kGravity * t * t;
    double since = t - first, speed = kRestitution * kGravity * first;
    for (; since > 2.0 * speed / kGravity; speed *= kRestitution) since -= 2.0 * speed / kGravity;
    return (speed - 0.5 * kGravity * since) * since;
}

using Course = std::vector<std::vector<dvec3>>;

// What closed forms or rest say; nothing where there is none.
Course exact_course(const PipelineScene& scene) {
    Course course(scene.bodies.moving.size());
    for (std::size_t i = 0; i < course.size(); ++i) {
        const dvec3 start = scene.bodies.moving[i].pose.position;
        for (const double t : scene.times) {
            dvec3 at = start;
            if (scene.kind == PipelineKind::Slide) {
                const double a = kGravity * (std::sin(kSlope) - static_cast<double>(static_cast<float>(kSlideFriction)) * std::cos(kSlope));
                at -= 0.5 * a * t * t * dvec3{std::cos(kSlope), std::sin(kSlope), 0.0};
            }
            if (scene.kind == PipelineKind::Bounce) at.y = kBallRadius + height_of_ball(t);
            course[i].push_back(at);
        }
    }
    return course;
}

Course course_of(const Track& track) {
    Course course;
    for (const auto& states : track.states) {
        course.emplace_back();
        for (const oracle::FreeBodyState& s : states) course.back().push_back(s.position);
    }
    return course;
}

double distance_between(const PipelineScene& scene, const Course& a, const Course& b) {
    double worst = 0.0;
    for (std::size_t t = 0; t < scene.course; ++t) {
        double sum = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i) {
            const double distance = glm::length(a[i][t] - b[i][t]);
            sum += distance;
            largest = std::max(largest, distance);
        }
        worst = std::max(worst, scene.kind == PipelineKind::Pile ? sum / static_cast<double>(a.size()) : largest);
    }
    return worst / scene.scale;
}

// Carom itself with steps far shorter than those it is to judge: what the scene's rigid bodies and Coulomb's friction come to.
void refer_to_small_steps(PipelineScene& scene, bool quick) {
    const double dt = 1.0 / (quick ? 960.0 : 3840.0);
    const auto run = [&](double step) {
        return course_of(follow(*make_carom(scene.make({})), scene.bodies, std::span(scene.times).first(scene.course), step));
    };
    scene.truth = run(dt);
    scene.doubt = distance_between(scene, run(2.0 * dt), scene.truth);
    scene.oracle = fmt::format("Carom's own course at dt = 1/{:.0f} s, which is {:.1e} from that at twice the step", 1.0 / dt, *scene.doubt);
}

double rms_speed(const PipelineScene& scene, const Track& track) {
    double sum = 0.0, count = 0.0;
    for (const auto& states : track.states) {
        for (std::size_t t = 0; t < scene.times.size(); ++t) {
            if (scene.times[t] < scene.times.back() - kQuiet + 0.5 * kSpacing) continue;
            sum += glm::dot(states[t].velocity, states[t].velocity);
            count += 1.0;
        }
    }
    return std::sqrt(sum / count);
}

double penetration(const PipelineScene& scene, const Track& track) {
    World world = scene.make({});
    const std::vector<BodyId> ids = moving_bodies(world);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        const oracle::FreeBodyState& s = track.states[i].back();
        world.set_pose(ids[i], Pose{s.position, glm::normalize(s.orientation)} * scene.bodies.moving[i].shape_in_mass);
    }
    const oracle::Penetration found = oracle::geometric_penetration(world);
    return std::max(found.polytopes.maximum, found.round.maximum) / scene.scale;
}

}  // namespace

const char* to_string(PipelineKind kind) noexcept {
    switch (kind) {
        case PipelineKind::Slide: return "slide";
        case PipelineKind::Bounce: return "bounce";
        case PipelineKind::Top: return "top";
        case PipelineKind::Creep: return "creep";
        case PipelineKind::Column: return "column";
        case PipelineKind::Pyramid: return "pyramid";
        case PipelineKind::Pile: return "pile";
    }
    return "unknown";
}

std::span<const PipelineKind> pipeline_kinds() {
    static constexpr std::array kKinds{PipelineKind::Slide,  PipelineKind::Bounce,  PipelineKind::Top, PipelineKind::Creep,
                                       PipelineKind::Column, PipelineKind::Pyramid, PipelineKind::Pile};
    return kKinds;
}

PipelineScenePtr pipeline_scene(PipelineKind kind, bool quick) {
    auto scene = std::make_shared<PipelineScene>();
    scene->kind = kind;
    scene->make = [kind](const WorldDef& def) { return make_world(kind, def); };
    scene->bodies = scene_bodies(scene->make({}));
    scene->rests = kind == PipelineKind::Creep || kind == PipelineKind::Column || kind == PipelineKind::Pyramid || kind == PipelineKind::Pile;
    scene->times = even_times(kSpacing, kind == PipelineKind::Pile ? 40 : kind == PipelineKind::Slide || kind == PipelineKind::Top ? 10 : 20);
    scene->course = kind == PipelineKind::Pile ? 5 : scene->times.size();
    scene->scale = kind == PipelineKind::Pile ? 0.5 : kind == PipelineKind::Top ? 0.3 : 1.0;
    if (kind == PipelineKind::Top || kind == PipelineKind::Pile) {
        refer_to_small_steps(*scene, quick);
        return scene;
    }
    scene->truth = exact_course(*scene);
    scene->oracle = kind == PipelineKind::Slide ? "a = g (sin - μ cos)" : kind == PipelineKind::Bounce ? "parabolas, e times the speed after each" : "rest";
    return scene;
}

std::optional<double> error_of(const PipelineScene& scene, const Track& track, PipelineMeasure measure) {
    if (!is_finite(track)) return std::nullopt;
    switch (measure) {
        case PipelineMeasure::Course: return distance_between(scene, course_of(track), scene.truth);
        case PipelineMeasure::Penetration: return penetration(scene, track);
        case PipelineMeasure::Jitter: return rms_speed(scene, track);
    }
    return std::nullopt;
}

}  // namespace carom::accuracy
