// What every subcommand of `carom` shares: exit codes, and how a subcommand hands over what it is to do.
//
//   void add_list_command(CLI::App& app, Action& action);    // parsing sets `action`, main runs it
#pragma once

#include <carom/core/result.hpp>

#include <CLI/CLI.hpp>

#include <functional>

namespace carom::cli {

/// docs/cli.md defines these for users.
enum class ExitCode : int {
    Ok = 0,
    Failed = 1,     ///< a check failed, or a result could not be delivered after the run
    BadInput = 2,   ///< usage, options, scene files, paths: found before anything ran
    NotFinite = 3,  ///< a body went non-finite or was quarantined
    Escaped = 4,    ///< a body left the scene's domain, or energy grew beyond the rule
};

using Action = std::function<ExitCode()>;

/// Prints "carom: where: message" to stderr. @return `code`.
ExitCode fail(ExitCode code, const Error& error);

void add_accuracy_command(CLI::App& app, Action& action);
void add_cast_command(CLI::App& app, Action& action);
void add_list_command(CLI::App& app, Action& action);
void add_plan_command(CLI::App& app, Action& action);
void add_run_command(CLI::App& app, Action& action);
void add_why_command(CLI::App& app, Action& action);
/// Adds nothing in builds without viz.
void add_view_command(CLI::App& app, Action& action);

}  // namespace carom::cli
