// Bodies as command lines name them: ours, or skins from elsewhere on the base mesh.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "app/common_options.h"
#include "app/report.h"

namespace CLI {
class App;
}

namespace ecorche {

// A body or character of ours (.glb), "crowd.glb#ada", or a bare skin
// (anatomy/base_mesh/skin_import.h), whose sex its measures tell. What was found out about the
// latter's units and axes goes to people and to the report under `body`. `unit`: of a bare skin, by
// its short name; found out when empty. Throws InputError or UnfitError.
Body open_body(const std::filesystem::path& file, const BodyPackage& package, const Common& common,
               Report& report, const std::string& unit = {});

// The same with the base mesh's own vertices, which measures are tied to: of a refined skin, those
// that it comes from. Throws UnfitError for another skin.
Body open_base_body(const std::filesystem::path& file, const BodyPackage& package,
                    const Common& common, Report& report, const std::string& unit = {});

// The option, by whatever name, that `unit` comes from.
void add_skin_unit_option(CLI::App& verb, const std::string& name, std::string& unit);

}  // namespace ecorche
