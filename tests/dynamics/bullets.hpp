// Small bodies of every shape, to be shot at things.
//
//   world.add_shape(body, bullet(i % kBullets));
#pragma once

#include <carom/collision/compound.hpp>
#include <carom/collision/convex_hull.hpp>

#include <support/box_mesh.hpp>

#include <vector>

namespace carom::test {

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

}  // namespace carom::test
