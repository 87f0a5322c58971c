// carom list: the scenes, with their sizes and parameters.
#include <carom/cli/command.hpp>

#include <carom/scenes/scene.hpp>

#include <fmt/format.h>

namespace carom::cli {
namespace {

ExitCode list() {
    fmt::print("{:<18} {:>7} {:>6}  {}\n", "scene", "bodies", "steps", "what it shows, and its parameters for --set");
    for (const scenes::SceneInfo& info : scenes::catalogue()) {
        fmt::print("{:<18} {:>7} {:>6}  {}\n", info.name, info.bodies, info.steps, info.summary);
        for (const scenes::SceneParameter& p : info.parameters) {
            fmt::print("{:<18} {:>7} {:>6}    {}={}, in {}..{}: {}\n", "", "", "", p.name, p.value, p.lower, p.upper, p.meaning);
        }
    }
    return ExitCode::Ok;
}

}  // namespace

void add_list_command(CLI::App& app, Action& action) {
    app.add_subcommand("list", "Lists the scenes and their parameters.")->callback([&action] { action = list; });
}

}  // namespace carom::cli
