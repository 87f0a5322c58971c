// The automatic camera sees everything that matters, from above, without wasting the picture.
#include <carom/core/check.hpp>
#include <carom/core/random.hpp>
#include <carom/viz/camera.hpp>
#include <carom/viz/layer.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

DebugFrame cloud(std::uint64_t seed, const dvec3& size) {
    Random random(seed);
    DebugFrame frame;
    frame.layers.push_back({.name = to_string(Layer::Shapes)});
    for (int i = 0; i < 500; ++i) {
        const dvec3 p{random.range(-size.x, size.x), random.range(0.0, size.y), random.range(-size.z, size.z)};
        frame.layers[0].vertices.push_back({vec3(p), {0.0f, 1.0f, 0.0f}});
    }
    return frame;
}

/// Where a point of the frame falls in the picture: both in [-1, 1] if it is seen. z: distance along the view.
dvec3 project(const Camera& camera, const dvec3& world, double aspect) {
    const dvec3 view = glm::normalize(camera.target - camera.position);
    const dvec3 right = glm::normalize(glm::cross(view, camera.up));
    const dvec3 up = glm::cross(right, view);
    const dvec3 d = world - camera.position;
    const double depth = glm::dot(d, view), half = std::tan(0.5 * camera.field_of_view);
    return {glm::dot(d, right) / (depth * half * aspect), glm::dot(d, up) / (depth * half), depth};
}

TEST(Camera, SeesEveryPointAndFillsThePicture) {
    std::uint64_t seed = 300;
    for (const dvec3 size : {dvec3{1, 1, 1}, dvec3{40, 1, 2}, dvec3{0.01, 5, 0.01}, dvec3{1e-3, 1e-3, 1e-3}, dvec3{2e4, 1e3, 2e4}}) {
        for (const double aspect : {1.6, 0.5}) {
            DebugFrame frame = cloud(++seed, size);
            frame.origin = {1e6, -2e5, 3e4};
            const CameraAngle angle{.azimuth = 0.1 * static_cast<double>(seed), .elevation = 0.5, .field_of_view = 0.5, .margin = 0.05};
            const Camera camera = automatic_camera(frame, aspect, angle);
            ASSERT_TRUE(validate(camera));
            EXPECT_GT(glm::dot(camera.position - camera.target, frame.up), 0.0);
            double reach = 0.0;
            for (const DebugVertex& v : frame.layers[0].vertices) {
                const dvec3 p = project(camera, frame.origin + dvec3(v.position), aspect);
                EXPECT_GT(p.z, 0.0);
                reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
            }
            EXPECT_LT(reach, 0.9 + 1e-3);  // the margin, and what 1e6 m leave of a millimetre
            EXPECT_GT(reach, 0.85);
        }
    }
}

TEST(Camera, OneBodyFarAwayDoesNotShrinkTheRest) {
    DebugFrame frame = cloud(77, {5, 3, 5});
    const Camera before = automatic_camera(frame, 1.6);
    frame.layers[0].vertices.push_back({{9000.0f, -4000.0f, 0.0f}, {0.0f, 1.0f, 0.0f}});
    const Camera after = automatic_camera(frame, 1.6);
    EXPECT_NEAR(glm::length(after.position - after.target), glm::length(before.position - before.target), 1e-9);
}

TEST(Camera, StaticShapesCountOnlyWhereNothingMoves) {
    DebugFrame frame = cloud(78, {1, 1, 1});
    frame.layers.push_back({.name = to_string(Layer::Static)});
    frame.layers[1].points.push_back({{200.0f, 0.0f, 0.0f}, {}, {}});
    const Camera both = automatic_camera(frame, 1.6);
    EXPECT_LT(glm::length(both.target), 3.0);
    frame.layers[0].vertices.clear();
    EXPECT_NEAR(automatic_camera(frame, 1.6).target.x, 200.0, 1e-9);
}

TEST(Camera, AnyUpDirectionWorks) {
    for (const dvec3 up : {dvec3{0, 0, 1}, dvec3{1, 0, 0}, dvec3{0, -1, 0}, dvec3{0, 0, -1}}) {
        DebugFrame frame = cloud(79, {1, 1, 1});
        frame.up = up;
        const Camera camera = automatic_camera(frame, 1.6);
        EXPECT_TRUE(validate(camera));
        EXPECT_GT(glm::dot(glm::normalize(camera.position - camera.target), up), 0.4);
    }
}

TEST(Camera, BadInputIsNamed) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Camera camera;
    camera.position.x = nan;
    EXPECT_EQ(validate(camera).error().code, ErrorCode::NotFinite);
    camera = {};
    camera.target = camera.position;
    EXPECT_EQ(validate(camera).error().where, "Camera::target");
    camera = {};
    camera.up = camera.target - camera.position;
    EXPECT_EQ(validate(camera).error().where, "Camera::up");
    camera = {};
    camera.field_of_view = 3.5;
    EXPECT_EQ(validate(camera).error().where, "Camera::field_of_view");
    EXPECT_TRUE(validate(automatic_camera(DebugFrame{}, 1.6)));  // nothing to see: the default
    for (const double aspect : {0.0, -1.0, nan}) EXPECT_THROW((void)automatic_camera(DebugFrame{}, aspect), MisuseError);
    EXPECT_THROW((void)automatic_camera(DebugFrame{}, 1.6, {.elevation = 2.0}), MisuseError);
    EXPECT_THROW((void)automatic_camera(DebugFrame{}, 1.6, {.margin = nan}), MisuseError);
}

}  // namespace
}  // namespace carom
