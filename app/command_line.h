// What was typed, before it is parsed: `help VERB`, and verbs and options that do not exist.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace ecorche {

// The words after the program's name, in forms that CLI11 knows: `help VERB...` becomes `VERB...
// --help`, -V becomes --version.
std::vector<std::string> read_command_line(int argc, char** argv);

// The subcommands that the words name, outermost first; `app` itself is not among them.
std::vector<const CLI::App*> named_verbs(const CLI::App& app,
                                         const std::vector<std::string>& words);

// The first word that is no verb or no option of the verb named, with what it may have been meant
// as: a sentence for people. Nothing where all are known.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

// The message of a parse error, with the verb's own help named as the next step.
std::string describe_parse_error(const CLI::App& app, const std::vector<std::string>& words,
                                 const CLI::ParseError& error);

}  // namespace ecorche
