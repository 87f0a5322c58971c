// peers: the same work through Carom and through other engines of Debian, side by side. docs/performance.md is the manual.
//
//   peers step pile_boxes/4000 --json out.json
//   peers rays bumpy1m
#include <carom/bench/rays_group.hpp>
#include <carom/bench/step_group.hpp>

#include <carom/core/output_file.hpp>
#include <carom/core/result.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace carom::bench {
namespace {

enum ExitCode { kOk = 0, kFailed = 1, kBadInput = 2 };

int fail(ExitCode code, const Error& error) {
    fmt::print(stderr, "peers: {}: {}\n", error.where, error.message);
    return code;
}

int run(int argc, char** argv) {
    CLI::App app{"The same work through Carom and other engines, side by side. Times are CPU time on one thread."};
    app.name("peers");
    std::string group, filter, json;
    app.add_option("GROUP", group, "step: whole steps against Bullet and ODE; rays: single rays against Embree")->required();
    app.add_option("FILTER", filter, "only the rows whose bench/peer contains this, e.g. pile_boxes/4000 or embree-fast");
    CLI::Option* json_option = app.add_option("--json", json, "write the rows into this file; - prints them, and the table goes to stderr");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kOk : kBadInput;
    }
    if (group != "step" && group != "rays") {
        return fail(kBadInput, {ErrorCode::UnknownName, fmt::format("no group is called \"{}\"; there are step and rays", group), "group"});
    }

    const bool wants_json = !json_option->empty();
    if (wants_json) {
        if (Status status = check_writable(json); !status) return fail(kBadInput, status.error());
    }
    const GroupRequest request{.filter = filter, .table = json == "-" ? stderr : stdout};
    const Result<std::vector<Row>> rows = group == "step" ? run_step_group(request) : run_rays_group(request);
    if (!rows) return fail(kBadInput, rows.error());
    if (wants_json) {
        if (Status status = write_text(json, to_json(*rows).dump(2) + "\n"); !status) return fail(kFailed, status.error());
    }
    return kOk;
}

}  // namespace
}  // namespace carom::bench

int main(int argc, char** argv) {
    try {
        return carom::bench::run(argc, argv);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "peers: %s\n", error.what());
        return 1;
    }
}
