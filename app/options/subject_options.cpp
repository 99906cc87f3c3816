#include "app/options/subject_options.h"

#include <CLI/CLI.hpp>

#include "app/options/option_values.h"

namespace ecorche {

void add_character_option(CLI::App& verb, std::filesystem::path& character) {
  verb.add_option("character", character, "Character written by `ecorche fit`, or CROWD.glb#NAME")
      ->required();
}

CLI::Option* add_body_option(CLI::App& verb, std::filesystem::path& body) {
  return verb.add_option(
      "body", body, "Body or character (.glb), or a bare skin on the base mesh (.obj, .ply, .glb)");
}

void add_template_option(CLI::App& verb, const std::string& name, std::filesystem::path& file) {
  verb.add_option(name, file,
                  "Template of `ecorche template import`; the built-in one when left out");
}

CLI::Option* add_sex_option(CLI::App& verb, std::string& sex, const std::string& help) {
  return verb.add_option("--sex", sex, help)->check(one_of({"male", "female"}));
}

void add_unusual_option(CLI::App& verb, bool& allowed) {
  verb.add_flag("--allow-unusual", allowed,
                "Accept measures that people do not have, as far as the skin can be bent");
}

void add_body_output_option(CLI::App& verb, std::filesystem::path& output) {
  verb.add_option("-o,--output", output, "Body file to write (.glb)")->required();
}

void add_json_option(CLI::App& verb, bool& json) {
  verb.add_flag("--json", json, "Print the report instead of a table");
}

}  // namespace ecorche
