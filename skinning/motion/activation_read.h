// Reads muscle activations from tables.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "anatomy/anatomy.h"
#include "skinning/motion/activation.h"

namespace ecorche::inline v1 {

// By the file's extension:
//   .csv         a column `time` and a column a muscle; or keyframes in any order: columns time,
//                muscle, value
//   .sto, .mot   OpenSim tables: a header that ends with `endheader`, then a line of labels, `time`
//                first. Where any label ends in `/activation` or `.activation`, the others are
//                ignored.
// Times are seconds and must rise (keyframes: no two of a muscle are equal). Throws InputError:
// unreadable, malformed, not finite, a value outside [0, 1], an unknown name (with the nearest
// ones); LimitError above 64 MB.
Activations read_activations(const std::filesystem::path& file, const Anatomy& anatomy,
                             const MuscleAliases& aliases = {});
Activations parse_activations(std::string_view text, const std::string& name,
                              const Anatomy& anatomy, const MuscleAliases& aliases = {});

}  // namespace ecorche::inline v1
