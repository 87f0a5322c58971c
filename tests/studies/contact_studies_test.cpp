// The cases of the studies of manifolds and probes against their own words, and their measures on manifolds that are known to be wrong.
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/manifold_cases.hpp>
#include <carom/studies/accuracy/surface_cases.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/executor.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <set>
#include <string>

namespace carom::accuracy {
namespace {

std::vector<Manifold> collide_all(const ManifoldCases& cases) {
    SerialExecutor executor;
    CollideScratch scratch;
    std::vector<Manifold> manifolds;
    collide(cases.placed(), cases.pairs, executor, scratch, manifolds);
    return manifolds;
}

TEST(ManifoldCases, WhatCollideSaysIsTrueAndWhatIsSpoiledIsNot) {
    const ManifoldCasesPtr boxes = box_cases(100, Depth::Any, 5);
    std::vector<Manifold> manifolds = collide_all(*boxes);
    ASSERT_EQ(manifolds.size(), 100u) << "each overlaps";
    EXPECT_LT(depth_error(*boxes, manifolds), 2e-6);
    EXPECT_LT(normal_error(*boxes, manifolds), 2e-6);
    EXPECT_LT(depth_error(*as_hulls(*boxes), collide_all(*as_hulls(*boxes))), 2e-6);
    for (ContactPoint& p : manifolds[7].points) p.separation += 0.01f;
    EXPECT_NEAR(depth_error(*boxes, manifolds), 0.01 / boxes->size[7], 1e-5);
    manifolds[7].normal = -manifolds[7].normal;
    EXPECT_GT(normal_error(*boxes, manifolds), 0.1);
    manifolds.erase(manifolds.begin() + 3);
    EXPECT_EQ(depth_error(*boxes, manifolds), 1.0) << "a contact that is missing";
}

TEST(ManifoldCases, WedgedBoxesAreDeep) {
    const ManifoldCasesPtr boxes = box_cases(100, Depth::Wedged, 6);
    for (const double depth : boxes->depth) EXPECT_GT(depth, 0.1 * 0.4);
}

TEST(ManifoldCases, AreasAreThoseOfTheSharedFaces) {
    const ManifoldCasesPtr boxes = resting_cases(100, 7);
    const std::vector<Manifold> manifolds = collide_all(*boxes);
    EXPECT_LT(depth_error(*boxes, manifolds), 4e-6);
    const double three = area_error(*boxes, manifolds, 3), four = area_error(*boxes, manifolds, 4);
    EXPECT_EQ(area_error(*boxes, manifolds, 2), 1.0);
    EXPECT_LT(three, 1.0);
    EXPECT_GT(three, 0.2) << "a triangle spans half of a rectangle";
    EXPECT_LT(four, 0.1);
    EXPECT_GT(four, 0.0) << "some regions have more corners";
}

TEST(ManifoldCases, GroundsAreFlatWhateverTheyAreMadeOf) {
    const ManifoldCasesPtr plane = ground_cases(40, 0, false, 8), mesh = ground_cases(40, 128, false, 8);
    ASSERT_EQ(plane->depth, mesh->depth);
    EXPECT_LT(depth_error(*plane, collide_all(*plane)), 1e-6);
    EXPECT_LT(depth_error(*mesh, collide_all(*mesh)), 1e-6);
}

TEST(ManifoldCases, NamesLastOverSmallMotions) {
    const ManifoldCasesPtr boxes = resting_cases(200, 9);
    const std::vector<Manifold> before = collide_all(*boxes);
    EXPECT_EQ(new_names(before, before), 0.0);
    EXPECT_LT(new_names(before, collide_all(*moved(*boxes, 1e-6, 1))), 0.01);
    std::vector<Manifold> renamed = before;
    for (Manifold& m : renamed) m.points[0].feature += 12345;
    EXPECT_GT(new_names(before, renamed), 0.2);
}

TEST(SurfaceCases, AreTheSolidsAsClosedMeshes) {
    for (const Solids kind : {Solids::Boxes, Solids::Hulls}) {
        const ManifoldCasesPtr solids = solid_cases(kind, 60, {0.02, 0.1}, 11);
        ASSERT_EQ(solids->count(), 60u);
        EXPECT_LT(depth_error(*solids, collide_all(*solids)), 2e-6) << "the oracle and the kernels of solids agree";
        const ManifoldCasesPtr meshes = as_surfaces(*solids, {.quads = 3}), one = as_surfaces(*solids, {.first = false});
        EXPECT_EQ(meshes->depth, solids->depth);
        EXPECT_EQ(meshes->size, solids->size);
        for (std::size_t k = 0; k < 2 * solids->count(); ++k) {
            const double extent = std::min(smallest_extent(solids->shapes[k]), smallest_extent(solids->shapes[k ^ 1]));
            EXPECT_GT(solids->depth[k / 2], 0.02 * extent);
            EXPECT_LT(solids->depth[k / 2], 0.1 * extent + 1e-12);
            const TriangleMeshPtr surface = std::get<TriangleMeshPtr>(meshes->shapes[k]);
            EXPECT_TRUE(surface->is_closed());
            const Aabb box = bounds(meshes->shapes[k], {}), same = bounds(solids->shapes[k], {});
            EXPECT_LT(glm::length(box.lower - same.lower) + glm::length(box.upper - same.upper), 1e-12);
            EXPECT_TRUE(kind == Solids::Hulls || surface->triangles().size() == 6u * 9u * 2u);
            EXPECT_EQ(one->shapes[k].index() == solids->shapes[k].index(), k % 2 == 0);
        }
        std::vector<Manifold> manifolds = collide_all(*meshes);
        const double mean = mean_depth_error(*meshes, manifolds);
        EXPECT_LT(mean, 0.01);
        EXPECT_LE(mean, depth_error(*meshes, manifolds));
        EXPECT_EQ(mean_depth_error(*meshes, {}), 1.0) << "all are missing";
        for (Manifold& m : manifolds) {
            for (ContactPoint& p : m.points) p.separation -= 0.1f;
        }
        EXPECT_GT(mean_depth_error(*meshes, manifolds), mean + 0.02);
    }
}

TEST(ContactStudies, EachGroupsNamesAreUniqueAndProbesMissLessWithMoreRays) {
    const std::vector<Study> studies = probe_studies({.quick = true});
    std::set<std::string> names;
    for (const Study& study : studies) EXPECT_TRUE(names.insert(study.name).second) << study.name;
    ASSERT_EQ(studies[0].name, "probes");
    const auto error_of = [&](const std::string& settings) {
        for (const Candidate& c : studies[0].candidates) {
            if (to_string(c.settings) == settings) return c.run().error.value_or(-1.0);
        }
        return -1.0;
    };
    EXPECT_EQ(error_of("query=collide"), 0.0);
    const double few = error_of("rays=4 rows=3 feel=rim"), many = error_of("rays=32 rows=3 feel=rim");
    EXPECT_GT(few, many);
    EXPECT_GE(many, 0.0);
    EXPECT_GT(error_of("rays=32 rows=1 feel=rim"), many) << "one row misses what lies beside it";
}

}  // namespace
}  // namespace carom::accuracy
