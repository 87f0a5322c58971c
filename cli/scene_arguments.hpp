// The options that say which scene and how: the same for run, plan and view.
//
//   auto arguments = std::make_shared<SceneArguments>();
//   arguments->add_to(*subcommand);
//   Result<LoadedScene> scene = arguments->load();
#pragma once

#include <carom/cli/command.hpp>

#include <carom/core/executor.hpp>
#include <carom/scenes/scene.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace carom::cli {

/// A scene with the executor that its world uses.
struct LoadedScene {
    std::unique_ptr<Executor> executor;  // before the world, which must not outlive it
    scenes::SceneRun run;
};

struct SceneArguments {
    std::string scene;                  ///< a name, or a path: whatever ends in .json or has a slash
    std::optional<int> bodies, steps, substeps;
    std::optional<double> dt;           ///< [s]
    std::optional<double> contact_reuse;
    std::optional<std::uint64_t> seed;
    std::vector<std::string> set;       ///< KEY=VALUE
    ContactMethod contact_method = ContactMethod::Automatic;
    std::optional<double> direct_sag;
    std::optional<std::uint64_t> direct_budget;
    BroadphaseMethod broadphase = BroadphaseMethod::Automatic;
    int threads = 1;
    bool discrete = false;
    bool sleep = false;
    bool record_paths = false;          ///< not an option: of commands that ask for paths

    void add_to(CLI::App& command);
    /// Checks the options and builds the scene. @return an error that names the option, or the place in the file.
    [[nodiscard]] Result<LoadedScene> load() const;
};

/// @return whether a scene's name is a path: it ends in .json or has a slash.
[[nodiscard]] bool is_path(const std::string& scene);

/// A check for options that takes whole numbers from `lower` to `upper` and nothing else (no sign wrap-around, no exponent).
[[nodiscard]] CLI::Validator whole_number(std::int64_t lower, std::uint64_t upper);

}  // namespace carom::cli
