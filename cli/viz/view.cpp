// carom view SCENE: the scene runs in a window.
#include <carom/cli/scene_arguments.hpp>

#include <carom/viz/broadphase_layers.hpp>
#include <carom/viz/make_debug_frame.hpp>
#include <carom/viz/sweep_layers.hpp>
#include <carom/viz/vtk/viewer.hpp>

#include <fmt/format.h>

#include <memory>

namespace carom::cli {
namespace {

struct ViewOptions {
    SceneArguments scene;
    bool paused = false;
    bool broadphase = false;
    bool sweeps = false;
};

ExitCode view(ViewOptions& options) {
    options.scene.record_paths = options.sweeps;
    Result<LoadedScene> loaded = options.scene.load();
    if (!loaded) return fail(ExitCode::BadInput, loaded.error());
    scenes::SceneRun& run = loaded->run;
    int done = 0;
    const ViewerSource source{
        .frame =
            [&] {
                DebugFrame frame = make_debug_frame(run.world);
                if (options.broadphase) append_broadphase_layers(frame, run.world);
                if (options.sweeps) append_sweep_layers(frame, run.world);
                frame.caption = fmt::format("{}, step {}, {:.2f} s", run.name, done, done * run.dt);
                return frame;
            },
        .step =
            [&] {
                if (options.scene.steps && done >= run.steps) return false;
                run.before_step(done++);
                run.world.step(run.dt);
                return true;
            },
        .describe = [&](BodyId body) { return describe_body(run.world, body); },
    };
    const Status status = Viewer(source, {.title = "carom: " + run.name, .paused = options.paused}).run();
    return status ? ExitCode::Ok : fail(ExitCode::BadInput, status.error());
}

}  // namespace

void add_view_command(CLI::App& app, Action& action) {
    auto options = std::make_shared<ViewOptions>();
    CLI::App* command = app.add_subcommand("view", "Runs a scene in a window, without end unless --steps is given.");
    options->scene.add_to(*command);
    command->add_flag("--paused", options->paused, "wait for the space bar");
    command->add_flag("--broadphase", options->broadphase, "show the broadphase's boxes, cells, axes and tree");
    command->add_flag("--sweeps", options->sweeps, "show what was followed in the step: swept volumes, impacts and the steps of advancement");
    command->callback([&action, options] { action = [options] { return view(*options); }; });
}

}  // namespace carom::cli
