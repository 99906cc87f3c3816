// Pose, shape and place of an articulated body by its nearest points to a scan and back.
//
// Gauss-Newton on robust distances (Geman and McClure), normals agreeing, with priors on turns and
// shape: iterated closest points in both directions, so that neither may the body hang in the air
// nor the scan be left over.
#pragma once

#include <vector>

#include "morph/registration/articulated_body.h"
#include "morph/registration/point_tree.h"

namespace ecorche::inline v1 {

// A scan as the fit sees it.
struct ScanTarget {
  SurfacePoints surface;    // m
  std::vector<int> spread;  // points spread evenly, in an order of which every beginning is spread
  bool one_sided = false;   // seen from one side: the body may have points that the scan lacks
  // #points, 1: beside a hole or an edge of what was seen; empty: none is
  std::vector<char> border{};
  std::vector<char> covering{};  // #points, 1: clothes: the body lies within; empty: none are
};

// Something known: where a joint or a vertex of the skin lies.
struct PlaceHint {
  int joint = -1, vertex = -1;  // one of them
  Vec3 place = Vec3::Zero();    // m, in the scan
  double accuracy = 0.03;       // m
};

struct FitStage {
  int rounds = 10;
  int samples = 1500;   // of the scan; of the body about as many
  double width = 0.1;   // m, distances beyond count ever less
  double reach = 0.1;   // m, of normals (PointTree)
  double across = 0.3;  // share of the distance across the normal that counts too
  bool shape = true, scale = false;
  double pose_prior = 1, shape_prior = 1;
  // The body stands: joints stay within SegmentJoint::most and twist as skin does.
  bool settled = false;
};

struct ArticulatedFit {
  const ArticulatedBody& body;
  const ScanTarget& scan;
  std::vector<PlaceHint> hints{};
  std::vector<int> joints{};  // that may turn while all else stays; empty: everything moves
  std::vector<int> still{};   // that keep their turns, and whose skin does not look for the scan
};

// Vertices spread over the outer skin, evenly; of hands and feet fewer count less.
struct BodySamples {
  std::vector<int> vertices;
  std::vector<double> weights;  // sum 1
};
BodySamples spread_vertices(const ArticulatedBody& body, int count);

// `prior`: turns that joints tend to.
void fit_articulated(const ArticulatedFit& fit, const FitStage& stage, const BodySamples& samples,
                     const PointTree& scan_tree, const std::vector<Mat3>& prior,
                     ArticulatedState& state);

// Mean of distances both ways, cut off at `most` and as a share of it: 0 .. 1.
double two_way_misfit(const ArticulatedFit& fit, const BodySamples& samples,
                      const PointTree& scan_tree, const RestShape& shape,
                      const ArticulatedState& state, int scan_samples, double most);

}  // namespace ecorche::inline v1
