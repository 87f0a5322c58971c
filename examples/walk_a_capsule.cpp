// A character that walks through a world without being a body of it: casts of a capsule, and a slide along what they meet.
//
//   build/release/bin/example_walk_a_capsule
#include <carom/dynamics/world.hpp>
#include <carom/dynamics/world_cast.hpp>

#include <glm/geometric.hpp>

#include <cstdio>

namespace {

constexpr double kSkin = 0.01;  // [m] that the capsule keeps from everything

/// Moves as far as nothing is in the way, then along what is.
carom::dvec3 walk(const carom::World& world, carom::dvec3 at, carom::dvec3 way) {
    for (int slides = 0; slides < 4 && glm::length(way) > 1e-6; ++slides) {
        const carom::ShapeCast cast{.shape = carom::Capsule{0.4f, 0.5f},
                                    .motion = {.start = {at, carom::kIdentityRotation}, .translation = way},
                                    .settings = {.separation = kSkin}};
        const auto hit = world.cast_shape(cast);
        if (!hit) return at + way;
        if (hit->impact.status != carom::ImpactStatus::Touching) return at;  // stuck: it began within the skin of something
        at += hit->impact.t * way;
        way *= 1.0 - hit->impact.t;
        way -= glm::dot(way, hit->impact.normal) * hit->impact.normal;  // what is left of the way, along the surface
        at -= 1e-6 * hit->impact.normal;                                // off it, so that the next cast does not begin in touch
    }
    return at;
}

}  // namespace

int main() {
    carom::World world;
    const carom::BodyId ground = world.create_body({.type = carom::BodyType::Static});
    world.add_shape(ground, carom::Plane{{0, 1, 0}, 0});
    world.add_shape(ground, carom::Box{{0.5f, 2.0f, 5.0f}}, {.local = {{4, 2, 0}}});

    carom::dvec3 player{0, 0.92, 0};
    for (int frame = 0; frame < 120; ++frame) player = walk(world, player, {0.05, 0, 0.02});
    std::printf("after 120 frames towards x = 6: at (%.3f %.3f %.3f)\n", player.x, player.y, player.z);
    // The wall begins at x = 3.5; along it goes on what the wall does not take.
    return player.x < 3.5 - 0.4 && player.x > 3.0 && player.z > 2.3 ? 0 : 1;
}
