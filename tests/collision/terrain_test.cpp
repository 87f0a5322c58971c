// Grids over a height function and fractal terrain.
#include <carom/collision/terrain.hpp>
#include <carom/core/check.hpp>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace carom {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

constexpr auto wave = [](double x, double z) { return 0.25 * x * x - 0.5 * z + 0.125 * x * z; };

TEST(HeightGrid, VerticesLieOnTheFunction) {
    const MeshData mesh = height_grid(6, 4, 0.5, wave);
    ASSERT_EQ(mesh.vertices.size(), 7u * 5u);
    ASSERT_EQ(mesh.triangles.size(), 2u * 6u * 4u);
    for (int j = 0; j <= 4; ++j) {
        for (int i = 0; i <= 6; ++i) {
            const double x = (i - 3) * 0.5, z = (j - 2) * 0.5;
            const vec3& v = mesh.vertices[static_cast<std::size_t>(j * 7 + i)];
            EXPECT_EQ(v, vec3(dvec3(x, wave(x, z), z)));
        }
    }
}

TEST(HeightGrid, QuadsAreSplitAsStatedAndLookUp) {
    const MeshData mesh = height_grid(6, 4, 0.5, wave);
    EXPECT_EQ(mesh.triangles[0], (std::array<std::uint32_t, 3>{0, 7, 8}));
    EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{0, 8, 1}));
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
        const dvec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
        const double up = 0.5 * glm::cross(b - a, c - a).y;
        EXPECT_GT(up, 0.0);
        area += up;
    }
    EXPECT_NEAR(area, 3.0 * 2.0, 1e-12);
}

TEST(HeightGrid, MisuseIsReported) {
    const auto flat = [](double, double) { return 0.0; };
    EXPECT_THROW(static_cast<void>(height_grid(0, 4, 1.0, flat)), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, -1, 1.0, flat)), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, 5000, 1.0, flat)), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, 4, 0.0, flat)), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, 4, kNaN, flat)), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, 4, 1.0, [](double, double) { return kNaN; })), MisuseError);
    EXPECT_THROW(static_cast<void>(height_grid(4, 4, 1.0, [](double, double) { return 1e300; })), MisuseError);
}

TEST(DiamondSquare, TheSeedDecidesEverything) {
    const TerrainSettings settings{.level = 5, .seed = 42};
    const MeshData a = diamond_square(settings), b = diamond_square(settings);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
    TerrainSettings other = settings;
    other.seed = 43;
    EXPECT_NE(a.vertices, diamond_square(other).vertices);
}

TEST(DiamondSquare, EveryLevelHasItsSizeAndBound) {
    for (int level = 1; level <= 8; ++level) {
        const TerrainSettings settings{.level = level, .spacing = 0.25, .roughness = 0.6, .height = 1.5, .seed = 11};
        const MeshData mesh = diamond_square(settings);
        const std::size_t side = (std::size_t{1} << level) + 1;
        ASSERT_EQ(mesh.vertices.size(), side * side);
        ASSERT_EQ(mesh.triangles.size(), 2 * (side - 1) * (side - 1));
        double bound = settings.height, factor = 1.0;
        for (int k = 1; k <= level; ++k) {
            factor *= settings.roughness;
            bound += 2.0 * settings.height * factor;
        }
        for (const vec3& v : mesh.vertices) {
            EXPECT_LE(std::abs(static_cast<double>(v.y)), bound * (1 + 1e-6));
        }
    }
}

TEST(DiamondSquare, WithoutNoiseTheInsideIsTheMeanOfTheCorners) {
    const MeshData mesh = diamond_square({.level = 1, .roughness = 0.0, .height = 2.0, .seed = 5});
    const auto y = [&](std::size_t i) { return static_cast<double>(mesh.vertices[i].y); };
    // Row by row: 0 1 2 / 3 4 5 / 6 7 8.
    const double centre = (y(0) + y(2) + y(6) + y(8)) / 4.0;
    EXPECT_NE(y(0), y(2));
    EXPECT_NEAR(y(4), centre, 1e-6);
    EXPECT_NEAR(y(1), (y(0) + y(2) + centre) / 3.0, 1e-6);
    EXPECT_NEAR(y(3), (y(0) + y(6) + centre) / 3.0, 1e-6);
    EXPECT_NEAR(y(5), (y(2) + y(8) + centre) / 3.0, 1e-6);
    EXPECT_NEAR(y(7), (y(6) + y(8) + centre) / 3.0, 1e-6);
}

TEST(DiamondSquare, EveryLevelAddsNoise) {
    // With the noise of all levels alike, each point differs from the mean of its neighbours on the grid around.
    const MeshData mesh = diamond_square({.level = 4, .roughness = 1.0, .seed = 6});
    std::size_t equal = 0;
    for (std::size_t j = 1; j < 16; ++j) {
        for (std::size_t i = 1; i < 16; ++i) {
            const auto y = [&](std::size_t a, std::size_t b) { return mesh.vertices[b * 17 + a].y; };
            const float mean = (y(i - 1, j) + y(i + 1, j) + y(i, j - 1) + y(i, j + 1)) / 4.0f;
            equal += std::abs(y(i, j) - mean) < 1e-4f ? 1 : 0;
        }
    }
    EXPECT_LE(equal, 2u);
}

TEST(DiamondSquare, TheRimRisesOutsideAndNowhereElse) {
    TerrainSettings settings{.level = 5, .spacing = 0.5, .seed = 9};
    const MeshData open = diamond_square(settings);
    settings.rim = true;
    const MeshData rimmed = diamond_square(settings);
    const double side = 16.0;
    for (std::size_t k = 0; k < open.vertices.size(); ++k) {
        const dvec3 a(open.vertices[k]), b(rimmed.vertices[k]);
        const double out = std::max(std::abs(a.x), std::abs(a.z));
        if (out <= 0.375 * side) {
            EXPECT_EQ(a, b);
        } else {
            EXPECT_GT(b.y, a.y);
            EXPECT_NEAR(b.y - a.y, rim_height(settings, a.x, a.z), 1e-6);
        }
    }
    EXPECT_DOUBLE_EQ(rim_height(settings, 8.0, 0.0), 1.6);
    EXPECT_DOUBLE_EQ(rim_height(settings, -7.0, 2.0), 0.4);
    EXPECT_EQ(rim_height({.level = 5, .rim = false}, 8.0, 0.0), 0.0);
}

TEST(DiamondSquare, MisuseIsReported) {
    const auto refuses = [](TerrainSettings settings) {
        EXPECT_THROW(static_cast<void>(diamond_square(settings)), MisuseError);
    };
    refuses({.level = 0});
    refuses({.level = 13});
    refuses({.spacing = 0.0});
    refuses({.spacing = kNaN});
    refuses({.roughness = -0.1});
    refuses({.roughness = 1.1});
    refuses({.height = -1.0});
    refuses({.height = std::numeric_limits<double>::infinity()});
}

}  // namespace
}  // namespace carom
