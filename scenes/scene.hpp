// Seeded scenes, shared by tests, benchmarks, studies, the program and the viewer.
//
//   Result<SceneRun> run = make_scene("pile_boxes", {.bodies = 1000});
//   for (int i = 0; i < run->steps; ++i) { run->before_step(i); run->world.step(run->dt); }
#pragma once

#include <carom/collision/aabb.hpp>
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

/// The most bodies that a scene accepts.
inline constexpr int kMaxSceneBodies = 1'000'000;

/// What a user may choose; what is not given comes from the scene.
struct SceneOptions {
    std::optional<int> bodies{};  ///< how many dynamic bodies, 0..kMaxSceneBodies; what a scene cannot meet is an error
    std::optional<std::uint64_t> seed{};       ///< of the random stream; scenes without one take no notice
    std::optional<int> substeps{};             ///< per step, 1..1024; over the scene file's own and over world.substeps
    std::map<std::string, std::string> set{};  ///< parameters the scene declares, e.g. {"ratio", "1e4"}
    WorldDef world{};  ///< executor, substeps, plan mode and the like; gravity is the scene's own
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
    int bodies = 0;  ///< default number of dynamic bodies
    int steps = 0;   ///< default number of steps
    std::vector<SceneParameter> parameters;
};

/// A built scene, ready to step.
struct SceneRun {
    std::string name;
    std::uint64_t seed = 0;
    World world;
    int steps = 600;
    double dt = 1.0 / 60.0;
    Aabb domain{};  ///< bodies whose centre of mass leaves it have escaped; empty: no limit
    /// Creates and removes bodies before a step; empty where the scene has no emitter. Use before_step().
    std::function<void(World&, int)> emitter{};
    /// Counts the bodies that went through what should have stopped them; empty where the scene has no such thing.
    std::function<int(const World&)> tunnelled{};

    /// Call before each step, with its number from 0: emitters create and remove bodies here.
    void before_step(int step) {
        if (emitter) emitter(world, step);
    }
};

/// @return every scene, in the order that lists show them.
[[nodiscard]] std::span<const SceneInfo> catalogue();

/// Builds a scene of the catalogue. The same name and options always give the same bodies, to the bit.
/// @return UnknownName (scene or parameter), WrongType (a parameter that is no number), InvalidArgument (a value out of
/// range, or a number of bodies that the scene cannot meet); `where` names the option.
[[nodiscard]] Result<SceneRun> make_scene(const std::string& name, const SceneOptions& options = {});

/// Builds a scene from a JSON file of at most 64 MiB; docs/scenes.md has the schema. The file says its own bodies, so
/// SceneOptions::bodies and ::set are refused.
/// @return Io, Parse, WrongType, UnknownName, InvalidArgument, NotFinite, Degenerate or Empty; `where` is `file:line`
/// and, past the parser, the key, as in `crates.json:12: bodies[3].shapes[0].radius`.
[[nodiscard]] Result<SceneRun> read_scene(const std::string& path, const SceneOptions& options = {});

/// @return how many dynamic bodies have their centre of mass outside `domain`; 0 where it is empty.
[[nodiscard]] int count_escaped(const World& world, const Aabb& domain);

}  // namespace carom::scenes
