#include <carom/collision/mesh_data.hpp>

#include <algorithm>
#include <limits>
#include <tuple>

namespace carom {

MeshData weld(const MeshData& mesh) {
    // Adding +0 turns -0 into +0, so equal positions have equal keys.
    const auto key = [&](std::uint32_t v) {
        const vec3& p = mesh.vertices[v];
        return std::tuple(p.x + 0.0f, p.y + 0.0f, p.z + 0.0f);
    };
    std::vector<std::uint32_t> order(mesh.vertices.size());
    for (std::uint32_t v = 0; v < order.size(); ++v) {
        order[v] = v;
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });

    std::vector<std::uint32_t> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && key(order[i - 1]) == key(order[i]);
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }

    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> renamed(order.size(), kUnused);
    MeshData welded;
    for (const auto& triangle : mesh.triangles) {
        const std::array<std::uint32_t, 3> corners{first[triangle[0]], first[triangle[1]], first[triangle[2]]};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
            continue;
        }
        auto& out = welded.triangles.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            std::uint32_t& name = renamed[corners[k]];
            if (name == kUnused) {
                name = static_cast<std::uint32_t>(welded.vertices.size());
                welded.vertices.push_back(mesh.vertices[corners[k]] + vec3{0.0f});
            }
            out[k] = name;
        }
    }
    return welded;
}

}  // namespace carom
