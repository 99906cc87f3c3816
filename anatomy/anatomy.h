// What a body is made of: bones on joints, muscles as strips of ellipse slices along action lines,
// and the skin around them.
//
// A fitted anatomy is again an Anatomy: nothing downstream knows whether its body was sized,
// scanned or the template's own.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/skeleton.h"
#include "anatomy/types.h"

namespace ecorche::inline v1 {

struct Bone {
  std::string name;  // "femur_l"
  Side side = Side::middle;
  int joint = 0;  // the joint whose frame carries it
  TriMesh mesh;   // world coordinates of the rest pose
};

// A point of an action line. It is carried by one joint, or by a blend of two (belly wall: thorax
// and pelvis):
//   posed = share * T(joints[0]) * rest + (1 - share) * T(joints[1]) * rest,   T(j) = X_WJ(pose) *
//   X_WJ(rest)^-1
struct PathPoint {
  Vec3 rest = Vec3::Zero();          // world, rest pose
  std::array<int, 2> joints{0, -1};  // joints[1] = -1: one carrier only
  double share = 1;
  // whose bones place the point in another body, where it glides on them; -1: its carriers'
  int placing_joint = -1;
};

// A section's outline: factors of its ellipse at even eccentric angles from the width axis on,
//   point i = center + factor[i] (radii.x cos(2 pi i / 16) width + radii.y sin(2 pi i / 16)
//   thickness).
// All ones are the ellipse itself. So muscles take the shape of what lies around them, and
// everything that knows ellipses alone still works.
constexpr int kOutlinePoints = 16;
using SliceOutline = std::array<float, kOutlinePoints>;
constexpr SliceOutline kEllipticOutline{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

// One cross-section, relative to the line it sits on, so that it cannot be mistaken for a posed
// one.
struct Slice {
  double s = 0;     // parameter along the smooth line, 0 origin .. 1 insertion
  double roll = 0;  // angle from the line's rotation-minimising frame to the width axis, rad
  // of the section's centre from the line, in the rolled frame (width, thickness), m
  Vec2 offset = Vec2::Zero();
  Vec2 radii = Vec2::Zero();  // half width, half thickness, m
  SliceOutline outline = kEllipticOutline;
};

// A surface that the line slides over when joints move; it rides on a joint. Paths are pushed out
// of it, never into it.
struct Wrap {
  enum class Kind { sphere, cylinder, ellipsoid };
  Kind kind = Kind::sphere;
  int joint = 0;
  // object frame in the world at rest; a cylinder's axis is its z
  Transform X_WO = Transform::Identity();
  Vec3 radii = Vec3::Zero();  // sphere: (r,r,r); cylinder: (r,r,half length); ellipsoid: semi axes
};

struct Strip {
  std::vector<PathPoint> path;     // origin, via points, insertion; at least two
  Vec3 reference = Vec3::UnitX();  // zero direction of roll at the origin, world at rest
  std::vector<Slice> slices;       // rising s
  std::vector<Wrap> wraps;
  double belly_begin = 0;  // s where the origin tendon ends
  double belly_end = 1;    // s where the insertion tendon begins
  // s of tendinous intersections: pale bands right across the belly, rising. Fibres run from one to
  // the next.
  std::vector<double> intersections;
  // share of the width, from the edge next to the mid-plane on, that is a raphe: pale, not flesh
  double raphe = 0;
  double rest_length = 0;  // length of the smooth line at rest, m
};

struct Muscle {
  std::string name;  // "biceps_femoris_long_l"
  Side side = Side::middle;
  std::string label;   // "biceps femoris, long head"
  std::string group;   // region: "thigh", "trunk_shoulder", ...
  std::string layer;   // "subcutaneous", "superficial", "intermediate", "deep"
  std::string origin;  // in words, for people
  std::string insertion;
  std::string origin_bone;  // name of the bone that the origin lies on ("" where it is fascia)
  std::string insertion_bone;
  std::vector<Strip> strips;
  double volume = 0;        // all strips, m^3
  double fibre_length = 0;  // optimal, m
  double pennation = 0;     // rad
  double max_force = 0;     // isometric, N; 0: not stated, PCSA times a stress
  double tendon_slack = 0;  // m; 0: not stated
  // in mid-belly at full effort while the joints hold still, over the relaxed; 0: not stated
  double tense_thickness = 0;
  bool sheet = false;  // strips lie side by side and are drawn as one surface
};

// A sheet or band of fascia, aponeurosis or ligament that lies over muscles and bones. It pulls at
// nothing: it is drawn, and goes with what it lies on (muscles/fascia_surface.h).
struct FasciaSheet {
  std::string name;  // "iliotibial_tract_l"
  Side side = Side::middle;
  std::string label;  // "iliotibial tract"
  std::string group;  // region, as muscles have it
  int rows = 0, columns = 0;
  // (rows * columns) x 3, row after row, world coordinates of the rest pose; the direction along a
  // row times the one to the next row points outwards
  Points V;
  std::vector<float> belly;        // #V, 0 fascia .. 1 faded into a belly below (for colour)
  std::vector<std::string> bones;  // that carry it alone; none: whatever it lies on
};

struct Anatomy {
  Skeleton skeleton;
  std::vector<Bone> bones;
  std::vector<Muscle> muscles;
  std::vector<FasciaSheet> fascia;
};

// Two triangles a cell of a grid whose points come row after row, outwards as a FasciaSheet's.
Triangles grid_triangles(int rows, int columns);

struct Landmark {
  std::string name;
  Vec3 position = Vec3::Zero();
};

enum class Sex { male, female };

struct Body {
  TriMesh skin;  // rest pose, world; base mesh vertex order unless refined
  std::vector<Landmark> landmarks;
  std::string name;
  Sex sex = Sex::male;
  double age = 25;  // years; 0 where unknown
  double mass = 0;  // kg; 0 where unknown
};

// A slice posed in the world.
struct Ellipse {
  Vec3 center = Vec3::Zero();
  // Columns: width, thickness, tangent, unit and right-handed. At rest they are orthogonal; what
  // stretches a section aslant brings width and thickness nearer to each other.
  Mat3 axes = Mat3::Identity();
  Vec2 radii = Vec2::Zero();
  SliceOutline outline = kEllipticOutline;
};

// Throws std::invalid_argument that names the part: indices out of range, parents after children,
// fewer than two path points, falling s, radii or outlines that are negative or not finite.
void validate(const Anatomy& anatomy);

int find_bone(const Anatomy& anatomy, std::string_view name);    // index or -1
int find_muscle(const Anatomy& anatomy, std::string_view name);  // index or -1
bool lies_in_fat(const Muscle& muscle);  // under the skin itself, as the face's do
// The joints that alone carry the bones of a strip's origin and insertion; -1: that end lies in
// fascia, or a blend of two joints carries it. Precondition: the strip is the muscle's.
std::array<int, 2> end_joints(const Muscle& muscle, const Strip& strip);
int slice_count(const Anatomy& anatomy);  // all strips of all muscles

}  // namespace ecorche::inline v1
