// An option that takes one of a few words.
//
//   add_choice(command, "--aim", aim, {{"chords", Aim::Chords}, {"edges", Aim::Edges}}, "where rays go");
#pragma once

#include <CLI/CLI.hpp>

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

namespace carom::cli {

template <class T>
using Choices = std::vector<std::pair<std::string, T>>;

/// The help shows the words; any other word is refused with a message that has it and them. `value` must outlive the parsing.
template <class T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, T& value, const Choices<T>& choices, const std::string& meaning) {
    std::string words, list;
    for (const auto& [word, unused] : choices) {
        words += (words.empty() ? "" : "|") + word;
        list += (list.empty() ? "" : ", ") + word;
    }
    const auto take = [&value, choices, name, list](const std::string& text) {
        for (const auto& [word, choice] : choices) {
            if (word != text) continue;
            value = choice;
            return;
        }
        throw CLI::ValidationError(name, fmt::format("\"{}\" is none of {}", text, list));
    };
    return command.add_option_function<std::string>(name, take, meaning)->type_name(words);
}

}  // namespace carom::cli
