// Registers a scan: which way it stands, how, its shape, and the base mesh on its surface.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/assets.h"
#include "morph/registration/articulated_body.h"
#include "morph/registration/registration.h"
#include "morph/shapes/tell_sex.h"

namespace ecorche::inline v1 {

struct RegistrationModel {
  BodyPackage package;
  ArticulatedBody body;
  SexLaws sexes;
};

// Throws InputError for missing or damaged packages and tables.
RegistrationModel make_registration_model(const Assets& assets);

struct RegistrationOptions {
  // Joints that are known, by the skeleton's names (hip_l, knee_l, ...; data/joints.csv) or the
  // segments' (articulated_body.h), in the coordinates of the file. Others are ignored.
  std::vector<Landmark> joints{};
  double joint_accuracy = 0.05;  // m; joints of rigs are not where the anatomical ones are
  // Points of the skin that are known: a name of registration_landmarks and its place,
  // in the coordinates of the file.
  std::vector<Landmark> landmarks{};
  std::optional<double> stature{};    // m, where it is known: sets the scale
  std::optional<std::string> pose{};  // "a", "t": of those alone
  // Called as stages begin: "pose", "shape", "surface", with a state to look at; may be empty.
  std::function<void(const std::string& stage, const Points& posed)> watch{};
};

// Names that `landmarks` knows, and their vertices.
std::vector<std::pair<std::string, int>> registration_landmarks(const RegistrationModel& model);

// Throws UnfitError for what is no person, or too little of one; the message says why. What is
// doubtful comes back with report.doubts.
Registration register_scan(const RegistrationModel& model, const Scan& scan,
                           const RegistrationOptions& options = {});

}  // namespace ecorche::inline v1
