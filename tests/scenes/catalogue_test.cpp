// The pinned definitions, by numbers that were computed apart from this code, and what make_scene refuses.
#include "support.hpp"

#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace carom::test {
namespace {

using scenes::catalogue;
using scenes::make_scene;
using scenes::SceneInfo;
using scenes::SceneOptions;
using scenes::SceneRun;

// Positions come from a handful of sums and products, and orientations from one sine.
constexpr double kRounding = 1e-12;
// Sizes are rounded to float.
constexpr double kFloat = 1e-7;

void expect_error(const Result<SceneRun>& result, ErrorCode code, const std::string& where) {
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().code, code) << result.error().message;
    EXPECT_EQ(result.error().where, where);
    EXPECT_FALSE(result.error().message.empty());
}

TEST(Catalogue, HasEverySceneOnceAndBuildsItAsItSays) {
    std::set<std::string> names;
    for (const SceneInfo& info : catalogue()) {
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_FALSE(info.summary.empty());
        const SceneRun run = scene(info.name);
        EXPECT_EQ(run.name, info.name);
        EXPECT_EQ(run.steps, info.steps) << info.name;
        EXPECT_EQ(run.dt, 1.0 / 60.0);
        const int at_start = info.name == "fountain" ? 0 : info.bodies;
        EXPECT_EQ(static_cast<int>(dynamic_bodies(run.world).size()), at_start) << info.name;
        EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 0) << info.name;
    }
    for (const char* name : {"pyramid", "pile_boxes", "pile_mixed", "pile_shapes", "mesh_bowl", "tall_stack", "mass_ratio",
                             "wall_fast", "single_body_spin", "teapots", "teapot_meshes", "fountain", "dominoes"}) {
        EXPECT_TRUE(names.contains(name)) << name;
    }
}

TEST(Catalogue, EveryShapeIsOfThePinnedMatter) {
    for (const SceneInfo& info : catalogue()) {
        const SceneRun run = scene(info.name);
        for (const BodyId body : run.world.bodies()) {
            for (const ShapeId shape : run.world.shapes(body)) {
                const ShapeDef& def = run.world.shape_def(shape);
                EXPECT_EQ(def.friction, 0.6f);
                EXPECT_EQ(def.restitution, 0.0f);
                EXPECT_TRUE(def.density == 1000.0 || info.name == "mass_ratio") << info.name;
            }
        }
    }
}

TEST(Catalogue, TheSameOptionsGiveTheSameBitsAndAnotherSeedOthers) {
    for (const SceneInfo& info : catalogue()) {
        EXPECT_EQ(scene(info.name).world.state_hash(), scene(info.name).world.state_hash()) << info.name;
    }
    EXPECT_NE(scene("pile_boxes").world.state_hash(), scene("pile_boxes", {.seed = 12346}).world.state_hash());
    EXPECT_EQ(scene("pile_boxes", {.seed = 7}).seed, 7u);
}

TEST(Pyramid, IsBuiltRowByRow) {
    const SceneRun run = scene("pyramid");
    const World& world = run.world;
    const BodyId ground = world.bodies()[0];
    EXPECT_EQ(std::get<Box>(first_shape(world, ground)).half_extents, vec3(50.0f, 0.5f, 50.0f));
    EXPECT_EQ(world.pose(ground).position, dvec3(0.0, -0.5, 0.0));
    const std::vector<BodyId> boxes = dynamic_bodies(world);
    ASSERT_EQ(boxes.size(), 820u);
    expect_near(world.pose(boxes[0]).position, {-19.89, 0.5, 0.0}, kRounding);  // row 0, i = 0: -(39/2) 1.02
    expect_near(world.pose(boxes[39]).position, {19.89, 0.5, 0.0}, kRounding);
    expect_near(world.pose(boxes[40]).position, {-19.38, 1.5, 0.0}, kRounding);  // row 1, i = 0: -(38/2) 1.02
    expect_near(world.pose(boxes[819]).position, {0.0, 39.5, 0.0}, kRounding);
    EXPECT_EQ(std::get<Box>(first_shape(world, boxes[0])).half_extents, vec3(0.5f));
}

TEST(Pyramid, TakesItsSizeByBaseOrByBodiesAndRefusesWhatIsNoPyramid) {
    EXPECT_EQ(dynamic_bodies(scene("pyramid", {.set = {{"base", "10"}}}).world).size(), 55u);
    EXPECT_EQ(dynamic_bodies(scene("pyramid", {.bodies = 55}).world).size(), 55u);
    EXPECT_EQ(dynamic_bodies(scene("pyramid", {.bodies = 55, .set = {{"base", "10"}}}).world).size(), 55u);
    const Result<SceneRun> odd = make_scene("pyramid", {.bodies = 1000});
    expect_error(odd, ErrorCode::InvalidArgument, "bodies");
    EXPECT_NE(odd.error().message.find("990 and 1035"), std::string::npos) << odd.error().message;
    expect_error(make_scene("pyramid", {.bodies = 55, .set = {{"base", "11"}}}), ErrorCode::InvalidArgument, "bodies");
    expect_error(make_scene("pyramid", {.set = {{"base", "10.5"}}}), ErrorCode::InvalidArgument, "set base");
}

// The numbers below were drawn by a few lines of Python from s = s * 6364136223846793005 + 1442695040888963407 mod
// 2^64.
TEST(PileBoxes, DrawsTheFirstBodiesInThePinnedOrder) {
    const SceneRun run = scene("pile_boxes");
    const World& world = run.world;
    const std::vector<BodyId> boxes = dynamic_bodies(world);
    ASSERT_EQ(boxes.size(), 1000u);
    expect_near(dvec3(std::get<Box>(first_shape(world, boxes[0])).half_extents),
                {0.27739465149637366, 0.31634632397943446, 0.4714059981671199}, kFloat);
    expect_near(world.angular_velocity(boxes[0]), {-0.6974757531247584, 0.24188892225370617, 1.175473740646244},
                kRounding);
    const dquat yaw = world.pose(boxes[0]).orientation;  // of 5.251093013160321 rad
    EXPECT_NEAR(yaw.w, -0.8697769822982038, kRounding);
    EXPECT_NEAR(yaw.y, 0.4934450334781273, kRounding);
    EXPECT_NEAR(yaw.x, 0.0, kRounding);
    EXPECT_NEAR(yaw.z, 0.0, kRounding);
    expect_near(dvec3(std::get<Box>(first_shape(world, boxes[1])).half_extents),
                {0.34787346876658204, 0.45379483919676916, 0.297042133945562}, kFloat);
    expect_near(world.angular_velocity(boxes[1]), {1.9322284190498595, -1.3534286512367535, 1.304440529673251},
                kRounding);
    // n = round(.8 * 10) = 8: the first corner of the first layer, its second cell, and the first of the second layer.
    expect_near(world.pose(boxes[0]).position, {-5.075, 1.0, -5.075}, kRounding);
    expect_near(world.pose(boxes[1]).position, {-3.625, 1.0, -5.075}, kRounding);
    expect_near(world.pose(boxes[64]).position, {-5.075, 2.05, -5.075}, kRounding);
}

TEST(PileBoxes, StandsInARoomOfThePinnedWidth) {
    const SceneRun run = scene("pile_boxes");
    const World& world = run.world;
    const double half_width = 1.45 * 8 / 2 + 0.25;
    Aabb inside{dvec3{-1e9}, dvec3{1e9}};  // the free space between the faces that look at the middle
    int fixed = 0;
    for (const BodyId body : world.bodies()) {
        if (world.type(body) != BodyType::Static) continue;
        ++fixed;
        const dvec3 center = world.pose(body).position;
        const dvec3 half(std::get<Box>(first_shape(world, body)).half_extents);
        const int thin = half.x == 0.5 ? 0 : (half.y == 0.5 ? 1 : 2);
        EXPECT_EQ(half[thin], 0.5);  // 1 m thick
        if (center[thin] < 0.0) inside.lower[thin] = center[thin] + half[thin];
        if (center[thin] > 0.0) inside.upper[thin] = center[thin] - half[thin];
    }
    EXPECT_EQ(fixed, 5);
    expect_near(inside.lower, {-half_width, 0.0, -half_width}, kRounding);
    EXPECT_NEAR(inside.upper.x, half_width, kRounding);
    EXPECT_NEAR(inside.upper.z, half_width, kRounding);
}

TEST(PileBoxes, HasAsManyBodiesAsAskedFor) {
    for (const int count : {0, 1, 2, 17, 4000}) {
        EXPECT_EQ(static_cast<int>(dynamic_bodies(scene("pile_boxes", {.bodies = count}).world).size()), count);
    }
    EXPECT_EQ(scene("pile_boxes", {.bodies = 4000}).steps, 600);
    EXPECT_EQ(scene("pile_boxes", {.bodies = 16000}).steps, 200);
}

TEST(PileMixed, DrawsTheFirstBodiesInThePinnedOrder) {
    const SceneRun run = scene("pile_mixed");
    const World& world = run.world;
    const std::vector<BodyId> bodies = dynamic_bodies(world);
    EXPECT_NEAR(static_cast<double>(std::get<Sphere>(first_shape(world, bodies[0])).radius), 0.27739465149637366,
                kFloat);
    EXPECT_NEAR(static_cast<double>(std::get<Box>(first_shape(world, bodies[1])).half_extents.y), 0.45379483919676916,
                kFloat);
    const Capsule capsule = std::get<Capsule>(first_shape(world, bodies[2]));
    EXPECT_NEAR(static_cast<double>(capsule.radius), 0.23745810908538412, kFloat);
    EXPECT_NEAR(static_cast<double>(capsule.half_segment), 0.13810614516259936, kFloat);
    expect_near(world.angular_velocity(bodies[2]), {-1.8836369624641272, -1.6421990607642893, -1.1129960652605324},
                kRounding);
    const ConvexHull& hull = *std::get<ConvexHullPtr>(first_shape(world, bodies[3]));
    EXPECT_EQ(hull.vertices().size(), 12u);  // points of a sphere are all corners
    for (const dvec3& point : {dvec3{-0.36043044537008956, -0.3064274245754756, -0.06938511425382304},
                               dvec3{0.1919549615273877, -0.33111016158796064, 0.2866034197281493}}) {
        EXPECT_TRUE(std::ranges::any_of(hull.vertices(),
                                        [&](const vec3& v) { return glm::distance(dvec3(v), point) < kFloat; }));
    }
    expect_near(world.angular_velocity(bodies[3]), {0.4806376066502147, 0.9956670088573123, 0.8233378240463036},
                kRounding);
    // The last body's spin tells that nothing more or less was drawn for the 999 before it.
    expect_near(world.angular_velocity(bodies[999]), {-1.279997046126244, -0.4320210069764019, 0.5492797520738275},
                kRounding);
    EXPECT_EQ(world.linear_velocity(bodies[3]), dvec3(0.0));
    EXPECT_NEAR(static_cast<double>(std::get<Sphere>(first_shape(world, bodies[4])).radius), 0.2866589357936048,
                kFloat);
}

TEST(MeshBowl, HasThePinnedMeshAndBodies) {
    const SceneRun run = scene("mesh_bowl");
    const World& world = run.world;
    const TriangleMesh& mesh = *std::get<TriangleMeshPtr>(first_shape(world, world.bodies()[0]));
    EXPECT_EQ(mesh.triangles().size(), 2u * 128u * 128u);
    EXPECT_EQ(mesh.vertices().size(), 129u * 129u);
    // Heights by Python's math.sin; coordinates of 30 m in float are good to 2e-6.
    for (const dvec3& point :
         {dvec3{-32, 21.908381380185634, -32}, dvec3{0, 1.2622064772118446, 0}, dvec3{3.5, 0.3556300550496293, -7}}) {
        EXPECT_TRUE(
            std::ranges::any_of(mesh.vertices(), [&](const vec3& v) { return glm::distance(dvec3(v), point) < 4e-6; }))
            << point.x << ", " << point.z;
    }
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
        const std::array<vec3, 3> c = mesh.corners(t);
        ASSERT_GT(glm::cross(c[1] - c[0], c[2] - c[0]).y, 0.0f) << t;  // seen from above
        // Each quad is cut from its lowest corner to its highest (in x and z).
        const float run_x = std::max({c[0].x, c[1].x, c[2].x}) - std::min({c[0].x, c[1].x, c[2].x});
        ASSERT_EQ(run_x, 0.5f);
        ASSERT_EQ(c[1].x + c[1].z > c[0].x + c[0].z, true);
    }
    const std::vector<BodyId> bodies = dynamic_bodies(world);
    ASSERT_EQ(bodies.size(), 2000u);
    expect_near(world.pose(bodies[0]).position, {-15.2, 10.0, -15.2}, kRounding);
    expect_near(world.pose(bodies[400]).position, {-15.2, 11.6, -15.2}, kRounding);
    const ConvexHull& hull = *std::get<ConvexHullPtr>(first_shape(world, bodies[0]));
    const dvec3 point{0.09666950943100285, 0.34011491627482393, 0.15300291309224984};
    EXPECT_TRUE(
        std::ranges::any_of(hull.vertices(), [&](const vec3& v) { return glm::distance(dvec3(v), point) < kFloat; }));
    expect_near(dvec3(std::get<Box>(first_shape(world, bodies[1])).half_extents),
                {0.40333055970923803, 0.2916661837651702, 0.4885798095510314}, kFloat);
    expect_near(world.angular_velocity(bodies[1]), {-0.2314799444726141, 1.9145039112280426, 1.4014671525294817},
                kRounding);
}

TEST(TallStack, HasAsManyBoxesAsAskedFor) {
    const SceneRun run = scene("tall_stack", {.bodies = 5});
    const std::vector<BodyId> boxes = dynamic_bodies(run.world);
    ASSERT_EQ(boxes.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(run.world.pose(boxes[i]).position, dvec3(0.0, 0.5 + static_cast<double>(i), 0.0));
    }
    EXPECT_EQ(run.steps, 1800);
}

TEST(MassRatio, IsSetByItsParameter) {
    const SceneRun run = scene("mass_ratio", {.set = {{"ratio", "1e4"}}});
    const std::vector<BodyId> boxes = dynamic_bodies(run.world);
    ASSERT_EQ(boxes.size(), 2u);
    EXPECT_NEAR(run.world.mass_properties(boxes[0]).mass, 1.0, 1e-12);
    EXPECT_NEAR(run.world.mass_properties(boxes[1]).mass, 1e4, 1e-8);
    EXPECT_EQ(run.world.pose(boxes[1]).position, dvec3(0.0, 1.5, 0.0));
    expect_error(make_scene("mass_ratio", {.bodies = 3}), ErrorCode::InvalidArgument, "bodies");
}

TEST(WallFast, HasThePinnedSpheresAndCountsThoseBeyondTheWall) {
    SceneRun run = scene("wall_fast");
    const std::vector<BodyId> spheres = dynamic_bodies(run.world);
    ASSERT_EQ(spheres.size(), 200u);
    EXPECT_EQ(run.world.settings().gravity, dvec3(0.0));
    expect_near(run.world.pose(spheres[0]).position, {-4.0, -4.0, -16.997792149774362}, kRounding);
    expect_near(run.world.pose(spheres[1]).position, {-4.0 + 8.0 / 19.0, -4.0, -23.945750092078697}, kRounding);
    expect_near(run.world.pose(spheres[199]).position, {4.0, 4.0, -23.760675386715224}, kRounding);
    EXPECT_NEAR(run.world.linear_velocity(spheres[0]).z, 50.0, kRounding);
    EXPECT_NEAR(run.world.linear_velocity(spheres[57]).z, 143.83067194652867, 1e-10);
    EXPECT_NEAR(run.world.linear_velocity(spheres[199]).z, 2000.0, 1e-9);
    ASSERT_TRUE(run.tunnelled);
    EXPECT_EQ(run.tunnelled(run.world), 0);
    run.world.set_pose(spheres[3], {dvec3{0.0, 0.0, 1.0}, kIdentityRotation});
    EXPECT_EQ(run.tunnelled(run.world), 1);
}

TEST(SingleBodySpin, HasInertiaTwoThreeFour) {
    const SceneRun run = scene("single_body_spin");
    const BodyId body = dynamic_bodies(run.world).at(0);
    const dmat3 inertia = run.world.mass_properties(body).inertia;
    EXPECT_NEAR(inertia[1][1] / inertia[0][0], 1.5, 1e-6);  // half extents are rounded to float
    EXPECT_NEAR(inertia[2][2] / inertia[0][0], 2.0, 1e-6);
    EXPECT_EQ(run.world.angular_velocity(body), dvec3(0.01, 5.0, 0.01));
}

TEST(Fountain, KeepsAsManyBodiesAsAskedFor) {
    SceneRun run = scene("fountain", {.bodies = 5});
    std::vector<BodyId> before;
    for (int i = 0; i < 60; ++i) {
        run.before_step(i);
        EXPECT_EQ(static_cast<int>(dynamic_bodies(run.world).size()), std::min(5, i / 4 + 1)) << i;
        if (i == 16) before = dynamic_bodies(run.world);
    }
    for (const BodyId body : before) EXPECT_FALSE(run.world.is_alive(body));  // the oldest go first
}

TEST(Escaped, CountsCentresOutsideTheDomain) {
    SceneRun run = scene("tall_stack", {.bodies = 3});
    const std::vector<BodyId> boxes = dynamic_bodies(run.world);
    run.world.set_pose(boxes[1], {dvec3{0.0, -20.0, 0.0}, kIdentityRotation});
    EXPECT_EQ(scenes::count_escaped(run.world, run.domain), 1);
    EXPECT_EQ(scenes::count_escaped(run.world, Aabb{}), 0);
}

TEST(MakeScene, RefusesWhatIsOutOfRange) {
    expect_error(make_scene("no_such_scene"), ErrorCode::UnknownName, "scene");
    expect_error(make_scene(""), ErrorCode::UnknownName, "scene");
    expect_error(make_scene("pile_boxes", {.bodies = -1}), ErrorCode::InvalidArgument, "bodies");
    expect_error(make_scene("pile_boxes", {.bodies = std::numeric_limits<int>::max()}), ErrorCode::InvalidArgument,
                 "bodies");
    expect_error(make_scene("pile_boxes", {.set = {{"ratio", "1"}}}), ErrorCode::UnknownName, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", ""}}}), ErrorCode::WrongType, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "heavy"}}}), ErrorCode::WrongType, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "10kg"}}}), ErrorCode::WrongType, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "nan"}}}), ErrorCode::NotFinite, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "inf"}}}), ErrorCode::NotFinite, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "1e999"}}}), ErrorCode::NotFinite, "set ratio");
    expect_error(make_scene("mass_ratio", {.set = {{"ratio", "-1"}}}), ErrorCode::InvalidArgument, "set ratio");
    expect_error(make_scene("pyramid", {.substeps = 0}), ErrorCode::InvalidArgument, "substeps");
    expect_error(make_scene("pyramid", {.world = {.substeps = 2000}}), ErrorCode::InvalidArgument, "substeps");
    expect_error(make_scene("pyramid", {.world = {.contact_rate = 2.0}}), ErrorCode::InvalidArgument, "WorldDef");
}

TEST(MakeScene, TakesTheWorldsSettings) {
    const SceneRun run = scene("mass_ratio", {.substeps = 7, .world = {.broadphase = BroadphaseMethod::BruteForce}});
    EXPECT_EQ(run.world.settings().substeps, 7);
    EXPECT_EQ(run.world.settings().broadphase, BroadphaseMethod::BruteForce);
    EXPECT_EQ(run.world.settings().gravity, dvec3(0.0, -9.81, 0.0));
}

}  // namespace
}  // namespace carom::test
