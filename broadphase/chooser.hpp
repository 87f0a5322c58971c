// Which broadphase method suits a scene, from what can be counted in it.
//
//   SceneStatistics scene = measure(boxes, alive, moving_share);
//   MethodChoice choice = choose_method(scene, BroadphaseMethod::UniformGrid);
#pragma once

#include <carom/broadphase/method.hpp>
#include <carom/broadphase/proxy.hpp>

#include <cstddef>
#include <span>
#include <string>

namespace carom {

/// What the choice is made from. Sizes are longest edges of boxes [m].
struct SceneStatistics {
    std::size_t count = 0;
    double median_size = 0.0;  ///< of a sample
    double p99_size = 0.0;     ///< of a sample
    double largest_size = 0.0;
    double largest_crowd = 0.0;  ///< boxes in a cell as long as the longest edge along each axis, were they spread evenly
    double line_density = 0.0;  ///< boxes side by side along the axis where they crowd most: count * median size / extent
    int spread_axes = 0;        ///< axes along which the boxes are spread over more than eight median sizes
    double fill = 1.0;          ///< occupied cells of a coarse grid over those that an even spread would occupy, at most 1
    double moving_share = 1.0;  ///< of the boxes, in an update, over the last few tens of updates
};

/// Counts over the live boxes; the spread is that of about a thousand of them and takes no notice of a few far away.
/// Cost: O(n), no allocation.
[[nodiscard]] SceneStatistics measure(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, double moving_share);

/// Whether there are so few boxes that nothing else about them matters.
[[nodiscard]] bool is_few(std::size_t count, double moving_share, BroadphaseMethod current) noexcept;

struct MethodChoice {
    BroadphaseMethod method = BroadphaseMethod::BruteForce;
    const char* reason = "";  ///< the rule, in words
};

/// The method for a scene. `current` is kept near a threshold, so that the choice does not flicker.
/// docs/broadphase.md has the thresholds and the measurements that they come from.
[[nodiscard]] MethodChoice choose_method(const SceneStatistics& scene, BroadphaseMethod current) noexcept;

/// What a look at the boxes leads to.
struct SceneChoice {
    MethodChoice choice;
    SceneStatistics scene;  ///< of few boxes the number and the moving share only
};

/// Measures as much as the choice needs, and chooses. Broadphase takes the choice with a moving share of 1 and no current method at its
/// first update.
[[nodiscard]] SceneChoice choose_for(std::span<const FloatAabb> boxes, std::span<const unsigned char> alive, std::size_t live_count,
                                     double moving_share, BroadphaseMethod current = BroadphaseMethod::Automatic);

/// The choice in one sentence, with the numbers that decided it.
[[nodiscard]] std::string describe(const MethodChoice& choice, const SceneStatistics& scene);

}  // namespace carom
