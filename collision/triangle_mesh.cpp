#include <carom/collision/triangle_mesh.hpp>

#include <carom/collision/detail/check_mesh.hpp>
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/wide_build.hpp>
#include <carom/collision/detail/wide_overlap.hpp>

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

/// The box of the tree below `ref`, whose own box is `box`, parents first.
void visit_below(const WideBvh& tree, WideRef ref, const Aabb& box, int depth, FunctionRef<void(const Aabb&, int)> visit) {
    visit(box, depth);
    if (is_leaf(ref)) return;
    const WideNode& node = tree.node(ref);
    const double unit = 1.0 / static_cast<double>(tree.scale);
    for (int i = 0; i < child_count(node); ++i) {
        const dvec3 lower(node.bound[0][0][i], node.bound[0][1][i], node.bound[0][2][i]);
        const dvec3 upper(node.bound[1][0][i], node.bound[1][1][i], node.bound[1][2][i]);
        visit_below(tree, node.child[i], {unit * lower, unit * upper}, depth + 1, visit);
    }
}

}  // namespace

TriangleMesh::~TriangleMesh() = default;

Result<TriangleMeshPtr> TriangleMesh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles) {
    SerialExecutor serial;
    return build(vertices, triangles, serial);
}

Result<TriangleMeshPtr> TriangleMesh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles, Executor& executor) {
    if (Status status = check_mesh(vertices, triangles, "TriangleMesh::build"); !status) {
        return status.error();
    }
    std::shared_ptr<TriangleMesh> mesh(new TriangleMesh(StaticBvh(build_wide_bvh(vertices, triangles, executor))));
    mesh->vertices_.assign(vertices.begin(), vertices.end());
    mesh->triangles_.assign(triangles.begin(), triangles.end());
    for (const vec3& v : vertices) {
        mesh->bounds_ = merge(mesh->bounds_, {dvec3(v), dvec3(v)});
    }
    for (const Triangle& t : triangles) {
        mesh->degenerate_count_ += degenerate(vertices[t[0]], vertices[t[1]], vertices[t[2]]) ? 1u : 0u;
    }
    mesh->closed_ = closed(vertices, triangles);
    return TriangleMeshPtr(std::move(mesh));
}

std::array<vec3, 3> TriangleMesh::corners(std::uint32_t index) const noexcept {
    const Triangle& t = triangles_[index];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
}

void TriangleMesh::overlap(const Aabb& box, FunctionRef<bool(std::uint32_t)> visit) const {
    if (bvh_.wide().lossless) {
        visit_overlaps(bvh_.wide(), box, visit);
        return;
    }
    visit_overlaps(bvh_.wide(), box, [&](std::uint32_t triangle) {
        const auto [a, b, c] = corners(triangle);
        const Aabb own{dvec3(glm::min(a, glm::min(b, c))), dvec3(glm::max(a, glm::max(b, c)))};
        return !overlaps(box, own) || visit(triangle);
    });
}

void TriangleMesh::visit_nodes(FunctionRef<void(const Aabb&, int)> visit) const {
    visit_below(bvh_.wide(), WideBvh::root(), bvh_.bounds(), 0, visit);
}

}  // namespace carom
