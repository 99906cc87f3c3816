// One side and the middle of a skeleton, in left-hand coordinates: what placing works on.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/base_mesh/body_package.h"
#include "morph/placement/bone_groups.h"

namespace ecorche::inline v1 {

using NamedPoints = std::map<std::string, Vec3, std::less<>>;

struct HalfBone {
  std::string name;  // without suffix
  int group = 0;
  bool paired = false;
  TriMesh mesh;
  std::vector<int> watched;  // vertices that stick out first, whatever way the bone goes
};

// Samples that stand for a bone's surface: far points in 26 directions, then furthest from those
// already chosen.
std::vector<int> surface_samples(const TriMesh& mesh, int count);
std::vector<int> watched_vertices(const TriMesh& mesh);

struct HalfSkeleton {
  NamedPoints points;  // joint centres, tips of fingers and toes, bases of the hand's rays
  NamedPoints hinges;  // flexion axes by joint, unit
  std::vector<HalfBone> bones;
  double stature = 0;    // m
  double mid_plane = 0;  // x of the plane of symmetry, m
};

// Precondition: bones and joints are named as in data/bones.csv; throws UnfitError that names what
// is missing.
HalfSkeleton left_half(const Anatomy& anatomy, const FitRules& rules, double mid_plane,
                       double stature);

// Adds what follows from the bones: finger and toe tips, bases of the rays, orbit, radioulnar
// joint.
void add_bone_points(HalfSkeleton& half);

// The point of a bone that a landmark rule picks. Throws UnfitError when the bone is missing or no
// vertex is within the limits.
struct BonePoint {
  int bone = 0;  // of HalfSkeleton::bones
  int vertex = 0;
  int group = 0;
  Vec3 position = Vec3::Zero();
};
BonePoint find_landmark(const HalfSkeleton& half, const LandmarkRule& rule);

// Where the joints of a skin are, guessed from the marks of the package's rigs (left side and
// middle). `cubes`: joint_cubes of a package shape; its weight and height should be near the
// average, elsewhere the marks mislead.
NamedPoints guess_centres(const FitRules& rules, const std::vector<Landmark>& cubes, Sex sex,
                          double stature);

// Adds the points of `source` that `target` lacks: between known ends a piece of the spine is
// carried by a similarity, others by the map of the group that they belong to.
void complete_centres(const HalfSkeleton& source, NamedPoints& target);

// Flexion axes from joint centres alone, unit, for the pose that the limbs are in.
NamedPoints guess_hinges(const NamedPoints& centres);

// The map that carries a group by its joint centres, before any correction. `width`: scale across
// the long axis.
BoneMap expected_map(const GroupRule& rule, const NamedPoints& source,
                     const NamedPoints& source_hinges, const NamedPoints& target,
                     const NamedPoints& target_hinges, double width);

}  // namespace ecorche::inline v1
