// Pictures of what rays see: against golden files, pixel by pixel, and by what they must show.
//
// After a change of the scene or of the pictures that is meant, draw the golden files anew and look at them:
//
//   CAROM_UPDATE_GOLDEN=1 build/release/bin/test_viz --gtest_filter='*RayPicture*'
#include <carom/core/random.hpp>
#include <carom/scenes/scene.hpp>
#include <carom/viz/png/png_file.hpp>
#include <carom/viz/ray_picture.hpp>

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <thread>
#include <unistd.h>

namespace carom {
namespace {

// The demo with 24 bodies above the big teapot, from a fixed place: nothing here depends on the automatic camera.
RayPictureSettings close_up(RayView view) {
    RayPictureSettings settings{.width = 160, .height = 100, .camera = {}, .view = view};
    settings.camera = {.position = {9, 11, 14}, .target = {0, 4, 0}, .up = {0, 1, 0}, .field_of_view = 0.7};
    return settings;
}

scenes::SceneRun demo() {
    Result<scenes::SceneRun> run = scenes::make_scene("teapots", {.bodies = 24});
    EXPECT_TRUE(run) << run.error().message;
    return std::move(*run);
}

std::string golden(const char* name) { return std::string(CAROM_TEST_DATA) + "/golden/teapots_" + name + ".png"; }

// How many pixels differ; all of them where the sizes do.
std::size_t differences(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height) return a.pixels.size();
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        count += a.pixels[i] != b.pixels[i] ? 1 : 0;
    }
    return count;
}

class RayPicture : public testing::TestWithParam<std::pair<const char*, RayView>> {};
INSTANTIATE_TEST_SUITE_P(Views, RayPicture,
                         testing::Values(std::pair{"depth", RayView::Depth}, std::pair{"normal", RayView::Normal}, std::pair{"id", RayView::Id}),
                         [](const auto& view) { return std::string(view.param.first); });

TEST_P(RayPicture, EqualsTheGoldenFileToTheBit) {
    const auto [name, view] = GetParam();
    const Result<Image> image = draw_rays(demo().world, close_up(view));
    ASSERT_TRUE(image);
    if (std::getenv("CAROM_UPDATE_GOLDEN") != nullptr) {
        ASSERT_TRUE(write_png(*image, golden(name)));
    }
    const Result<Image> expected = read_png(golden(name));
    ASSERT_TRUE(expected) << expected.error().message;
    EXPECT_EQ(differences(*image, *expected), 0u);
}

TEST_P(RayPicture, ShowsABodyThatMovedByTwentyCentimetres) {
    const auto [name, view] = GetParam();
    const Result<Image> expected = read_png(golden(name));
    ASSERT_TRUE(expected) << expected.error().message;
    scenes::SceneRun run = demo();
    const auto bodies = run.world.bodies();
    const auto moving = std::ranges::find_if(bodies, [&](BodyId b) { return run.world.type(b) == BodyType::Dynamic; });
    ASSERT_NE(moving, bodies.end());
    const BodyId body = *moving;
    Pose pose = run.world.pose(body);
    pose.position.y += 0.2;
    run.world.set_pose(body, pose);
    const Result<Image> image = draw_rays(run.world, close_up(view));
    ASSERT_TRUE(image);
    EXPECT_GT(differences(*image, *expected), 3u);
}

// Cuts the range into single indices, from the last to the first, on a thread each.
class BackwardsExecutor final : public Executor {
public:
    int thread_count() const noexcept override { return 2; }
    void parallel_for(std::size_t count, std::size_t, Body body) override {
        std::thread upper([&] {
            for (std::size_t i = count; i-- > count / 2;) body(i, i + 1);
        });
        for (std::size_t i = count / 2; i-- > 0;) body(i, i + 1);
        upper.join();
    }
};

TEST_P(RayPicture, IsTheSameOnManyThreads) {
    const scenes::SceneRun run = demo();
    RayPictureSettings settings = close_up(GetParam().second);
    const Result<Image> serial = draw_rays(run.world, settings);
    BackwardsExecutor executor;
    settings.executor = &executor;
    EXPECT_EQ(*draw_rays(run.world, settings), *serial);
}

// A ball of radius 1 at the origin, seen along -z from 5 m.
std::optional<PixelHit> ball(const Ray& ray) {
    const std::optional<RayHit> hit = cast_ray(Sphere{1.0f}, ray);
    return hit ? std::optional(PixelHit{hit->distance, hit->normal, 3}) : std::nullopt;
}

TEST(RayPictures, ABallIsRoundAndFacesTheCamera) {
    RayPictureSettings settings{.width = 101, .height = 101, .camera = {.position = {0, 0, 5}, .field_of_view = 0.6}, .view = RayView::Normal};
    const Image normals = *draw_rays(ball, settings);
    EXPECT_EQ(normals.at(50, 50), (Image::Pixel{128, 128, 255})) << "towards +z";
    EXPECT_GT(normals.at(75, 50)[0], 200) << "the right side faces +x";
    EXPECT_LT(normals.at(25, 50)[0], 55);
    EXPECT_GT(normals.at(50, 25)[1], 200) << "rows go from top to bottom, and the upper side faces +y";
    EXPECT_EQ(normals.at(0, 0), (Image::Pixel{0, 0, 0})) << "a miss is black";
    // The ball's outline: sin = 1/5, so tan = 0.2041; half the picture is tan 0.3 = 0.3093.
    const double radius = 0.20412 / 0.30934 * 50.5;
    for (int y = 0; y < 101; ++y) {
        for (int x = 0; x < 101; ++x) {
            const double away = std::hypot(x - 50.0, y - 50.0) - radius;
            if (std::abs(away) > 0.01) {
                EXPECT_EQ(normals.at(x, y) == (Image::Pixel{0, 0, 0}), away > 0.0) << x << ' ' << y;
            }
        }
    }
    settings.view = RayView::Depth;
    const Image depth = *draw_rays(ball, settings);
    EXPECT_EQ(depth.at(50, 50), (Image::Pixel{255, 255, 255})) << "nearest is white";
    EXPECT_GT(depth.at(60, 50)[0], depth.at(80, 50)[0]);
    settings.view = RayView::Id;
    const Color color = palette(3);
    EXPECT_EQ(draw_rays(ball, settings)->at(50, 50), (Image::Pixel{color.r, color.g, color.b}));
}

TEST(RayPictures, AFlatWallHasOneDepth) {
    const auto wall = [](const Ray& ray) { return std::optional(PixelHit{3.0 / -ray.direction.z, {0, 0, 1}, 0}); };
    const Image image = *draw_rays(wall, {.width = 7, .height = 5, .camera = {.position = {0, 0, 3}}, .view = RayView::Depth});
    // Rounding may leave an ulp of depth between them, which is then the whole range: all that holds is that none is black.
    for (const Image::Pixel& pixel : image.pixels) {
        EXPECT_GE(pixel[0], 40);
    }
}

TEST(RayPictures, BadSettingsAreRefused) {
    const auto nothing = [](const Ray&) { return std::optional<PixelHit>{}; };
    EXPECT_EQ(draw_rays(nothing, {.width = 0}).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(draw_rays(nothing, {.height = 8193}).error().code, ErrorCode::InvalidArgument);
    EXPECT_FALSE(draw_rays(nothing, {.camera = {.position = {0, 0, 0}}}));
    EXPECT_FALSE(draw_rays(nothing, {.camera = {.position = {0, 0, std::numeric_limits<double>::quiet_NaN()}}}));
    const Image empty = *draw_rays(nothing, {.width = 2, .height = 2});
    EXPECT_EQ(empty, Image(2, 2));
}

TEST(RaySceneTest, GivesWhatTheWorldGivesToTheBit) {
    Random random(9001);
    for (const char* name : {"pile_mixed", "teapots", "mesh_bowl"}) {
        Result<scenes::SceneRun> run = scenes::make_scene(name, {.bodies = 60});
        ASSERT_TRUE(run);
        const RayScene scene(run->world);
        const dvec3 middle = 0.5 * (scene.bounds().lower + scene.bounds().upper), half = scene.bounds().upper - middle;
        int hits = 0;
        for (int i = 0; i < 1000; ++i) {
            const auto draw = [&](double reach) {
                const double x = random.range(-reach, reach), y = random.range(-reach, reach);
                return middle + half * dvec3{x, y, random.range(-reach, reach)};
            };
            Ray ray{.origin = draw(1.2)};
            ray.direction = draw(1.0) - ray.origin;
            if (i % 5 == 0) ray.direction[i / 5 % 3] = i % 2 == 0 ? 0.0 : -0.0;
            if (i % 7 == 0) ray.max_distance = random.range(0.0, 4.0);
            const std::optional<WorldRayHit> expected = run->world.cast_ray(ray), hit = scene.cast_ray(ray);
            ASSERT_EQ(hit.has_value(), expected.has_value()) << name << ' ' << i;
            if (!hit) continue;
            ++hits;
            EXPECT_EQ(hit->body, expected->body);
            EXPECT_EQ(hit->shape, expected->shape);
            EXPECT_EQ(hit->hit.distance, expected->hit.distance);
            EXPECT_EQ(hit->hit.normal, expected->hit.normal);
        }
        EXPECT_GT(hits, 200) << name;
    }
}

TEST(RaySceneTest, PlanesAndBadRays) {
    World world;
    world.add_shape(world.create_body({.type = BodyType::Static}), Plane{});
    const RayScene scene(world);
    EXPECT_TRUE(is_empty(scene.bounds()));
    const auto hit = scene.cast_ray({.origin = {1e5, 2, 0}, .direction = {0, -1, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->hit.distance, 2.0);
    EXPECT_FALSE(scene.cast_ray({.direction = {0, 0, 0}}));
}

class PngFile : public testing::Test {
protected:
    PngFile() : path_(std::filesystem::temp_directory_path() / ("carom_png_" + std::to_string(getpid()) + ".png")) {}
    ~PngFile() override { std::filesystem::remove(path_); }
    std::string path_;
};

TEST_F(PngFile, HoldsThePixels) {
    Image image(37, 11);
    Random random(37);
    for (Image::Pixel& pixel : image.pixels) {
        for (std::uint8_t& channel : pixel) channel = static_cast<std::uint8_t>(random.range(0, 256));
    }
    ASSERT_TRUE(write_png(image, path_));
    const Result<Image> read = read_png(path_);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, image);
}

TEST_F(PngFile, BadInputIsNamed) {
    EXPECT_EQ(write_png(Image{}, path_).error().code, ErrorCode::InvalidArgument);
    Image wrong(2, 2);
    wrong.pixels.pop_back();
    EXPECT_EQ(write_png(wrong, path_).error().code, ErrorCode::InvalidArgument);
    EXPECT_EQ(write_png(Image(2, 2), "/no/such/folder/p.png").error().where, "/no/such/folder/p.png");
    EXPECT_EQ(read_png(path_).error().code, ErrorCode::Io);
    std::ofstream(path_) << "not a picture";
    EXPECT_EQ(read_png(path_).error().code, ErrorCode::Parse);
    ASSERT_TRUE(write_png(Image(64, 64), path_));
    std::filesystem::resize_file(path_, std::filesystem::file_size(path_) / 2);
    EXPECT_EQ(read_png(path_).error().code, ErrorCode::Parse) << "cut off";
}

}  // namespace
}  // namespace carom
