// Shapes in scene files: all kinds and their keys.
#include "scene_file.hpp"

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>

namespace carom::test {
namespace {

const std::string kExamples = std::string(CAROM_TEST_DATA) + "/../scenes/examples/";

class ReadShapes : public ReadScene {};

TEST_F(ReadShapes, BuildsMeshesAndHullsFromPointsAndGenerators) {
    Result<SceneRun> run = read_scene(kExamples + "teapot_hill.json");
    ASSERT_TRUE(run.has_value()) << run.error().where << ": " << run.error().message;
    const World& world = run->world;
    const auto bodies = world.bodies();
    EXPECT_EQ(std::get<TriangleMeshPtr>(first_shape(world, bodies[0]))->triangles().size(), 2u * 32u * 32u);
    EXPECT_NEAR(std::get<TriangleMeshPtr>(first_shape(world, bodies[1]))->local_bounds().upper.y, 1.47, 0.05);
    EXPECT_GT(std::get<ConvexHullPtr>(first_shape(world, bodies[2]))->vertices().size(), 20u);
    EXPECT_EQ(std::get<ConvexHullPtr>(first_shape(world, bodies[3]))->faces().size(), 5u);
    step(*run, 120);
    EXPECT_EQ(scenes::count_escaped(run->world, run->domain), 0);
}

TEST_F(ReadShapes, TakesAMeshWrittenOut) {
    const Result<SceneRun> run =
        read_shape(R"("type": "triangle_mesh", "vertices": [[0,0,0],[0,0,1],[1,0,0]], "triangles": [[0,1,2]])", "static");
    ASSERT_TRUE(run.has_value()) << run.error().message;
    const World& world = run->world;
    EXPECT_EQ(std::get<TriangleMeshPtr>(first_shape(world, world.bodies()[0]))->triangles().size(), 1u);
    EXPECT_EQ(run->name, "scene");  // the file's own name, where it says none
    EXPECT_EQ(run->dt, 1.0 / 60.0);
}

TEST_F(ReadShapes, AMeshMayBeOneSided) {
    const std::string mesh =
        R"("type": "triangle_mesh", "vertices": [[0,0,0],[0,0,1],[1,0,0],[0,-1,0]], "triangles": [[0,1,2],[0,2,3]], "one_sided": )";
    for (const bool one_sided : {true, false}) {
        Result<SceneRun> run = read_shape(mesh + (one_sided ? "true" : "false"), "static");
        ASSERT_TRUE(run.has_value()) << run.error().message;
        EXPECT_EQ(std::get<TriangleMeshPtr>(first_shape(run->world, run->world.bodies()[0]))->is_one_sided(), one_sided);
    }
    EXPECT_TRUE(read_shape(mesh + "true", "kinematic").has_value());
    EXPECT_TRUE(read_shape(mesh + "false").has_value());
    expect_error(read_shape(mesh + "true"), ErrorCode::WrongType, ":3: bodies[0].shapes[0]");
    expect_error(read_shape(mesh + "1", "static"), ErrorCode::WrongType, ":3: bodies[0].shapes[0].one_sided");
    expect_error(read_shape(R"("type": "box", "half_extents": [1,1,1], "one_sided": true)"), ErrorCode::UnknownName,
                 ":3: bodies[0].shapes[0].one_sided");
}

TEST_F(ReadShapes, NamesKeysOfShapes) {
    const std::string at = ":3: bodies[0].shapes[0]";
    expect_error(read_shape(R"("type": "ball")"), ErrorCode::UnknownName, at + ".type");
    expect_error(read_shape(R"("type": "sphere")"), ErrorCode::Empty, at);
    expect_error(read_shape(R"("type": "sphere", "radius": 0)"), ErrorCode::InvalidArgument, at + ".radius");
    expect_error(read_shape(R"("type": "sphere", "radius": -1)"), ErrorCode::InvalidArgument, at + ".radius");
    expect_error(read_shape(R"("type": "sphere", "radius": 1e-300)"), ErrorCode::InvalidArgument, at + ".radius");
    expect_error(read_shape(R"("type": "sphere", "radius": 1e300)"), ErrorCode::InvalidArgument, at + ".radius");
    expect_error(read_shape(R"("type": "sphere", "radius": true)"), ErrorCode::WrongType, at + ".radius");
    expect_error(read_shape(R"("type": "sphere", "radius": 1, "half_segment": 1)"), ErrorCode::UnknownName, at + ".half_segment");
    expect_error(read_shape(R"("type": "box", "half_extents": [1,0,1])"), ErrorCode::InvalidArgument, at + ".half_extents[1]");
    expect_error(read_shape(R"("type": "box", "half_extents": [1,1,1,1])"), ErrorCode::WrongType, at + ".half_extents");
    expect_error(read_shape(R"("type": "capsule", "radius": 1, "half_segment": -1)"), ErrorCode::InvalidArgument, at + ".half_segment");
    expect_error(read_shape(R"("type": "plane", "normal": [0,0,0])", "static"), ErrorCode::InvalidArgument, at + ".normal");
    expect_error(read_shape(R"("type": "plane", "normal": [0,1,0])"), ErrorCode::WrongType, at);
    const std::string sphere = R"("type": "sphere", "radius": 1, )";
    expect_error(read_shape(sphere + R"("density": 0)"), ErrorCode::InvalidArgument, at + ".density");
    expect_error(read_shape(sphere + R"("friction": -0.1)"), ErrorCode::InvalidArgument, at + ".friction");
    expect_error(read_shape(sphere + R"("restitution": 1.1)"), ErrorCode::InvalidArgument, at + ".restitution");
    expect_error(read_shape(sphere + R"("density": 1e308)"), ErrorCode::NotFinite, at);
    expect_error(read_shape(sphere + R"("friction_rule": "sum")"), ErrorCode::UnknownName, at + ".friction_rule");
    expect_error(read_shape(sphere + R"("restitution_rule": 1)"), ErrorCode::WrongType, at + ".restitution_rule");
}

TEST_F(ReadShapes, NamesKeysOfHullsAndMeshes) {
    const std::string at = ":3: bodies[0].shapes[0]";
    expect_error(read_shape(R"("type": "convex_hull", "points": [])"), ErrorCode::Empty, at + ".points");
    expect_error(read_shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]])"), ErrorCode::Degenerate,
                 at + ".points");
    expect_error(read_shape(R"("type": "convex_hull", "points": [[0,0,0],[1,0]])"), ErrorCode::WrongType, at + ".points[1]");
    expect_error(read_shape(R"("type": "convex_hull", "generate": "bunny")"), ErrorCode::UnknownName, at + ".generate");
    const std::string mesh = R"("type": "triangle_mesh", )";
    EXPECT_TRUE(read_shape(mesh + R"("generate": "teapot", "size": 1)")) << "a body that is a mesh";
    expect_error(read_shape(mesh + R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]])"), ErrorCode::Degenerate, at);
    expect_error(read_shape(mesh + R"("generate": "bunny")", "static"), ErrorCode::UnknownName, at + ".generate");
    expect_error(read_shape(mesh + R"("generate": "teapot")", "static"), ErrorCode::Empty, at);
    expect_error(read_shape(mesh + R"("generate": "teapot", "size": 1, "chord_error": 1e-9)", "static"), ErrorCode::InvalidArgument,
                 at + ".chord_error");
    expect_error(read_shape(mesh + R"("generate": "terrain", "level": 40)", "static"), ErrorCode::InvalidArgument, at + ".level");
    expect_error(read_shape(mesh + R"("generate": "terrain", "roughness": 2)", "static"), ErrorCode::InvalidArgument, at + ".roughness");
    expect_error(read_shape(mesh + R"("generate": "terrain", "points": [])", "static"), ErrorCode::UnknownName, at + ".points");
    expect_error(read_shape(mesh + R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [])", "static"), ErrorCode::Empty, at);
    expect_error(read_shape(mesh + R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,3]])", "static"),
                 ErrorCode::InvalidArgument, at + ".triangles[0][2]");
    expect_error(read_shape(mesh + R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,0.5]])", "static"), ErrorCode::WrongType,
                 at + ".triangles[0][2]");
    expect_error(read_shape(mesh + R"("vertices": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1]])", "static"), ErrorCode::WrongType,
                 at + ".triangles[0]");
}

TEST_F(ReadShapes, CylindersConesAndCompounds) {
    const Result<SceneRun> round = read_body(
        "\"shapes\": [\n"
        "{\"type\": \"cylinder\", \"radius\": 0.5, \"half_height\": 1},\n"
        "{\"type\": \"cone\", \"radius\": 0.25, \"half_height\": 2, \"position\": [0, 3, 0]}]");
    ASSERT_TRUE(round.has_value()) << round.error().where << ": " << round.error().message;
    const World& world = round->world;
    const auto shapes = world.shapes(world.bodies()[0]);
    EXPECT_EQ(world.shape(shapes[0]), Shape(Cylinder{0.5f, 1.0f}));
    EXPECT_EQ(world.shape(shapes[1]), Shape(Cone{0.25f, 2.0f}));

    const Result<SceneRun> mixed = read_shape(
        "\"type\": \"compound\", \"density\": 500, \"friction\": 0.1, \"parts\": [\n"
        "{\"type\": \"sphere\", \"radius\": 1, \"position\": [2, 0, 0], \"density\": 3000, \"restitution\": 0.5},\n"
        "{\"type\": \"cylinder\", \"radius\": 1, \"half_height\": 2, \"friction\": 0.9,\n"
        " \"orientation\": {\"axis\": [0, 0, 1], \"angle\": 1}}]");
    ASSERT_TRUE(mixed.has_value()) << mixed.error().where << ": " << mixed.error().message;
    const CompoundPtr& compound = std::get<CompoundPtr>(mixed->world.shape(mixed->world.shapes(mixed->world.bodies()[0])[0]));
    ASSERT_EQ(compound->parts().size(), 2u);
    EXPECT_EQ(compound->parts()[0].pose.position, dvec3(2, 0, 0));
    EXPECT_EQ(compound->parts()[0].material.density, 3000.0);
    EXPECT_EQ(compound->parts()[0].material.restitution, 0.5f);
    EXPECT_FALSE(compound->parts()[0].material.friction.has_value());
    EXPECT_EQ(compound->parts()[1].material.friction, 0.9f);
    EXPECT_FALSE(compound->parts()[1].material.density.has_value());

    expect_error(read_shape("\"type\": \"cylinder\", \"radius\": 1"), ErrorCode::Empty, ":3: bodies[0].shapes[0]");
    expect_error(read_shape("\"type\": \"cylinder\", \"radius\": -1, \"half_height\": 1"), ErrorCode::InvalidArgument,
                 ":3: bodies[0].shapes[0].radius");
    expect_error(read_shape("\"type\": \"cone\", \"radius\": 1, \"half_height\": 0"), ErrorCode::InvalidArgument,
                 ":3: bodies[0].shapes[0].half_height");
    expect_error(read_shape("\"type\": \"cone\", \"radius\": 1, \"half_height\": 1e6"), ErrorCode::InvalidArgument,
                 ":3: bodies[0].shapes[0]");
    expect_error(read_shape("\"type\": \"cone\", \"radius\": 1, \"half_height\": 1, \"half_segment\": 1"), ErrorCode::UnknownName,
                 ":3: bodies[0].shapes[0].half_segment");
    const auto part = [&](const std::string& text) { return read_shape("\"type\": \"compound\", \"parts\": [\n{" + text + "}]"); };
    expect_error(read_shape("\"type\": \"compound\""), ErrorCode::Empty, ":3: bodies[0].shapes[0]");
    expect_error(read_shape("\"type\": \"compound\", \"parts\": []"), ErrorCode::Empty, ":3: bodies[0].shapes[0].parts");
    expect_error(part("\"type\": \"plane\", \"normal\": [0, 1, 0]"), ErrorCode::WrongType, ":4: bodies[0].shapes[0].parts[0]");
    expect_error(part("\"type\": \"compound\", \"parts\": [{\"type\": \"sphere\", \"radius\": 1}]"), ErrorCode::WrongType,
                 ":4: bodies[0].shapes[0].parts[0]");
    expect_error(part("\"type\": \"sphere\", \"radius\": 1, \"mass\": 1"), ErrorCode::UnknownName, ":4: bodies[0].shapes[0].parts[0].mass");
    expect_error(part("\"type\": \"sphere\", \"radius\": 1, \"restitution\": 2"), ErrorCode::InvalidArgument,
                 ":4: bodies[0].shapes[0].parts[0].restitution");
}

}  // namespace
}  // namespace carom::test
