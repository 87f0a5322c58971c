// The viewer, driven by its keys and by a source that ends.
#include "scratch.hpp"

#include <carom/core/check.hpp>
#include <carom/viz/vtk/viewer.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace carom {
namespace {

ViewerSettings small_window() {
    return {.title = "test", .width = 400, .height = 200, .camera = front_camera(), .paused = false, .close_at_end = true,
            .steps_per_second = 1000.0};
}

TEST(Viewer, RunsTheSourceToItsEndAndCloses) {
    int made = 0, stepped = 0;
    Viewer viewer({.frame = [&] { ++made; return small_scene(); }, .step = [&] { return ++stepped < 5; }}, small_window());
    const Status status = viewer.run();
    ASSERT_TRUE(status) << status.error().message;
    EXPECT_EQ(stepped, 5);
    EXPECT_EQ(viewer.steps(), 5u);
    EXPECT_EQ(made, 6);  // the start, and after each step
}

TEST(Viewer, KeysPauseStepAndSwitchLayers) {
    int stepped = 0;
    Viewer viewer({.frame = [&] { return small_scene(); }, .step = [&] { ++stepped; return true; }}, small_window());
    ASSERT_TRUE(viewer.open());
    EXPECT_FALSE(viewer.paused());
    viewer.press("space");
    EXPECT_TRUE(viewer.paused());
    viewer.press("space");
    EXPECT_FALSE(viewer.paused());
    viewer.press("n");  // a single step pauses
    viewer.press("n");
    EXPECT_TRUE(viewer.paused());
    EXPECT_EQ(stepped, 2);
    EXPECT_TRUE(viewer.layer_visible("shapes"));
    EXPECT_FALSE(viewer.layer_visible("names"));
    viewer.press("1");
    viewer.press("3");
    EXPECT_FALSE(viewer.layer_visible("shapes"));
    EXPECT_TRUE(viewer.layer_visible("names"));
    viewer.press("n");  // a new frame keeps the switches
    EXPECT_FALSE(viewer.layer_visible("shapes"));
    for (const char* key : {"9", "r", "h", "x", ""}) viewer.press(key);
    EXPECT_FALSE(viewer.layer_visible("no such layer"));
    viewer.press("q");
    EXPECT_TRUE(viewer.run());  // closed already
    EXPECT_EQ(stepped, 3);
}

TEST(Viewer, PicksTheBodyUnderThePointer) {
    std::string printed;
    ViewerSource source{.frame = [] { return small_scene(); }};
    source.describe = [](BodyId body) { return "slot " + std::to_string(body.slot); };
    source.print = [&](const std::string& text) { printed = text; };
    Viewer viewer(source, small_window());
    ASSERT_TRUE(viewer.open());
    EXPECT_EQ(viewer.pick(151, 100), kRedBody);
    EXPECT_EQ(printed, "slot 3");
    EXPECT_EQ(viewer.pick(249, 100), kBlueBody);
    EXPECT_EQ(printed, "slot 4");
    printed.clear();
    EXPECT_EQ(viewer.pick(200, 190), BodyId{});
    EXPECT_EQ(printed, "");
    viewer.press("1");  // hidden bodies cannot be picked
    EXPECT_EQ(viewer.pick(151, 100), BodyId{});
}

TEST(Viewer, PicksWhatIsDrawnBehindAHiddenBack) {
    ViewerSource source{.frame = [] { return with_wall(small_scene(), -1.0f); }, .print = [](const std::string&) {}};
    Viewer behind(source, small_window());
    ASSERT_TRUE(behind.open());
    EXPECT_EQ(behind.pick(151, 100), kRedBody);
    source.frame = [] { return with_wall(small_scene(), 1.0f); };
    Viewer before(source, small_window());
    ASSERT_TRUE(before.open());
    EXPECT_EQ(before.pick(151, 100), kWallBody);
}

TEST(Viewer, BadInputIsTyped) {
    const ViewerSource source{.frame = [] { return small_scene(); }};
    EXPECT_EQ(Viewer({}, small_window()).run().error().where, "ViewerSource::frame");
    ViewerSettings settings = small_window();
    settings.width = 0;
    EXPECT_EQ(Viewer(source, settings).run().error().code, ErrorCode::InvalidArgument);
    settings = small_window();
    settings.steps_per_second = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(Viewer(source, settings).run().error().where, "ViewerSettings::steps_per_second");
    settings = small_window();
    settings.camera->up = dvec3{0.0};
    EXPECT_EQ(Viewer(source, settings).run().error().where, "Camera::up");
    Viewer closed(source, small_window());
    EXPECT_THROW(closed.press("n"), MisuseError);
    EXPECT_THROW((void)closed.pick(0, 0), MisuseError);
    EXPECT_FALSE(closed.layer_visible("shapes"));
}

TEST(Viewer, AFrameThatTurnsInvalidEndsTheRun) {
    int made = 0;
    ViewerSource source{.frame = [&] {
                            DebugFrame frame = small_scene();
                            if (++made == 3) frame.layers[0].triangles[0].vertices[0] = 1u << 30;
                            return frame;
                        },
                        .step = [] { return true; }};
    Viewer viewer(source, small_window());
    const Status status = viewer.run();
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(made, 3);
}

TEST(Viewer, WithoutADisplayIsAnErrorNotAnAbort) {
    const DisplayIs none(nullptr);
    Viewer viewer({.frame = [] { return small_scene(); }}, small_window());
    EXPECT_EQ(viewer.run().error().where, "DISPLAY");
}

}  // namespace
}  // namespace carom
