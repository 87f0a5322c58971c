// carom accuracy NAME: error against run time, with the times to reach 1e-2, 1e-3 and 1e-4.
#include <carom/cli/build_info.hpp>
#include <carom/cli/command.hpp>
#include <carom/cli/progress.hpp>
#include <carom/cli/study_peers.hpp>

#include <carom/core/output_file.hpp>
#include <carom/core/simd_width.hpp>
#include <carom/studies/accuracy/catalogue.hpp>
#include <carom/studies/accuracy/plot.hpp>
#include <carom/studies/accuracy/report.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace carom::cli {
namespace {

constexpr int kRepeats = 9, kQuickRepeats = 3;

struct AccuracyOptions {
    std::string name;
    bool list = false;
    bool quick = false;
    std::optional<std::string> json, out;
};

ExitCode list() {
    for (const accuracy::StudyGroup& group : accuracy::study_catalogue()) {
        fmt::print("{:<12} {}\n", group.name, group.summary);
    }
    return ExitCode::Ok;
}

// The studies, and what they ran on.
std::string report(const std::vector<accuracy::StudyResult>& results, const AccuracyOptions& options) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(accuracy::to_json(results));
    json["quick"] = options.quick;
    json["repeats"] = options.quick ? kQuickRepeats : kRepeats;
    json["machine"] = {{"cpu", cpu_model()}, {"cores", cpu_cores()}};
    json["build"] = {{"version", version()}, {"compiler", compiler()}, {"type", build_type()}, {"simd_width", simd_width()}};
    return json.dump(2) + "\n";
}

Status prove_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return Error{ErrorCode::Io, "cannot be made: " + error.message(), folder};
    return check_writable(folder + "/accuracy.json");
}

// The report of all, and CSV and SVG of each. Without gnuplot there is no SVG, and one line says so.
Status write_folder(const std::vector<accuracy::StudyResult>& results, const accuracy::Digest& digest, const std::string& folder,
                    const std::string& json) {
    if (Status status = write_text(folder + "/accuracy.json", json); !status) return status;
    bool missing = false;
    for (const accuracy::StudyResult& result : results) {
        const std::string stem = folder + "/" + result.name;
        if (Status status = write_text(stem + ".csv", accuracy::to_csv(result)); !status) return status;
        const Result<accuracy::Drawn> drawn = accuracy::draw_svg(result, stem);
        if (!drawn) return drawn.error();
        missing = *drawn == accuracy::Drawn::NoGnuplot;
    }
    for (const accuracy::Digest::Picture& picture : digest.pictures) {
        const std::string stem = folder + "/" + picture.name;
        const Result<accuracy::Drawn> drawn = accuracy::run_script(picture.script(stem + ".svg"), stem);
        if (!drawn) return drawn.error();
        missing = *drawn == accuracy::Drawn::NoGnuplot;
    }
    if (missing) fmt::print(stderr, "carom: gnuplot is not on the PATH: the .gp scripts are written, but no .svg\n");
    return {};
}

std::vector<accuracy::StudyResult> measure_all(const accuracy::StudyGroup& group, const AccuracyOptions& options) {
    std::vector<accuracy::Study> studies = group.make({.quick = options.quick, .ray_peers = study_ray_peers(), .engine_peers = study_engine_peers()});
    const int rounds = 1 + (options.quick ? kQuickRepeats : kRepeats);
    Progress progress(rounds * static_cast<int>(studies.size()));
    std::vector<accuracy::StudyResult> results;
    for (accuracy::Study& waiting : studies) {
        const accuracy::Study study = std::exchange(waiting, {});  // what it holds goes with it
        const int before = rounds * static_cast<int>(results.size());
        const auto show = [&](int done, int) { progress.show(before + done); };
        results.push_back(accuracy::measure(study, {.repeats = rounds - 1, .progress = show}));
    }
    return results;
}

ExitCode run(const AccuracyOptions& options) {
    if (options.list || options.name.empty()) return list();
    const Result<accuracy::StudyGroup> group = accuracy::find_study(options.name);
    if (!group) return fail(ExitCode::BadInput, group.error());
    // The folder first: it is made where it is missing, and the report may go there.
    if (options.out) {
        if (Status status = prove_folder(*options.out); !status) return fail(ExitCode::BadInput, status.error());
    }
    if (options.json) {
        if (Status status = check_writable(*options.json); !status) return fail(ExitCode::BadInput, status.error());
    }
    const std::vector<accuracy::StudyResult> results = measure_all(*group, options);
    const std::string json = report(results, options);
    const accuracy::Digest digest = group->digest ? group->digest(results) : accuracy::Digest{};
    if (options.out) {
        if (Status status = write_folder(results, digest, *options.out, json); !status) return fail(ExitCode::Failed, status.error());
    }
    if (options.json) {
        if (Status status = write_text(*options.json, json); !status) return fail(ExitCode::Failed, status.error());
    }
    if (options.json == "-") return ExitCode::Ok;
    std::string tables;
    for (const accuracy::StudyResult& result : results) {
        tables += (tables.empty() ? "" : "\n") + accuracy::to_table(result);
    }
    if (!digest.table.empty()) tables += "\n" + digest.table;
    if (Status status = write_text("-", tables); !status) return fail(ExitCode::Failed, status.error());
    return ExitCode::Ok;
}

}  // namespace

void add_accuracy_command(CLI::App& app, Action& action) {
    auto options = std::make_shared<AccuracyOptions>();
    CLI::App* command = app.add_subcommand("accuracy", "Measures error against run time.");
    command->add_option("NAME", options->name, "a study; without one they are listed");
    command->add_flag("--list", options->list, "list the studies");
    command->add_flag("--quick", options->quick, "fewer and smaller cases, 3 repeats: seconds in all");
    command->add_option("--json", options->json, "write the report into this file; - prints it, and nothing else");
    command->add_option("--out", options->out, "write accuracy.json and a .csv and .svg of each study into this folder");
    command->callback([&action, options] { action = [options] { return run(*options); }; });
}

}  // namespace carom::cli
