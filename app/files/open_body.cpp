#include "app/files/open_body.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "anatomy/base_mesh/base_skin.h"
#include "anatomy/base_mesh/skin_import.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "app/options/option_values.h"
#include "morph/shapes/tell_sex.h"
#include "skinning/crowd/crowd_read.h"
#include "skinning/files/character_read.h"

namespace ecorche {
namespace {

// Of a skin that measures can be taken of.
std::optional<TriMesh> base_mesh_of(const TriMesh& skin, const BodyPackage& package,
                                    const Common& common) {
  if (skin.V.rows() == package.skin_size) return skin;
  std::optional<BaseSkin> base = find_base(common.assets, skin);
  if (!base) return std::nullopt;
  return std::move(base->mesh);
}

}  // namespace

Body open_body(const std::filesystem::path& file, const BodyPackage& package, const Common& common,
               Report& report, const std::string& unit) {
  if (const std::optional<CrowdAddress> one = crowd_address(file))
    return read_crowd_person(open_crowd(one->file), one->person).body;
  if (has_body_notes(file)) return read_body(file);
  BareSkin bare = read_bare_skin(file, package, unit.empty() ? std::nullopt : metres_in(unit));
  for (const std::string& text : bare.notes) {
    note(common, text);
    report.append_text("body.notes", text);
  }
  report.set("body.unit", bare.unit);
  report.set("body.up", bare.up);
  report.set("body.front", bare.front);
  if (const std::optional<TriMesh> base = base_mesh_of(bare.body.skin, package, common)) {
    bare.body.sex = told_sex(make_sex_laws(BodyModel(common.assets)), base->V);
    report.set("body.sex", bare.body.sex == Sex::male ? "male" : "female");
  }
  return std::move(bare.body);
}

Body open_base_body(const std::filesystem::path& file, const BodyPackage& package,
                    const Common& common, Report& report, const std::string& unit) {
  Body body = open_body(file, package, common, report, unit);
  std::optional<TriMesh> base = base_mesh_of(body.skin, package, common);
  if (!base)
    throw UnfitError(
        fmt::format("{}: {} skin vertices, but measures are tied to the base mesh's {}; "
                    "bring the skin onto the base mesh first",
                    printable(file.string()), body.skin.V.rows(), package.skin_size));
  body.skin = std::move(*base);
  return body;
}

void add_skin_unit_option(CLI::App& verb, const std::string& name, std::string& unit) {
  verb.add_option(name, unit,
                  "Of a bare skin's coordinates: m, dm, cm, mm, in or ft; found out from its "
                  "height when left out")
      ->check(one_of({"m", "dm", "cm", "mm", "in", "ft"}));
}

}  // namespace ecorche
