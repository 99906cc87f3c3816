// What the readers of model files share: XML with limits, lists of numbers, paths that stay inside
// the model's folder.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "anatomy/limits.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct ModelFiles {
  std::function<std::string(const std::string& path)>
      read;  // by normalised path relative to the model's folder
};

namespace model_xml {

// Throws InputError "name: byte N: ..." or, for elements nested deeper than limits::kXmlDepth,
// LimitError before parsing.
void load(pugi::xml_document& document, std::string_view text, const std::string& name);

// Words of a text as finite numbers; throws InputError "where: ..." for anything else or more than
// `most`.
std::vector<double> numbers(std::string_view text, const std::string& where,
                            std::size_t most = 100000);
double number(std::string_view text, const std::string& where);
Vec3 vector3(std::string_view text, const std::string& where);

// `path` as seen from the folder of `from`, normalised; throws InputError when it leaves the
// model's folder or is absolute.
std::string inside(const std::string& from, const std::string& path, const std::string& where);

// Rotation of body-fixed turns about x, y, z (OpenSim's orientation).
Mat3 body_xyz(const Vec3& angles);

}  // namespace model_xml
}  // namespace ecorche::inline v1
