// Shape spaces are kept in the cache (anatomy/files/cache.h): building one takes seconds.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/files/assets.h"
#include "morph/shapes/shape_space.h"

namespace ecorche::inline v1 {

// Hash of everything that a space is built from: the tables, the pinned packages, the code.
// `tables`: Assets::tables.
std::string shape_space_key(const std::filesystem::path& tables, Sex sex);

// The space of build_shape_space from the cache; built and stored when there is none.
ShapeSpace read_shape_space(const BodyPackage& package, const TapeMeasure& tape, Sex sex);

}  // namespace ecorche::inline v1
