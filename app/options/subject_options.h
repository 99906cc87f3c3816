// Options that several verbs share: what they work on, and the form of what they write.
#pragma once

#include <filesystem>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ecorche {

// `character`, required: a file of `ecorche fit` or one person of a crowd; for open_character().
void add_character_option(CLI::App& verb, std::filesystem::path& character);

// `body`, optional unless made required: a body, a character or a bare skin; for open_body().
CLI::Option* add_body_option(CLI::App& verb, std::filesystem::path& body);

// A template of `ecorche template import`, under the name `name`; optional.
void add_template_option(CLI::App& verb, const std::string& name, std::filesystem::path& file);

// --sex: "male" or "female"; `help` says whose.
CLI::Option* add_sex_option(CLI::App& verb, std::string& sex, const std::string& help);

// --allow-unusual: measurements beyond those of people.
void add_unusual_option(CLI::App& verb, bool& allowed);

// -o, --output, required: a body file.
void add_body_output_option(CLI::App& verb, std::filesystem::path& output);

// --json: the report on stdout in place of a table.
void add_json_option(CLI::App& verb, bool& json);

}  // namespace ecorche
