#include <carom/bench/random_shapes.hpp>

#include <carom/collision/convex_hull.hpp>
#include <carom/core/types.hpp>

#include <glm/geometric.hpp>

#include <vector>

namespace carom::bench {

dvec3 direction_of(Random& random) {
    for (;;) {
        dvec3 d{0.0};
        for (int k = 0; k < 3; ++k) d[k] = random.range(-1.0, 1.0);
        const double length = glm::length(d);
        if (length <= 1.0 && length > 0.1) return d / length;
    }
}

dquat rotation_of(Random& random) {
    for (;;) {
        dquat q = kIdentityRotation;
        q.w = random.range(-1.0, 1.0), q.x = random.range(-1.0, 1.0), q.y = random.range(-1.0, 1.0), q.z = random.range(-1.0, 1.0);
        const double length = glm::length(q);
        if (length <= 1.0 && length > 0.1) return glm::normalize(q);
    }
}

Shape box_of(Random& random) {
    vec3 half{0.0f};
    for (int k = 0; k < 3; ++k) half[k] = static_cast<float>(random.range(0.2, 1.0));
    return Box{half};
}

Shape hull_of(Random& random) {
    dvec3 scale{0.0};
    for (int k = 0; k < 3; ++k) scale[k] = random.range(0.4, 1.0);
    std::vector<vec3> points;
    for (int i = 0; i < 32; ++i) points.push_back(vec3(direction_of(random) * scale));
    return *ConvexHull::build(points);
}

}  // namespace carom::bench
