// peers: the same work through Carom and through other engines of Debian, side by side. docs/performance.md is the manual.
//
//   peers step pile_boxes/4000 --json out.json
//   peers rays bumpy1m
#include <carom/bench/broadphase_group.hpp>
#include <carom/bench/narrowphase_group.hpp>
#include <carom/bench/rays_group.hpp>
#include <carom/bench/step_group.hpp>
#include <carom/bench/sweeps_group.hpp>

#include <carom/core/output_file.hpp>
#include <carom/core/result.hpp>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <iterator>
#include <string>
#include <vector>

namespace carom::bench {
namespace {

struct Group {
    const char* name;
    const char* about;
    Result<std::vector<Row>> (*run)(const GroupRequest&);
};
constexpr Group kGroups[] = {
    {"step", "whole steps against Bullet and ODE", run_step_group},
    {"rays", "single rays against Embree", run_rays_group},
    {"narrowphase", "boxes, hulls and meshes in pairs against FCL", run_narrowphase_group},
    {"sweeps", "first contacts of moving convex shapes against FCL and Bullet", run_sweeps_group},
    {"broadphase", "pairs of moving boxes against Bullet, FCL and CGAL", run_broadphase_group},
};

enum ExitCode { kOk = 0, kFailed = 1, kBadInput = 2 };

int fail(ExitCode code, const Error& error) {
    fmt::print(stderr, "peers: {}: {}\n", error.where, error.message);
    return code;
}

int run(int argc, char** argv) {
    CLI::App app{"The same work through Carom and other engines, side by side. Times are CPU time on one thread."};
    app.name("peers");
    std::string group, filter, json;
    std::string about, names;
    for (const Group& g : kGroups) {
        about += fmt::format("{}{}: {}", about.empty() ? "" : "; ", g.name, g.about);
        names += fmt::format("{}{}", names.empty() ? "" : ", ", g.name);
    }
    app.add_option("GROUP", group, about)->required();
    app.add_option("FILTER", filter, "only the rows whose bench/peer contains this, e.g. pile_boxes/4000 or embree-fast");
    CLI::Option* json_option = app.add_option("--json", json, "write the rows into this file; - prints them, and the table goes to stderr");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kOk : kBadInput;
    }
    const auto* const found = std::find_if(std::begin(kGroups), std::end(kGroups), [&](const Group& g) { return group == g.name; });
    if (found == std::end(kGroups)) {
        return fail(kBadInput, {ErrorCode::UnknownName, fmt::format("no group is called \"{}\"; there are {}", group, names), "group"});
    }

    const bool wants_json = !json_option->empty();
    if (wants_json) {
        if (Status status = check_writable(json); !status) return fail(kBadInput, status.error());
    }
    const Result<std::vector<Row>> rows = found->run({.filter = filter, .table = json == "-" ? stderr : stdout});
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
