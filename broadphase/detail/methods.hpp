// The broadphase methods behind make_broadphase.
#pragma once

#include <carom/broadphase/broadphase.hpp>

#include <memory>

namespace carom::detail {

[[nodiscard]] std::unique_ptr<Broadphase> make_brute_force();
[[nodiscard]] std::unique_ptr<Broadphase> make_sweep_and_prune();

}  // namespace carom::detail
