#include "morph/template/template_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/authoring/muscle_checks.h"
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/muscles/transform_muscles.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kEndLimit = 0.010;     // m
constexpr double kMirrorLimit = 0.001;  // m
constexpr double kVolumeLimit = 0.01;
constexpr int kBones = 178, kMuscles = 400;

Vec3 mirrored(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

std::string other_side(const std::string& name) {
  std::string other = name;
  other.back() = name.back() == 'l' ? 'r' : 'l';
  return other;
}

void sum_up_ends(std::vector<double> distances, TemplateCheck& check) {
  check.ends = distances.size();
  if (distances.empty()) return;
  std::sort(distances.begin(), distances.end());
  check.end_distance_median = distances[distances.size() / 2];
  check.end_distance_max = distances.back();
  std::sort(check.loose_ends.begin(), check.loose_ends.end(),
            [](const LooseEnd& l, const LooseEnd& r) { return l.distance > r.distance; });
}

void check_ends(const MuscleTable& table, const Anatomy& anatomy, TemplateCheck& check) {
  std::vector<double> distances;
  for (const Attachment& end : measure_attachments(table, anatomy)) {
    distances.push_back(end.distance);
    if (end.distance > kEndLimit)
      check.loose_ends.push_back({anatomy.muscles[end.muscle].name, end.bone, end.distance});
  }
  sum_up_ends(std::move(distances), check);
}

// Models name bodies, not bones: the bone that an end lies nearest to was noted when it was
// imported.
void check_imported_ends(const Anatomy& anatomy, TemplateCheck& check) {
  std::vector<double> distances;
  for (const Muscle& muscle : anatomy.muscles)
    for (const auto& [name, at_origin] :
         {std::pair{muscle.origin_bone, true}, std::pair{muscle.insertion_bone, false}}) {
      const int bone = find_bone(anatomy, name);
      if (bone < 0) continue;
      const PathPoint& end =
          at_origin ? muscle.strips[0].path.front() : muscle.strips[0].path.back();
      const double distance = distance_to_mesh(end.rest, anatomy.bones[bone].mesh);
      distances.push_back(distance);
      if (distance > kEndLimit) check.loose_ends.push_back({muscle.name, name, distance});
    }
  sum_up_ends(std::move(distances), check);
}

void check_mirror(const Anatomy& anatomy, TemplateCheck& check) {
  for (const Bone& bone : anatomy.bones) {
    if (bone.side != Side::left) continue;
    const int right = find_bone(anatomy, other_side(bone.name));
    if (right < 0 || anatomy.bones[right].mesh.V.rows() != bone.mesh.V.rows()) {
      check.unpaired.push_back(bone.name);
      continue;
    }
    Points flipped = anatomy.bones[right].mesh.V;
    flipped.col(0) *= -1;
    check.mirror_bones_max =
        std::max(check.mirror_bones_max, (flipped - bone.mesh.V).rowwise().norm().maxCoeff());
  }
  for (const Muscle& muscle : anatomy.muscles) {
    if (muscle.side != Side::left) continue;
    const int right = find_muscle(anatomy, other_side(muscle.name));
    if (right < 0 || anatomy.muscles[right].strips.size() != muscle.strips.size()) {
      check.unpaired.push_back(muscle.name);
      continue;
    }
    for (size_t i = 0; i < muscle.strips.size(); ++i) {
      const auto &l = muscle.strips[i].path, &r = anatomy.muscles[right].strips[i].path;
      for (size_t k = 0; k < std::min(l.size(), r.size()); ++k)
        check.mirror_muscles_max =
            std::max(check.mirror_muscles_max, (mirrored(r[k].rest) - l[k].rest).norm());
    }
  }
}

}  // namespace

bool TemplateCheck::passed() const {
  if (imported) return volume_error_max <= kVolumeLimit;
  return bones == kBones && muscles >= kMuscles && loose_ends.empty() &&
         mirror_bones_max <= kMirrorLimit && mirror_muscles_max <= kMirrorLimit &&
         volume_error_max <= kVolumeLimit && unpaired.empty();
}

TemplateCheck check_template(const Template& tmpl, const std::filesystem::path& tables) {
  TemplateCheck check;
  check.bones = tmpl.anatomy.bones.size();
  check.muscles = tmpl.anatomy.muscles.size();
  check.imported = tmpl.tables.built_in.has_value();
  if (check.imported)
    check_imported_ends(tmpl.anatomy, check);
  else
    check_ends(read_muscle_table(tables), tmpl.anatomy, check);
  check_mirror(tmpl.anatomy, check);
  for (const Muscle& muscle : tmpl.anatomy.muscles) {
    const double error = std::abs(rest_volume(muscle) / muscle.volume - 1);
    if (error <= check.volume_error_max) continue;
    check.volume_error_max = error;
    check.volume_error_muscle = muscle.name;
  }
  return check;
}

std::string format_check(const TemplateCheck& check) {
  std::string out;
  const auto line = [&](const char* what, const std::string& found, const std::string& wanted,
                        bool ok) {
    out += fmt::format("{:<34} {:>14}   {:<16} {}\n", what, found, wanted, ok ? "ok" : "BROKEN");
  };
  if (check.imported) {
    line("bones", std::to_string(check.bones), "", true);
    line("muscles", std::to_string(check.muscles), "", true);
    line("muscle ends from their bones, max",
         fmt::format("{:.1f} mm", 1e3 * check.end_distance_max), "", true);
    line("muscle ends from their bones, median",
         fmt::format("{:.1f} mm", 1e3 * check.end_distance_median), "", true);
  } else {
    line("bones", std::to_string(check.bones), std::to_string(kBones), check.bones == kBones);
    line("muscles", std::to_string(check.muscles), fmt::format(">= {}", kMuscles),
         check.muscles >= kMuscles);
    line("muscle ends from their bones, max",
         fmt::format("{:.1f} mm", 1e3 * check.end_distance_max), "<= 10 mm",
         check.loose_ends.empty());
    line("muscle ends from their bones, median",
         fmt::format("{:.1f} mm", 1e3 * check.end_distance_median), "", true);
    line("left and right bones differ by", fmt::format("{:.3f} mm", 1e3 * check.mirror_bones_max),
         "<= 1 mm", check.mirror_bones_max <= kMirrorLimit);
    line("left and right muscles differ by",
         fmt::format("{:.3f} mm", 1e3 * check.mirror_muscles_max), "<= 1 mm",
         check.mirror_muscles_max <= kMirrorLimit);
  }
  line("muscle volume off its table by", fmt::format("{:.2f} %", 1e2 * check.volume_error_max),
       "<= 1 %", check.volume_error_max <= kVolumeLimit);
  for (const LooseEnd& end : check.loose_ends)
    out += fmt::format("  {} ends {:.1f} mm from {}\n", end.muscle, 1e3 * end.distance, end.bone);
  for (const std::string& name : check.unpaired)
    out += fmt::format("  {} has no partner on the other side\n", name);
  return out;
}

}  // namespace ecorche::inline v1
