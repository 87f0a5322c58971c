// carom plan SCENE: what each stage of the first step runs or skips, and why.
#include <carom/cli/scene_arguments.hpp>

#include <fmt/format.h>

#include <memory>

namespace carom::cli {
namespace {

ExitCode plan(const SceneArguments& arguments) {
    Result<LoadedScene> scene = arguments.load();
    if (!scene) return fail(ExitCode::BadInput, scene.error());
    scene->run.before_step(0);
    const Plan plan = scene->run.world.plan(scene->run.dt);
    fmt::print("{}: {} substeps a step\n\n", scene->run.name, plan.substeps);
    for (const PlanEntry& entry : plan.entries) {
        fmt::print("{:<12} {}\n", to_string(entry.stage), entry.reason);
    }
    fmt::print("\nbroadphase   {}: {}\n", to_string(plan.broadphase.method), plan.broadphase.reason);
    if (!plan.settings.empty()) {
        fmt::print("\nsettings that change accuracy\n");
    }
    for (const std::string& setting : plan.settings) {
        fmt::print("  {}\n", setting);
    }
    return ExitCode::Ok;
}

}  // namespace

void add_plan_command(CLI::App& app, Action& action) {
    auto arguments = std::make_shared<SceneArguments>();
    CLI::App* command = app.add_subcommand("plan", "Says what each stage of a step will do for a scene, and what it skips.");
    arguments->add_to(*command);
    command->callback([&action, arguments] { action = [arguments] { return plan(*arguments); }; });
}

}  // namespace carom::cli
