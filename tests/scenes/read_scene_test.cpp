// Scene files: what they say is what is built, and whatever is wrong with them is named.
#include "scene_file.hpp"

namespace carom::test {
namespace {

const std::string kExamples = std::string(CAROM_TEST_DATA) + "/../scenes/examples/";

TEST_F(ReadScene, BuildsWhatTheFileSays) {
    Result<SceneRun> run = read_scene(kExamples + "crates.json");
    ASSERT_TRUE(run.has_value()) << run.error().where << ": " << run.error().message;
    const World& world = run->world;
    EXPECT_EQ(run->name, "crates");
    EXPECT_EQ(run->steps, 240);
    EXPECT_EQ(run->domain, (Aabb{{-10, -1, -10}, {10, 20, 10}}));
    ASSERT_EQ(world.body_count(), 5u);
    const auto bodies = world.bodies();
    EXPECT_EQ(world.type(bodies[0]), BodyType::Static);
    EXPECT_EQ(std::get<Plane>(first_shape(world, bodies[0])), (Plane{{0, 1, 0}, 0}));
    EXPECT_EQ(world.name(bodies[2]), "turned crate");
    EXPECT_EQ(std::get<Box>(first_shape(world, bodies[2])).half_extents, vec3(0.4f));
    EXPECT_NEAR(world.pose(bodies[2]).orientation.y, std::sin(0.25), 1e-15);
    EXPECT_NEAR(world.mass_properties(bodies[1]).mass, 500.0, 1e-9);
    EXPECT_EQ(world.linear_velocity(bodies[3]), dvec3(-1, 0, 0));
    EXPECT_EQ(world.angular_velocity(bodies[3]), dvec3(0, 0, 1));
    EXPECT_EQ(world.shape_def(world.shapes(bodies[3])[0]).restitution, 0.4f);
    ASSERT_EQ(world.shapes(bodies[4]).size(), 2u);
    EXPECT_EQ(world.shape_def(world.shapes(bodies[4])[1]).local.position, dvec3(0, 0.6, 0));
    step(*run, 60);
    EXPECT_EQ(scenes::count_escaped(run->world, run->domain), 0);
}

TEST_F(ReadScene, JoinsBodies) {
    Result<SceneRun> run = read_scene(kExamples + "crane.json");
    ASSERT_TRUE(run.has_value()) << run.error().where << ": " << run.error().message;
    World& world = run->world;
    ASSERT_EQ(world.joints().size(), 5u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(world.joint_state(world.joints()[i]).length, 1e-12);
    const SpringDef spring = std::get<SpringDef>(world.joint_def(world.joints()[4]));
    EXPECT_EQ(spring.body_a, BodyId{});
    EXPECT_EQ(world.name(spring.body_b), "lamp");
    EXPECT_EQ(spring.rest_length, 2.0);
    EXPECT_EQ(spring.damping, 10.0);
    step(*run, 600);
    EXPECT_EQ(scenes::count_escaped(world, run->domain), 0);
    EXPECT_NEAR(world.joint_state(world.joints()[4]).force.y, 64.0 * 9.81, 20.0);  // it still swings a little
    EXPECT_LT(world.center_of_mass(world.bodies()[9]).y, 3.0);                      // the weight went through the crates
}

TEST_F(ReadScene, NamesTheFaultOfAJoint) {
    const auto with = [&](const std::string& joint) {
        const std::string ball = R"("shapes": [{"type": "sphere", "radius": 1}])";
        return read("{\"bodies\": [{\"name\": \"x\", " + ball + "}, {\"name\": \"y\", " + ball + "}, {\"name\": \"y\", \"type\": \"static\", " + ball +
                    "}],\n\"joints\": [{" + joint + "}]}");
    };
    EXPECT_TRUE(with(R"("type": "ball", "body_a": "x", "body_b": 2)").has_value());
    EXPECT_TRUE(with(R"("type": "spring", "body_a": 0, "stiffness": 3, "collide_connected": true)").has_value());
    expect_error(with(R"("body_a": "x")"), ErrorCode::Empty, ":2: joints[0]");
    expect_error(with(R"("type": "hinge", "body_a": "x")"), ErrorCode::UnknownName, ":2: joints[0].type");
    expect_error(with(R"("type": "ball", "body_a": "z")"), ErrorCode::UnknownName, ":2: joints[0].body_a");
    expect_error(with(R"("type": "ball", "body_a": "y")"), ErrorCode::InvalidArgument, ":2: joints[0].body_a");
    expect_error(with(R"("type": "ball", "body_a": 3)"), ErrorCode::InvalidArgument, ":2: joints[0].body_a");
    expect_error(with(R"("type": "ball", "body_a": 1, "body_b": 1)"), ErrorCode::InvalidArgument, ":2: joints[0]");
    expect_error(with(R"("type": "ball", "body_b": 2)"), ErrorCode::WrongType, ":2: joints[0]");
    expect_error(with(R"("type": "ball", "body_a": 0, "at": [0, 0, 0], "anchor_b": [0, 0, 0])"), ErrorCode::InvalidArgument, ":2: joints[0].anchor_b");
    expect_error(with(R"("type": "ball", "body_a": 0, "anchor_b": [1e31, 0, 0])"), ErrorCode::InvalidArgument, ":2: joints[0].anchor_b");
    expect_error(with(R"("type": "ball", "body_a": 0, "stiffness": 1)"), ErrorCode::UnknownName, ":2: joints[0].stiffness");
    expect_error(with(R"("type": "spring", "body_a": 0)"), ErrorCode::Empty, ":2: joints[0]");
    expect_error(with(R"("type": "spring", "body_a": 0, "stiffness": -1)"), ErrorCode::InvalidArgument, ":2: joints[0].stiffness");
    expect_error(with(R"("type": "spring", "body_a": 0, "stiffness": 1, "damping": -1)"), ErrorCode::InvalidArgument, ":2: joints[0].damping");
    expect_error(with(R"("type": "spring", "body_a": 0, "stiffness": 1, "rest_length": "long")"), ErrorCode::WrongType, ":2: joints[0].rest_length");
    expect_error(read(R"({"bodies": [], "joints": [{"type": "ball", "body_a": 0}]})"), ErrorCode::UnknownName, ":1: joints[0].body_a");
}

TEST_F(ReadScene, SubstepsComeFromTheUserThenTheFileThenTheSettings) {
    std::ofstream(path()) << R"({"substeps": 6, "bodies": []})";
    EXPECT_EQ(read_scene(path())->world.settings().substeps, 6);
    EXPECT_EQ(read_scene(path(), {.substeps = 9})->world.settings().substeps, 9);
    std::ofstream(path()) << R"({"bodies": []})";
    EXPECT_EQ(read_scene(path(), {.world = {.substeps = 3}})->world.settings().substeps, 3);
}

TEST_F(ReadScene, GivesTheVelocityOfTheCentreOfMass) {
    const Result<SceneRun> run = read_body(R"("linear_velocity": [1,2,3], "angular_velocity": [0,0,5],
                     "shapes": [{"type": "sphere", "radius": 0.5, "position": [2, 0, 0]}])");
    ASSERT_TRUE(run.has_value()) << run.error().message;
    EXPECT_EQ(run->world.linear_velocity(run->world.bodies()[0]), dvec3(1, 2, 3));
}

TEST_F(ReadScene, NamesTheFileThatCannotBeRead) {
    const Result<SceneRun> missing = read_scene(path());
    expect_error(missing, ErrorCode::Io, "");
    const Result<SceneRun> folder = read_scene(folder_.string());
    ASSERT_FALSE(folder.has_value());
    EXPECT_EQ(folder.error().code, ErrorCode::Io);
    const Result<SceneRun> empty_path = read_scene("");
    ASSERT_FALSE(empty_path.has_value());
    EXPECT_EQ(empty_path.error().code, ErrorCode::Io);
}

TEST_F(ReadScene, RefusesAHugeFileWithoutReadingIt) {
    std::ofstream(path()) << "{}";
    std::filesystem::resize_file(path(), std::uintmax_t{4} << 30u);  // sparse
    expect_error(read_scene(path()), ErrorCode::Io, "");
}

TEST_F(ReadScene, NamesTheLineWhereTheTextIsNotJson) {
    expect_error(read(""), ErrorCode::Parse, ":1");
    expect_error(read("{\n\"bodies\": [\n}\n"), ErrorCode::Parse, ":3");
    expect_error(read("{\"bodies\": []}\n\nrest"), ErrorCode::Parse, ":3");
    expect_error(read("{\"dt\": 1,\n\"dt\": 2, \"bodies\": []}"), ErrorCode::Parse, ":2");
    expect_error(read("{\"dt\":\n NaN, \"bodies\": []}"), ErrorCode::Parse, ":2");
    expect_error(read("{\"dt\":\n 1e999, \"bodies\": []}"), ErrorCode::Parse, ":2");
    expect_error(read("{\"name\": \"\xff\"}"), ErrorCode::Parse, ":1");
    expect_error(read(std::string("{\"name\": \"\0\"}", 13)), ErrorCode::Parse, ":1");
}

TEST_F(ReadScene, SurvivesDeepNesting) {
    expect_error(read(std::string(1'000'000, '[')), ErrorCode::Parse, ":1");
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":\n";
    expect_error(read(objects), ErrorCode::Parse, ":33");
}

TEST_F(ReadScene, RefusesFarTooManyValues) {
    std::string text = "[0";
    for (int i = 0; i < 4'100'000; ++i) text += ",0";
    expect_error(read(text + "]"), ErrorCode::Parse, ":1");
}

TEST_F(ReadScene, NamesKeysOfTheRoot) {
    expect_error(read("[]"), ErrorCode::WrongType, ":1");
    expect_error(read("{}"), ErrorCode::Empty, ":1");
    expect_error(read("{\"bodies\": 3}"), ErrorCode::WrongType, ":1: bodies");
    expect_error(read("{\"bodies\": [],\n\"gravitiy\": [0,0,0]}"), ErrorCode::UnknownName, ":2: gravitiy");
    expect_error(read("{\"bodies\": [], \"gravity\": [0,0]}"), ErrorCode::WrongType, ":1: gravity");
    expect_error(read("{\"bodies\": [], \"gravity\": [0,\n\"1\",0]}"), ErrorCode::WrongType, ":2: gravity[1]");
    expect_error(read("{\"bodies\": [], \"dt\": 0}"), ErrorCode::InvalidArgument, ":1: dt");
    expect_error(read("{\"bodies\": [], \"dt\": -1}"), ErrorCode::InvalidArgument, ":1: dt");
    expect_error(read("{\"bodies\": [], \"dt\": \"1\"}"), ErrorCode::WrongType, ":1: dt");
    expect_error(read("{\"bodies\": [], \"steps\": -1}"), ErrorCode::InvalidArgument, ":1: steps");
    expect_error(read("{\"bodies\": [],\n\"steps\": -1\n\n}"), ErrorCode::InvalidArgument, ":2: steps");
    expect_error(read("{\"bodies\": [], \"steps\": 1.5}"), ErrorCode::WrongType, ":1: steps");
    expect_error(read("{\"bodies\": [], \"substeps\": 0}"), ErrorCode::InvalidArgument, ":1: substeps");
    expect_error(read("{\"bodies\": [], \"name\": null}"), ErrorCode::WrongType, ":1: name");
    expect_error(read(R"({"bodies": [], "domain": {"lower": [0,0,0], "upper": [1,-1,1]}})"), ErrorCode::InvalidArgument,
                 ":1: domain");
    expect_error(read(R"({"bodies": [], "domain": {"lower": [0,0,0]}})"), ErrorCode::Empty, ":1: domain");
}

TEST_F(ReadScene, NamesKeysOfBodies) {
    const std::string shapes = R"("shapes": [{"type": "sphere", "radius": 1}])";
    expect_error(read("{\"bodies\": [4]}"), ErrorCode::WrongType, ":1: bodies[0]");
    expect_error(read_body(""), ErrorCode::Empty, ":2: bodies[0]");
    expect_error(read_body("\"shapes\": []"), ErrorCode::Empty, ":2: bodies[0].shapes");
    expect_error(read_body(shapes + ", \"mass\": 3"), ErrorCode::UnknownName, ":2: bodies[0].mass");
    expect_error(read_body(shapes + ", \"type\": \"rigid\""), ErrorCode::UnknownName, ":2: bodies[0].type");
    expect_error(read_body(shapes + ", \"type\": 1"), ErrorCode::WrongType, ":2: bodies[0].type");
    expect_error(read_body(shapes + ", \"position\": {}"), ErrorCode::WrongType, ":2: bodies[0].position");
    expect_error(read_body(shapes + ", \"orientation\": [1,0,0]"), ErrorCode::WrongType, ":2: bodies[0].orientation");
    expect_error(read_body(shapes + ", \"orientation\": [2,0,0,0]"), ErrorCode::InvalidArgument,
                 ":2: bodies[0].orientation");
    expect_error(read_body(shapes + ", \"orientation\": [0,0,0,0]"), ErrorCode::InvalidArgument,
                 ":2: bodies[0].orientation");
    expect_error(read_body(shapes + R"(, "orientation": {"axis": [0,0,0], "angle": 1})"), ErrorCode::InvalidArgument,
                 ":2: bodies[0].orientation.axis");
    expect_error(read_body(shapes + R"(, "orientation": {"axis": [0,1,0]})"), ErrorCode::Empty,
                 ":2: bodies[0].orientation");
    expect_error(read_body(shapes + R"(, "type": "static", "linear_velocity": [1,0,0])"), ErrorCode::InvalidArgument,
                 ":2: bodies[0].linear_velocity");
    expect_error(read("{\"bodies\": [{" + shapes + "},\n{" + shapes + "},\n{\"shapes\": [{}]}]}"), ErrorCode::Empty,
                 ":3: bodies[2].shapes[0]");
}

TEST_F(ReadScene, ReadsWhatBodiesAskForBeyondGravity) {
    const std::string shape = R"("shapes": [{"type": "sphere", "radius": 1, "friction_rule": "minimum", "restitution_rule": "product"}])";
    const std::string asks = R"("gravity_scale": 0.5, "linear_damping": 0.1, "angular_damping": 0.2, "locked": ["move_z", "turn_x", "turn_y"], )";
    const Result<SceneRun> run = read_body(asks + shape);
    ASSERT_TRUE(run.has_value()) << run.error().where << ": " << run.error().message;
    const World& world = run->world;
    const BodyId body = world.bodies()[0];
    EXPECT_EQ(world.gravity_scale(body), 0.5);
    EXPECT_EQ(world.linear_damping(body), 0.1);
    EXPECT_EQ(world.angular_damping(body), 0.2);
    EXPECT_EQ(world.locked_axes(body), LockedAxes::Plane2D);
    EXPECT_EQ(world.shape_def(world.shapes(body)[0]).friction_rule, CombineRule::Minimum);
    EXPECT_EQ(world.shape_def(world.shapes(body)[0]).restitution_rule, CombineRule::Product);

    const auto refuse = [&](const std::string& keys, ErrorCode code, const std::string& place) {
        expect_error(read_body(keys + ", " + shape), code, ":2: bodies[0]." + place);
    };
    refuse(R"("gravity_scale": 1e7)", ErrorCode::InvalidArgument, "gravity_scale");
    refuse(R"("linear_damping": -1)", ErrorCode::InvalidArgument, "linear_damping");
    refuse(R"("angular_damping": "much")", ErrorCode::WrongType, "angular_damping");
    refuse(R"("locked": ["x"])", ErrorCode::UnknownName, "locked[0]");
    refuse(R"("type": "kinematic", "gravity_scale": 0)", ErrorCode::InvalidArgument, "gravity_scale");
}

TEST_F(ReadScene, ReadsSleepAndResistance) {
    const std::string shape = R"("shapes": [{"type": "sphere", "radius": 1, "rolling_resistance": 0.25, "torsion": 0.5, "rolling_rule": "average"}])";
    const Result<SceneRun> run = read_body(R"("can_sleep": false, )" + shape);
    ASSERT_TRUE(run.has_value()) << run.error().where << ": " << run.error().message;
    EXPECT_FALSE(run->world.settings().sleep.enabled);
    const ShapeDef& def = run->world.shape_def(run->world.shapes(run->world.bodies()[0])[0]);
    EXPECT_EQ(def.rolling_resistance, 0.25f);
    EXPECT_EQ(def.torsion, 0.5f);
    EXPECT_EQ(def.rolling_rule, CombineRule::Average);
    EXPECT_TRUE(read_scene(kExamples + "crates.json", {.world = {.sleep = {.enabled = true}}})->world.settings().sleep.enabled);

    EXPECT_FALSE(read(R"({"continuous": false, "bodies": []})")->world.settings().continuous.enabled);
    expect_error(read(R"({"continuous": 1, "bodies": []})"), ErrorCode::WrongType, ":1: continuous");
    EXPECT_EQ(read_body(R"("continuity": "always", )" + shape)->world.continuity(run->world.bodies()[0]), Continuity::Always);
    expect_error(read_body(R"("continuity": "often", )" + shape), ErrorCode::UnknownName, ":2: bodies[0].continuity");
    expect_error(read_body(R"("type": "static", "continuity": "never", )" + shape), ErrorCode::InvalidArgument, ":2: bodies[0].continuity");
    EXPECT_TRUE(read(R"({"sleep": true, "bodies": []})")->world.settings().sleep.enabled);
    expect_error(read(R"({"sleep": "deep", "bodies": []})"), ErrorCode::WrongType, ":1: sleep");
    expect_error(read_body(R"("can_sleep": 1, )" + shape), ErrorCode::WrongType, ":2: bodies[0].can_sleep");
    expect_error(read_body(R"("type": "static", "can_sleep": false, )" + shape), ErrorCode::InvalidArgument, ":2: bodies[0].can_sleep");
    const std::string sphere = R"("type": "sphere", "radius": 1, )", at = ":3: bodies[0].shapes[0]";
    expect_error(read_shape(sphere + R"("rolling_resistance": -0.1)"), ErrorCode::InvalidArgument, at + ".rolling_resistance");
    expect_error(read_shape(sphere + R"("torsion": "much")"), ErrorCode::WrongType, at + ".torsion");
    expect_error(read_shape(sphere + R"("rolling_rule": "sum")"), ErrorCode::UnknownName, at + ".rolling_rule");
}

TEST_F(ReadScene, RefusesOptionsThatAFileDoesNotHave) {
    const Result<SceneRun> bodies = read_scene(kExamples + "crates.json", {.bodies = 3});
    ASSERT_FALSE(bodies.has_value());
    EXPECT_EQ(bodies.error().where, "bodies");
    const Result<SceneRun> set = read_scene(kExamples + "crates.json", {.set = {{"ratio", "3"}}});
    ASSERT_FALSE(set.has_value());
    EXPECT_EQ(set.error().code, ErrorCode::UnknownName);
    const Result<SceneRun> substeps = read_scene(kExamples + "crates.json", {.substeps = -1});
    ASSERT_FALSE(substeps.has_value());
    EXPECT_EQ(substeps.error().where, "substeps");
}


}  // namespace
}  // namespace carom::test
