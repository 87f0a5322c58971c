#include <carom/broadphase/method.hpp>

#include <algorithm>
#include <iterator>

namespace carom {

const char* to_string(BroadphaseMethod method) noexcept {
    switch (method) {
        case BroadphaseMethod::Automatic:
            return "automatic";
        case BroadphaseMethod::BruteForce:
            return "brute_force";
        case BroadphaseMethod::SweepAndPrune:
            return "sweep_and_prune";
        case BroadphaseMethod::SortedAxes:
            return "sorted_axes";
        case BroadphaseMethod::UniformGrid:
            return "uniform_grid";
        case BroadphaseMethod::HierarchicalGrid:
            return "hierarchical_grid";
        case BroadphaseMethod::DynamicTree:
            return "dynamic_tree";
    }
    return "unknown";
}

bool is_valid(BroadphaseMethod method) noexcept {
    return method == BroadphaseMethod::Automatic ||
           std::find(std::begin(kBroadphaseMethods), std::end(kBroadphaseMethods), method) != std::end(kBroadphaseMethods);
}

}  // namespace carom
