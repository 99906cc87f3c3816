// Where a hand can take hold of a document in the figure, and which action a drag is.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/posed_anatomy.h"
#include "app/edit/action_list.h"
#include "app/edit/document/workshop.h"
#include "app/studio/handles/live_muscles.h"
#include "viewer/draw_list.h"

namespace ecorche {

struct Handle {
  // belly: an end of the flesh; wrap: its middle; size: a radius or half length of a wrap; limit:
  // of a joint's angle; axis: an end of one of a joint's axes
  enum class Kind {
    point,
    joint,
    width,
    thickness,
    belly,
    wrap,
    size,
    limit,
    axis
  } kind = Kind::point;
  Side side = Side::left;
  int strip = 0, point = 0, points = 0;  // of a line, from 0; how many the line has
  int joint = -1;                        // of the skeleton
  PathPoint at{};                        // at rest, and what carries it
  Vec3 place = Vec3::Zero();             // now, world
  std::string name{};                    // "point:1:3", "point_r:1:3", "joint:elbow_l"
  // width, thickness, size, limit, axis: from there to `place`, now, world
  Vec3 middle = Vec3::Zero();
  Vec3 along = Vec3::Zero();  // width: of the line, towards the insertion, unit
  // width, thickness: of the section, as a share of the line; limit: as it is, deg
  double value = 0;
  // belly, limit: 0 the lower, 1 the upper; wrap, size: of the strip's wraps, from 0
  int index = 0;
  int axis = 0;  // size: of the wrap's frame; limit, axis: flexion, abduction, rotation
  Mat3 built = Mat3::Identity();  // axis: all three before a hand turned them, at rest
  // belly: the line by its shares; limit: where the bone points, by degrees
  std::vector<std::pair<double, Vec3>> way{};
};

Vec3 posed_place(const PathPoint& point, std::span<const Vec3> joint_rest,
                 const PosedAnatomy& posed);

// Points of a muscle's lines.
void add_points(const Muscle& muscle, std::span<const Vec3> joint_rest, const PosedAnatomy& posed,
                std::vector<Handle>& out);
// Centres of joints.
void add_joints(const Skeleton& skeleton, const PosedAnatomy& posed, std::vector<Handle>& out);

// A step of the table's left side, mm, that a step at rest in the shown body is there. `at`: the
// place in the table, m.
struct DragInput;
Vec3 step_in_table(const DragInput& input, const Vec3& at, int joint, Side side, const Vec3& rest);
// How far a step now goes at rest.
Vec3 rest_step(const PathPoint& at, const PosedAnatomy& posed, const Vec3& moved);

// A muscle's lines, sections and wraps as lines in the world.
struct WireShape {
  enum class Kind { line, section, wrap } kind = Kind::line;
  std::vector<Vec3f> points{};
  bool closed = false;
};
void add_wires(const Muscle& muscle, std::span<const Ellipse> slices,
               std::span<const Vec3> joint_rest, const PosedAnatomy& posed,
               std::vector<WireShape>& out);

// A drag of a handle as an action on both sides, or on the handle's alone. `moved`: in the world,
// m. Rounded to 0.1 mm.
struct DragInput {
  const Document& document;
  Workshop& workshop;
  const BoneCarrier& carrier;  // from the template's body to the shown one
  const PosedAnatomy& posed;
  const Skeleton& skeleton;  // of the shown body
};
// Of a point or a joint.
std::optional<Action> action_of_drag(const DragInput& input, const Handle& handle,
                                     const Vec3& moved, bool one_side);

}  // namespace ecorche
