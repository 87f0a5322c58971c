#include <carom/broadphase/broadphase.hpp>
#include <carom/broadphase/detail/methods.hpp>
#include <carom/core/check.hpp>

namespace carom {

const char* to_string(BroadphaseMethod method) noexcept {
    switch (method) {
        case BroadphaseMethod::BruteForce: return "brute_force";
        case BroadphaseMethod::SweepAndPrune: return "sweep_and_prune";
    }
    return "unknown";
}

std::unique_ptr<Broadphase> make_broadphase(BroadphaseMethod method) {
    switch (method) {
        case BroadphaseMethod::BruteForce: return detail::make_brute_force();
        case BroadphaseMethod::SweepAndPrune: return detail::make_sweep_and_prune();
    }
    report_error(ErrorCode::InvalidArgument, "no such broadphase method");
    return nullptr;
}

}  // namespace carom
