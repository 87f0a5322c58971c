// Which boxes overlap, as they come, move and go, without a world: needs carom::broadphase only.
//
//   build/release/bin/example_find_pairs
#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/queries.hpp>

#include <cstdint>
#include <cstdio>
#include <vector>

int main() {
    carom::SerialExecutor executor;
    carom::Broadphase broadphase;  // chooses its method by the boxes

    // A row of unit boxes half a metre apart, by slot: the index is the caller's name of a box.
    std::vector<carom::FloatAabb> boxes;
    std::vector<std::uint32_t> moved;
    for (std::uint32_t slot = 0; slot < 100; ++slot) {
        const float x = 1.5f * static_cast<float>(slot);
        boxes.push_back({{x, 0, 0}, {x + 1, 1, 1}});
        moved.push_back(slot);
    }
    const std::vector<carom::ProxyFilter> filters(boxes.size());
    broadphase.update({.bounds = boxes, .filters = filters, .moved = moved}, executor);
    std::printf("%zu boxes, %zu pairs\n", broadphase.live_count(), broadphase.result().pairs.size());

    // One box moves onto its neighbours, another goes. Only what changed is listed.
    boxes[7] = {{10, 0, 0}, {13, 1, 1}};
    moved = {7};
    const std::vector<std::uint32_t> removed{50};
    const carom::PairUpdate& found =
        broadphase.update({.bounds = boxes, .filters = filters, .moved = moved, .removed = removed}, executor);
    for (const carom::ProxyPair& pair : found.begun) std::printf("%u and %u overlap now\n", pair.a, pair.b);

    // What is near a point, and what a ray meets first.
    int near = 0;
    carom::query_sphere(broadphase, {75, 0, 0}, 3.0, [&](std::uint32_t) { return ++near > 0; });
    const auto hit = carom::closest_on_ray(broadphase, {200, 0.5, 0.5}, {-1, 0, 0}, 1000, [](std::uint32_t) { return true; });
    std::printf("%d boxes within 3 m of x = 75, where slot 50 was; a ray from the right meets slot %u\n", near, hit ? hit->slot : 0);

    return found.begun.size() == 2 && near == 4 && hit && hit->slot == 99 ? 0 : 1;
}
