// Seeded scenes, shared by tests, benchmarks, studies, the program and the viewer.
//
//   Result<SceneRun> run = make_scene("pile_boxes", {.bodies = 1000});
//   for (int i = 0; i < run->steps; ++i) { run->before_step(i); run->world.step(run->dt); }
#pragma once

#include <carom/core/result.hpp>
#include <carom/dynamics/world.hpp>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace carom::scenes {

/// What a user may choose; what is not given comes from the scene.
struct SceneOptions {
    std::optional<int> bodies;              ///< how many dynamic bodies, >= 0
    std::optional<std::uint64_t> seed;
    std::map<std::string, std::string> set; ///< parameters the scene declares, e.g. {"ratio", "1e4"}
    WorldDef world{};                       ///< executor, substeps, plan mode; gravity is the scene's own
};

/// A parameter that a scene declares for SceneOptions::set.
struct SceneParameter {
    std::string name;
    double value = 0.0;  ///< the default
    double lower = 0.0, upper = 0.0;
    std::string meaning;  ///< with its unit
};

/// One entry of the catalogue.
struct SceneInfo {
    std::string name;
    std::string summary;
    int bodies = 0;      ///< default number of dynamic bodies
    int steps = 0;       ///< default number of steps
    std::vector<SceneParameter> parameters;
};

/// A built scene, ready to step.
struct SceneRun {
    std::string name;
    std::uint64_t seed = 0;
    World world;
    int steps = 600;
    double dt = 1.0 / 60.0;
    Aabb domain;  ///< bodies whose centre leaves it have escaped; empty: no limit
    /// Called before step i (0-based): emitters create and remove bodies here.
    std::function<void(int)> before_step = [](int) {};
    /// Counts the bodies that went through what should have stopped them; empty where the scene has no such thing.
    std::function<int(const World&)> tunnelled;
};

/// @return every scene, by name.
[[nodiscard]] std::span<const SceneInfo> catalogue();

/// Builds a scene of the catalogue.
/// @return UnknownName (scene or parameter), InvalidArgument (a value out of range), with the place named.
[[nodiscard]] Result<SceneRun> make_scene(const std::string& name, const SceneOptions& options = {});

/// Builds a scene from a JSON file; docs/scenes.md has the schema.
/// @return Io, Parse, WrongType, UnknownName, InvalidArgument ..., `where` naming file, line or key.
[[nodiscard]] Result<SceneRun> read_scene(const std::string& path, const SceneOptions& options = {});

}  // namespace carom::scenes
