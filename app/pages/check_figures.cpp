#include "app/pages/check_figures.h"

namespace ecorche {
namespace {

constexpr double kSharedByBones = 0.05e-6;  // m^3, of pairs that are told

}  // namespace

void report_anatomy_check(const AnatomyCheck& check, Report& report) {
  report.set("check.bone_points", check.bone_points);
  report.set("check.bone_points_outside", check.bone_points_outside);
  report.set("check.muscle_points", check.muscle_points);
  report.set(
      "check.muscle_points_outside_share",
      check.muscle_points > 0 ? double(check.muscle_points_outside) / check.muscle_points : 0.0);
  report.set("check.muscle_points_outside_max", check.furthest_outside);
  report.set("check.fascia_points", check.fascia.points);
  report.set("check.fascia_points_outside", check.fascia.outside);
  report.set("check.fascia_points_pierced", check.fascia.pierced);
  report.set("check.posed_fascia_outside_share_mean", check.posed_fascia_outside);
  report.set("check.posed_fascia_pierced_share_mean", check.posed_fascia_pierced);
  report.set("check.muscle_overlap_share", check.overlap_share);
  report.set("check.bone_overlap_share", check.bone_share);
  report.set("check.bone_overlap_share_max", check.pierced_share);
  report.set("check.bone_overlap_muscle", check.pierced_muscle);
  report.set("check.bones_in_bones_share", check.bone_overlap.share);
  for (const BonePair& pair : check.bone_overlap.pairs)
    if (pair.volume > kSharedByBones)
      report.set("check.bones_within." + pair.a + "." + pair.b, pair.volume);
  if (check.compared) {
    report.set("check.torn_muscles", check.torn);
    report.set("check.torn_muscle", check.torn_muscle);
    report.set("check.needles_at_rest", check.needles_at_rest);
  }
  report.set("check.posed_bone_points_outside_max", check.posed_bone_points_outside);
  report.set("check.filled_share", check.filled_share);
  report.set("check.slits", check.slits);
  report.set("check.slit_muscle", check.slit_muscle);
  report.set("check.shown_through", check.shown);
  report.set("check.shown_through_by_one", check.shown_by_one);
  report.set("check.shown_through_most", check.shown_most);
  report.set("check.fat_gap_median", check.gap_median);
  report.set("check.fat_gap_p95", check.gap_p95);
  report.set("check.ends", check.ends);
  report.set("check.loose_ends", check.loose_ends);
  report.set("check.end_distance_median", check.end_distance_median);
  report.set("check.end_distance_max", check.end_distance_max);
  report.set("check.poses", int(check.poses.size()));
  report.set("check.posed_outside_share_mean", check.posed_outside_share);
  report.set("check.posed_outside_share_max", check.posed_outside_worst);
  report.set("check.posed_overlap_share_mean", check.posed_overlap_mean);
  report.set("check.posed_overlap_share_max", check.posed_overlap_worst);
  report.set("check.posed_bone_share_max", check.posed_bone_share_worst);
  report.set("check.posed_spikes_mean", check.posed_spikes);
  report.set("check.posed_spike_max", check.posed_spike_max);
  report.set("check.posed_creased_share_mean", check.posed_creased_mean);
  report.set("check.posed_creased_share_max", check.posed_creased_worst);
  report.set("check.posed_needles_mean", check.posed_needles);
  report.set("check.posed_daylight_mean", check.posed_daylight);
  report.set("check.posed_buried_mean", check.posed_buried);
  report.set("check.posed_stretch_max", check.posed_stretch_max);
  report.set("check.posed_tendon_kink_max", check.posed_kink_max);
  report.set("check.posed_loose_ends_mean", check.posed_loose_ends);
  for (const PoseCheck& pose : check.poses) {
    const std::string key = "check.pose." + pose.name + ".";
    report.set(key + "creased_share", pose.creased_share);
    report.set(key + "needles", pose.needles);
    report.set(key + "daylight", pose.daylight);
    report.set(key + "buried", pose.buried);
    report.set(key + "stretch", pose.stretch);
    report.set(key + "tendon_kink", pose.kink);
    report.set(key + "loose_ends", pose.loose_ends);
    report.set(key + "muscle_overlap_share", pose.overlap_share);
    report.set(key + "bone_overlap_share", pose.bone_share);
    report.set(key + "bone_points_outside", pose.bone_points_outside);
    report.set(key + "bone_points_outside_max", pose.bone_depth);
    report.set(key + "muscle_points_outside", pose.muscle_points_outside);
    report.set(key + "fascia_points_outside", pose.fascia.outside);
    report.set(key + "fascia_points_pierced", pose.fascia.pierced);
  }
  if (check.swept || !check.poses.empty()) report.set("check.volume_drift_max", check.drift_max);
  if (check.swept) {
    report.set("check.path_jump_max", check.jump_max);
    report.set("check.paths_that_jump", check.paths_that_jump);
  }
  report.set("check.open_columns", double(check.open_columns));
}

void report_bulges(const Bulges& bulges, Report& report) {
  report.set("check.bulge.arm_relaxed", bulges.arm_relaxed);
  report.set("check.bulge.arm_flexed", bulges.arm_flexed);
  report.set("check.bulge.arm_tensed", bulges.arm_tensed);
  for (const Thickening& m : bulges.muscles) {
    report.set("check.bulge." + m.muscle + ".relaxed", m.relaxed);
    report.set("check.bulge." + m.muscle + ".tense", m.tense);
  }
}

}  // namespace ecorche
