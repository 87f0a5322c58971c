// carom::scenes linked alone.
#include <carom/scenes/scene.hpp>

int main() {
    const auto run = carom::scenes::make_scene("pile_boxes", {.bodies = 8});
    return run && run->world.body_count() > 8 ? 0 : 1;
}
