#include "anatomy/model_files/model_export.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/model_files/coordinates.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kUnknownMass = 70;         // kg
constexpr double kSmallShare = 1.0 / 5000;  // of the mass, for a body without a segment
constexpr double kSmallRadius = 0.02;       // m, of the ball that such a body is taken for
constexpr double kLeastLeft = 0.2;          // of a body that small ones hang on
constexpr double kMostFibre = 0.95;         // of the path: fibres at rest leave room for a tendon
constexpr double kLeastTendon = 0.02;       // of the path

// Gives bodies without a mass one that a simulation can bear, and takes it from the body that they
// hang on: a hand with its fingers weighs what it weighed.
void add_small_masses(ExportModel& model) {
  double mass = 0;
  for (const ExportBody& b : model.bodies) mass += b.mass;
  std::vector<double> taken(model.bodies.size(), 0);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].mass > 0) continue;
    int from = model.bodies[i].parent;
    while (from >= 0 && !(model.bodies[from].mass > 0)) from = model.bodies[from].parent;
    if (from < 0) from = 0;
    taken[from] += kSmallShare * mass;
  }
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    ExportBody& b = model.bodies[i];
    if (b.mass > 0) {
      const double left = std::max(kLeastLeft, 1 - taken[i] / b.mass);
      b.mass *= left;
      b.inertia *= left;
    } else {
      b.mass = kSmallShare * mass;
      b.inertia = 0.4 * kSmallRadius * kSmallRadius * b.mass * Mat3::Identity();
    }
  }
}

void add_masses(const Anatomy& anatomy, const Body& body, const std::filesystem::path& tables,
                ExportModel& out) {
  const Table table(tables / "segments.csv");
  const auto rest = rest_positions(anatomy.skeleton);
  const double stature =
      body.skin.V.rows() > 0 ? body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff() : 1.75;
  const double mass = body.mass > 0 ? body.mass : kUnknownMass;
  const std::string sex = body.sex == Sex::female ? "female" : "male";
  double told = 0;
  for (int row = 0; row < table.rows(); ++row)
    for (const char* side : {"_l", "_r"}) {
      const bool paired = table.text(row, "paired") == "yes";
      if (!paired && side[1] == 'r') continue;
      const auto joint = [&](const char* column) {
        int j = find_joint(anatomy.skeleton, table.text(row, column) + (paired ? side : ""));
        if (j < 0)
          throw InputError(fmt::format("{}: no joint '{}' in the skeleton", table.where(row),
                                       table.text(row, column)));
        return j;
      };
      const auto value = [&](const char* column) {
        return table.number(row, column + ("_" + sex));
      };
      const int j = joint("joint");
      const Vec3 from = rest[joint("from")], to = rest[joint("to")],
                 along = (to - from).normalized();
      ExportBody& b = out.bodies[j];
      b.mass = value("mass");
      b.center = from + value("at") * (to - from) - rest[j];
      const double length = value("length") * stature;
      const double across = std::pow(value("gyration_across") * length, 2),
                   axial = std::pow(value("gyration_along") * length, 2);
      b.inertia =
          across * Mat3::Identity() + (axial - across) * along * along.transpose();  // of 1 kg
      told += b.mass;
    }
  for (ExportBody& b : out.bodies) {
    b.mass *= mass / told;
    b.inertia *= b.mass;
  }
  add_small_masses(out);
}

// L = A Rx(f) Ry(a) Rz(r) Z^-1 A^T with Z the angles at rest (coordinates.h). About rest it is a
// chain of turns about axes fixed in the rest frame: the first A x, the second A Rx(f0) y, the
// third A Rx(f0) Ry(a0) z, each by its change; a left-handed A turns them round.
void add_angles(const Skeleton& skeleton, ExportModel& out) {
  for (const Coordinate& one : model_coordinates(skeleton)) {
    const Joint& joint = skeleton.joints[one.joint];
    Mat3 axes = joint.axes.determinant() < 0 ? Mat3(-joint.axes) : joint.axes;
    for (int i = 0; i < one.axis; ++i)
      axes = Eigen::AngleAxisd(joint.zero[i], axes.col(i).normalized()).toRotationMatrix() * axes;
    const double zero = joint.zero[one.axis];
    out.angles.push_back({one.name, one.joint, axes.col(one.axis).normalized(), zero,
                          std::min(joint.min[one.axis], zero),
                          std::max(joint.max[one.axis], zero)});
  }
}

double polyline(const std::vector<PathPoint>& path) {
  double length = 0;
  for (size_t k = 1; k < path.size(); ++k) length += (path[k].rest - path[k - 1].rest).norm();
  return length;
}

void add_strip(const Muscle& muscle, size_t index, double share, const std::vector<Vec3>& rest,
               ExportModel& out) {
  const Strip& strip = muscle.strips[index];
  ExportStrip s;
  s.name = muscle.strips.size() > 1 ? fmt::format("{}.{}", muscle.name, index + 1) : muscle.name;
  for (const PathPoint& p : strip.path) {
    const bool second = p.joints[1] >= 0 && p.share < 0.5;
    out.blended_points += p.joints[1] >= 0 && p.share > 0 && p.share < 1;
    s.bodies.push_back(p.joints[second ? 1 : 0]);
    s.points.push_back(p.rest - rest[s.bodies.back()]);
  }
  s.wraps = strip.wraps;
  const double length = polyline(strip.path);
  s.pennation = muscle.pennation;
  s.fibre_length = muscle.fibre_length > 0 ? muscle.fibre_length : 0.6 * length;
  s.max_force = share * (muscle.max_force > 0 ? muscle.max_force
                                              : isometric_force(muscle.volume, s.fibre_length));
  if (muscle.max_force > 0 && muscle.tendon_slack > 0) {
    s.tendon_slack = muscle.tendon_slack;
  } else {
    s.fibre_length = std::min(s.fibre_length, kMostFibre * length);
    s.tendon_slack =
        std::max(kLeastTendon * length, length - s.fibre_length * std::cos(s.pennation));
  }
  out.strips.push_back(std::move(s));
}

std::string file_name(const std::string& name) {
  std::string out = name;
  for (char& c : out)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
          c == '-' || c == '.'))
      c = '_';
  return out + ".obj";
}

}  // namespace

void set_masses(std::span<const BodySegment> segments, ExportModel& model) {
  for (ExportBody& b : model.bodies) b.mass = 0;
  for (const BodySegment& segment : segments) {
    if (segment.joint < 0 || segment.joint >= int(model.bodies.size()))
      throw std::invalid_argument("set_masses: a segment of another skeleton");
    ExportBody& b = model.bodies[segment.joint];
    b.mass = segment.mass;
    b.center = segment.center;
    b.inertia = segment.inertia;
  }
  for (ExportBody& b : model.bodies)
    if (!(b.mass > 0)) b.center = Vec3::Zero();
  add_small_masses(model);
}

ExportModel make_export_model(const Anatomy& anatomy, const Body& body,
                              const std::filesystem::path& tables) {
  validate(anatomy);
  ExportModel out;
  out.name = body.name.empty() ? "body" : body.name;
  const auto rest = rest_positions(anatomy.skeleton);
  const auto& joints = anatomy.skeleton.joints;
  for (const Joint& joint : joints) {
    ExportBody b;
    b.name = joint.name;
    b.parent = joint.parent;
    b.place = joint.X_PJ.translation();
    out.bodies.push_back(std::move(b));
  }
  add_masses(anatomy, body, tables, out);
  add_angles(anatomy.skeleton, out);
  const auto angle = [&](const std::string& name) {
    for (size_t a = 0; a < out.angles.size(); ++a)
      if (out.angles[a].name == name) return int(a);
    return -1;
  };
  for (const char* side : {"_l", "_r"}) {
    const int patella = angle(fmt::format("patella{}_flexion", side)),
              knee = angle(fmt::format("knee{}_flexion", side));
    if (patella >= 0 && knee >= 0) out.patellae.emplace_back(patella, knee);
  }
  for (const Muscle& muscle : anatomy.muscles) {
    double total = 0;
    out.filled_forces += muscle.max_force <= 0;
    std::vector<double> volumes;
    for (const Strip& strip : muscle.strips) {
      volumes.push_back(strip.slices.size() >= 2 ? tube_volume(rest_slices(strip)) : 0);
      total += volumes.back();
    }
    for (size_t k = 0; k < muscle.strips.size(); ++k)
      add_strip(muscle, k,
                muscle.strips.size() == 1 ? 1
                : total > 0               ? volumes[k] / total
                                          : 1.0 / double(muscle.strips.size()),
                rest, out);
  }
  for (const Bone& bone : anatomy.bones) {
    ExportMesh mesh{bone.joint, file_name(bone.name), bone.mesh};
    mesh.mesh.V.rowwise() -= rest[bone.joint].transpose();
    out.meshes.push_back(std::move(mesh));
  }
  return out;
}

}  // namespace ecorche::inline v1
