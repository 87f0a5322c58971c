// Pictures: the right colours in the right places, and every failure typed.
#include "scratch.hpp"

#include <carom/viz/reveal.hpp>
#include <carom/viz/vtk/picture.hpp>

#include <gtest/gtest.h>

#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <array>
#include <fstream>
#include <limits>

namespace carom {
namespace {

using Pixel = std::array<int, 3>;

class Image {
public:
    explicit Image(const std::string& path) {
        reader_->SetFileName(path.c_str());
        reader_->Update();
    }
    [[nodiscard]] int width() const { return reader_->GetOutput()->GetDimensions()[0]; }
    [[nodiscard]] int height() const { return reader_->GetOutput()->GetDimensions()[1]; }
    /// From the lower left corner.
    [[nodiscard]] Pixel at(int x, int y) const {
        const auto* p = static_cast<const unsigned char*>(reader_->GetOutput()->GetScalarPointer(x, y, 0));
        return {p[0], p[1], p[2]};
    }
    template <class Predicate>
    [[nodiscard]] int count(Predicate is) const {
        int n = 0;
        for (int y = 0; y < height(); ++y) {
            for (int x = 0; x < width(); ++x) n += is(at(x, y)) ? 1 : 0;
        }
        return n;
    }

private:
    vtkNew<vtkPNGReader> reader_;
};

bool reddish(const Pixel& p) { return p[0] > 90 && p[1] < p[0] / 3 && p[2] < p[0] / 3; }
bool bluish(const Pixel& p) { return p[2] > 70 && p[0] < p[2] / 2 && p[1] < p[2] / 2; }
bool greenish(const Pixel& p) { return p[1] > 80 && p[0] < p[1] && p[2] < p[1] && p[1] - std::max(p[0], p[2]) > 15; }

TEST(Picture, ShowsEachBodyInItsColourWhereItIs) {
    const ScratchFolder folder("picture");
    // Far from the world's origin: relative positions must be drawn as well as near it.
    for (const dvec3 origin : {dvec3{0.0}, dvec3{1e7, -3e6, 2e6}}) {
        DebugFrame frame = small_scene(origin);
        frame.layers[1].visible = false;
        const std::string path = folder / "a.png";
        const Status status = render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera(origin)});
        ASSERT_TRUE(status) << status.error().message;
        const Image image(path);
        ASSERT_EQ(image.width(), 400);
        ASSERT_EQ(image.height(), 200);
        // Half the height is 12 tan(0.25) = 3.064 m, so the bodies' middles are 49 pixels off the picture's.
        EXPECT_TRUE(reddish(image.at(151, 100)));
        EXPECT_TRUE(bluish(image.at(249, 100)));
        EXPECT_FALSE(reddish(image.at(200, 190)) || bluish(image.at(200, 190)));
        // The front of the box, 2 m wide at 11 m, is 71 pixels square; the ball's disc at 12 m about pi 33² pixels.
        EXPECT_NEAR(image.count(reddish), 71 * 71, 0.15 * 71 * 71);
        EXPECT_NEAR(image.count(bluish), 3400, 0.15 * 3400);
        EXPECT_EQ(image.count(greenish), 0);
    }
}

TEST(Picture, WhatIsOnTopShinesThrough) {
    const ScratchFolder folder("on_top");
    const std::string path = folder / "a.png";
    DebugFrame frame = small_scene();
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    const int through = Image(path).count([](const Pixel& p) { return p[1] > 60 && p[1] > p[2] && p[0] < 2 * p[1]; });
    EXPECT_GT(through, 50);
    frame.layers[1].on_top = false;
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    const Image hidden(path);
    EXPECT_TRUE(reddish(hidden.at(151, 100)));
    EXPECT_TRUE(greenish(hidden.at(200, 100)));  // the line between the bodies is in the open
}

TEST(Picture, HiddenBacksShowWhatIsBehindThem) {
    const ScratchFolder folder("backs");
    const std::string path = folder / "a.png";
    DebugFrame frame = with_wall(small_scene(), -1.0f);
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    EXPECT_TRUE(reddish(Image(path).at(151, 100)));
    frame = with_wall(small_scene(), 1.0f);
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    EXPECT_FALSE(reddish(Image(path).at(151, 100)));
}

TEST(Picture, AnOpenedWallShowsWhatIsBehindItAndItsEdges) {
    const ScratchFolder folder("opened");
    const std::string path = folder / "a.png";
    DebugFrame frame = with_wall(small_scene(), 1.0f);
    ASSERT_EQ(reveal(frame, front_camera()), 1u);
    ASSERT_EQ(frame.find("static")->lines.size(), 4u);
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    const Image image(path);
    EXPECT_TRUE(reddish(image.at(151, 100)));
    EXPECT_TRUE(bluish(image.at(249, 100)));
}

TEST(Picture, HiddenLayersAreNotDrawnAndNamesAre) {
    const ScratchFolder folder("layers");
    const std::string path = folder / "a.png";
    DebugFrame frame = small_scene();
    frame.layers[0].visible = frame.layers[1].visible = false;
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    EXPECT_EQ(Image(path).count(reddish), 0);
    frame.layers[2].visible = true;
    ASSERT_TRUE(render_to_png(frame, path, {.width = 400, .height = 200, .camera = front_camera()}));
    EXPECT_GT(Image(path).count(reddish), 30);
}

TEST(Picture, AutomaticCameraAndDefaultSize) {
    const ScratchFolder folder("automatic");
    const std::string path = folder / "a.png";
    ASSERT_TRUE(render_to_png(small_scene(), path));
    const Image image(path);
    EXPECT_EQ(image.width(), 1600);
    EXPECT_EQ(image.height(), 1000);
    EXPECT_GT(image.count(reddish), 40000);
    EXPECT_GT(image.count(bluish), 40000);
    ASSERT_TRUE(render_to_png(DebugFrame{}, path, {.width = 64, .height = 64}));  // nothing to see: the background
    EXPECT_EQ(Image(path).count(reddish), 0);
}

TEST(Picture, BadInputIsTypedAndWritesNothing) {
    const ScratchFolder folder("bad");
    const std::string path = folder / "a.png";
    EXPECT_EQ(render_to_png(small_scene(), path, {.width = 8}).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(render_to_png(small_scene(), path, {.height = 9000}).error().code, ErrorCode::InvalidArgument);
    Camera camera = front_camera();
    camera.target = camera.position;
    EXPECT_EQ(render_to_png(small_scene(), path, {.camera = camera}).error().code, ErrorCode::InvalidArgument);
    DebugFrame frame = small_scene();
    frame.layers[0].vertices[0].position.x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(render_to_png(frame, path).error().code, ErrorCode::NotFinite);
    EXPECT_FALSE(std::filesystem::exists(path));
    for (const std::string& bad : {folder / "no/such/folder/a.png", folder.path()}) {
        const Status status = render_to_png(small_scene(), bad, {.width = 64, .height = 64});
        ASSERT_FALSE(status);
        EXPECT_EQ(status.error().code, ErrorCode::Io);
        EXPECT_NE(status.error().message.find(bad), std::string::npos);
    }
}

TEST(Picture, WithoutADisplayIsAnErrorNotAnAbort) {
    const ScratchFolder folder("display");
    for (const char* display : {static_cast<const char*>(nullptr), "", ":4711"}) {
        const DisplayIs changed(display);
        const Status status = render_to_png(small_scene(), folder / "a.png");
        ASSERT_FALSE(status);
        EXPECT_EQ(status.error().code, ErrorCode::Io);
        EXPECT_EQ(status.error().where, "DISPLAY");
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "a.png"));
}

}  // namespace
}  // namespace carom
