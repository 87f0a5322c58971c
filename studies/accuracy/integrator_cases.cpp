#include <carom/studies/accuracy/integrator_cases.hpp>

#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/scenes/scene.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

constexpr double kInterval = 0.5;  // between two comparisons [s]
constexpr double kApart = 100.0;   // [m]
const dvec3 kGravity{0.0, -9.81, 0.0};

vec3 half_extents_of(FreeKind kind) {
    if (kind == FreeKind::Isotropic) return vec3{0.5f};
    return kind == FreeKind::Symmetric ? vec3{0.3f, 0.7f, 0.3f} : vec3{0.7f, 0.5f, 0.3f};
}

dvec3 direction(Random& random) {
    for (;;) {
        const double x = random.range(-1.0, 1.0), y = random.range(-1.0, 1.0), z = random.range(-1.0, 1.0);
        const dvec3 v{x, y, z};
        const double length = glm::length(v);
        if (length > 0.1 && length <= 1.0) return v / length;
    }
}

World make_boxes(FreeKind kind, int count, WorldDef def) {
    def.gravity = kind == FreeKind::Falling ? kGravity : dvec3{0.0};
    World world(def);
    Random random(7100 + static_cast<std::uint64_t>(kind));
    for (int i = 0; i < count; ++i) {
        BodyDef body;
        body.position = {kApart * (i % 4), 0.0, kApart * (i / 4)};
        const double half_angle = random.range(0.0, kPi);
        const dvec3 axis = direction(random) * std::sin(half_angle);
        body.orientation = {std::cos(half_angle), axis.x, axis.y, axis.z};
        dvec3 spin = direction(random);
        if (i % 3 == 0) spin = glm::normalize(dvec3{0.0, 1.0, 0.0} + 0.01 * spin);  // in body axes, the middle moment's
        body.angular_velocity = rotate(body.orientation, spin * random.range(3.0, 6.0));
        if (kind == FreeKind::Falling) body.linear_velocity = 5.0 * direction(random);
        world.add_shape(world.create_body(body), Box{half_extents_of(kind)});
    }
    return world;
}

World make_scene_world(const WorldDef& def) { return std::move(scenes::make_scene("single_body_spin", {.world = def})->world); }

double kinetic_energy(const dvec3& moments, const oracle::FreeBodyState& s) {
    const dvec3 spin = rotate_inverse(s.orientation, s.spin);
    return 0.5 * glm::dot(moments * spin, spin);
}

dvec3 angular_momentum(const dvec3& moments, const oracle::FreeBodyState& s) {
    return rotate(s.orientation, moments * rotate_inverse(s.orientation, s.spin));
}

/// The angle that turns one into the other, by the sine of its half: exact near zero.
double angle_between(const dquat& a, const dquat& b) {
    const dquat turn = glm::conjugate(a) * b;
    return 2.0 * std::asin(std::min(1.0, glm::length(dvec3{turn.x, turn.y, turn.z})));
}

double error_of(const MovingBody& body, const oracle::FreeBodyState& truth, const oracle::FreeBodyState& state, FreeMeasure measure) {
    switch (measure) {
        case FreeMeasure::Orientation: return angle_between(truth.orientation, state.orientation);
        case FreeMeasure::Energy: return std::abs(kinetic_energy(body.moments, state) / kinetic_energy(body.moments, truth) - 1.0);
        case FreeMeasure::Momentum: {
            const dvec3 exact = angular_momentum(body.moments, truth);
            return glm::length(angular_momentum(body.moments, state) - exact) / glm::length(exact);
        }
        case FreeMeasure::Position:
            return glm::length(state.position - truth.position) / glm::length(truth.position - body.pose.position);
    }
    return 0.0;
}

}  // namespace

const char* to_string(FreeKind kind) noexcept {
    switch (kind) {
        case FreeKind::Isotropic: return "isotropic";
        case FreeKind::Symmetric: return "symmetric";
        case FreeKind::Asymmetric: return "asymmetric";
        case FreeKind::Falling: return "fall";
        case FreeKind::Scene: return "single_body_spin";
    }
    return "unknown";
}

FreeCasesPtr free_cases(FreeKind kind, int count, double duration) {
    auto cases = std::make_shared<FreeCases>();
    cases->make = [kind, count](const WorldDef& def) { return kind == FreeKind::Scene ? make_scene_world(def) : make_boxes(kind, count, def); };
    cases->bodies = scene_bodies(cases->make({}));
    cases->times = even_times(kInterval, static_cast<int>(std::lround(duration / kInterval)));
    for (const MovingBody& body : cases->bodies.moving) {
        const oracle::FreeBodyState start{body.pose.position, body.pose.orientation, body.linear_velocity, body.angular_velocity};
        cases->truth.push_back(oracle::free_motion({body.moments, start, cases->bodies.gravity}, cases->times));
    }
    return cases;
}

std::optional<double> error_of(const FreeCases& cases, const Track& track, FreeMeasure measure) {
    if (!is_finite(track)) return std::nullopt;
    double worst = 0.0;
    for (std::size_t i = 0; i < cases.truth.size(); ++i) {
        for (std::size_t t = 0; t < cases.times.size(); ++t) {
            worst = std::max(worst, error_of(cases.bodies.moving[i], cases.truth[i][t], track.states[i][t], measure));
        }
    }
    return worst;
}

}  // namespace carom::accuracy
