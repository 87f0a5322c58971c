// A world's debug frame: every layer holds what the world says.
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/check.hpp>
#include <carom/viz/make_debug_frame.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

const DebugLayer& layer(const DebugFrame& frame, Layer which) { return *frame.find(to_string(which)); }

/// A ground plane and one body of each bounded shape above it, the box resting on the plane.
struct Park {
    World world;
    BodyId ground, box, ball, capsule, hull, terrain;

    explicit Park(const dvec3& at = dvec3{0.0}) {
        ground = world.create_body({.type = BodyType::Static, .position = at, .name = "ground"});
        world.add_shape(ground, Plane{});
        box = world.create_body({.position = at + dvec3{0.0, 0.5, 0.0}, .name = "crate"});
        world.add_shape(box, Box{{0.5f, 0.5f, 0.5f}});
        ball = world.create_body({.position = at + dvec3{3.0, 2.0, 0.0}});
        world.add_shape(ball, Sphere{0.5f});
        capsule = world.create_body({.position = at + dvec3{-3.0, 2.0, 0.0}});
        world.add_shape(capsule, Capsule{0.25f, 0.5f});
        const std::vector<vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        hull = world.create_body({.position = at + dvec3{0.0, 4.0, 0.0}});
        world.add_shape(hull, *ConvexHull::build(corners));
        const std::vector<vec3> square{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}};
        const std::vector<TriangleMesh::Triangle> halves{{0, 1, 2}, {0, 2, 3}};
        terrain = world.create_body({.type = BodyType::Static, .position = at + dvec3{0.0, -0.5, 0.0}});
        world.add_shape(terrain, *TriangleMesh::build(square, halves));
    }
};

TEST(MakeDebugFrame, HasEveryLayerInOrderAndIsValid) {
    Park park;
    park.world.step(1.0 / 60.0);
    const DebugFrame frame = make_debug_frame(park.world);
    ASSERT_EQ(frame.layers.size(), static_cast<std::size_t>(kLayerCount));
    EXPECT_TRUE(layer(frame, Layer::Static).hide_backs);
    EXPECT_FALSE(layer(frame, Layer::Shapes).hide_backs);
    for (int i = 0; i < kLayerCount; ++i) {
        EXPECT_EQ(frame.layers[static_cast<std::size_t>(i)].name, to_string(static_cast<Layer>(i)));
    }
    const Status status = validate(frame);
    EXPECT_TRUE(status) << status.error().message;
    EXPECT_EQ(frame.up, (dvec3{0.0, 1.0, 0.0}));
}

TEST(MakeDebugFrame, JointsAreLinesFromCentreToAnchorToAnchorToCentre) {
    World world;
    const BodyId a = world.create_body({.position = {1, 0, 0}}), b = world.create_body({.position = {4, 0, 0}});
    world.create_joint(SpringDef{.body_a = a, .body_b = b, .anchor_a = {1, 0, 0}, .anchor_b = {-1, 0, 0}, .stiffness = 1.0});
    world.create_joint(BallJointDef{.body_b = b, .anchor_a = {4, 2, 0}, .anchor_b = {0, 2, 0}});
    const DebugFrame frame = make_debug_frame(world);
    const std::vector<DebugLine>& lines = layer(frame, Layer::Joints).lines;
    ASSERT_EQ(lines.size(), 4u);  // the second has its anchors at one point, and the world has no centre
    const dvec3 o = frame.origin;
    EXPECT_EQ(dvec3(lines[0].a) + o, dvec3(1, 0, 0));
    EXPECT_EQ(dvec3(lines[1].a) + o, dvec3(2, 0, 0));
    EXPECT_EQ(dvec3(lines[1].b) + o, dvec3(3, 0, 0));
    EXPECT_EQ(dvec3(lines[2].b) + o, dvec3(4, 0, 0));
    EXPECT_EQ(dvec3(lines[3].a) + o, dvec3(4, 2, 0));
    EXPECT_TRUE(make_debug_frame(world, {.layers = kAllLayers & ~layer_bit(Layer::Joints)}).layers[static_cast<std::size_t>(Layer::Joints)].lines.empty());
}

TEST(MakeDebugFrame, ShapesBecomeTheirTrianglesWithTheirBody) {
    const Park park;
    const DebugFrame frame = make_debug_frame(park.world, {.segments = 8});
    const auto triangles_of = [&](Layer which, BodyId body) {
        const auto& all = layer(frame, which).triangles;
        return std::count_if(all.begin(), all.end(), [&](const DebugTriangle& t) { return t.body == body; });
    };
    EXPECT_EQ(triangles_of(Layer::Shapes, park.box), 12);
    EXPECT_EQ(triangles_of(Layer::Shapes, park.ball), 8 * 6);
    EXPECT_EQ(triangles_of(Layer::Shapes, park.capsule), 8 * 8);
    EXPECT_EQ(triangles_of(Layer::Shapes, park.hull), 4);
    EXPECT_EQ(triangles_of(Layer::Static, park.terrain), 2);
    EXPECT_EQ(triangles_of(Layer::Static, park.ground), 2 * 16 * 16);
    EXPECT_EQ(triangles_of(Layer::Static, park.box), 0);
    EXPECT_EQ(layer(frame, Layer::Bounds).lines.size(), 12u * 5u);  // the plane has none
    EXPECT_EQ(layer(frame, Layer::Bvh).lines.size() % 12, 0u);
    EXPECT_GE(layer(frame, Layer::Bvh).lines.size(), 12u);
    ASSERT_EQ(layer(frame, Layer::Names).texts.size(), 2u);
    EXPECT_EQ(layer(frame, Layer::Names).texts[1].text, "crate");
    EXPECT_EQ(layer(frame, Layer::Names).texts[1].body, park.box);
}

TEST(MakeDebugFrame, ContactsNormalsAndImpulsesAreThoseOfTheLastStep) {
    Park park;
    EXPECT_TRUE(layer(make_debug_frame(park.world), Layer::Contacts).empty());
    for (int i = 0; i < 3; ++i) park.world.step(1.0 / 60.0);
    const DebugFrame frame = make_debug_frame(park.world, {.line_length = 0.25});
    std::size_t points = 0;
    for (std::size_t i = 0; i < park.world.contact_count(); ++i) points += park.world.contact(i).manifold.count;
    ASSERT_EQ(points, 4u);  // the crate's lower face
    EXPECT_EQ(layer(frame, Layer::Contacts).points.size(), points);
    ASSERT_EQ(layer(frame, Layer::Normals).lines.size(), points);
    EXPECT_EQ(layer(frame, Layer::Impulses).lines.size(), points);
    float longest = 0.0f;
    for (std::size_t i = 0; i < points; ++i) {
        const DebugPoint& point = layer(frame, Layer::Contacts).points[i];
        EXPECT_EQ(point.body, park.box);
        EXPECT_NEAR(std::abs(point.position.x), 0.5f, 1e-3f);
        EXPECT_NEAR(point.position.y, 0.0f, 1e-2f);
        const DebugLine& normal = layer(frame, Layer::Normals).lines[i];
        EXPECT_EQ(normal.a, point.position);
        EXPECT_NEAR(std::abs(normal.b.y - normal.a.y), 0.25f, 1e-4f);
        const DebugLine& impulse = layer(frame, Layer::Impulses).lines[i];
        longest = std::max(longest, glm::length(impulse.b - impulse.a));
    }
    EXPECT_NEAR(longest, 0.25f, 1e-4f);
}

TEST(MakeDebugFrame, FarFromTheOriginOnlyTheFramesOriginDiffers) {
    const dvec3 far{3e7, 0.0, -2e7};
    const DebugFrame here = make_debug_frame(Park().world);
    const DebugFrame there = make_debug_frame(Park(far).world, {.origin = far});
    EXPECT_EQ(there.origin, far);
    for (const Layer which : {Layer::Shapes, Layer::Static}) {
        const auto& a = layer(here, which).vertices;
        const auto& b = layer(there, which).vertices;
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            // A double at 3e7 has a spacing of 4e-9; the patch of the plane is sized from bounds of that accuracy.
            EXPECT_LT(glm::length(a[i].position - b[i].position), 1e-5f) << to_string(which) << ' ' << i;
        }
    }
}

TEST(MakeDebugFrame, SettingsChooseLayersAndColours) {
    const Park park;
    const DebugFrame some = make_debug_frame(park.world, {.layers = layer_bit(Layer::Shapes) | layer_bit(Layer::Names)});
    for (int i = 0; i < kLayerCount; ++i) {
        const auto which = static_cast<Layer>(i);
        EXPECT_EQ(layer(some, which).empty(), which != Layer::Shapes && which != Layer::Names) << to_string(which);
    }
    World twins;
    for (int i = 0; i < 2; ++i) {
        twins.add_shape(twins.create_body({.position = {2.0 * i, 0.0, 0.0}}), Box{});
    }
    const auto first = [](const DebugFrame& f) { return layer(f, Layer::Shapes).triangles.front().color; };
    const auto last = [](const DebugFrame& f) { return layer(f, Layer::Shapes).triangles.back().color; };
    const DebugFrame by_body = make_debug_frame(twins);
    const DebugFrame by_type = make_debug_frame(twins, {.color_by = ColorBy::ShapeType});
    EXPECT_FALSE(first(by_body) == last(by_body));
    EXPECT_EQ(first(by_type), last(by_type));
}

TEST(MakeDebugFrame, UpIsAgainstGravity) {
    EXPECT_EQ(make_debug_frame(World({.gravity = {0.0, 0.0, -3.7}})).up, (dvec3{0.0, 0.0, 1.0}));
    EXPECT_EQ(make_debug_frame(World({.gravity = dvec3{0.0}})).up, (dvec3{0.0, 1.0, 0.0}));
}

TEST(MakeDebugFrame, MisuseIsReported) {
    const World world;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW((void)make_debug_frame(world, {.origin = dvec3{nan}}), MisuseError);
    EXPECT_THROW((void)make_debug_frame(world, {.segments = 7}), MisuseError);
    EXPECT_THROW((void)make_debug_frame(world, {.bvh_depth = -1}), MisuseError);
    EXPECT_THROW((void)make_debug_frame(world, {.line_length = -0.1}), MisuseError);
    EXPECT_THROW((void)make_debug_frame(world, {.plane_half_size = nan}), MisuseError);
}

TEST(DescribeBody, SaysWhatAPickPrints) {
    Park park;
    park.world.set_linear_velocity(park.box, {1.5, 0.0, 0.0});
    const std::string text = describe_body(park.world, park.box);
    for (const char* part : {"\"crate\"", "dynamic", "box", "(0, 0.5, 0) m", "(1.5, 0, 0) m/s", "rad/s", "1000 kg"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
    }
    park.world.destroy_body(park.box);
    EXPECT_NE(describe_body(park.world, park.box).find("no longer there"), std::string::npos);
}

}  // namespace
}  // namespace carom
