// The broadphase methods by name.
//
//   to_string(BroadphaseMethod::UniformGrid)   // "uniform_grid"
#pragma once

namespace carom {

enum class BroadphaseMethod : unsigned char {
    Automatic,         ///< chosen by the scene, and again as it changes
    BruteForce,        ///< every pair, many at once: a few hundred boxes
    SweepAndPrune,     ///< sorted along one axis in cells of the other two, each time anew
    SortedAxes,        ///< persistent sweep-and-prune: insertion-sorted ends on three axes
    UniformGrid,       ///< cells of one size, boxes of like size
    HierarchicalGrid,  ///< a grid for each size class
    DynamicTree,       ///< boxes in boxes: any sizes, and the best for queries
};
inline constexpr BroadphaseMethod kBroadphaseMethods[] = {BroadphaseMethod::BruteForce,       BroadphaseMethod::SweepAndPrune,
                                                          BroadphaseMethod::SortedAxes,       BroadphaseMethod::UniformGrid,
                                                          BroadphaseMethod::HierarchicalGrid, BroadphaseMethod::DynamicTree};

[[nodiscard]] const char* to_string(BroadphaseMethod method) noexcept;
[[nodiscard]] bool is_valid(BroadphaseMethod method) noexcept;

}  // namespace carom
