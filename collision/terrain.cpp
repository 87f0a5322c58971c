#include <carom/collision/terrain.hpp>

#include <carom/core/check.hpp>
#include <carom/core/random.hpp>

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// Heights on a grid of (2^level + 1)^2 points.
class HeightField {
public:
    explicit HeightField(int side) : side_(side), heights_(index(side, side) + 1, 0.0) {}
    double& at(int i, int j) { return heights_[index(i, j)]; }

    // The mean of the points at the offsets that lie on the grid.
    double mean(int i, int j, const std::array<std::array<int, 2>, 4>& offsets) {
        double sum = 0.0;
        int count = 0;
        for (const auto& [di, dj] : offsets) {
            if (i + di >= 0 && i + di <= side_ && j + dj >= 0 && j + dj <= side_) {
                sum += at(i + di, j + dj);
                ++count;
            }
        }
        return sum / count;
    }

private:
    [[nodiscard]] std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(side_ + 1) + static_cast<std::size_t>(i);
    }
    int side_;
    std::vector<double> heights_;
};

HeightField fractal(const TerrainSettings& settings) {
    const int side = 1 << settings.level;
    HeightField field(side);
    Random random(settings.seed);
    for (int j : {0, side}) {
        for (int i : {0, side}) {
            field.at(i, j) = random.range(-settings.height, settings.height);
        }
    }
    double noise = settings.height;
    for (int step = side; step > 1; step /= 2) {
        const int half = step / 2;
        noise *= settings.roughness;
        for (int j = half; j < side; j += step) {
            for (int i = half; i < side; i += step) {
                field.at(i, j) = field.mean(i, j, {{{-half, -half}, {half, -half}, {-half, half}, {half, half}}}) +
                                 random.range(-noise, noise);
            }
        }
        for (int j = 0; j <= side; j += half) {
            for (int i = (j / half) % 2 == 0 ? half : 0; i <= side; i += step) {
                field.at(i, j) = field.mean(i, j, {{{-half, 0}, {half, 0}, {0, -half}, {0, half}}}) +
                                 random.range(-noise, noise);
            }
        }
    }
    return field;
}

}  // namespace

MeshData height_grid(int nx, int nz, double spacing, FunctionRef<double(double x, double z)> height) {
    CAROM_REQUIRE(nx >= 1 && nx <= 4096 && nz >= 1 && nz <= 4096, ErrorCode::InvalidArgument,
                  "height_grid: nx and nz must be 1..4096", {});
    CAROM_REQUIRE(is_finite(spacing), ErrorCode::NotFinite, "height_grid: spacing must be finite", {});
    CAROM_REQUIRE(spacing > 0.0, ErrorCode::InvalidArgument, "height_grid: spacing must be positive", {});
    MeshData mesh;
    mesh.vertices.reserve(static_cast<std::size_t>(nx + 1) * static_cast<std::size_t>(nz + 1));
    for (int j = 0; j <= nz; ++j) {
        for (int i = 0; i <= nx; ++i) {
            const double x = (i - 0.5 * nx) * spacing, z = (j - 0.5 * nz) * spacing;
            const vec3 vertex{static_cast<float>(x), static_cast<float>(height(x, z)), static_cast<float>(z)};
            CAROM_REQUIRE(is_finite(vertex), ErrorCode::NotFinite, "height_grid: a vertex is not finite in float", {});
            mesh.vertices.push_back(vertex);
        }
    }
    mesh.triangles.reserve(2 * static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz));
    const auto columns = static_cast<std::uint32_t>(nx + 1);
    for (std::uint32_t j = 0; j < static_cast<std::uint32_t>(nz); ++j) {
        for (std::uint32_t i = 0; i + 1 < columns; ++i) {
            const std::uint32_t a = j * columns + i, b = a + columns;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    }
    return mesh;
}

double rim_height(const TerrainSettings& settings, double x, double z) noexcept {
    if (!settings.rim) {
        return 0.0;
    }
    const double side = settings.spacing * (1 << settings.level);
    const double into = std::max(std::abs(x), std::abs(z)) - 0.375 * side;
    if (into <= 0.0) {
        return 0.0;
    }
    const double share = into / (0.125 * side);
    return 0.1 * side * share * share;
}

MeshData diamond_square(const TerrainSettings& settings) {
    CAROM_REQUIRE(is_finite(settings.spacing) && is_finite(settings.roughness) && is_finite(settings.height),
                  ErrorCode::NotFinite, "diamond_square: spacing, roughness and height must be finite", {});
    CAROM_REQUIRE(settings.level >= 1 && settings.level <= 12, ErrorCode::InvalidArgument,
                  "diamond_square: level must be 1..12", {});
    CAROM_REQUIRE(settings.spacing > 0.0, ErrorCode::InvalidArgument, "diamond_square: spacing must be positive", {});
    CAROM_REQUIRE(settings.roughness >= 0.0 && settings.roughness <= 1.0, ErrorCode::InvalidArgument,
                  "diamond_square: roughness must be 0..1", {});
    CAROM_REQUIRE(settings.height >= 0.0, ErrorCode::InvalidArgument, "diamond_square: height must not be negative", {});
    HeightField field = fractal(settings);
    const int side = 1 << settings.level;
    int next = 0;
    return height_grid(side, side, settings.spacing, [&](double x, double z) {
        const int vertex = next++;
        return field.at(vertex % (side + 1), vertex / (side + 1)) + rim_height(settings, x, z);
    });
}

}  // namespace carom
