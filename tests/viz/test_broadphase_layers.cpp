// The layers of a broadphase: those of the method in use, relative to the frame's origin, and only where they were asked for.
#include <carom/core/check.hpp>
#include <carom/viz/broadphase_layers.hpp>
#include <carom/viz/make_debug_frame.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace carom {
namespace {

World row_of_crates(BroadphaseMethod method, const dvec3& at) {
    World world({.broadphase = method});
    for (int i = 0; i < 40; ++i) {
        const BodyId crate = world.create_body({.position = at + dvec3{2.0 * i, 0.0, i % 7}});
        world.add_shape(crate, Box{{0.5f, 0.5f, 0.5f}});
    }
    world.step(1.0 / 60.0);
    return world;
}

std::set<std::string> names(const DebugFrame& frame) {
    std::set<std::string> found;
    for (const DebugLayer& layer : frame.layers) found.insert(layer.name);
    return found;
}

TEST(BroadphaseLayers, AreThoseOfTheMethodInUse) {
    const dvec3 far{1e6, 0.0, 0.0};
    for (const BroadphaseMethod method : kBroadphaseMethods) {
        SCOPED_TRACE(to_string(method));
        const World world = row_of_crates(method, far);
        DebugFrame frame = make_debug_frame(world, {.layers = 0, .origin = far});
        EXPECT_EQ(frame.layers.size(), static_cast<std::size_t>(kLayerCount)) << "nothing that was not asked for";
        append_broadphase_layers(frame, world);
        const Status status = validate(frame);
        EXPECT_TRUE(status) << status.error().message;
        const DebugLayer* bounds = frame.find(kBroadphaseBounds);
        ASSERT_NE(bounds, nullptr);
        ASSERT_EQ(bounds->lines.size(), 40u * 12u);
        for (const DebugLine& line : bounds->lines) EXPECT_LT(glm::length(line.a), 100.0f);
        const bool grid = method == BroadphaseMethod::UniformGrid || method == BroadphaseMethod::HierarchicalGrid;
        EXPECT_EQ(frame.find(kBroadphaseCells) != nullptr, grid);
        EXPECT_EQ(frame.find(kBroadphaseTree) != nullptr, method == BroadphaseMethod::DynamicTree);
        const bool sorted = method == BroadphaseMethod::SortedAxes || method == BroadphaseMethod::SweepAndPrune;
        ASSERT_EQ(frame.find(kBroadphaseAxes) != nullptr, sorted);
        if (sorted) {
            EXPECT_EQ(frame.find(kBroadphaseAxes)->points.size(), method == BroadphaseMethod::SortedAxes ? 240u : 40u);
        }
    }
}

TEST(BroadphaseLayers, TheTreeEndsAtTheDepthThatWasAskedFor) {
    const World world = row_of_crates(BroadphaseMethod::DynamicTree, dvec3{0.0});
    std::size_t before = 0;
    for (const int depth : {0, 1, 2, 50}) {
        DebugFrame frame;
        append_broadphase_layers(frame, world.broadphase(), world.broadphase_origin(), depth);
        const std::size_t lines = frame.find(kBroadphaseTree)->lines.size();
        if (depth == 0) {
            EXPECT_EQ(lines, 12u);
        }
        EXPECT_GT(lines, before);
        before = lines;
    }
    EXPECT_EQ(before, 12u * (2 * 40 - 1));
}

TEST(BroadphaseLayers, NothingAliveGivesNoLayerAndMisuseNone) {
    DebugFrame frame;
    append_broadphase_layers(frame, World());
    EXPECT_TRUE(names(frame).empty());
    const World world = row_of_crates(BroadphaseMethod::UniformGrid, dvec3{0.0});
    EXPECT_THROW(append_broadphase_layers(frame, world.broadphase(), dvec3{std::numeric_limits<double>::quiet_NaN()}), MisuseError);
    EXPECT_THROW(append_broadphase_layers(frame, world.broadphase(), dvec3{0.0}, -1), MisuseError);
    EXPECT_TRUE(names(frame).empty());
}

}  // namespace
}  // namespace carom
