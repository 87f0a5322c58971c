#include <carom/collision/detail/wide_crowding.hpp>

#include <carom/collision/detail/wide_volume.hpp>

#include <algorithm>
#include <cstdint>

namespace carom {
namespace {

constexpr std::size_t kPlaces = 128;
constexpr int kMostLeaves = 1000;  // at one place

/// The middle of a leaf's first triangle, as a box without extent. Rounding does not take it out of the triangle's box.
WideVolume place_in(const WideLeaf& leaf) noexcept {
    WideVolume place{};
    for (int axis = 0; axis < 3; ++axis) {
        const float a = leaf.vertex[axis][leaf.corner[0][0]];
        const float b = leaf.vertex[axis][leaf.corner[1][0]];
        const float c = leaf.vertex[axis][leaf.corner[2][0]];
        const float middle = a / 3.0f + b / 3.0f + c / 3.0f;
        place.lower[axis] = place.upper[axis] = std::clamp(middle, std::min({a, b, c}), std::max({a, b, c}));
    }
    return place;
}

}  // namespace

double crowding_of(const WideBvh& tree, std::span<const WideRef> refs) {
    const std::size_t places = std::min(kPlaces, tree.leaf_count);
    std::int64_t leaves = 0;
    std::size_t seen = 0, taken = 0;
    for (const WideRef ref : refs) {
        if (!is_leaf(ref)) continue;
        // Every leaf_count / places-th leaf.
        if (seen++ * places < taken * tree.leaf_count) continue;
        ++taken;
        int here = 0;
        visit_leaves(tree, place_in(tree.leaf(ref)), [&](const WideLeaf&) { return ++here < kMostLeaves; });
        leaves += here;
    }
    return static_cast<double>(leaves) / static_cast<double>(taken);
}

}  // namespace carom
