// carom run SCENE|FILE.json: runs a scene from end to end and says how long it took and how wrong it is.
#include <carom/cli/heap_in_use.hpp>
#include <carom/cli/progress.hpp>
#include <carom/cli/recorder.hpp>
#include <carom/cli/report.hpp>
#include <carom/cli/scene_arguments.hpp>
#include <carom/cli/simulate.hpp>

#include <carom/core/output_file.hpp>

#include <fmt/format.h>

#include <memory>
#include <string>

namespace carom::cli {
namespace {

struct RunOptions {
    SceneArguments scene;
    RecorderOptions recorder;
    std::optional<std::string> json;
    int peak_every = 1;
};

// The verdict, with a line on stderr for each thing that is wrong.
ExitCode judge(const RunRecord& record) {
    ExitCode code = ExitCode::Ok;
    const auto blame = [&](ExitCode worse, const std::string& message) {
        fail(worse, {ErrorCode::InvalidArgument, message, record.scene});
        if (code == ExitCode::Ok) code = worse;
    };
    if (record.non_finite > 0) blame(ExitCode::NotFinite, fmt::format("{} bodies are not finite", record.non_finite));
    if (record.quarantined > 0) blame(ExitCode::NotFinite, fmt::format("{} bodies were quarantined", record.quarantined));
    if (record.escaped.value_or(0) > 0) blame(ExitCode::Escaped, fmt::format("{} bodies escaped", *record.escaped));
    if (!(record.energy_drift <= kEnergyRule)) {
        blame(ExitCode::Escaped, fmt::format("energy grew by {:.3g} of the reference, more than {:g}", record.energy_drift, kEnergyRule));
    }
    return code;
}

// What the run wrote, a line each, for the end of the summary.
std::string files_written(const RunOptions& options) {
    std::string text;
    const auto add = [&text](const std::string& path) { text += (text.empty() ? "files         " : "              ") + path + "\n"; };
    if (options.json) add(*options.json);
    if (!options.recorder.picture.empty()) add(options.recorder.picture);
    if (!options.recorder.vtk.empty()) add(options.recorder.vtk + "/frames.pvd");
    return text;
}

ExitCode run(RunOptions& options) {
    options.scene.record_paths = options.recorder.sweeps;
    const std::optional<std::size_t> heap_before = heap_in_use();
    Result<LoadedScene> loaded = options.scene.load();
    if (!loaded) return fail(ExitCode::BadInput, loaded.error());
    scenes::SceneRun& scene = loaded->run;
    // Frames first: their folder is made where it is missing, and other files may go there.
    const std::unique_ptr<Recorder> recorder = make_recorder(options.recorder);
    if (recorder) {
        if (Status status = recorder->begin(scene); !status) return fail(ExitCode::BadInput, status.error());
    }
    if (options.json) {
        if (Status status = check_writable(*options.json); !status) return fail(ExitCode::BadInput, status.error());
    }

    const Result<RunRecord> record = [&] {
        Progress progress(scene.steps);
        return simulate(scene, {.threads = options.scene.threads,
                                .peak_every = options.peak_every,
                                .heap_before = recorder ? std::nullopt : heap_before,  // which holds frames of its own
                                .after_step = [&](int done) {
                                    progress.show(done);
                                    return recorder ? recorder->stepped(scene, done) : Status{};
                                }});
    }();
    if (!record) return fail(ExitCode::Failed, record.error());
    if (recorder) {
        if (Status status = recorder->end(scene); !status) return fail(ExitCode::Failed, status.error());
    }
    if (options.json) {
        if (Status status = write_text(*options.json, to_json(*record).dump(2) + "\n"); !status) {
            return fail(ExitCode::Failed, status.error());
        }
    }
    if (options.json != "-") {
        if (Status status = write_text("-", summary(*record) + files_written(options)); !status) return fail(ExitCode::Failed, status.error());
    }
    return judge(*record);
}

}  // namespace

void add_run_command(CLI::App& app, Action& action) {
    auto options = std::make_shared<RunOptions>();
    CLI::App* command = app.add_subcommand("run", "Runs a scene and reports time and errors.");
    options->scene.add_to(*command);
    command->add_option("--json", options->json, "write the report into this file; - prints it, and nothing else");
    add_recorder_options(*command, options->recorder);
    command->add_option("--peak-every", options->peak_every, "steps between looks at the penetration; 0: at the end only")
        ->check(whole_number(0, 1'000'000));
    command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace carom::cli
