// carom::viz linked alone.
#include <carom/viz/make_debug_frame.hpp>

int main() {
    carom::World world;
    world.add_shape(world.create_body(), carom::Sphere{0.5f});
    const carom::DebugFrame frame = carom::make_debug_frame(world);
    const carom::DebugLayer* shapes = frame.find("shapes");
    return shapes != nullptr && !shapes->triangles.empty() ? 0 : 1;
}
