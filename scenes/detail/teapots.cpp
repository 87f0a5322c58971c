// The demo: teapots, boxes, spheres and capsules fall round a big teapot on hilly ground with a rim; teapots as hulls, or as the meshes they
// are.
#include <carom/scenes/detail/recipe.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/teapot.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace carom::scenes::detail {
namespace {

constexpr double kBigTeapot = 6.0;  // from handle to spout [m]
constexpr double kSmallTeapot = 0.9;
constexpr double kSmallChord = 0.02 * kSmallTeapot;  // of its mesh
constexpr double kPitch = 1.3;       // between neighbours and between layers [m]
constexpr int kAcross = 12;          // bodies along each side of a layer
constexpr double kFirstLayer = 6.0;  // [m]; the teapot's lid is below 5 m

TerrainSettings hills(std::uint64_t seed) {
    return {.level = 6, .spacing = 0.5, .roughness = 0.5, .height = 0.8, .seed = seed, .rim = true};
}

/// @return the lowest point of the ground under the teapot's base, so that no gap is seen.
double seat_height(const MeshData& ground) {
    double lowest = 1e9;
    for (const vec3& v : ground.vertices) {
        if (v.x * v.x + v.z * v.z < 2.25f) lowest = std::min(lowest, static_cast<double>(v.y));
    }
    return lowest;
}

/// A small teapot as it is: open at its seams, so that its mass is that of its hull.
Result<Shape> small_teapot_mesh() {
    Result<MeshData> pot = teapot(kSmallTeapot, kSmallChord);
    if (!pot) return pot.error();
    for (vec3& v : pot->vertices) v.y -= 0.25f * static_cast<float>(kSmallTeapot);  // about its middle
    Result<TriangleMeshPtr> mesh = TriangleMesh::build(pot->vertices, pot->triangles);
    if (!mesh) return mesh.error();
    return Shape{std::move(mesh).value()};
}

/// The hull of those points of a small teapot that are farthest in each of 48 directions (a Fibonacci lattice on the
/// sphere): the hull of all of them has four times as many corners, which nobody sees.
Result<Shape> small_teapot_hull() {
    const Result<MeshData> pot = teapot(kSmallTeapot, 0.04 * kSmallTeapot);
    if (!pot) return pot.error();
    constexpr int kDirections = 48;
    constexpr double kGoldenAngle = 2.399963229728653;
    std::vector<vec3> points;
    for (int i = 0; i < kDirections; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / kDirections;
        const double r = std::sqrt(1.0 - y * y);
        const SinCos turn = sin_cos(i * kGoldenAngle);
        const vec3 direction(dvec3{r * turn.cos, y, r * turn.sin});
        vec3 farthest =
            *std::ranges::max_element(pot->vertices, {}, [&](const vec3& v) { return glm::dot(direction, v); });
        farthest.y -= 0.25f * static_cast<float>(kSmallTeapot);  // about its middle
        points.push_back(farthest);
    }
    Result<ConvexHullPtr> hull = ConvexHull::build(points);
    if (!hull) return hull.error();
    return Shape{std::move(hull).value()};
}

/// Adds ground and teapot. @return the box of the ground.
Result<Aabb> add_landscape(World& world, std::uint64_t seed) {
    const MeshData ground = diamond_square(hills(seed));
    Result<TriangleMeshPtr> ground_mesh = TriangleMesh::build(ground.vertices, ground.triangles);
    if (!ground_mesh) return ground_mesh.error();
    const Result<MeshData> pot = teapot(kBigTeapot, 0.002 * kBigTeapot);
    if (!pot) return pot.error();
    Result<TriangleMeshPtr> pot_mesh = TriangleMesh::build(pot->vertices, pot->triangles);
    if (!pot_mesh) return pot_mesh.error();
    const Aabb box = (*ground_mesh)->local_bounds();
    add_body(world, {.type = BodyType::Static, .name = "ground"}, std::move(ground_mesh).value());
    add_body(world, {.type = BodyType::Static, .position = {0.0, seat_height(ground), 0.0}, .name = "teapot"},
             std::move(pot_mesh).value());
    return box;
}

Shape draw_shape(Random& random, int i, const Shape& pot) {
    switch (i % 4) {
        case 0:
            return pot;
        case 1: {
            dvec3 half{0.0};
            for (int axis = 0; axis < 3; ++axis) half[axis] = random.range(0.2, 0.4);
            return Box{vec3(half)};
        }
        case 2:
            return Sphere{static_cast<float>(random.range(0.2, 0.4))};
        default: {
            const double radius = random.range(0.15, 0.25);
            return Capsule{static_cast<float>(radius), static_cast<float>(random.range(0.15, 0.3))};
        }
    }
}

/// What falls: teapots alone, or teapots in turn with others.
enum class Falling { Mixed, Teapots };

Result<SceneRun> build_scene(const Request& request, const char* name, const Result<Shape>& pot, Falling falling) {
    if (!pot) return pot.error();
    SceneRun run{.name = name, .seed = request.seed, .world = World(request.world_def())};
    run.steps = 600;
    const Result<Aabb> ground = add_landscape(run.world, request.seed);
    if (!ground) return ground.error();
    const int per_layer = kAcross * kAcross;
    run.domain = *ground;
    run.domain.lower.y -= 0.5;
    run.domain.upper.y = kFirstLayer + kPitch * (request.bodies / per_layer + 1) + 10.0;

    Random random(request.seed);
    for (int i = 0; i < request.bodies; ++i) {
        const int cell = i % per_layer;
        BodyDef body;
        body.position = {(cell % kAcross - (kAcross - 1) / 2.0) * kPitch, kFirstLayer + kPitch * (i / per_layer),
                         (cell / kAcross - (kAcross - 1) / 2.0) * kPitch};
        Shape shape = falling == Falling::Teapots ? *pot : draw_shape(random, i, *pot);
        draw_yaw_and_spin(random, body);
        add_body(run.world, body, std::move(shape));
    }
    return run;
}

Result<SceneRun> build_teapots(const Request& request) { return build_scene(request, "teapots", small_teapot_hull(), Falling::Mixed); }
Result<SceneRun> build_meshes(const Request& request) {
    return build_scene(request, "teapot_meshes", small_teapot_mesh(), Falling::Teapots);
}

}  // namespace

std::vector<Recipe> teapots_recipes() {
    return {{.info = {.name = "teapots",
                      .summary = "teapots, boxes, spheres and capsules fall round a big teapot on hilly ground",
                      .bodies = 300,
                      .steps = 600,
                      .parameters = {}},
             .seed = 1975,
             .most_bodies = 20'000,
             .build = build_teapots},
            {.info = {.name = "teapot_meshes",
                      .summary = "teapots that collide as the meshes they are fall round and on a big one",
                      .bodies = 60,
                      .steps = 600,
                      .parameters = {}},
             .seed = 1975,
             .most_bodies = 20'000,
             .build = build_meshes}};
}

}  // namespace carom::scenes::detail
