// Small bodies of every shape, to be shot at things, and thin walls for them.
//
//   World world(kSpace);
//   world.add_shape(body, bullet(i % kBullets));
//   world.add_shape(target, thin_wall(i % kThinWalls, 0.001f));
#pragma once

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/triangle_mesh.hpp>
#include <carom/core/math.hpp>
#include <carom/core/random.hpp>
#include <carom/dynamics/world.hpp>

#include <support/box_mesh.hpp>

#include <array>
#include <vector>

namespace carom::test {

inline constexpr WorldDef kSpace{.gravity = dvec3{0.0}};

inline dquat any_rotation(Random& random) {
    const dvec3 axis{random.range(-1.0, 1.0), random.range(-1.0, 1.0), random.range(-1.0, 1.0)};
    return glm::normalize(rotation_from_vector(3.0 * axis));
}

inline Shape hull_of_box(const vec3& half) {
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i) corners.push_back(half * vec3{i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f});
    return *ConvexHull::build(corners);
}

/// What is shot.
inline Shape bullet(int kind) {
    switch (kind) {
        case 0:
            return Sphere{0.05f};
        case 1:
            return Box{{0.05f, 0.08f, 0.03f}};
        case 2:
            return Capsule{0.0005f, 0.4995f};  // 1:1000
        case 3:
            return hull_of_box({0.04f, 0.05f, 0.06f});
        case 4:
            return Cylinder{0.05f, 0.02f};
        case 5:
            return Cone{0.04f, 0.06f};
        case 6:
            return *Compound::build(
                {{Sphere{0.03f}, {{-0.06, 0, 0}, kIdentityRotation}}, {Box{vec3{0.02f}}, {{0.05, 0, 0}, kIdentityRotation}}});
        default:
            return box_mesh(vec3{0.04f, 0.05f, 0.03f}, 2);
    }
}
inline constexpr int kBullets = 8;

/// The radius of a ball inside of the bullet about its centre of mass; none of a compound, which has nothing there.
inline double core_of(int kind) { return std::array{0.05, 0.03, 0.0005, 0.035, 0.02, 0.025, 0.0, 0.03}[static_cast<std::size_t>(kind)]; }

/// A box, a closed mesh, a sheet, a hull, between z = -thickness / 2 and thickness / 2; and the half-space beyond the former.
inline Shape thin_wall(int kind, float thickness) {
    const vec3 half{300.0f, 300.0f, 0.5f * thickness};
    switch (kind) {
        case 0:
            return Box{half};
        case 1:
            return box_mesh(half, 1);
        case 2:
            return *TriangleMesh::build(std::vector<vec3>{{-300, -300, 0}, {300, -300, 0}, {300, 300, 0}, {-300, 300, 0}},
                                        std::vector<TriangleMesh::Triangle>{{0, 1, 2}, {0, 2, 3}});
        case 3:
            return hull_of_box(half);
        default:
            return Plane{{0.0f, 0.0f, -1.0f}, 0.5f * thickness};
    }
}
inline constexpr int kThinWalls = 5;

}  // namespace carom::test
