// Boxes on boxes: a pyramid, a column, and a heavy box on a light one.
#include <carom/scenes/detail/recipe.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace carom::scenes::detail {
namespace {

constexpr double kGround = 50.0;  // half width of the ground [m], at least
constexpr double kPyramidSpacing = 1.02;

SceneRun run_on_ground(const Request& request, const char* name, int steps, double top, double ground = kGround) {
    SceneRun run{.name = name, .seed = request.seed, .world = World(request.world_def())};
    run.steps = steps;
    run.domain = {{-ground, -0.5, -ground}, {ground, top + 10.0, ground}};
    add_static_box(run.world, {0.0, -0.5, 0.0}, {ground, 0.5, ground}, "ground");
    return run;
}

void add_unit_box(World& world, const dvec3& position, double density = 1000.0) {
    ShapeDef matter = scene_matter();
    matter.density = density;
    add_body(world, {.position = position}, Box{vec3{0.5f}}, matter);
}

constexpr int triangle_number(int base) { return base * (base + 1) / 2; }

/// @return the base that the request asks for, by `bodies` or by `base`.
Result<int> pyramid_base(const Request& request) {
    const double value = request.value("base");
    if (value != std::floor(value)) {
        return Error{ErrorCode::InvalidArgument, "base must be a whole number of boxes", "set base"};
    }
    const int base = static_cast<int>(value);
    if (!request.bodies_given || request.bodies == triangle_number(base)) return base;
    int below = 0;
    while (triangle_number(below + 1) <= request.bodies) ++below;
    if (triangle_number(below) != request.bodies) {
        return Error{ErrorCode::InvalidArgument,
                     "a pyramid has base (base + 1) / 2 boxes; next to " + std::to_string(request.bodies) + " are " +
                         std::to_string(triangle_number(below)) + " and " + std::to_string(triangle_number(below + 1)),
                     "bodies"};
    }
    if (request.given.at("base")) {
        return Error{ErrorCode::InvalidArgument,
                     "a base of " + std::to_string(base) + " has " + std::to_string(triangle_number(base)) +
                         " boxes, not " + std::to_string(request.bodies),
                     "bodies"};
    }
    return below;
}

Result<SceneRun> build_pyramid(const Request& request) {
    const Result<int> base = pyramid_base(request);
    if (!base) return base.error();
    SceneRun run = run_on_ground(request, "pyramid", 300, *base, std::max(kGround, 0.5 * kPyramidSpacing * *base + 5.0));
    for (int row = 0; row < *base; ++row) {
        const int count = *base - row;
        for (int i = 0; i < count; ++i) add_unit_box(run.world, {(i - (count - 1) / 2.0) * kPyramidSpacing, 0.5 + row, 0.0});
    }
    return run;
}

Result<SceneRun> build_tall_stack(const Request& request) {
    SceneRun run = run_on_ground(request, "tall_stack", 1800, request.bodies);
    for (int i = 0; i < request.bodies; ++i) add_unit_box(run.world, {0.0, 0.5 + i, 0.0});
    return run;
}

Result<SceneRun> build_mass_ratio(const Request& request) {
    SceneRun run = run_on_ground(request, "mass_ratio", 600, 2.0);
    add_unit_box(run.world, {0.0, 0.5, 0.0}, 1.0);
    add_unit_box(run.world, {0.0, 1.5, 0.0}, request.value("ratio"));
    return run;
}

}  // namespace

std::vector<Recipe> stack_recipes() {
    return {
        {.info = {.name = "pyramid",
                  .summary = "unit boxes in a wall that narrows to one box; it stands still",
                  .bodies = triangle_number(40),
                  .steps = 300,
                  .parameters = {{"base", 40.0, 1.0, 1000.0, "boxes in the lowest row; bodies = base (base + 1) / 2"}}},
         .fewest_bodies = 1,
         .most_bodies = triangle_number(1000),
         .build = build_pyramid},
        {.info = {.name = "tall_stack",
                  .summary = "a column of unit boxes; it stands",
                  .bodies = 30,
                  .steps = 1800,
                  .parameters = {}},
         .most_bodies = 10'000,
         .build = build_tall_stack},
        {.info = {.name = "mass_ratio",
                  .summary = "a heavy unit box on one of 1 kg",
                  .bodies = 2,
                  .steps = 600,
                  .parameters = {{"ratio", 1000.0, 1e-6, 1e9, "mass of the upper box [kg]"}}},
         .fewest_bodies = 2,
         .most_bodies = 2,
         .build = build_mass_ratio},
    };
}

}  // namespace carom::scenes::detail
