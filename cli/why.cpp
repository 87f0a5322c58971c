// carom why A B SCENE: why two bodies touch, or why not, and where one passed through the other.
#include <carom/cli/progress.hpp>
#include <carom/cli/scene_arguments.hpp>
#include <carom/cli/why_picture.hpp>
#include <carom/cli/why_report.hpp>
#include <carom/cli/why_sweep_report.hpp>

#include <carom/core/output_file.hpp>
#include <carom/dynamics/explain.hpp>
#include <carom/dynamics/explain_sweep.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace carom::cli {
namespace {

struct WhyOptions {
    std::string a, b;
    SceneArguments scene;
    std::optional<int> step;
    std::optional<std::string> json;
    WhyPictureOptions picture;
};

std::optional<std::uint32_t> number_of(const std::string& text) {
    std::uint32_t number = 0;
    const std::from_chars_result parsed = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = parsed.ec == std::errc{} && parsed.ptr == text.data() + text.size();
    return whole ? std::optional(number) : std::nullopt;
}

// A body by its number, or by a name that no other body has.
Result<BodyId> find_body(const World& world, const std::string& text, const std::string& where) {
    const std::optional<std::uint32_t> number = number_of(text);
    std::optional<BodyId> found;
    std::uint32_t highest = 0;
    for (const BodyId body : world.bodies()) {
        highest = std::max(highest, body.slot);
        if (number ? body.slot != *number : world.name(body) != text) continue;
        if (found)
            return Error{ErrorCode::InvalidArgument, fmt::format("more than one body is called \"{}\"; give its number", text), where};
        found = body;
    }
    if (found) return *found;
    if (world.body_count() == 0) return Error{ErrorCode::UnknownName, "the scene has no bodies", where};
    if (!number) return Error{ErrorCode::UnknownName, fmt::format("no body is called \"{}\"; give a number", text), where};
    return Error{ErrorCode::UnknownName, fmt::format("no body has the number {}; the highest is {}", text, highest), where};
}

// The two bodies at the step in question.
Result<std::pair<BodyId, BodyId>> find_bodies(const World& world, const WhyOptions& options) {
    const Result<BodyId> a = find_body(world, options.a, "A");
    if (!a) return a.error();
    const Result<BodyId> b = find_body(world, options.b, "B");
    if (!b) return b.error();
    if (*a == *b) return Error{ErrorCode::InvalidArgument, fmt::format("A and B are one body, number {}", a->slot), "B"};
    return std::pair(*a, *b);
}

// Runs the scene to the step in question. @return the passages of the two on the way there.
std::vector<Passage> run_to(scenes::SceneRun& run, int step, const WhyOptions& options) {
    std::vector<Passage> passages;
    std::optional<std::pair<BodyId, BodyId>> bodies;
    Progress progress(step);
    for (int done = 0; done < step; ++done) {
        run.before_step(done);
        run.world.step(run.dt);
        progress.show(done + 1);
        if (!bodies || run.emitter) {  // which may yet create them
            const auto found = find_bodies(run.world, options);
            bodies = found ? std::optional(*found) : std::nullopt;
        }
        if (!bodies) continue;
        if (std::optional<Passage> passage = run.world.passage(bodies->first, bodies->second)) passages.push_back(std::move(*passage));
    }
    return passages;
}

ExitCode why(const WhyOptions& options) {
    Result<LoadedScene> loaded = options.scene.load();
    if (!loaded) return fail(ExitCode::BadInput, loaded.error());
    scenes::SceneRun& run = loaded->run;
    const int step = options.step.value_or(run.steps);
    if (step > run.steps) {
        const std::string message = fmt::format("the scene runs for {} steps; give --steps for more", run.steps);
        return fail(ExitCode::BadInput, {ErrorCode::InvalidArgument, message, "--step"});
    }
    // An emitter may yet create the bodies.
    if (!run.emitter) {
        if (const auto bodies = find_bodies(run.world, options); !bodies) return fail(ExitCode::BadInput, bodies.error());
    }
    if (Status status = check_why_picture(options.picture); !status) return fail(ExitCode::BadInput, status.error());
    if (options.json) {
        if (Status status = check_writable(*options.json); !status) return fail(ExitCode::BadInput, status.error());
    }
    const std::vector<Passage> passages = run_to(run, step, options);
    const Result<std::pair<BodyId, BodyId>> bodies = find_bodies(run.world, options);
    if (!bodies) return fail(ExitCode::BadInput, bodies.error());
    const ContactExplanation explanation = run.world.explain(bodies->first, bodies->second);
    const SweepExplanation sweep = run.world.explain_sweep(bodies->first, bodies->second);
    const std::string way = way_sentences(sweep, passages);
    if (Status status = draw_why(run, explanation, way, options.picture); !status) return fail(ExitCode::Failed, status.error());
    if (options.json) {
        nlohmann::ordered_json report{{"scene", run.name}};
        report.update(to_json(explanation, run.world));
        report["sweep"] = to_json(sweep);
        report["passages"] = to_json(passages);
        for (const std::string& text : sweep.disagreements) report["disagreements"].push_back(text);
        if (Status status = write_text(*options.json, report.dump(2) + "\n"); !status) return fail(ExitCode::Failed, status.error());
    }
    if (options.json != "-") {
        const std::string head = fmt::format("{}, step {}: {} and {}\n\n", run.name, explanation.step,
                                             "A is " + body_text(run.world, bodies->first), "B is " + body_text(run.world, bodies->second));
        if (Status status = write_text("-", head + to_text(explanation, run.world, way_text(sweep, run.world)) + way); !status)
            return fail(ExitCode::Failed, status.error());
    }
    ExitCode code = ExitCode::Ok;
    for (const auto* const texts : {&explanation.disagreements, &sweep.disagreements}) {
        for (const std::string& text : *texts) code = fail(ExitCode::Failed, {ErrorCode::InvalidArgument, text, "disagreement"});
    }
    return code;
}

}  // namespace

void add_why_command(CLI::App& app, Action& action) {
    auto options = std::make_shared<WhyOptions>();
    options->scene.record_paths = true;
    CLI::App* command = app.add_subcommand("why", "Says why two bodies of a scene touch, or why not.");
    command->add_option("A", options->a, "a body's number, or its name")->required();
    command->add_option("B", options->b, "another one's")->required();
    options->scene.add_to(*command);
    command->add_option("--step", options->step, "the step in question; the scene's last where it is not given")
        ->check(whole_number(0, 1'000'000'000));
    command->add_option("--json", options->json, "write the explanation into this file; - prints it, and nothing else");
    add_why_picture_options(*command, options->picture);
    command->callback([&action, options] { action = [options] { return why(*options); }; });
}

}  // namespace carom::cli
