// Bodies that are meshes: they rest, stack and slide as the solids that they bound; what has no volume is refused.
#include "support/box_mesh.hpp"
#include "support/grid_mesh.hpp"
#include "table.hpp"

#include <carom/collision/mass_properties.hpp>
#include <carom/core/check.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace carom {
namespace {

using namespace test;

// Of 10,082 triangles, at y = 0.
TriangleMeshPtr flat_floor(float cell) {
    return grid_mesh(72, [cell](float i, float j) { return vec3{cell * (i - 35.5f), 0.0f, cell * (j - 35.5f)}; });
}

double weight_on(const World& world) {
    double impulse = 0.0;
    for (std::size_t c = 0; c < world.contact_count(); ++c) {
        const ContactView contact = world.contact(c);
        for (std::uint32_t k = 0; k < contact.manifold.count; ++k) impulse += static_cast<double>(contact.normal_impulse[k]);
    }
    return impulse * 60.0 * world.settings().substeps;  // impulses are of one substep
}

TEST(Meshes, ABoxOfTrianglesRestsOnEveryGround) {
    struct Ground {
        Shape shape;
        double y = 0.0;
    };
    const std::array<Ground, 4> grounds{{{Plane{}, 0.0}, {Box{{5, 1, 5}}, -1.0}, {flat_floor(0.2f), 0.0}, {box_mesh({5, 1, 5}, 3), -1.0}}};
    for (const Ground& ground : grounds) {
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static, .position = {0, ground.y, 0}}), ground.shape);
        const BodyId crate = world.create_body({.position = {0.1, 0.4, 0.2}});
        world.add_shape(crate, box_mesh({0.5f, 0.25f, 0.375f}, 2));
        EXPECT_NEAR(world.mass_properties(crate).mass, 375.0, 1e-3);
        for (int i = 0; i < 150; ++i) world.step(kDt);
        EXPECT_NEAR(world.pose(crate).position.y, 0.25, 1e-3) << to_string(type_of(ground.shape));
        EXPECT_LT(glm::length(world.linear_velocity(crate)), 1e-4);
        EXPECT_LT(glm::length(world.angular_velocity(crate)), 1e-4);
        EXPECT_NEAR(weight_on(world), 375.0 * 9.81, 4.0) << to_string(type_of(ground.shape));
    }
}

TEST(Meshes, StackAsTheirSolidsDo) {
    Table table;
    std::vector<BodyId> crates;
    for (int i = 0; i < 4; ++i) crates.push_back(table.add({.position = {0.003 * i, 0.26 + 0.51 * i, 0.0}}, box_mesh({0.4f, 0.25f, 0.3f}, 1 + i % 2)));
    table.run(240);
    for (int i = 0; i < 4; ++i) {
        const BodyId crate = crates[static_cast<std::size_t>(i)];
        EXPECT_NEAR(table.world.pose(crate).position.y, 0.25 + 0.5 * i, 2e-3) << i;
        EXPECT_NEAR(table.world.pose(crate).position.x, 0.003 * i, 2e-3) << i;
        EXPECT_LT(glm::length(table.world.linear_velocity(crate)), 1e-3) << i;
    }
}

// Without friction over ten thousand triangles in one plane: no inner edge is felt. The path crosses edges of all three directions.
TEST(Meshes, NothingIsFeltOfInnerEdges) {
    const std::array<Shape, 3> sliders{Box{{0.5f, 0.25f, 0.4f}}, box_mesh({0.5f, 0.25f, 0.4f}, 1), box_mesh({0.5f, 0.25f, 0.4f}, 3)};
    for (const Shape& slider : sliders) {
        World world;
        world.add_shape(world.create_body({.type = BodyType::Static}), flat_floor(1.5f), {.friction = 0.0f});
        const dvec3 speed{20.0, 0.0, 3.1};
        const BodyId body = world.create_body({.position = {-48.0, 0.25, -7.0}, .linear_velocity = speed});
        world.add_shape(body, slider, {.friction = 0.0f});
        double highest = 0.0;
        for (int i = 0; i < 290; ++i) {
            world.step(kDt);
            if (i > 10) highest = std::max(highest, std::abs(world.linear_velocity(body).y));
        }
        EXPECT_GT(world.pose(body).position.x, 45.0) << "nearly 100 m";
        const double v = glm::length(speed);
        EXPECT_LT(highest, 1e-4 * v);
        EXPECT_NEAR(glm::length(world.linear_velocity(body)), v, 1e-4 * v);
        EXPECT_LT(glm::length(world.angular_velocity(body)), 1e-4 * v);
    }
}

int g_reports = 0;
ErrorCode g_code{};
void count_report(const Error& error) {
    ++g_reports;
    g_code = error.code;
}

TEST(Meshes, WithoutVolumeAreNoBodies) {
    const ErrorHandler before = set_error_handler(count_report);
    World world;
    const BodyId body = world.create_body({});
    g_reports = 0;
    EXPECT_EQ(world.add_shape(body, flat_floor(0.5f)), ShapeId{});
    EXPECT_EQ(g_reports, 1);
    EXPECT_EQ(g_code, ErrorCode::Degenerate) << "open, and flat";
    // Wound inside out.
    const TriangleMeshPtr crate = box_mesh({0.5f, 0.5f, 0.5f}, 1);
    std::vector<TriangleMesh::Triangle> inwards(crate->triangles().begin(), crate->triangles().end());
    for (auto& t : inwards) std::swap(t[1], t[2]);
    EXPECT_EQ(world.add_shape(body, *TriangleMesh::build(crate->vertices(), inwards)), ShapeId{});
    EXPECT_EQ(g_code, ErrorCode::InvalidArgument);
    set_error_handler(before);
    // An open one has the mass of its hull.
    const auto lidless = crate->triangles().subspan(2);
    world.add_shape(body, *TriangleMesh::build(crate->vertices(), lidless));
    EXPECT_NEAR(world.mass_properties(body).mass, 1000.0, 1e-3);
}

}  // namespace
}  // namespace carom
