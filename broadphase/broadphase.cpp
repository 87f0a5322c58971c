#include <carom/broadphase/broadphase.hpp>

namespace carom {

const char* to_string(BroadphaseMethod method) noexcept {
    switch (method) {
        case BroadphaseMethod::BruteForce: return "brute_force";
        case BroadphaseMethod::SweepAndPrune: return "sweep_and_prune";
    }
    return "unknown";
}

}  // namespace carom
