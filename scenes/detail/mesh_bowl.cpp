// Boxes and hulls fall into a hilly bowl made of one big triangle mesh.
#include <carom/scenes/detail/recipe.hpp>

#include <carom/collision/terrain.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>

#include <utility>

namespace carom::scenes::detail {
namespace {

constexpr int kQuads = 128;                     // along each side
constexpr double kQuad = 0.5;                   // edge of a quad [m]
constexpr double kHalf = kQuads * kQuad / 2.0;  // the mesh covers |x|, |z| <= kHalf [m]
constexpr int kAcross = 20;                     // bodies along each side of a layer
constexpr double kPitch = 1.6;                  // between neighbours and between layers [m]

double height(double x, double z) {
    return 2.0 * sin_cos(0.3 * x).sin + 1.5 * sin_cos(0.37 * z + 1.0).sin + 0.5 * sin_cos(0.9 * x + 0.7 * z).sin +
           0.01 * (x * x + z * z);
}

Result<TriangleMeshPtr> bowl() {
    const MeshData grid = height_grid(kQuads, kQuads, kQuad, [](double x, double z) { return height(x, z); });
    return TriangleMesh::build(grid.vertices, grid.triangles);
}

Result<SceneRun> build_mesh_bowl(const Request& request) {
    Result<TriangleMeshPtr> mesh = bowl();
    if (!mesh) return mesh.error();
    SceneRun run{.name = "mesh_bowl", .seed = request.seed, .world = World(request.world_def())};
    run.steps = 600;
    const int layers = request.bodies / (kAcross * kAcross) + 1;
    // The lowest point of the mesh is above -4 m.
    run.domain = {{-kHalf, -5.0, -kHalf}, {kHalf, 10.0 + kPitch * layers + 20.0, kHalf}};
    add_body(run.world, {.type = BodyType::Static, .name = "bowl"}, std::move(mesh).value());

    Random random(request.seed);
    for (int i = 0; i < request.bodies; ++i) {
        const int cell = i % (kAcross * kAcross);
        BodyDef body;
        body.position = {(cell % kAcross - (kAcross - 1) / 2.0) * kPitch, 10.0 + kPitch * (i / (kAcross * kAcross)),
                         (cell / kAcross - (kAcross - 1) / 2.0) * kPitch};
        const dvec3 half = draw_half_extents(random);
        Shape shape = i % 2 == 1 ? Shape{Box{vec3(half)}} : draw_hull(random, 0.35, 0.6);
        draw_yaw_and_spin(random, body);
        add_body(run.world, body, std::move(shape));
    }
    return run;
}

}  // namespace

Recipe mesh_bowl_recipe() {
    return {.info = {.name = "mesh_bowl",
                     .summary = "boxes and hulls fall into a hilly bowl of 32,768 triangles",
                     .bodies = 2000,
                     .steps = 600,
                     .parameters = {}},
            .seed = 777,
            .most_bodies = 40'000,
            .build = build_mesh_bowl};
}

}  // namespace carom::scenes::detail
