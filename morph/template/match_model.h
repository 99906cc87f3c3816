// Another program's model matched with a skeleton of ours: which joint carries each of its bodies,
// and the similarity that takes the body there.
//
// Names are matched by data/model_bodies.csv (and by the names of our joints). The posture of the
// model differs from the skeleton's, so each body is taken over by itself: turned so that the
// directions between its joint centres agree (Wahba's problem, solved by singular values, with a
// small weight on leaving the body as it stands, which decides the turn about its long axis),
// scaled and shifted so that the centres agree in the least squares. The model is tried in each of
// its poses and, where the file does not say which way it faces, in four directions; the best one
// is taken. A model whose centres agree with the skeleton's to 5 mm (median) is the same skeleton
// and is moved as a whole.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/model_files/musculoskeletal_model.h"

namespace ecorche::inline v1 {

struct BodyRule {  // a row of data/model_bodies.csv
  std::string body;
  std::vector<std::string> joints;
  bool first = false;  // see data/model_bodies.csv
  bool none = false;
  std::string with;
};
std::vector<BodyRule> read_body_rules(const std::filesystem::path& file);

// "femur_r", "R_Femur", "right_femur" -> {"femur", right}; names without side give middle.
std::pair<std::string, Side> split_model_side(const std::string& name);

struct BodyMatch {
  // of the skeleton; the first moves the body. Never empty: bodies without a name we know go with
  // their parent
  std::vector<int> joints;
  int with = -1;       // second carrier, half and half
  bool named = false;  // found by its name
  // model body -> skeleton's rest world: turn, uniform scale, shift
  Affine X_TB = Affine::Identity();
  double scale = 1;
};

struct ModelMatch {
  int pose = kZeroPose;        // the model's, that agreed best
  int facing = 0;              // quarter turns to the left about the vertical
  bool same = false;           // same skeleton, moved as a whole
  double direction_error = 0;  // rms over pairs of joint centres, rad: how far the posture differs
  double center_error = 0;     // rms distance of joint centres once every body is taken over, m
  int centers = 0;
  std::vector<BodyMatch> bodies;     // #bodies of the model
  std::vector<std::string> unknown;  // bodies that carry muscles and go with their parents
};

// Throws UnfitError that lists the model's bodies when fewer than two are known.
ModelMatch match_model(const MusculoskeletalModel& model, const Skeleton& skeleton,
                       const std::vector<BodyRule>& rules);

}  // namespace ecorche::inline v1
