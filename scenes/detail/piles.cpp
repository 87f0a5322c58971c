// A room full of bodies that fall and settle: boxes only, or spheres, boxes, capsules and hulls in turn, or every convex shape and a
// compound.
#include <carom/collision/compound.hpp>
#include <carom/core/math.hpp>
#include <carom/scenes/detail/recipe.hpp>

#include <cmath>
#include <utility>

namespace carom::scenes::detail {
namespace {

constexpr double kCell = 1.45;   // between neighbours of a layer [m]
constexpr double kLayer = 1.05;  // between layers [m]

/// @return the shape of body `i` of the mixed pile, drawing what it needs.
Shape draw_mixed(Random& random, int i, const dvec3& half) {
    switch (i % 4) {
        case 0:
            return Sphere{static_cast<float>(half.x)};
        case 1:
            return Box{vec3(half)};
        case 2: {
            const double radius = random.range(0.2, 0.3);
            const double half_segment = random.range(0.1, 0.2);
            return Capsule{static_cast<float>(radius), static_cast<float>(half_segment)};
        }
        default:
            return draw_hull(random, 0.35, 0.5);
    }
}

/// Two heavy balls on a bar along x, in a box of the given half extents.
Shape dumbbell(const dvec3& half) {
    const auto ball = static_cast<float>(0.6 * half.y);
    const double arm = half.x - 0.6 * half.y;
    const SinCos eighth = sin_cos(0.25 * kPi);
    const Pose bar{dvec3{0.0}, {eighth.cos, 0.0, 0.0, eighth.sin}};
    std::vector<CompoundPart> parts{{Sphere{ball}, {{-arm, 0.0, 0.0}}, {.density = 2000.0}},
                                    {Sphere{ball}, {{arm, 0.0, 0.0}}, {.density = 2000.0}},
                                    {Cylinder{static_cast<float>(0.2 * half.y), static_cast<float>(arm)}, bar}};
    return Compound::build(std::move(parts)).value();
}

/// @return the shape of body `i` of the pile of all shapes, drawing what it needs.
Shape draw_any(Random& random, int i, const dvec3& half) {
    switch (i % 7) {
        case 4:
            return Cylinder{static_cast<float>(half.x), static_cast<float>(half.y)};
        case 5:
            return Cone{static_cast<float>(half.x), static_cast<float>(half.y)};
        case 6:
            return dumbbell({half.x + 0.25, half.y, half.z});
        default:
            return draw_mixed(random, i % 7, half);
    }
}

enum class PileOf { Boxes, Mixed, Shapes };

Shape draw_shape(PileOf kind, Random& random, int i, const dvec3& half) {
    switch (kind) {
        case PileOf::Mixed: return draw_mixed(random, i, half);
        case PileOf::Shapes: return draw_any(random, i, half);
        case PileOf::Boxes: break;
    }
    return Box{vec3(half)};
}

Result<SceneRun> build_pile(const Request& request, const char* name, PileOf kind) {
    const int across = static_cast<int>(std::lround(0.8 * std::cbrt(request.bodies)));
    const int layers = request.bodies == 0 ? 0 : (request.bodies - 1) / (across * across) + 1;
    const double half_width = kCell * across / 2.0 + 0.25;
    const double height = 1.0 + kLayer * layers + 1.0;

    SceneRun run{.name = name, .seed = request.seed, .world = World(request.world_def())};
    run.steps = request.bodies > 4000 ? 200 : 600;
    run.domain = {{-half_width - 0.5, -0.5, -half_width - 0.5}, {half_width + 0.5, height + 10.0, half_width + 0.5}};
    add_room(run.world, half_width, height);

    Random random(request.seed);
    for (int i = 0; i < request.bodies; ++i) {
        const int cell = i % (across * across);
        const int layer = i / (across * across);
        BodyDef body;
        body.position = {(cell % across - (across - 1) / 2.0) * kCell, 1.0 + kLayer * layer,
                         (cell / across - (across - 1) / 2.0) * kCell};
        const dvec3 half = draw_half_extents(random);
        Shape shape = draw_shape(kind, random, i, half);
        draw_yaw_and_spin(random, body);
        add_body(run.world, body, std::move(shape));
    }
    return run;
}

}  // namespace

std::vector<Recipe> pile_recipes() {
    return {
        {.info = {.name = "pile_boxes",
                  .summary = "boxes of random sizes fall into a walled room and settle",
                  .bodies = 1000,
                  .steps = 600,
                  .parameters = {}},
         .seed = 12345,
         .build = [](const Request& request) { return build_pile(request, "pile_boxes", PileOf::Boxes); }},
        {.info = {.name = "pile_mixed",
                  .summary = "spheres, boxes, capsules and hulls fall into a walled room and settle",
                  .bodies = 1000,
                  .steps = 600,
                  .parameters = {}},
         .seed = 12345,
         .build = [](const Request& request) { return build_pile(request, "pile_mixed", PileOf::Mixed); }},
        {.info = {.name = "pile_shapes",
                  .summary = "spheres, boxes, capsules, hulls, cylinders, cones and dumbbells fall into a walled room and settle",
                  .bodies = 700,
                  .steps = 600,
                  .parameters = {}},
         .seed = 12345,
         .build = [](const Request& request) { return build_pile(request, "pile_shapes", PileOf::Shapes); }},
    };
}

}  // namespace carom::scenes::detail
