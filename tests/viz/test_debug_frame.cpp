// Frames as values: layers by name, colours, validation.
#include <carom/viz/debug_frame.hpp>
#include <carom/viz/layer.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

namespace carom {
namespace {

DebugFrame small_frame() {
    DebugFrame frame;
    DebugLayer shapes{.name = "shapes"};
    shapes.vertices.resize(3);
    shapes.triangles.push_back({{0, 1, 2}, palette(0), {}});
    frame.layers = {shapes, DebugLayer{.name = "contacts"}};
    frame.layers[1].points.push_back({{1.0f, 2.0f, 3.0f}, palette(1), {}});
    frame.layers[1].lines.push_back({vec3{0.0f}, vec3{1.0f}, palette(1), {}});
    frame.layers[1].texts.push_back({vec3{0.0f}, "here", palette(1), {}});
    return frame;
}

void expect_fault(const DebugFrame& frame, ErrorCode code, const char* where) {
    const Status status = validate(frame);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, code);
    EXPECT_NE(status.error().where.find(where), std::string::npos) << status.error().where;
}

TEST(DebugFrame, FindsLayersByName) {
    DebugFrame frame = small_frame();
    EXPECT_EQ(frame.find("contacts"), &frame.layers[1]);
    EXPECT_EQ(frame.find("nothing"), nullptr);
    EXPECT_FALSE(frame.layers[0].empty());
    EXPECT_TRUE(DebugLayer{}.empty());
    EXPECT_TRUE(validate(frame));
}

TEST(DebugFrame, LayersOfAWorldHaveDistinctNames) {
    std::set<std::string> names;
    for (int i = 0; i < kLayerCount; ++i) names.insert(to_string(static_cast<Layer>(i)));
    EXPECT_EQ(names.size(), static_cast<std::size_t>(kLayerCount));
    EXPECT_EQ(names.count("unknown"), 0u);
}

TEST(DebugFrame, EveryFaultIsFoundAndNamed) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    DebugFrame frame = small_frame();
    frame.layers[0].triangles[0].vertices[2] = 3;
    expect_fault(frame, ErrorCode::InvalidArgument, "shapes");
    frame = small_frame();
    frame.layers[0].vertices[1].normal.y = nan;
    expect_fault(frame, ErrorCode::NotFinite, "shapes");
    frame = small_frame();
    frame.layers[1].points[0].position.x = infinity;
    expect_fault(frame, ErrorCode::NotFinite, "contacts");
    frame = small_frame();
    frame.layers[1].lines[0].b.z = nan;
    expect_fault(frame, ErrorCode::NotFinite, "contacts");
    frame = small_frame();
    frame.layers[1].texts[0].position.z = nan;
    expect_fault(frame, ErrorCode::NotFinite, "contacts");
    frame = small_frame();
    frame.layers[1].point_size = 0.0f;
    expect_fault(frame, ErrorCode::InvalidArgument, "contacts");
    frame = small_frame();
    frame.layers[1].line_width = infinity;
    expect_fault(frame, ErrorCode::InvalidArgument, "contacts");
    frame = small_frame();
    frame.layers[1].name = "shapes";
    expect_fault(frame, ErrorCode::InvalidArgument, "shapes");
    for (const char* name : {"", "../up", "a b"}) {
        frame = small_frame();
        frame.layers[1].name = name;
        expect_fault(frame, ErrorCode::InvalidArgument, "layer");
    }
    frame = small_frame();
    frame.origin.x = static_cast<double>(nan);
    expect_fault(frame, ErrorCode::NotFinite, "origin");
    frame = small_frame();
    frame.up = dvec3{0.0};
    expect_fault(frame, ErrorCode::InvalidArgument, "up");
}

TEST(Color, PaletteColoursAreFarApartAndWrapRound) {
    for (std::uint32_t i = 0; i < kPaletteSize; ++i) {
        EXPECT_EQ(palette(i), palette(i + kPaletteSize));
        for (std::uint32_t j = 0; j < i; ++j) {
            const Color a = palette(i), b = palette(j);
            EXPECT_GT(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b), 60) << i << " and " << j;
        }
    }
}

TEST(Color, MixRunsFromOneToTheOther) {
    const Color a{0, 100, 200, 255}, b{100, 0, 200, 55};
    EXPECT_EQ(mix(a, b, 0.0), a);
    EXPECT_EQ(mix(a, b, 1.0), b);
    EXPECT_EQ(mix(a, b, 0.5), (Color{50, 50, 200, 155}));
    EXPECT_EQ(mix(a, b, -3.0), a);
    EXPECT_EQ(mix(a, b, 7.0), b);
    EXPECT_EQ(mix(a, b, std::nan("")), a);
}

}  // namespace
}  // namespace carom
