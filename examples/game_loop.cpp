// A small game loop: a fixed time step under a frame rate that wavers, ids that outlive their bodies, errors as values.
//
//   build/release/bin/example_game_loop
#include <carom/core/check.hpp>
#include <carom/dynamics/world.hpp>

#include <cstdio>

namespace {

constexpr double kStep = 1.0 / 60.0;

/// Advances the world by as many whole steps as `elapsed` [s] has paid for; returns what is left for the next frame.
double advance(carom::World& world, double elapsed) {
    for (; elapsed >= kStep; elapsed -= kStep) {
        world.step(kStep);
    }
    return elapsed;
}

}  // namespace

int main() {
    carom::World world;
    world.add_shape(world.create_body({.type = carom::BodyType::Static}), carom::Plane{});
    const carom::BodyId player = world.create_body({.position = {0, 0.5, 0}, .name = "player"});
    world.add_shape(player, carom::Box{{0.6f, 0.5f, 0.6f}}, {.density = 200});
    const carom::BodyId ball = world.create_body({.position = {3, 0.5, 0}, .linear_velocity = {-8, 0, 0}});
    world.add_shape(ball, carom::Sphere{0.5f}, {.restitution = 0.8f});

    double left = 0.0;
    for (int frame = 0; frame < 120; ++frame) {
        left = advance(world, left + (frame % 3 == 0 ? 0.021 : 0.013));  // frames of 13 and 21 ms, as a display would give
        if (frame == 60) {
            world.destroy_body(ball);
        }
    }
    std::printf("the player was pushed to x = %.2f m\n", world.pose(player).position.x);

    // A dead id is found out, and nothing changes. The default handler throws; a game may install its own.
    try {
        world.apply_impulse(ball, {1, 0, 0}, {0, 0, 0});
    } catch (const carom::MisuseError& misuse) {
        std::printf("refused: %s\n", misuse.error().message.c_str());
        return world.pose(player).position.x < 0.0 ? 0 : 1;
    }
    return 1;
}
