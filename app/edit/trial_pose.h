// What a document is tried in, on a character: pose, activation, and the figures of a muscle in
// them.
#pragma once

#include <optional>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posing/posing_table.h"
#include "app/edit/workshop.h"

namespace ecorche {

// The document's pose of the pose book (`start` where there is none, or a motion is played) with
// the joints that were turned.
Pose trial_pose(Workshop& workshop, const Document& document, const Skeleton& skeleton,
                const Pose& start);

std::vector<double> trial_activation(const Document& document, const Anatomy& anatomy);

struct MuscleFigures {
  double length = 0, rest_length = 0;  // of the longest strip, tendons included, m
  double volume = 0;                   // m^3
  double fibre_length = 0;             // m
  double force = 0;                    // isometric, at full effort, N
  // m, positive where pulling increases the angle; the mean of the strips that cross the joint
  std::optional<double> moment_arm;
};

// `joint`, `axis`: about which a moment arm is wanted; -1: none.
MuscleFigures muscle_figures(const Anatomy& anatomy, int muscle, const Pose& pose,
                             const std::vector<double>& activation, int joint, int axis);

// One muscle with the skeleton that it moves with, measured pose after pose.
class MuscleGauge {
 public:
  // `joint`, `axis`: as of muscle_figures().
  MuscleGauge(const Anatomy& anatomy, int muscle, double activation, int joint, int axis);

  double length(const Pose& pose) const;  // of the longest strip, m
  std::optional<double> moment_arm(const Pose& pose) const;

 private:
  Anatomy one_;
  PosingTable table_;
  double activation_;
  int joint_, axis_;
};

// How fast values that lie 1 / fps apart change, a second: from the one before to the one after.
std::vector<double> speeds_of(const std::vector<double>& values, double fps);

}  // namespace ecorche
