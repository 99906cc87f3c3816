// Skins as real people have them: bodies of the model, whose skins are moved along their normals by
// smooth random fields. How far, and over what lengths, is what scanned adults differ by from the
// nearest body that the package's shapes make.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "morph/shapes/body_model.h"

namespace ecorche {

// Normal distance of scanned adults' skins from the nearest package body, by region (positive:
// outwards).
struct SkinResidual {
  const char* region;
  double mean, sd;  // m
  double length;    // m over which the correlation falls to 1/e
};
inline constexpr std::array<SkinResidual, 12> kSkinResiduals{{
    {"head_neck", 0.0e-3, 4.4e-3, 5e-3},
    {"shoulder", 5.8e-3, 7.2e-3, 50e-3},
    {"torso", 1.4e-3, 6.2e-3, 50e-3},
    {"hip", 1.0e-3, 6.5e-3, 55e-3},
    {"upper_arm", 0.3e-3, 6.2e-3, 50e-3},
    {"elbow", -1.1e-3, 4.9e-3, 35e-3},
    {"forearm", -0.7e-3, 4.5e-3, 35e-3},
    {"hand", -0.1e-3, 3.3e-3, 10e-3},
    {"thigh", -1.0e-3, 4.3e-3, 55e-3},
    {"knee", -1.2e-3, 3.5e-3, 45e-3},
    {"shin", -0.7e-3, 3.7e-3, 45e-3},
    {"foot", 0.1e-3, 2.6e-3, 10e-3},
}};

// Lengths below the skin's own detail crumple it: fields change over no less than this, m.
inline constexpr double kShortestField = 25e-3;

struct RealSkin {
  Body body;              // mass 0, as of a scan
  BodySpec spec;          // of the body that was moved
  double scale;           // of the table's spread, 0.5 .. 1.5
  Eigen::VectorXd moved;  // #skin, along the normals of the body that was moved, m
};

// Deterministic: one seed, one skin. The mirrored share of the fields' variance is 0.6.
class RealSkins {
 public:
  explicit RealSkins(const BodyModel& model);

  // Both sexes, 18 .. 85 years, body mass index 17 .. 42. The skin crosses itself in no more
  // triangles than the body's.
  RealSkin make(unsigned seed) const;

  // Index in kSkinResiduals of each skin vertex; -1 behind lips and lids. #skin
  const std::vector<int>& regions() const { return regions_; }

 private:
  Eigen::VectorXd field(const Points& V, unsigned seed) const;
  Eigen::VectorXd displacement(const Points& V, double scale, unsigned seed,
                               const Eigen::VectorXd& inwards,
                               const Eigen::VectorXd& outwards) const;
  void calibrate();

  const BodyModel& model_;
  std::vector<int> regions_;
  std::vector<std::vector<int>> rings_;
  std::vector<double> lengths_;                 // the fields' different lengths
  Eigen::MatrixXd share_;                       // #skin x #lengths, squares sum to 1
  Eigen::VectorXd mean_, sd_;                   // #skin, m, smooth
  std::array<double, 12> mean_of_{}, sd_of_{};  // what the regions are given to come out as asked
};

}  // namespace ecorche
