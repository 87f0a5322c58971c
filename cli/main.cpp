// carom: runs, plans, lists and shows scenes. docs/cli.md is the manual.
//
//   carom run pile_boxes --bodies 1000 --json -
#include <carom/cli/build_info.hpp>
#include <carom/cli/command.hpp>

#include <carom/core/check.hpp>

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>

namespace carom::cli {
namespace {

bool is_command(const CLI::App& app, const std::string& name) {
    return !app.get_subcommands([&](const CLI::App* command) { return command->get_name() == name; }).empty();
}

std::string command_names(const CLI::App& app) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands({})) {
        names += (names.empty() ? "" : ", ") + command->get_name();
    }
    return names;
}

ExitCode run(int argc, char** argv) {
    CLI::App app{"Carom: collision detection and physics, run from end to end."};
    app.name("carom");
    app.set_version_flag("--version", version());
    app.require_subcommand(1);
    Action action;
    add_list_command(app, action);
    add_plan_command(app, action);
    add_run_command(app, action);
    add_view_command(app, action);
    add_why_command(app, action);
    add_cast_command(app, action);
    add_accuracy_command(app, action);
    if (argc > 1 && argv[1][0] != '-' && !is_command(app, argv[1])) {
        return fail(ExitCode::BadInput, {ErrorCode::UnknownName,
                                         fmt::format("no command is called \"{}\"; there are {}", argv[1], command_names(app)),
                                         "command"});
    }
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        // The parser's own codes (100 and more) are all bad usage; help and version are not errors.
        return app.exit(error) == 0 ? ExitCode::Ok : ExitCode::BadInput;
    }
    return action();
}

}  // namespace

ExitCode fail(ExitCode code, const Error& error) {
    const std::string place = error.where.empty() ? "" : error.where + ": ";
    fmt::print(stderr, "carom: {}{}\n", place, error.message);
    return code;
}

}  // namespace carom::cli

int main(int argc, char** argv) {
    try {
        return static_cast<int>(carom::cli::run(argc, argv));
    } catch (const carom::MisuseError& error) {
        return static_cast<int>(carom::cli::fail(carom::cli::ExitCode::BadInput, error.error()));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "carom: %s\n", error.what());
        return static_cast<int>(carom::cli::ExitCode::Failed);
    }
}
