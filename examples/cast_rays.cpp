// Ray casts against bare shapes, without a world: needs carom::collision only.
//
//   build/release/bin/example_cast_rays
#include <carom/collision/convex_hull.hpp>
#include <carom/collision/ray_cast.hpp>

#include <cstdio>
#include <vector>

int main() {
    // A square pyramid, from its corners; untrusted points come back as a Result that says what is wrong with them.
    const std::vector<carom::vec3> corners{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 2, 0}};
    const carom::Result<carom::ConvexHullPtr> pyramid = carom::ConvexHull::build(corners);
    if (!pyramid) {
        std::printf("no hull: %s\n", pyramid.error().message.c_str());
        return 1;
    }

    int hits = 0;
    for (const double x : {0.25, 0.5, 1.5}) {
        const carom::Ray down{.origin = {x, 5, 0}, .direction = {0, -1, 0}, .max_distance = 10};
        if (const auto hit = carom::cast_ray(*pyramid, carom::Pose{}, down)) {
            std::printf("x = %.2f: hit at height %.3f, normal (%.2f %.2f %.2f)\n", x, hit->point.y, hit->normal.x, hit->normal.y,
                        hit->normal.z);
            ++hits;
        } else {
            std::printf("x = %.2f: nothing\n", x);
        }
    }
    return hits == 2 ? 0 : 1;
}
