// Private to the writers of models: numbers, names and meshes as both formats have them. Numbers
// keep all their digits, so that what is read back is what was written.
#pragma once

#include <filesystem>
#include <string>

#include "anatomy/model_files/model_export.h"

namespace ecorche::inline v1 {

std::string text(double v);
std::string text(const Vec3& v);  // "x y z"

// For XML.
std::string escaped(const std::string& raw);

// The bones beside the model, their axes turned; returns the folder's name.
std::string write_model_meshes(const std::filesystem::path& file, const ExportModel& model,
                               const Mat3& axes);

}  // namespace ecorche::inline v1
