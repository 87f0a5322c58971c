// One physics engine with one scene in it: what comparisons of whole steps ask of each.
//
//   std::unique_ptr<Engine> engine = make_carom(std::move(run.world));
//   engine->step(1.0 / 60.0);
#pragma once

#include <carom/studies/accuracy/scene_bodies.hpp>

#include <carom/core/pose.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace carom::accuracy {

/// Every engine runs on one thread, at its defaults unless it is told otherwise, and never puts a body to sleep.
class Engine {
public:
    Engine() = default;
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;
    virtual ~Engine() = default;

    [[nodiscard]] virtual std::string name() const = 0;     ///< as filters and reports spell it
    [[nodiscard]] virtual std::string version() const = 0;  ///< of the library that runs
    virtual void step(double dt) = 0;                       ///< one step of `dt` seconds > 0

    /// Of the moving body `index`, in the order of SceneBodies::moving: the pose that Carom would give, the velocity of the
    /// centre of mass [m/s] and the angular velocity, world axes [rad/s].
    [[nodiscard]] virtual Pose pose(std::size_t index) const = 0;
    [[nodiscard]] virtual dvec3 velocity(std::size_t index) const = 0;
    [[nodiscard]] virtual dvec3 spin(std::size_t index) const = 0;
};

/// Carom itself. Takes the world over.
[[nodiscard]] std::unique_ptr<Engine> make_carom(World world);

/// An engine that joins studies by its name.
struct EngineMaker {
    std::string who;
    std::function<std::unique_ptr<Engine>(const SceneBodies&)> make;
};

}  // namespace carom::accuracy
