// The course of a lift: a person lies on a sheet on a mattress; straps are drawn in, the spreader
// bar rises until the person hangs free, and comes to rest.
#pragma once

#include <functional>
#include <vector>

#include "skinning/lift/carry.h"

namespace ecorche::inline v1 {

struct SlingOptions {
  double width = 1.15;       // m
  double below_knee = 0.02;  // m from the knee towards the ankle to which the sheet reaches
  double spacing = 0.05;     // m between nodes. Larger: pressure in folds of the sheet is missed
  int straps = 4;            // 4 at the corners; 6: two more beside the hips
  SheetMaterial material{};
};

// A rectangle below the lying person, from the crown of the head to below the knees, with straps.
Sheet make_sling(const Patient& patient, const Pose& lying, const SlingOptions& options = {});

// A sheet of the user's: laid out in the plane of x (across) and z (along, the head's end at the
// smaller z), m, moved to where the rectangle would lie; straps at its outermost corners.
Sheet make_sling(const Patient& patient, const Pose& lying, const TriMesh& sheet,
                 const SlingOptions& options = {});

struct LiftOptions {
  double frames_per_second = 30;
  double lie = 1.5;          // s at rest on the mattress
  double draw_speed = 0.2;   // m/s at which straps are drawn in to their length
  double bar_height = 0.95;  // m above the mattress, before it rises
  double rise = 0.85;        // m
  double rise_speed = 0.2;   // m/s, the most
  double hang = 3;           // s at rest in the end
};

struct LiftFrame {
  double time = 0;
  Pose pose;
  Points nodes;                                                   // of the sheet
  Vec3 bar = Vec3::Zero();                                        // middle of the spreader bar
  Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> skin;  // pressed in, #V x 3
  std::vector<float> pressure;               // #V, Pa, smoothed (pressure_map.h)
  std::vector<Vec3> region;                  // N, by Patient::regions
  std::vector<double> straps;                // N
  double strap_lift = 0, mattress_lift = 0;  // N upwards
  std::vector<Vec3> pads;                    // N, by CarryModel::pads
  double limit_excess = 0;                   // rad
};

struct LiftResult {
  std::vector<LiftFrame> frames;
  CarryState last;
  double seconds = 0;       // of wall time that the steps took
  double core_seconds = 0;  // of all cores
};

// Where the bar's middle begins.
Vec3 bar_start(const CarryModel& model, const Pose& lying, const LiftOptions& options);

// Precondition: model.sheet has straps. `progress`: share of the time, 0 .. 1.
LiftResult lift_patient(const CarryModel& model, const Pose& lying, const LiftOptions& options,
                        const std::function<void(double)>& progress = {});

// The person comes to rest on the mattress or the pads, without a sheet or upon one; one frame of
// the end, or so many a second.
LiftResult rest_patient(const CarryModel& model, const Pose& pose, double seconds,
                        double frames_per_second = 0);

}  // namespace ecorche::inline v1
