// A fitted anatomy as a musculoskeletal model for other programs: OpenSim (.osim) and MuJoCo (MJCF
// .xml).
//
// One body a joint, its frame aligned with the world at rest, named as the joint. A joint turns
// about its three anatomical axes in the order flexion, abduction, rotation; its coordinates are
// the anatomical angles (joint_flexion, ...), at rest those of the rest pose, with the joint's
// limits. Angles that can hardly change (less than 4.5 degrees) are left fixed. The patella follows
// the knee. One actuator a strip, named as the muscle, or NAME.1, NAME.2, ... for several strips. A
// path point between two joints rides on the one with the larger share. Forces are the muscles' own
// (Muscle::max_force); where a character of an earlier version states none, they are volume / fibre
// length times a stress.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/body_segment.h"
#include "anatomy/muscles/muscle_force.h"

namespace ecorche::inline v1 {

struct ExportBody {
  std::string name;
  int parent = -1;
  Vec3 place = Vec3::Zero();    // origin in the parent's frame, m; of the root in the world
  double mass = 0;              // kg
  Vec3 center = Vec3::Zero();   // of mass, body frame
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, kg m^2
};

struct ExportAngle {
  std::string name;  // "knee_l_flexion"
  int body = 0;
  // body frame at rest; angles of one joint turn in order, each with those before it
  Vec3 axis = Vec3::UnitX();
  double rest = 0, low = 0, high = 0;  // rad
};

struct ExportStrip {
  std::string name;
  std::vector<int> bodies;   // of each point
  std::vector<Vec3> points;  // body frames
  std::vector<Wrap> wraps;   // X_WO and joint as in the anatomy
  double max_force = 0, fibre_length = 0, tendon_slack = 0, pennation = 0;
};

struct ExportMesh {
  int body = 0;
  std::string file;  // "femur_l.obj"
  TriMesh mesh;      // body frame, our axes
};

// A ball that meets the ground.
struct ExportContact {
  std::string name;  // "heel_l"
  int body = 0;
  Vec3 center = Vec3::Zero();  // body frame
  double radius = 0;
};

struct ExportMarker {
  std::string name;  // "acromion_l"
  int body = 0;
  Vec3 place = Vec3::Zero();  // body frame
};

struct ExportModel {
  std::string name;
  std::vector<ExportBody> bodies;  // #joints
  std::vector<ExportAngle> angles;
  std::vector<std::pair<int, int>>
      patellae;  // angle of the patella, angle of the knee that it follows
  std::vector<ExportStrip> strips;
  std::vector<ExportMesh> meshes;
  std::vector<ExportContact> contacts;  // export_ground.h; none where there is no ground
  std::optional<double> ground;         // height of the floor, world at rest, m
  std::vector<ExportMarker> markers;
  int blended_points = 0;  // that ride on one joint instead of two
  // muscles whose force rests on the volume that fills the skin, because the character does not say
  // another
  int filled_forces = 0;
};

// Masses from data/segments.csv for the body's sex, stature (skin) and mass (70 kg where unknown);
// joints without a segment of their own get 1/5000 of the mass each, from the segment that they
// hang on. Throws InputError for a
// missing table, std::invalid_argument for an anatomy that is not valid.
// `tables`: Assets::tables.
ExportModel make_export_model(const Anatomy& anatomy, const Body& body,
                              const std::filesystem::path& tables);

// Masses of a body's own segments in place of those of the table. Precondition
// (std::invalid_argument): the segments' joints are the model's bodies.
void set_masses(std::span<const BodySegment> segments, ExportModel& model);

// What a format has no word for.
struct ExportLosses {
  // MJCF has no ellipsoids to wrap over: the sphere that is like it where the line passes
  int wraps_as_spheres = 0;
  int wraps_left_out = 0;  // MJCF takes one object between two points
};

}  // namespace ecorche::inline v1
