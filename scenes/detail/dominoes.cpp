// Dominoes on an arc of a circle; the first is pushed.
#include <carom/scenes/detail/recipe.hpp>

#include <carom/core/math.hpp>

#include <algorithm>

namespace carom::scenes::detail {
namespace {

constexpr double kHalfHeight = 0.5;
constexpr double kHalfThickness = 0.06;
constexpr double kHalfWidth = 0.25;
constexpr double kSpacing = 0.4;  // along the arc [m]
constexpr double kPush = 1.5;     // the first one's angular velocity [rad/s]; 0.46 rad/s would do to tip it
constexpr double kSmallestRadius = 4.0;

Result<SceneRun> build_dominoes(const Request& request) {
    SceneRun run{.name = "dominoes", .seed = request.seed, .world = World(request.world_def())};
    run.steps = 900;
    // Room for three more, so that the last does not push the first.
    const double radius = std::max(kSmallestRadius, (request.bodies + 3) * kSpacing / (2.0 * kPi));
    const double edge = radius + 3.0;
    run.domain = {{-edge, -0.5, -edge}, {edge, 10.0, edge}};
    add_static_box(run.world, {0.0, -0.5, 0.0}, {edge, 0.5, edge}, "ground");
    for (int i = 0; i < request.bodies; ++i) {
        // At angle 0 a domino stands at x = radius and falls towards -z, along the arc; yaw turns both alike.
        const double angle = i * kSpacing / radius;
        const SinCos turn = sin_cos(angle);
        BodyDef body;
        body.position = {radius * turn.cos, kHalfHeight, -radius * turn.sin};
        body.orientation = rotation_about({0.0, 1.0, 0.0}, angle);
        if (i == 0) {
            // A turn about the lower edge, which stays where it is.
            body.angular_velocity = {-kPush, 0.0, 0.0};
            body.linear_velocity = glm::cross(body.angular_velocity, dvec3{0.0, kHalfHeight, kHalfThickness});
        }
        add_body(run.world, body, Box{vec3(dvec3{kHalfWidth, kHalfHeight, kHalfThickness})});
    }
    return run;
}

}  // namespace

Recipe dominoes_recipe() {
    return {.info = {.name = "dominoes",
                     .summary = "dominoes on an arc; the first falls and takes the others with it",
                     .bodies = 100,
                     .steps = 900,
                     .parameters = {}},
            .most_bodies = 100'000,
            .build = build_dominoes};
}

}  // namespace carom::scenes::detail
