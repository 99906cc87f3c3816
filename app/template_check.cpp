#include "app/template_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "anatomy/carry_muscles.h"

namespace ecorche {
namespace {

constexpr double kEndLimit = 0.010;     // m
constexpr double kMirrorLimit = 0.001;  // m
constexpr double kVolumeLimit = 0.01;
constexpr int kBones = 178, kMuscles = 400;

// Nearest point of a triangle by the regions of its plane (Ericson 2005, Real-Time Collision Detection, 5.1.5).
double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return ap.squaredNorm();
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return bp.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (ap - ab * (d1 / (d1 - d3))).squaredNorm();
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return cp.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (ap - ac * (d2 / (d2 - d6))).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return (bp - (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)))).squaredNorm();
  const double w = 1 / (va + vb + vc);
  return (ap - ab * (vb * w) - ac * (vc * w)).squaredNorm();
}

double distance_to(const TriMesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    best = std::min(best, squared_distance(p, mesh.V.row(mesh.F(f, 0)), mesh.V.row(mesh.F(f, 1)), mesh.V.row(mesh.F(f, 2))));
  return std::sqrt(best);
}

Vec3 mirrored(const Vec3& p) { return {-p.x(), p.y(), p.z()}; }

std::string other_side(const std::string& name) {
  std::string other = name;
  other.back() = name.back() == 'l' ? 'r' : 'l';
  return other;
}

void check_ends(const Anatomy& anatomy, TemplateCheck& check) {
  std::vector<double> distances;
  for (const Muscle& muscle : anatomy.muscles) {
    for (const Strip& strip : muscle.strips) {
      for (const auto& [bone_name, point] : {std::pair(muscle.origin_bone, strip.path.front()), std::pair(muscle.insertion_bone, strip.path.back())}) {
        const int named = bone_name.empty() ? -1 : find_bone(anatomy, bone_name);
        if (named < 0) continue;
        // Strips of one muscle may spread over several bones (ribs, vertebrae): any bone of the joint that carries the end counts.
        double distance = distance_to(anatomy.bones[named].mesh, point.rest);
        for (const Bone& bone : anatomy.bones)
          if (distance > 1e-3 && bone.joint == point.joints[0]) distance = std::min(distance, distance_to(bone.mesh, point.rest));
        distances.push_back(distance);
        if (distance > kEndLimit) check.loose_ends.push_back({muscle.name, bone_name, distance});
      }
    }
  }
  check.ends = static_cast<int>(distances.size());
  if (distances.empty()) return;
  std::sort(distances.begin(), distances.end());
  check.end_distance_median = distances[distances.size() / 2];
  check.end_distance_max = distances.back();
  std::sort(check.loose_ends.begin(), check.loose_ends.end(), [](const LooseEnd& l, const LooseEnd& r) { return l.distance > r.distance; });
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
    check.mirror_bones_max = std::max(check.mirror_bones_max, (flipped - bone.mesh.V).rowwise().norm().maxCoeff());
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
        check.mirror_muscles_max = std::max(check.mirror_muscles_max, (mirrored(r[k].rest) - l[k].rest).norm());
    }
  }
}

}  // namespace

bool TemplateCheck::passed() const {
  return bones == kBones && muscles >= kMuscles && loose_ends.empty() && mirror_bones_max <= kMirrorLimit && mirror_muscles_max <= kMirrorLimit &&
         volume_error_max <= kVolumeLimit && unpaired.empty();
}

TemplateCheck check_template(const Template& tmpl) {
  TemplateCheck check;
  check.bones = static_cast<int>(tmpl.anatomy.bones.size());
  check.muscles = static_cast<int>(tmpl.anatomy.muscles.size());
  check_ends(tmpl.anatomy, check);
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
  const auto line = [&](const char* what, const std::string& found, const std::string& wanted, bool ok) {
    out += fmt::format("{:<34} {:>14}   {:<16} {}\n", what, found, wanted, ok ? "ok" : "BROKEN");
  };
  line("bones", std::to_string(check.bones), std::to_string(kBones), check.bones == kBones);
  line("muscles", std::to_string(check.muscles), fmt::format(">= {}", kMuscles), check.muscles >= kMuscles);
  line("muscle ends from their bones, max", fmt::format("{:.1f} mm", 1e3 * check.end_distance_max), "<= 10 mm", check.loose_ends.empty());
  line("muscle ends from their bones, median", fmt::format("{:.1f} mm", 1e3 * check.end_distance_median), "", true);
  line("left and right bones differ by", fmt::format("{:.3f} mm", 1e3 * check.mirror_bones_max), "<= 1 mm", check.mirror_bones_max <= kMirrorLimit);
  line("left and right muscles differ by", fmt::format("{:.3f} mm", 1e3 * check.mirror_muscles_max), "<= 1 mm", check.mirror_muscles_max <= kMirrorLimit);
  line("muscle volume off its table by", fmt::format("{:.2f} %", 1e2 * check.volume_error_max), "<= 1 %", check.volume_error_max <= kVolumeLimit);
  for (const LooseEnd& end : check.loose_ends) out += fmt::format("  {} ends {:.1f} mm from {}\n", end.muscle, 1e3 * end.distance, end.bone);
  for (const std::string& name : check.unpaired) out += fmt::format("  {} has no partner on the other side\n", name);
  return out;
}

void report_check(const TemplateCheck& check, Report& report) {
  report.set("template.muscle_ends", check.ends);
  report.set("template.end_distance_median", check.end_distance_median);
  report.set("template.end_distance_max", check.end_distance_max);
  report.set("template.loose_ends", static_cast<int>(check.loose_ends.size()));
  report.set("template.mirror_bones_max", check.mirror_bones_max);
  report.set("template.mirror_muscles_max", check.mirror_muscles_max);
  report.set("template.volume_error_max", check.volume_error_max);
  report.set_flag("template.passed", check.passed());
}

}  // namespace ecorche
