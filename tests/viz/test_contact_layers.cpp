// The layers of an explanation: there where the pair has such a thing, where the last step saw it.
#include <carom/viz/contact_layers.hpp>

#include <carom/collision/mesh_pairs.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/dynamics/world.hpp>
#include <carom/scenes/bumpy.hpp>
#include <carom/viz/layer.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace carom {
namespace {

std::set<std::string> names(const DebugFrame& frame) {
    std::set<std::string> found;
    for (const DebugLayer& layer : frame.layers) found.insert(layer.name);
    return found;
}

struct Scene {
    World world{{.gravity = {0, 0, 0}}};
    BodyId ground = world.create_body({.type = BodyType::Static, .position = {1e6, 0, 0}});
    BodyId low = world.create_body({.position = {1e6, 0.999, 0}, .orientation = {1, 0, 0, 0}});
    BodyId high = world.create_body({.position = {1e6, 4, 0}});
    Scene() {
        world.add_shape(ground, Box{{0.5f, 0.5f, 0.5f}});
        world.add_shape(low, Box{{0.5f, 0.5f, 0.5f}});
        world.add_shape(high, Sphere{0.5f});
        world.set_linear_velocity(low, {0, -0.01, 0});
        world.step(1.0 / 60.0);
    }
};

TEST(ContactLayers, ATouchingPairHasThemAll) {
    const Scene s;
    const ContactExplanation why = s.world.explain(s.ground, s.low);
    ASSERT_EQ(why.rung, Rung::Touch);
    const DebugFrame frame = make_contact_frame(s.world, why);
    const Status status = validate(frame);
    EXPECT_TRUE(status) << status.error().message;
    EXPECT_EQ(names(frame), (std::set<std::string>{"static", "shapes", kWhyBounds, kWhyAxis, kWhySimplex, kWhyManifold, kWhyPatch}));
    EXPECT_EQ(frame.caption, why.sentence);
    EXPECT_EQ(frame.origin, (dvec3{1e6, 0, 0})) << "the frame counts from A";
    EXPECT_EQ(frame.find(kWhyManifold)->points.size(), 4u);
    EXPECT_EQ(frame.find(kWhyManifold)->lines.size(), 4u);
    for (const DebugPoint& p : frame.find(kWhyManifold)->points) EXPECT_NEAR(p.position.y, 0.4995, 1e-5);
    EXPECT_EQ(frame.find(kWhyPatch)->lines.size(), 12u) << "two faces and what they share";
    EXPECT_EQ(frame.find(kWhyBounds)->lines.size(), 24u);
    EXPECT_FALSE(frame.find(kWhyBounds)->visible);
    // The body has moved since; the picture shows it where the step saw it.
    float highest = 0.0f;
    for (const DebugVertex& v : frame.find("shapes")->vertices) highest = std::max(highest, v.position.y);
    EXPECT_NEAR(highest, 1.499, 1e-6);
}

TEST(ContactLayers, APairThatIsApartHasItsGap) {
    const Scene s;
    const ContactExplanation why = s.world.explain(s.high, s.low);
    ASSERT_EQ(why.rung, Rung::Bounds);
    const DebugFrame frame = make_contact_frame(s.world, why);
    EXPECT_EQ(names(frame), (std::set<std::string>{"shapes", kWhyBounds, kWhyAxis, kWhySimplex}));
    EXPECT_TRUE(frame.find(kWhyBounds)->visible) << "the bounds are what parts them";
    ASSERT_EQ(frame.find(kWhyAxis)->texts.size(), 1u);
    EXPECT_EQ(frame.find(kWhyAxis)->texts[0].text, "gap 2.001 m");
}

TEST(ContactLayers, TwoMeshesHaveTheNodesThatWereLookedAt) {
    const MeshData ball = scenes::bumpy(8);
    const TriangleMeshPtr mesh = TriangleMesh::build(ball.vertices, ball.triangles).value();
    World world{{.gravity = {0, 0, 0}}};
    const BodyId low = world.create_body({.type = BodyType::Static, .position = {1e6, 0, 0}});
    const BodyId high = world.create_body({.position = {1e6, 1.9, 0.1}});
    const BodyId crate = world.create_body({.position = {1e6, -1.2, 0}});
    world.add_shape(low, mesh);
    world.add_shape(high, mesh);
    world.add_shape(crate, Box{{0.5f, 0.5f, 0.5f}});
    world.step(1.0 / 60.0);
    const ContactExplanation why = world.explain(low, high);
    const DebugFrame frame = make_contact_frame(world, why);
    const Status status = validate(frame);
    EXPECT_TRUE(status) << status.error().message;
    const DebugLayer* nodes = frame.find(kWhyNodes);
    ASSERT_NE(nodes, nullptr);
    EXPECT_FALSE(nodes->visible);
    const ShapePairExplanation& pair = why.pairs[why.deciding];
    std::set<std::int32_t> of_low, of_high;
    const Pose high_in_low = inverse(pair.pose_a) * pair.pose_b;
    for (const NodePair& v : visited_nodes(mesh->bvh(), mesh->bvh(), high_in_low, pair.contact->margin)) {
        of_low.insert(v.a.id);
        of_high.insert(v.b.id);
    }
    EXPECT_EQ(nodes->lines.size(), 12 * (of_low.size() + of_high.size())) << "a box for each node, once";
    // The boxes of the lower mesh are among those of all its nodes, those of the upper one lie above.
    float highest = -1.0f;
    for (const DebugLine& line : nodes->lines) highest = std::max({highest, line.a.y, line.b.y});
    EXPECT_GT(highest, 2.0f);
    EXPECT_EQ(make_contact_frame(world, world.explain(low, crate)).find(kWhyNodes), nullptr) << "a box has no nodes";
}

TEST(ContactLayers, WithoutShapesThereIsNothing) {
    Scene s;
    const BodyId empty = s.world.create_body({});
    EXPECT_TRUE(make_contact_frame(s.world, s.world.explain(s.low, empty)).layers.empty());
    const ContactExplanation why = s.world.explain(s.high, s.low);
    s.world.destroy_body(s.high);
    EXPECT_TRUE(make_contact_frame(s.world, why).layers.empty()) << "a shape is dead by now";
    EXPECT_TRUE(make_contact_frame(s.world, ContactExplanation{}).layers.empty());
}

}  // namespace
}  // namespace carom
