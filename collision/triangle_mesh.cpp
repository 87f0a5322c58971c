#include <carom/collision/triangle_mesh.hpp>

#include <carom/collision/detail/check_mesh.hpp>
#include <carom/collision/detail/closed_surface.hpp>
#include <carom/collision/detail/convex_solid.hpp>
#include <carom/collision/detail/exact_sign.hpp>
#include <carom/collision/detail/wide_build.hpp>
#include <carom/collision/detail/wide_overlap.hpp>

#include <utility>

namespace carom {
namespace {

using Triangle = TriangleMesh::Triangle;

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

Result<TriangleMeshPtr> TriangleMesh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles,
                                            const TriangleMeshSettings& settings) {
    SerialExecutor serial;
    return build(vertices, triangles, serial, settings);
}

Result<TriangleMeshPtr> TriangleMesh::build(std::span<const vec3> vertices, std::span<const Triangle> triangles, Executor& executor,
                                            const TriangleMeshSettings& settings) {
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
    const SurfaceKind kind = surface_kind(vertices, triangles);
    mesh->closed_ = kind == SurfaceKind::Closed;
    mesh->oriented_ = kind != SurfaceKind::Loose;
    if (mesh->closed_) mesh->solid_ = detail::convex_solid(vertices, triangles);
    mesh->one_sided_ = settings.one_sided;
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
