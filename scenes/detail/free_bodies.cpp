// Bodies without gravity: fast spheres shot at a thin wall, and one box that spins.
#include <carom/scenes/detail/recipe.hpp>

#include <cmath>

namespace carom::scenes::detail {
namespace {

int count_beyond_wall(const World& world) {
    int count = 0;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) == BodyType::Dynamic && world.center_of_mass(body).z > 0.0) ++count;
    }
    return count;
}

// The spheres fly tens of metres past the wall's edge and back, so there is no domain.
Result<SceneRun> build_wall_fast(const Request& request) {
    SceneRun run{.name = "wall_fast", .seed = request.seed, .world = World(request.world_def(dvec3{0.0}))};
    run.steps = 120;
    run.tunnelled = count_beyond_wall;
    add_static_box(run.world, dvec3{0.0}, {5.0, 5.0, 0.005}, "wall");
    Random random(request.seed);
    for (int i = 0; i < request.bodies; ++i) {
        BodyDef body;
        body.position = {-4.0 + 8.0 * (i % 20) / 19.0, -4.0 + 8.0 * (i / 20) / 9.0,
                         -10.0 - 30.0 * random.range(0.0, 1.0)};
        body.linear_velocity = {0.0, 0.0, 50.0 * std::pow(40.0, i / 199.0)};
        add_body(run.world, body, Sphere{0.05f});
    }
    return run;
}

Result<SceneRun> build_single_body_spin(const Request& request) {
    SceneRun run{.name = "single_body_spin", .seed = request.seed, .world = World(request.world_def(dvec3{0.0}))};
    run.steps = 3600;
    run.domain = {dvec3{-1.0}, dvec3{1.0}};
    const dvec3 half = 0.5 * dvec3{std::sqrt(2.5), std::sqrt(1.5), std::sqrt(0.5)};
    add_body(run.world, {.angular_velocity = {0.01, 5.0, 0.01}}, Box{vec3(half)});
    return run;
}

}  // namespace

std::vector<Recipe> free_recipes() {
    return {
        {.info = {.name = "wall_fast",
                  .summary = "spheres at 50 to 2,000 m/s against a wall of 1 cm; counts those that go through",
                  .bodies = 200,
                  .steps = 120,
                  .parameters = {}},
         .seed = 99,
         .most_bodies = 200,
         .build = build_wall_fast},
        {.info = {.name = "single_body_spin",
                  .summary = "a free box of inertia 2:3:4 spins about its middle axis and tumbles",
                  .bodies = 1,
                  .steps = 3600,
                  .parameters = {}},
         .fewest_bodies = 1,
         .most_bodies = 1,
         .build = build_single_body_spin},
    };
}

}  // namespace carom::scenes::detail
