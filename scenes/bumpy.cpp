#include <carom/scenes/bumpy.hpp>

#include <carom/core/check.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>

#include <glm/geometric.hpp>

#include <array>
#include <cstdint>

namespace carom::scenes {
namespace {

using MeshTriangle = std::array<std::uint32_t, 3>;

double sine(double x) { return sin_cos(x).sin; }

vec3 on_ball(const dvec3& cube_point) {
    const dvec3 p = glm::normalize(cube_point);
    const double radius = 1.0 + 0.12 * sine(9.0 * p.x + 1.0) * sine(8.0 * p.y + 2.0) * sine(7.0 * p.z + 0.5) +
                          0.03 * sine(31.0 * p.x) * sine(29.0 * p.y) * sine(33.0 * p.z);
    return vec3(radius * p);
}

/// Along an edge of the cube, from exactly -1 to exactly 1, so that faces meet exactly.
std::vector<double> grid_lines(int n) {
    std::vector<double> lines(static_cast<std::size_t>(n) + 1);
    for (int i = 0; i <= n; ++i) {
        const SinCos angle = sin_cos((2.0 * i / n - 1.0) * (kPi / 4.0));
        lines[static_cast<std::size_t>(i)] = angle.sin / angle.cos;
    }
    lines.front() = -1.0;
    lines.back() = 1.0;
    return lines;
}

dvec3 point_on_sphere(Random& random, double radius) {
    for (;;) {
        const double x = random.range(-1.0, 1.0);
        const double y = random.range(-1.0, 1.0);
        const dvec3 p{x, y, random.range(-1.0, 1.0)};
        const double length = glm::length(p);
        if (length <= 1.0 && length >= 0.1) return p * (radius / length);
    }
}

}  // namespace

MeshData bumpy(int n) {
    CAROM_REQUIRE(n >= 1, ErrorCode::InvalidArgument, "a bumpy ball needs at least one quad along an edge", MeshData{});
    const std::vector<double> line = grid_lines(n);
    const auto side = static_cast<std::uint32_t>(n) + 1;
    MeshData mesh;
    mesh.vertices.reserve(std::size_t{6} * side * side);
    mesh.triangles.reserve(std::size_t{12} * (side - 1) * (side - 1));
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        const bool upper = face % 2 == 0;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::uint32_t i = 0; i < side; ++i) {
            for (std::uint32_t j = 0; j < side; ++j) {
                dvec3 p{0.0};
                p[axis] = upper ? 1.0 : -1.0;
                p[(axis + 1) % 3] = line[i];
                p[(axis + 2) % 3] = line[j];
                mesh.vertices.push_back(on_ball(p));
            }
        }
        for (std::uint32_t i = 0; i + 1 < side; ++i) {
            for (std::uint32_t j = 0; j + 1 < side; ++j) {
                const std::uint32_t a = first + i * side + j;
                const std::uint32_t b = a + side;
                const std::uint32_t c = b + 1;
                const std::uint32_t d = a + 1;
                mesh.triangles.push_back(upper ? MeshTriangle{a, b, c} : MeshTriangle{a, c, b});
                mesh.triangles.push_back(upper ? MeshTriangle{a, c, d} : MeshTriangle{a, d, c});
            }
        }
    }
    return mesh;
}

std::vector<geo::Ray<float>> bumpy_camera_rays() {
    constexpr int kSide = 707;
    std::vector<geo::Ray<float>> rays;
    rays.reserve(std::size_t{kSide} * kSide);
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const dvec3 direction{(x + 0.5) / kSide - 0.5, 0.5 - (y + 0.5) / kSide, -1.4};
            rays.push_back({.origin = {0.0f, 0.0f, 4.0f}, .direction = vec3(glm::normalize(direction))});
        }
    }
    return rays;
}

std::vector<geo::Ray<float>> bumpy_chords(std::size_t count) {
    constexpr double kRadius = 2.0;
    Random random(4242);
    std::vector<geo::Ray<float>> rays;
    rays.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const dvec3 from = point_on_sphere(random, kRadius);
        const dvec3 to = point_on_sphere(random, kRadius);
        rays.push_back({.origin = vec3(from), .direction = vec3(glm::normalize(to - from))});
    }
    return rays;
}

}  // namespace carom::scenes
