// Scans whose truth is known: people with real skins in standing poses, remeshed, with noise,
// outliers, holes, sometimes a floor, in any unit and axes. One seed, one scan.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "morph/shapes/body_model.h"
#include "tests/morph/posed_people.h"
#include "tests/morph/real_skins.h"

namespace ecorche {

struct SyntheticScan {
  std::string name;    // "male 43, hands on hips, 45000 faces, cm, Z up, obj"
  std::string format;  // "ply", "obj", "off", "stl"
  // The file's coordinates.
  TriMesh mesh;
  // The scanned surface: before noise and what was added; of the shown parts only. #clean rows.
  Points clean;
  Points noisy;                  // the same points as the file has them
  Points truth;                  // #skin: where the base vertices are
  std::vector<char> shown;       // #skin: the scan has surface within 15 mm
  std::vector<Landmark> joints;  // names as registration has them
  // file = axes (world / unit) + shift
  double unit = 1;  // metres
  Mat3 axes = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Points rest;  // #skin, world, m
  Sex sex = Sex::male;
};

class SyntheticScans {
 public:
  explicit SyntheticScans(const BodyModel& model);
  SyntheticScan make(unsigned seed) const;

 private:
  const BodyModel& model_;
  RealSkins skins_;
  PersonPoser default_, game_;
};

// In the format; float coordinates. Throws OutputError.
void write_scan(const std::filesystem::path& file, const TriMesh& mesh, const std::string& format);

}  // namespace ecorche
