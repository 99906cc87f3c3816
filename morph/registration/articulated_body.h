// The body that registration fits to a scan: a shape space of both sexes on a rig of few joints.
//
// x = scale (sum_b w_b (G_b (x0(z) - J_b(z)) + P_b)) + shift, linear blend skinning of a skin x0 =
// mean + basis z, whose joint centres J move with it. Joints are those of the body package's
// default rig, gathered into segments.
#pragma once

#include <string>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/types.h"
#include "morph/shapes/body_model.h"
#include "morph/shapes/shape_space.h"

namespace ecorche::inline v1 {

// How a segment may turn against its parent, from the rest pose.
struct SegmentJoint {
  std::string name;  // "thigh_l"
  Side side = Side::middle;
  int parent = -1;             // parents precede children
  double bend = 0, twist = 0;  // usual turns across and about the long axis, rad
  double skin_twist = 0;       // usual turn of the skin about it, rad
  Vec3 axis = Vec3::UnitY();   // long axis, world at rest
  // of a hinge: turns about it count as `bend`, others across as a tenth of it
  Vec3 hinge = Vec3::Zero();
  double hinge_min = 0, hinge_max = 0;  // rad
  double most = 0;                      // rad, of the whole turn, beyond which nobody goes; 0: any
};

// How far from its usual turns: squared deviations, and what lies beyond a hinge's ends.
double squared_turn(const SegmentJoint& joint, const Mat3& turn);

struct ArticulatedBody {
  Points mean;       // #skin x 3, m
  ShapeBasis basis;  // 3 #skin x K, per standard deviation. Column 0: from female to male
  std::vector<SegmentJoint> joints;
  Points joint_mean;       // #joints x 3
  ShapeBasis joint_basis;  // 3 #joints x K
  VertexWeights weights;   // of joints; sum 1
  Triangles F;
  std::vector<char> outer;        // #skin, 0: in the mouth or an eye's socket
  std::vector<VertexPart> parts;  // #skin
  std::vector<double> area;       // #skin, of the mean body, m^2; 0 where not outer
  std::vector<int> mirror;        // #skin
};

int find_segment(const ArticulatedBody& body, const std::string& name);  // or -1

// Reads or builds shape spaces, which takes seconds the first time. Throws as BodyModel.
ArticulatedBody make_articulated_body(const BodyModel& model);

// What registration looks for: shape, pose and place.
struct ArticulatedState {
  Eigen::VectorXd z;          // #K
  std::vector<Mat3> turns;    // #joints, local; the root's is its place in space
  Vec3 shift = Vec3::Zero();  // m
  double log_scale = 0;
};

ArticulatedState rest_state(const ArticulatedBody& body);

// Mean over all joints but the root.
double mean_squared_turn(const ArticulatedBody& body, const std::vector<Mat3>& turns);

// Somebody at rest.
struct RestShape {
  Points skin;     // #skin x 3
  Points normals;  // #skin x 3, unit
  Points centres;  // #joints x 3
};
RestShape rest_shape(const ArticulatedBody& body, const Eigen::VectorXd& z);

// A state's skin: the shape, which must outlive it, and the maps of joints.
struct ArticulatedPose {
  const RestShape& shape;
  std::vector<Mat3> turns;   // #joints, world
  std::vector<Vec3> places;  // #joints, world, posed centres
  double scale = 1;
  Vec3 shift = Vec3::Zero();
};
// Precondition: `shape` is that of the state's z.
ArticulatedPose articulate(const ArticulatedBody& body, const RestShape& shape,
                           const ArticulatedState& state);

// Of vertices as posed; of all for an empty list.
Points posed_points(const ArticulatedBody& body, const ArticulatedPose& pose,
                    const std::vector<int>& vertices = {});

// Blend of joint maps at a vertex: linear part, scale included.
Mat3 blended_turn(const ArticulatedBody& body, const ArticulatedPose& pose, int vertex);

}  // namespace ecorche::inline v1
