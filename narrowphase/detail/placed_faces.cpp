#include <carom/narrowphase/detail/feature.hpp>
#include <carom/narrowphase/detail/placed_faces.hpp>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace carom::detail {
namespace {

std::uint32_t edge_name(std::uint32_t a, std::uint32_t b) noexcept {
    return static_cast<std::uint32_t>(scrambled(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b)) >> 33);
}

PlacedFace placed_face(const MeshSide& side, std::uint32_t triangle) noexcept {
    PlacedFace face;
    face.corners = side.corners(triangle);
    face.vertices = side.vertices(triangle);
    const auto& [a, b, c] = face.corners;
    face.box = {glm::min(glm::min(a, b), c), glm::max(glm::max(a, b), c)};
    const dvec3 cross = glm::cross(b - a, c - a);
    const double area = std::sqrt(glm::dot(cross, cross));
    if (area > 0.0) face.normal = cross / area;
    for (std::size_t k = 0; k < 3; ++k) face.names[k] = vertex_name(side.mesh().vertices()[face.vertices[k]]);
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        face.edges[k] = edge_name(face.names[k], face.names[next]);
        face.edge_boxes[k] = {glm::min(face.corners[k], face.corners[next]), glm::max(face.corners[k], face.corners[next])};
    }
    return face;
}

}  // namespace

std::uint32_t vertex_name(const vec3& position) noexcept {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0f)}; };  // -0 is +0
    return static_cast<std::uint32_t>(scrambled(scrambled(bits(position.x) << 32 | bits(position.y)) + bits(position.z)) >> 33);
}

std::uint32_t PlacedFaces::number_of(Placed& placed, std::vector<PlacedFace>& faces, const MeshSide& side, std::uint32_t triangle) {
    if (placed.rounds[triangle] != round_) {
        placed.rounds[triangle] = round_;
        placed.numbers[triangle] = static_cast<std::uint32_t>(faces.size());
        faces.push_back(placed_face(side, triangle));
    }
    return placed.numbers[triangle];
}

void PlacedFaces::place(const MeshSide& a, const MeshSide& b, std::span<const TrianglePair> near, std::span<const TrianglePair> meeting,
                        double reach) {
    first.clear();
    second.clear();
    pairs.clear();
    ++round_;
    const auto make_room = [](Placed& placed, std::size_t count) {
        if (placed.rounds.size() >= count) return;
        placed.rounds.resize(count, 0u);
        placed.numbers.resize(count, 0u);
    };
    make_room(first_placed_, a.mesh().triangles().size());
    make_room(second_placed_, b.mesh().triangles().size());
    for (const TrianglePair& pair : near) {
        const std::uint32_t i = number_of(first_placed_, first, a, pair.a), j = number_of(second_placed_, second, b, pair.b);
        if (!within(first[i].box, second[j].box, reach)) continue;
        while (!meeting.empty() && meeting.front() < pair) meeting = meeting.subspan(1);
        pairs.push_back({i, j, !meeting.empty() && meeting.front() == pair});
    }
}

}  // namespace carom::detail
