// Our skeleton in the coordinates that markers on the skin see, and in sizes of its parts.
//
// Root, hips and upper arms turn freely. Trunk and neck each have three turns, which their joints
// share in proportion to their ranges; elbows, forearms, wrists, knees, ankles and feet turn about
// their own axes. Upper arms are counted against the thorax: clavicle and scapula follow the arm
// (shoulder_rhythm.h), and markers see what they do beyond that.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anatomy/skeleton.h"

namespace ecorche::inline v1 {

// A part of the figure that turns.
struct FigureTurn {
  bool free = false;            // a ball; else a vector of turns about the joints' anatomical axes
  int first = 0;                // of its coordinates in the figure's
  int slot = 0;                 // in FigurePose::free or shared
  int parent = -1;              // of a ball: in whose frame it turns; -1: the world
  std::vector<int> components;  // of the vector that are free: 0 flexion, 1 abduction, 2 rotation
  std::vector<int> joints;      // one after the other, or side by side (toes)
  std::vector<Vec3> shares;     // #joints: of the vector
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();      // limits of the vector, from rest, rad
  Vec3 usual = Vec3::Zero(), spread = Vec3::Ones();  // where it is before anything is seen, rad
};

struct FigurePose {
  Vec3 root = Vec3::Zero();
  std::vector<Quat> free;    // by slot
  std::vector<Vec3> shared;  // by slot
};

// Segments whose sizes are found.
inline constexpr std::array<const char*, 11> kFigureSizes = {
    "pelvis width", "pelvis height", "trunk length", "trunk width", "head and neck", "upper arm",
    "forearm",      "hand",          "thigh",        "shank",       "foot"};
using FigureSizes = Eigen::Matrix<double, int(kFigureSizes.size()), 1>;

struct MarkerFigure {
  Skeleton skeleton;                         // at the sizes that are set
  std::vector<Vec3> offsets;                 // #joints: of X_PJ at sizes of one
  std::vector<FigureTurn> turns;             // the root's first
  std::vector<int> turn_of;                  // #joints: -1: none
  std::vector<std::array<int, 3>> sizes_of;  // #joints: along x, y, z at rest, of kFigureSizes
  std::array<int, 2> clavicle{}, scapula{}, shoulder{}, elbow{};  // left, right
  int coordinates = 0;
  FigureSizes sizes = FigureSizes::Ones();
};

// Preconditions (std::invalid_argument): the skeleton has our joints.
MarkerFigure make_figure(const Skeleton& skeleton);
void set_sizes(const FigureSizes& sizes, MarkerFigure& figure);
FigurePose attention(const MarkerFigure& figure);

// The pose of all joints, and where they are.
void figure_kinematics(const MarkerFigure& figure, const FigurePose& at, Pose& pose,
                       std::vector<Transform>& X);

// Adds a step of all coordinates.
void move_figure(const MarkerFigure& figure, const Eigen::VectorXd& step, FigurePose& at);

// The turn from one pose to another by coordinates, of everything but the root.
void figure_difference(const MarkerFigure& figure, const FigurePose& from, const FigurePose& to,
                       Eigen::VectorXd& out);

// Derivatives of a point of a joint's frame, `local` at sizes of one: by coordinates (3 x
// #coordinates, zeroed by the caller), and by sizes if `by_size` is not null (3 x #sizes). X, at:
// of figure_kinematics.
void point_derivatives(const MarkerFigure& figure, const FigurePose& at,
                       const std::vector<Transform>& X, int joint, const Vec3& local,
                       const Vec3& offset, Eigen::Ref<Eigen::Matrix3Xd> by_coordinate,
                       Eigen::Matrix<double, 3, int(kFigureSizes.size())>* by_size);

// World position of such a point, `offset` beyond it at no size.
Vec3 figure_point(const MarkerFigure& figure, const std::vector<Transform>& X, int joint,
                  const Vec3& local, const Vec3& offset);

}  // namespace ecorche::inline v1
