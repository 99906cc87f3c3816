// What is measured of a muscle in a pose, and over a motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/posing_table.h"

namespace ecorche {

struct MuscleFigures {
  double length = 0, rest_length = 0;  // of the longest strip, tendons included, m
  double volume = 0;                   // m^3
  double fibre_length = 0;             // m
  double force = 0;                    // isometric, at full effort, N
  // m, positive where pulling increases the angle; the mean of the strips that cross the joint
  std::optional<double> moment_arm;
};

// The joint that a name means beside a muscle of a side ("_l", "_r"): the one of that name, or that
// of the muscle's side. -1: there is none.
int joint_beside(const Skeleton& skeleton, const std::string& name, const std::string& side);

// `joint`, `axis`: about which a moment arm is wanted; -1: none.
MuscleFigures muscle_figures(const Anatomy& anatomy, int muscle, const Pose& pose,
                             const std::vector<double>& activation, int joint, int axis);

// One muscle with the skeleton that it moves with, measured pose after pose.
class MuscleGauge {
 public:
  // `joint`, `axis`: as of muscle_figures().
  MuscleGauge(const Anatomy& anatomy, int muscle, int joint, int axis);

  double length(const Pose& pose, double activation) const;  // of the longest strip, m
  std::optional<double> moment_arm(const Pose& pose, double activation) const;
  // Width of its thickest section over that at rest, relaxed: the root of their areas.
  double bulge(const Pose& pose, double activation) const;
  // Pull along the path, N: Hill's fibre in a row with a tendon that is just slack at rest
  // (anatomy/muscles/force_curves.h). `speed`: the path's, m/s, lengthening positive. 0 where no
  // fibres are known.
  double force(double length, double speed, double activation) const;

 private:
  Anatomy one_;
  PosingTable table_;
  int joint_, axis_;
  double thickest_ = 0;  // m^2, of half axes multiplied
};

// A muscle over a motion, frame after frame.
struct MuscleCurves {
  std::vector<double> lengths, efforts, bulges;  // m, 0 .. 1, times
  std::vector<std::optional<double>> moment_arms;
  std::vector<double> speeds, forces;  // m/s, N; once all frames are there
};
void add_frame(const MuscleGauge& gauge, const Pose& pose, double activation, MuscleCurves& curves);
void finish(const MuscleGauge& gauge, double fps, MuscleCurves& curves);
// As a table, a row a frame: seconds, mm, mm/s, mm, 0 .. 1, N, times.
std::string table_of(const MuscleCurves& curves, double fps);

// How fast values that lie 1 / fps apart change, a second: from the one before to the one after.
std::vector<double> speeds_of(const std::vector<double>& values, double fps);

}  // namespace ecorche
