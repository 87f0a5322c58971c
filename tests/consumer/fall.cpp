// A user's program that steps a world.
#include <carom/dynamics/world.hpp>

int main() {
    carom::World world;
    const carom::BodyId ball = world.create_body({.position = {0, 5, 0}});
    world.add_shape(ball, carom::Sphere{0.5f});
    world.step(1.0 / 60.0);
    return world.pose(ball).position.y < 5.0 ? 0 : 1;
}
