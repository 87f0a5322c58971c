// peers: the same work through Carom and through other engines of Debian, side by side. docs/performance.md is the manual.
//
//   peers step pile_boxes/4000 --json out.json
#include <carom/bench/step_group.hpp>

#include <carom/core/result.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>
#include <system_error>

namespace carom::bench {
namespace {

enum ExitCode { kOk = 0, kFailed = 1, kBadInput = 2 };

int fail(ExitCode code, const Error& error) {
    fmt::print(stderr, "peers: {}: {}\n", error.where, error.message);
    return code;
}

Error not_written(const std::string& path) {
    return {ErrorCode::Io, fmt::format("cannot be written: {}", std::strerror(errno)), path.empty() ? "\"\"" : path};
}

// Before minutes of work: opens the file without changing it; one that did not exist does not exist afterwards.
Status check_writable(const std::string& path) {
    if (path == "-") return {};
    std::error_code ignored;
    const bool existed = std::filesystem::exists(path, ignored);
    std::FILE* file = std::fopen(path.c_str(), "a");
    if (file == nullptr) return not_written(path);
    std::fclose(file);
    if (!existed) std::filesystem::remove(path, ignored);
    return {};
}

Status write_report(const std::string& path, const std::string& text) {
    std::FILE* file = path == "-" ? stdout : std::fopen(path.c_str(), "w");
    if (file == nullptr) return not_written(path);
    bool good = std::fputs(text.c_str(), file) >= 0;
    good = std::fflush(file) == 0 && good;
    if (file != stdout) good = std::fclose(file) == 0 && good;
    return good ? Status{} : Status{not_written(path)};
}

int run(int argc, char** argv) {
    CLI::App app{"The same work through Carom and other engines, side by side. Times are CPU time on one thread."};
    app.name("peers");
    std::string group, filter, json;
    app.add_option("GROUP", group, "step: whole steps against Bullet and ODE")->required();
    app.add_option("FILTER", filter, "only the rows whose bench/peer contains this, e.g. pile_boxes/4000 or bullet");
    CLI::Option* json_option = app.add_option("--json", json, "write the rows into this file; - prints them, and the table goes to stderr");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? kOk : kBadInput;
    }
    if (group != "step") {
        return fail(kBadInput, {ErrorCode::UnknownName, fmt::format("no group is called \"{}\"; there is step", group), "group"});
    }

    const bool wants_json = !json_option->empty();
    if (wants_json) {
        if (Status status = check_writable(json); !status) return fail(kBadInput, status.error());
    }
    const Result<std::vector<Row>> rows = run_step_group({.filter = filter, .table = json == "-" ? stderr : stdout});
    if (!rows) return fail(kBadInput, rows.error());
    if (wants_json) {
        if (Status status = write_report(json, to_json(*rows).dump(2) + "\n"); !status) return fail(kFailed, status.error());
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
