// The typed words before CLI11 parses them: `help VERB`, unknown verbs and unknown options.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace ecorche {

// The words after the program's name, in forms that CLI11 knows: `help VERB...` becomes `VERB...
// --help`, -V becomes --version.
std::vector<std::string> read_command_line(int argc, char** argv);

// The subcommands that the words name, outermost first; `app` itself is not among them.
std::vector<const CLI::App*> named_verbs(const CLI::App& app,
                                         const std::vector<std::string>& words);

// A message about the first word that is no verb or no option of the named verb, with the most
// similar one; nothing if all words are known.
std::optional<std::string> unknown_word(const CLI::App& app, const std::vector<std::string>& words);

// The message of a parse error, which refers to the verb's --help.
std::string describe_parse_error(const CLI::App& app, const std::vector<std::string>& words,
                                 const CLI::ParseError& error);

}  // namespace ecorche
