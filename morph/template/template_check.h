// The template's promises: counts, muscle ends on their bones, mirror symmetry, volumes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "morph/template/template.h"

namespace ecorche::inline v1 {

struct LooseEnd {
  std::string muscle, bone;
  double distance = 0;  // m
};

struct TemplateCheck {
  // another anatomy than the built-in one: only volumes are promised, the rest is measured
  bool imported = false;
  int bones = 0, muscles = 0;
  int ends = 0;  // strip ends on bones; those on fascia, tendons and skin are left out
  double end_distance_median = 0;  // m, of the ends from the surface of their bone
  double end_distance_max = 0;
  std::vector<LooseEnd> loose_ends;  // further than 10 mm, worst first
  double mirror_bones_max = 0;       // m, a left bone's vertices from the mirrored right ones
  double mirror_muscles_max = 0;     // m, path points
  double volume_error_max = 0;       // relative, strips' tubes against Muscle::volume
  std::string volume_error_muscle;
  std::vector<std::string> unpaired;  // left without right or the other way round

  bool passed() const;
};

// `tables`: Assets::tables; the built-in template is compared with the table of muscles there.
// Throws as read_muscle_table does.
TemplateCheck check_template(const Template& tmpl, const std::filesystem::path& tables);
std::string format_check(const TemplateCheck& check);  // a table for people

}  // namespace ecorche::inline v1
