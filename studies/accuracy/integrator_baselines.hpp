// Free motion without a world around it: Carom's rotation alone, and the integrator of the textbook.
//
//   std::unique_ptr<Engine> naive = make_semi_implicit_euler(bodies);
//   std::unique_ptr<Engine> bare = make_rotation(bodies, {.tolerance = 1.0, .scheme = SpinScheme::Strang});
#pragma once

#include <carom/dynamics/free_rotation.hpp>
#include <carom/studies/accuracy/engine.hpp>

#include <memory>

namespace carom::accuracy {

/// v += a h, x += v h; spin += I⁻¹ (I spin x spin) h in world axes, q += (0, spin) q h / 2, normalised. First order. Fixed shapes are not looked at.
[[nodiscard]] std::unique_ptr<Engine> make_semi_implicit_euler(const SceneBodies& bodies);

/// rotate_free() and the exact parabola, body by body. Fixed shapes are not looked at.
[[nodiscard]] std::unique_ptr<Engine> make_rotation(const SceneBodies& bodies, const SpinSettings& settings);

}  // namespace carom::accuracy
