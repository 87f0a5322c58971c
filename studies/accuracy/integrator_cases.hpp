// Free bodies whose every later state is known, and how far an engine's are from it.
//
//   const FreeCasesPtr cases = free_cases(FreeKind::Asymmetric, 8, 10.0);
//   const Track track = follow(*make_carom(cases->make({})), cases->bodies, cases->times, 1.0 / 64.0);
//   double worst = error_of(*cases, track, FreeMeasure::Orientation);
#pragma once

#include <carom/studies/accuracy/track.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace carom::accuracy {

/// Boxes by the class of their inertia, without gravity; Falling: asymmetric ones, thrown; Scene: the body of `single_body_spin`.
enum class FreeKind : unsigned char { Isotropic, Symmetric, Asymmetric, Falling, Scene };
[[nodiscard]] const char* to_string(FreeKind kind) noexcept;

/// What is compared, the largest over bodies and times: the angle between the orientations [rad]; the change of the kinetic energy over the energy; that
/// of the angular momentum, as a vector, over its length; the distance between the centres of mass over the way.
enum class FreeMeasure : unsigned char { Orientation, Energy, Momentum, Position };

struct FreeCases {
    std::function<World(const WorldDef&)> make;     ///< a world with the bodies, far apart; the definition's gravity is not used
    SceneBodies bodies{};                           ///< of that world
    std::vector<double> times{};                    ///< at which states are compared, evenly spaced [s]
    BodyStates truth{};

    [[nodiscard]] double duration() const { return times.back(); }
};
using FreeCasesPtr = std::shared_ptr<const FreeCases>;

/// Bodies from a seed: spins of 3 to 6 rad/s about any axis, every third within 0.01 of the middle one, about which it tips over.
/// @param count     of bodies, >= 1; Scene has one.
/// @param duration  a multiple of half a second.
[[nodiscard]] FreeCasesPtr free_cases(FreeKind kind, int count, double duration);

/// @return none where a state is not finite.
[[nodiscard]] std::optional<double> error_of(const FreeCases& cases, const Track& track, FreeMeasure measure);

}  // namespace carom::accuracy
