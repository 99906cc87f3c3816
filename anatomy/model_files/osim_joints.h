// Coordinates and joints of OpenSim files: what value each coordinate has in the poses that a model
// is read in, and where joints put their bodies.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include <pugixml.hpp>

#include "anatomy/model_files/musculoskeletal_model.h"

namespace ecorche::inline v1 {

struct OsimCoordinate {
  double initial = 0, low = 0, high = 0;
  bool limited = false, locked = false, turns = false;  // turns: an angle, not a length
};

struct OsimJoint {
  std::string name, kind;
  pugi::xml_node node;  // the joint's element
  std::vector<std::string> coordinates;
  std::string parent, child;  // bodies; parent "ground" for the root
  Transform X_PF = Transform::Identity(), X_BM = Transform::Identity();
  std::string where;  // "model.osim: joint 'hip_r'"
};

class OsimCoordinates {
 public:
  void add(const OsimJoint& joint);  // declares the coordinates of a joint's element
  void couple(pugi::xml_node constraint, const std::string& where);  // CoordinateCouplerConstraint
  void settle();  // values in both poses; couplings included
  double value(const std::string& name, int pose,
               const std::string& where) const;  // throws InputError for unknown ones

 private:
  struct Coupling {
    std::string dependent;
    std::vector<std::string> independent;
    pugi::xml_node function;
    double scale = 1;
    std::string where;
  };
  std::map<std::string, OsimCoordinate> coordinates_;
  std::vector<Coupling> couplings_;
  PerPose<std::map<std::string, double>> values_;
};

// X_FM of a joint in a pose. Notes kinds that are taken to be something simpler.
Transform osim_joint_transform(const OsimJoint& joint, const OsimCoordinates& coordinates, int pose,
                               std::vector<std::string>& notes);

}  // namespace ecorche::inline v1
