// A crate falls onto a floor and comes to rest; the engine says itself how deep anything overlapped.
//
//   build/release/bin/example_drop_a_crate
#include <carom/dynamics/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

int main() {
    carom::World world({.gravity = {0, -9.81, 0}});
    const carom::BodyId ground = world.create_body({.type = carom::BodyType::Static});
    world.add_shape(ground, carom::Plane{{0, 1, 0}, 0});
    const carom::BodyId crate = world.create_body({.position = {0, 2, 0}, .name = "crate"});
    world.add_shape(crate, carom::Box{{0.5f, 0.5f, 0.5f}}, {.density = 500, .friction = 0.6f});

    double deepest = 0.0;
    for (int i = 0; i < 180; ++i) {
        const carom::StepReport report = world.step(1.0 / 60.0);
        deepest = std::max(deepest, report.max_penetration);
        if (i % 30 == 0) {
            std::printf("%4.1f s  height %.4f m  contacts %zu\n", i / 60.0, world.pose(crate).position.y, report.contacts);
        }
    }
    const double height = world.pose(crate).position.y;
    std::printf("at rest at %.4f m, deepest overlap on the way %.4f m\n", height, deepest);
    return std::abs(height - 0.5) < 0.005 && deepest < 0.1 ? 0 : 1;
}
