#include <carom/scenes/meshes.hpp>

#include <carom/collision/teapot.hpp>
#include <carom/collision/terrain.hpp>
#include <carom/core/check.hpp>
#include <carom/core/math.hpp>

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace carom::scenes {
namespace {

struct Recipe {
    MeshInfo info;
    std::function<Result<MeshData>()> make;
};

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all{
        {{"teapot", "the Utah teapot, 1 m from handle to spout, within 0.5 mm of its patches; open at rim, handle and spout"},
         [] { return teapot(1.0, 5e-4); }},
        {{"terrain", "fractal hills of 64 x 64 m, 32,768 triangles; open at its border"},
         []() -> Result<MeshData> { return diamond_square({.level = 7, .height = 3.0, .seed = 7}); }},
        {{"bumpy", "a ball of bumps, 69,312 triangles, closed"}, []() -> Result<MeshData> { return bumpy_sphere(76); }},
        {{"bumpy1m", "the same with 1,002,252 triangles"}, []() -> Result<MeshData> { return bumpy_sphere(289); }},
    };
    return all;
}

// tan(x) at n + 1 equal angles from -45 to 45 degrees. The ends are exact, and the two halves mirror each other, so that faces which
// share an edge of the cube agree on its vertices.
std::vector<double> grid_lines(int n) {
    std::vector<double> lines(static_cast<std::size_t>(n) + 1, 0.0);
    for (int i = 0; 2 * i < n; ++i) {
        const SinCos angle = sin_cos((1.0 - 2.0 * i / n) * kPi / 4.0);
        const double line = i == 0 ? 1.0 : angle.sin / angle.cos;
        lines[static_cast<std::size_t>(i)] = -line;
        lines[static_cast<std::size_t>(n - i)] = line;
    }
    return lines;
}

}  // namespace

std::span<const MeshInfo> mesh_catalogue() {
    static const std::vector<MeshInfo> infos = [] {
        std::vector<MeshInfo> out;
        for (const Recipe& recipe : recipes()) {
            out.push_back(recipe.info);
        }
        return out;
    }();
    return infos;
}

Result<MeshData> make_mesh(const std::string& name) {
    std::string names;
    for (const Recipe& recipe : recipes()) {
        if (recipe.info.name == name) {
            Result<MeshData> mesh = recipe.make();
            return mesh ? Result<MeshData>(weld(*mesh)) : mesh;
        }
        names += (names.empty() ? "" : ", ") + recipe.info.name;
    }
    return Error{ErrorCode::UnknownName, fmt::format("no mesh is called \"{}\"; there are {}", name, names), "mesh"};
}

MeshData cube_sphere(int n, FunctionRef<double(const dvec3& direction)> radius) {
    CAROM_REQUIRE(n >= 1 && n <= 2048, ErrorCode::InvalidArgument, "cube_sphere: n must be in 1..2048", {});
    const std::vector<double> lines = grid_lines(n);
    const auto row = static_cast<std::uint32_t>(n + 1);
    MeshData mesh;
    for (int face = 0; face < 6; ++face) {
        const int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        const bool back = face % 2 != 0;
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const double u : lines) {
            for (const double v : lines) {
                dvec3 p{0.0};
                p[a] = back ? -1.0 : 1.0;
                p[b] = u;
                p[c] = v;
                p /= std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
                const double r = radius(p);
                CAROM_REQUIRE(is_finite(r), ErrorCode::NotFinite, "cube_sphere: the radius is not finite", {});
                mesh.vertices.push_back(vec3(r * p));
            }
        }
        for (std::uint32_t i = 0; i + 1 < row; ++i) {
            for (std::uint32_t j = 0; j + 1 < row; ++j) {
                const std::uint32_t p = first + i * row + j, q = p + row;
                const std::array<std::uint32_t, 4> quad = back ? std::array{p, p + 1, q + 1, q} : std::array{p, q, q + 1, p + 1};
                mesh.triangles.push_back({quad[0], quad[1], quad[2]});
                mesh.triangles.push_back({quad[0], quad[2], quad[3]});
            }
        }
    }
    return weld(mesh);
}

MeshData bumpy_sphere(int n) {
    const auto sine = [](double x) { return sin_cos(x).sin; };
    return cube_sphere(n, [&](const dvec3& p) {
        return 1.0 + 0.12 * sine(9.0 * p.x + 1.0) * sine(8.0 * p.y + 2.0) * sine(7.0 * p.z + 0.5) +
               0.03 * sine(31.0 * p.x) * sine(29.0 * p.y) * sine(33.0 * p.z);
    });
}

}  // namespace carom::scenes
