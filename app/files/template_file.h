// Templates as files: the built-in one, or one made by `ecorche template import`.
#pragma once

#include <filesystem>

#include "anatomy/files/assets.h"
#include "morph/template/template.h"

namespace ecorche {

// The built-in template for an empty path. Else a character in the default body (.glb): its bones
// and muscles on the built-in skeleton, with the built-in tables for fitting. Throws InputError (no
// character), UnfitError (another skeleton than the built-in one, so that fitting does not know its
// joints).
Template open_template(const Assets& assets, const std::filesystem::path& file);

}  // namespace ecorche
