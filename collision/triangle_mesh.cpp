#include <carom/collision/triangle_mesh.hpp>

#include <carom/collision/detail/bvh.hpp>
#include <carom/collision/detail/exact_sign.hpp>

#include <algorithm>
#include <numeric>
#include <string>

namespace carom {
namespace {

using Triangle = TriangleMesh::Triangle;

bool before(const vec3& a, const vec3& b) noexcept {
    if (a.x != b.x) {
        return a.x < b.x;
    }
    return a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// @return for each vertex, a number that it shares with every vertex at exactly its position (-0 counts as +0).
std::vector<std::uint32_t> weld(std::span<const vec3> vertices) {
    std::vector<std::uint32_t> order(vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t i, std::uint32_t j) { return before(vertices[i], vertices[j]); });
    std::vector<std::uint32_t> welded(vertices.size());
    std::uint32_t position = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        position += k > 0 && before(vertices[order[k - 1]], vertices[order[k]]) ? 1u : 0u;
        welded[order[k]] = position;
    }
    return welded;
}

/// Each edge of a closed surface is run along once upwards and once downwards in vertex number. A triangle with two corners at
/// one position vanishes in the weld: its other two edges are one edge, and the neighbours meet there.
bool closed(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    const std::vector<std::uint32_t> welded = weld(vertices);
    std::vector<std::uint64_t> up;
    std::vector<std::uint64_t> down;
    up.reserve(triangles.size() * 3 / 2 + 1);
    down.reserve(triangles.size() * 3 / 2 + 1);
    for (const Triangle& t : triangles) {
        const Triangle w{welded[t[0]], welded[t[1]], welded[t[2]]};
        if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) {
            continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint64_t a = w[k];
            const std::uint64_t b = w[(k + 1) % 3];
            (a < b ? up : down).push_back(a < b ? a << 32 | b : b << 32 | a);
        }
    }
    if (up.empty() || up.size() != down.size()) {
        return false;
    }
    std::stable_sort(up.begin(), up.end());
    std::stable_sort(down.begin(), down.end());
    return up == down && std::adjacent_find(up.begin(), up.end()) == up.end();
}

/// True if the corners are exactly collinear: each projection onto a coordinate plane has zero area.
bool degenerate(const vec3& a, const vec3& b, const vec3& c) noexcept {
    return orientation_sign({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0 &&
           orientation_sign({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == 0 &&
           orientation_sign({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == 0;
}

Status check(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    constexpr const char* kWhere = "TriangleMesh::build";
    if (triangles.empty()) {
        return Error{ErrorCode::Empty, "a mesh needs at least one triangle", kWhere};
    }
    if (triangles.size() > Bvh::kMaxTriangles) {
        return Error{ErrorCode::InvalidArgument, "a mesh holds at most 2^29 triangles", kWhere};
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if (!is_finite(vertices[i])) {
            return Error{ErrorCode::NotFinite, "vertex " + std::to_string(i) + " is not finite", kWhere};
        }
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (const std::uint32_t v : triangles[i]) {
            if (v >= vertices.size()) {
                return Error{ErrorCode::InvalidArgument,
                             "triangle " + std::to_string(i) + " names vertex " + std::to_string(v) + " of " +
                                 std::to_string(vertices.size()),
                             kWhere};
            }
        }
    }
    return {};
}

}  // namespace

TriangleMesh::~TriangleMesh() = default;

Result<TriangleMeshPtr> TriangleMesh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    if (Status status = check(vertices, triangles); !status) {
        return status.error();
    }
    std::shared_ptr<TriangleMesh> mesh(new TriangleMesh);
    mesh->vertices_.assign(vertices.begin(), vertices.end());
    mesh->triangles_.assign(triangles.begin(), triangles.end());
    for (const vec3& v : vertices) {
        mesh->bounds_ = merge(mesh->bounds_, {dvec3(v), dvec3(v)});
    }
    for (const Triangle& t : triangles) {
        mesh->degenerate_count_ += degenerate(vertices[t[0]], vertices[t[1]], vertices[t[2]]) ? 1u : 0u;
    }
    mesh->closed_ = closed(vertices, triangles);
    mesh->bvh_ = std::make_unique<const Bvh>(vertices, triangles);
    return TriangleMeshPtr(std::move(mesh));
}

std::array<vec3, 3> TriangleMesh::corners(std::uint32_t index) const noexcept {
    const Triangle& t = triangles_[index];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
}

void TriangleMesh::overlap(const Aabb& box, FunctionRef<bool(std::uint32_t)> visit) const { bvh_->overlap(box, visit); }

void TriangleMesh::visit_nodes(FunctionRef<void(const Aabb&, int)> visit) const { bvh_->visit_nodes(visit); }

}  // namespace carom
