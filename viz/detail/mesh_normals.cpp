#include <carom/viz/detail/mesh_normals.hpp>

#include <cmath>

namespace carom::detail {
namespace {

constexpr double kCreaseCosine = 0.766;  // 40 degrees

dvec3 unit_or(const dvec3& v, const dvec3& fallback) {
    const double length = std::sqrt(glm::dot(v, v));
    return length > 0.0 ? v / length : fallback;
}

}  // namespace

std::vector<vec3> corner_normals(std::span<const vec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles) {
    std::vector<dvec3> area(triangles.size()), unit(triangles.size());
    std::vector<std::uint32_t> first(vertices.size() + 1, 0);  // triangles of vertex v: sharing[first[v] .. first[v + 1])
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const dvec3 a(vertices[triangles[t][0]]), b(vertices[triangles[t][1]]), c(vertices[triangles[t][2]]);
        area[t] = glm::cross(b - a, c - a);
        unit[t] = unit_or(area[t], {0.0, 1.0, 0.0});
        for (const std::uint32_t v : triangles[t]) ++first[v + 1];
    }
    for (std::size_t v = 0; v < vertices.size(); ++v) first[v + 1] += first[v];
    std::vector<std::uint32_t> sharing(3 * triangles.size()), next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::uint32_t v : triangles[t]) sharing[next[v]++] = static_cast<std::uint32_t>(t);
    }
    std::vector<vec3> normals;
    normals.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (const std::uint32_t v : triangles[t]) {
            dvec3 sum{0.0};
            for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) {
                if (glm::dot(unit[sharing[k]], unit[t]) > kCreaseCosine) sum += area[sharing[k]];
            }
            normals.push_back(vec3(unit_or(sum, unit[t])));
        }
    }
    return normals;
}

}  // namespace carom::detail
