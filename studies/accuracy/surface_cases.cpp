#include <carom/studies/accuracy/surface_cases.hpp>

#include <carom/collision/aabb.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/mesh_data.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/studies/accuracy/any_direction.hpp>
#include <carom/studies/oracle/brute_force.hpp>
#include <carom/studies/oracle/hull_surface.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace carom::accuracy {
namespace {

using oracle::seeded_surface_of;
using oracle::surface_of;

dquat any_turn(Random& random) { return rotation_from_vector(random.range(0.0, kPi) * any_direction(random)); }

Shape any_solid(Solids solids, Random& random) {
    const auto size = [&] { return static_cast<float>(random.range(0.4, 1.0)); };
    const vec3 scale{size(), size(), size()};
    if (solids == Solids::Boxes) return Box{scale};
    std::vector<vec3> points;
    for (int i = 0; i < 32; ++i) points.push_back(scale * vec3(any_direction(random)));
    return *ConvexHull::build(points);
}

oracle::Solid solid_at(const Shape& shape, const Pose& pose) {
    const Box* box = std::get_if<Box>(&shape);
    return box != nullptr ? oracle::solid_of(*box, pose, dvec3{0.0}) : oracle::solid_of(*std::get<ConvexHullPtr>(shape), pose, dvec3{0.0});
}

ConvexHullPtr hull_of(const Shape& shape) {
    const Box* box = std::get_if<Box>(&shape);
    return box != nullptr ? *ConvexHull::build(oracle::corners_of(*box)) : std::get<ConvexHullPtr>(shape);
}

// Six sides of n x n quads; corners of neighbouring sides are at the same positions.
TriangleMeshPtr surface_of(const Box& box, int n) {
    MeshData mesh;
    const auto step = [n](int i) { return 2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f; };
    for (int face = 0; face < 6; ++face) {
        const int axis = face % 3, u = (axis + 1) % 3, w = (axis + 2) % 3;
        const bool upper = face < 3;
        const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
        const auto at = [&](int i, int k) { return base + static_cast<std::uint32_t>(i * (n + 1) + k); };
        for (int i = 0; i <= n; ++i) {
            for (int k = 0; k <= n; ++k) {
                vec3 p{0.0f};
                p[axis] = upper ? box.half_extents[axis] : -box.half_extents[axis];
                p[u] = box.half_extents[u] * step(i);
                p[w] = box.half_extents[w] * step(k);
                mesh.vertices.push_back(p);
            }
        }
        for (int i = 0; i < n; ++i) {
            for (int k = 0; k < n; ++k) {
                const std::uint32_t a = at(i, k), b = at(i + 1, k), c = at(i + 1, k + 1), d = at(i, k + 1);
                mesh.triangles.push_back(upper ? TriangleMesh::Triangle{a, b, c} : TriangleMesh::Triangle{a, c, b});
                mesh.triangles.push_back(upper ? TriangleMesh::Triangle{a, c, d} : TriangleMesh::Triangle{a, d, c});
            }
        }
    }
    return *TriangleMesh::build(mesh.vertices, mesh.triangles);
}

}  // namespace

ManifoldCasesPtr solid_cases(Solids solids, std::size_t count, const DepthRange& range, std::uint64_t seed) {
    auto cases = std::make_shared<ManifoldCases>();
    Random random(seed);
    while (cases->depth.size() < count) {
        const Shape a = any_solid(solids, random), b = any_solid(solids, random);
        const Pose pose_a{dvec3{0.0}, any_turn(random)};
        Pose pose_b{any_direction(random) * random.range(0.5, 1.5), any_turn(random)};
        const double extent = std::min(smallest_extent(a), smallest_extent(b)), wanted = random.range(range.least, range.most) * extent;
        const oracle::Solid first = solid_at(a, pose_a);
        const oracle::Separation before = oracle::greatest_separation(first, solid_at(b, pose_b));
        // Moved along the axis that parts them best until they overlap by so much along it; where another one is better then, by less.
        const double way = static_cast<double>(before.value) + wanted;
        pose_b.position -= way * dvec3(before.normal);
        const auto depth = -static_cast<double>(oracle::greatest_separation(first, solid_at(b, pose_b)).value);
        if (!(depth > range.least * extent)) continue;
        cases->add(a, pose_a, b, pose_b);
        cases->depth.push_back(depth);
    }
    cases->number(0.0f);
    return cases;
}

ManifoldCasesPtr pierced_cases(std::size_t count, std::uint64_t seed) {
    auto cases = std::make_shared<ManifoldCases>();
    Random random(seed);
    const auto thin = [&] { return static_cast<float>(random.range(0.01, 0.05)); };
    const auto wide = [&] { return static_cast<float>(random.range(0.2, 0.5)); };
    for (std::size_t k = 0; k < count; ++k) {
        const vec3 bar{thin(), 1.0f, thin()}, plate{wide(), thin(), wide()};
        const Pose pose_b{dvec3{0.0}, any_turn(random)}, turned{dvec3{0.0}, any_turn(random)};
        // A point of the bar's middle line lies in a point of the plate.
        const dvec3 on_bar{0.0, random.range(-0.9, 0.9), 0.0};
        const dvec3 share{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
        const Pose pose_a{rotate(pose_b.orientation, share * dvec3(plate)) - rotate(turned.orientation, on_bar), turned.orientation};
        const Box a{bar}, b{plate};
        cases->add(a, pose_a, b, pose_b);
        cases->depth.push_back(-static_cast<double>(oracle::greatest_separation(solid_at(a, pose_a), solid_at(b, pose_b)).value));
    }
    cases->number(0.0f);
    return cases;
}

ManifoldCasesPtr as_surfaces(const ManifoldCases& solids, const SurfaceSettings& settings) {
    auto cases = std::make_shared<ManifoldCases>(solids);
    for (std::size_t i = settings.first ? 0 : 1; i < cases->shapes.size(); i += settings.first ? 1 : 2) {
        Shape& shape = cases->shapes[i];
        if (settings.seeded) {
            shape = seeded_surface_of(*hull_of(shape));
            continue;
        }
        const Box* box = std::get_if<Box>(&shape);
        const TriangleMeshPtr surface = box != nullptr ? surface_of(*box, settings.quads) : surface_of(*std::get<ConvexHullPtr>(shape));
        shape = surface;
    }
    cases->number(solids.pairs.empty() ? 0.0f : solids.pairs[0].margin);
    return cases;
}

}  // namespace carom::accuracy
