// Teapots that collide as meshes: they come to rest on each other, and lie hardly in each other, as points and triangles alone tell.
#include "support.hpp"

#include <carom/collision/bvh_queries.hpp>
#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/studies/oracle/ledger.hpp>

namespace carom::test {
namespace {

using scenes::SceneRun;

struct Placed {
    const TriangleMesh* mesh = nullptr;
    Pose pose;
    bool moves = false;
};

/// How far the deepest corner of one lies straight behind a triangle of the other, of those at most `reach` behind.
double depth_behind(const Placed& corners, const Placed& surface, double reach) {
    double deepest = 0.0;
    const Pose to_surface = inverse(surface.pose) * corners.pose;
    const Aabb box = inflate(surface.mesh->local_bounds(), reach);
    for (const vec3& v : corners.mesh->vertices()) {
        const dvec3 p = transform_point(to_surface, dvec3(v));
        if (!overlaps(box, Aabb{p, p})) continue;
        const std::optional<ClosestOnMesh> nearest = closest_point(surface.mesh->bvh(), p, reach);
        if (!nearest) continue;
        const auto c = surface.mesh->corners(nearest->triangle);
        const dvec3 n = glm::normalize(glm::cross(dvec3(c[1]) - dvec3(c[0]), dvec3(c[2]) - dvec3(c[0])));
        const double height = glm::dot(n, p - nearest->point);
        if (height < -0.99 * nearest->distance) deepest = std::max(deepest, nearest->distance);
    }
    return deepest;
}

TEST(TeapotMeshes, FallAndRestOnEachOther) {
    SceneRun run = scene("teapot_meshes", {.bodies = 24});
    oracle::EnergyLedger ledger(run.world);
    for (int i = 0; i < 300; ++i) {
        const StepReport report = run.world.step(run.dt);
        ASSERT_TRUE(report.quarantined.empty());
        ledger.stepped(run.world);
    }
    EXPECT_LE(ledger.drift(), 1e-3) << "nothing gains energy";
    EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 0);
    std::vector<Placed> pots;
    for (const BodyId body : run.world.bodies()) {
        const ShapeId shape = run.world.shapes(body)[0];
        pots.push_back({std::get<TriangleMeshPtr>(run.world.shape(shape)).get(), run.world.pose(body),
                        run.world.type(body) == BodyType::Dynamic});
    }
    double deepest = 0.0;
    int touching = 0;
    for (std::size_t i = 0; i < pots.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (!pots[i].moves && !pots[k].moves) continue;
            touching += meshes_overlap(pots[i].mesh->bvh(), pots[k].mesh->bvh(), inverse(pots[i].pose) * pots[k].pose);
            deepest = std::max({deepest, depth_behind(pots[i], pots[k], 0.05), depth_behind(pots[k], pots[i], 0.05)});
        }
    }
    EXPECT_GE(touching, 12);
    EXPECT_LT(deepest, 0.01);
    double speed = 0.0;
    for (const BodyId body : dynamic_bodies(run.world)) speed += glm::length(run.world.linear_velocity(body)) / 24.0;
    EXPECT_LT(speed, 0.5) << "a few still roll";
    // After fifteen seconds they rest: 0.002 m/s; 0.1 m/s for good where the corners of a patch were chosen whatever their height.
    for (int i = 300; i < 900; ++i) run.world.step(run.dt);
    speed = 0.0;
    for (int i = 0; i < 60; ++i) {
        run.world.step(run.dt);
        for (const BodyId body : dynamic_bodies(run.world)) speed += glm::length(run.world.linear_velocity(body)) / (24.0 * 60.0);
    }
    EXPECT_LT(speed, 0.02);
}

}  // namespace
}  // namespace carom::test
