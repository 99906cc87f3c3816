// Our muscles beside those of BodyParts3D, and BodyParts3D's muscles through our resampling.
//
//   bodyparts MODELS [FOLDER]
//
// MODELS: the unpacked folder of GLB parts (millimetres; left, back, up). FOLDER: muscles.csv,
// shells.csv and both meshes of the worst ten are written there. Our skeleton stands in the bone
// package's neutral pose and every joint's bones are laid on theirs by a similarity, those of many
// bones then by an affine map (iterated nearest points, both ways); muscles go where their bones
// go, with the volumes that a fit gives a man of their stature and mass. Ends with 1 when a figure
// is worse than asked.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <numeric>
#include <sstream>

#include "anatomy/authoring/muscle_placement.h"
#include "anatomy/authoring/muscle_table.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/package_archive.h"
#include "anatomy/geometry/edge_paths.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/overlap_volumes.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/muscles/transform_muscles.h"
#include "anatomy/queries/nearest_surface.h"
#include "morph/fit/fit_anatomy.h"
#include "morph/shapes/body_model.h"
#include "morph/template/template.h"
#include "morph/template/template_cache.h"
#include "tests/muscles/shells.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

constexpr double kTableStature = 1.77,
                 // m: the man of the muscle table, and theirs (skull 1.638 m, and skin)
    kTheirStature = 1.66;
// kg: theirs. The young man whose pictures BodyParts3D was begun with (TARO: Nagaoka et al.
// 2004, 10.1088/0031-9155/49/1/001) is published with 1.728 m and 65.0 kg (recalled); at the
// stature of the meshes the same build has this mass, or 57.6 kg were he shrunk alike.
constexpr double kTheirMass = 65.0 / (1.728 * 1.728) * kTheirStature * kTheirStature;
// a joint with as many bones is laid on theirs by an affine map
constexpr std::size_t kBonesToStretch = 4;

// What is asked.
constexpr std::size_t kMuscles = 80;
constexpr double kCentres = 0.015, kLeastRatio = 0.7,
                 kMostRatio = 1.4;  // m; shares of all compared muscles, ours over theirs

struct Alignment {
  Mat3 A = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  Vec3 operator()(const Vec3& p) const { return A * p + t; }
  Vec3 back(const Vec3& p) const { return A.inverse() * (p - t); }
  double scale() const { return std::cbrt(A.determinant()); }
};

// Least squares (Umeyama 1991), every pair alike.
Alignment fit_similarity(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const double count = from.size();
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) a += from[i] / count, b += to[i] / count;
  Mat3 C = Mat3::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    C += (to[i] - b) * (from[i] - a).transpose();
    spread += (from[i] - a).squaredNorm();
  }
  const Eigen::JacobiSVD<Mat3> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vec3 sense(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  Alignment out;
  out.A = svd.singularValues().dot(sense) / spread * svd.matrixU() * sense.asDiagonal() *
          svd.matrixV().transpose();
  out.t = b - out.A * a;
  return out;
}

Alignment fit_affine(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Eigen::Matrix4d left = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Eigen::Vector4d p(from[i].x(), from[i].y(), from[i].z(), 1);
    left += p * p.transpose();
    right += p * to[i].transpose();
  }
  const Eigen::Matrix<double, 4, 3> solved = left.ldlt().solve(right);
  return {solved.topRows<3>().transpose(), solved.row(3).transpose()};
}

std::vector<std::string> split_plus(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream words(text);
  std::string word, name;
  while (words >> word) {
    if (word == "+")
      out.push_back(std::move(name)), name.clear();
    else
      name += (name.empty() ? "" : " ") + word;
  }
  out.push_back(name);
  return out;
}

TriMesh joined(const std::vector<TriMesh>& meshes) {
  TriMesh all{Points(0, 3), Triangles(0, 3)};
  for (const TriMesh& mesh : meshes) {
    const Eigen::Index points = all.V.rows(), faces = all.F.rows();
    all.V.conservativeResize(points + mesh.V.rows(), 3);
    all.V.bottomRows(mesh.V.rows()) = mesh.V;
    all.F.conservativeResize(faces + mesh.F.rows(), 3);
    all.F.bottomRows(mesh.F.rows()) = mesh.F.array() + int(points);
  }
  return all;
}

// The parts by their names: FJ103_BP62944_FMA24481_Left_fibula.glb is "Left fibula". Read when
// asked for, in metres and our axes.
class Parts {
 public:
  explicit Parts(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.path().extension() != ".glb") continue;
      std::string name = entry.path().stem().string();
      for (int i = 0; i < 3 && name.find('_') != std::string::npos; ++i)
        name.erase(0, name.find('_') + 1);
      std::replace(name.begin(), name.end(), '_', ' ');
      files_[name] = entry.path();
    }
    if (files_.empty()) throw InputError(folder.string() + ": no .glb parts");
  }
  TriMesh read(const std::string& names) const {
    std::vector<TriMesh> meshes;
    for (const std::string& name : split_plus(names)) {
      const auto file = files_.find(name);
      if (file == files_.end()) throw InputError(fmt::format("no part '{}'", name));
      TriMesh mesh = read_mesh(file->second);
      const bool metres =
          (mesh.V.colwise().maxCoeff() - mesh.V.colwise().minCoeff()).norm() < 0.9 &&
          mesh.V.cwiseAbs().maxCoeff() < 3;
      const Points V = (metres ? 1.0 : 1e-3) * mesh.V;
      mesh.V.col(0) = V.col(0);
      mesh.V.col(1) = V.col(2);
      mesh.V.col(2) = -V.col(1);
      meshes.push_back(welded(mesh));
    }
    return joined(meshes);
  }
  std::vector<std::string> muscles() const {
    std::vector<std::string> names;
    for (const auto& [name, file] : files_)
      if (file.parent_path().filename() == "muscles") names.push_back(name);
    return names;
  }

 private:
  std::map<std::string, fs::path> files_;
};

// A bone of ours and theirs, with points spread over both.
struct BonePair {
  std::string name;
  TriMesh ours, theirs;
  std::unique_ptr<NearestSurface> on_ours, on_theirs;
  std::vector<Vec3> from_ours, from_theirs;
};

std::vector<Vec3> spread(const TriMesh& mesh, int most) {
  std::vector<Vec3> out;
  const int step = std::max(1, int(mesh.V.rows()) / most);
  for (Eigen::Index i = 0; i < mesh.V.rows(); i += step) out.push_back(mesh.V.row(i));
  return out;
}

Vec3 middle(const std::vector<Vec3>& points) {
  return std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / double(points.size());
}

// Pairs of nearest points, both ways, bone by bone; and how far they lie apart, RMS.
double nearest_pairs(const std::vector<const BonePair*>& bones, const Alignment& at,
                     std::vector<Vec3>& from, std::vector<Vec3>& to) {
  from.clear(), to.clear();
  double sum = 0;
  for (const BonePair* bone : bones) {
    for (const Vec3& p : bone->from_ours)
      from.push_back(p), to.push_back(bone->on_theirs->nearest(at(p)).point);
    for (const Vec3& q : bone->from_theirs)
      from.push_back(bone->on_ours->nearest(at.back(q)).point), to.push_back(q);
  }
  for (std::size_t i = 0; i < from.size(); ++i) sum += (at(from[i]) - to[i]).squaredNorm();
  return std::sqrt(sum / double(from.size()));
}

double settle(const std::vector<const BonePair*>& bones, int rounds, Alignment& at,
              bool affine = false) {
  std::vector<Vec3> from, to;
  double error = 0;
  for (int i = 0; i < rounds; ++i) {
    error = nearest_pairs(bones, at, from, to);
    at = affine ? fit_affine(from, to) : fit_similarity(from, to);
  }
  return error;
}

Vec3 long_axis(const std::vector<Vec3>& points, double& slender) {
  const Vec3 at = middle(points);
  Mat3 C = Mat3::Zero();
  for (const Vec3& p : points) C += (p - at) * (p - at).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(C);
  slender = std::sqrt(solver.eigenvalues()[2] / solver.eigenvalues()[1]);
  return solver.eigenvectors().col(2);
}

// All bones of one joint together. From `start`, and turned about their long axis where they are
// slender: what fits best.
Alignment align(const std::vector<const BonePair*>& bones, const Mat3& start, double& error) {
  std::vector<Vec3> a, b;
  for (const BonePair* bone : bones) {
    a.insert(a.end(), bone->from_ours.begin(), bone->from_ours.end());
    b.insert(b.end(), bone->from_theirs.begin(), bone->from_theirs.end());
  }
  const auto size = [](const std::vector<Vec3>& points) {
    const Vec3 at = middle(points);
    double sum = 0;
    for (const Vec3& p : points) sum += (p - at).squaredNorm();
    return std::sqrt(sum / double(points.size()));
  };
  double slender_a = 0, slender_b = 0;
  const Vec3 axis_a = start * long_axis(a, slender_a);
  Vec3 axis_b = long_axis(b, slender_b);
  std::vector<Mat3> starts{start};
  if (std::min(slender_a, slender_b) > 2) {
    if (axis_a.dot(axis_b) < 0) axis_b = -axis_b;
    const Mat3 on = Quat::FromTwoVectors(axis_a, axis_b).toRotationMatrix() * start;
    for (int k = 0; k < 12; ++k)
      starts.push_back(Eigen::AngleAxisd(k * std::numbers::pi / 6, axis_b) * on);
  }
  Alignment best;
  error = 1e300;
  for (const Mat3& R : starts) {
    Alignment at;
    at.A = size(b) / size(a) * R;
    at.t = middle(b) - at.A * middle(a);
    const double now = settle(bones, 12, at);
    if (now < error) error = now, best = at;
  }
  error = settle(bones, 40, best);
  if (bones.size() >= kBonesToStretch) error = settle(bones, 40, best, true);
  return best;
}

Mat3 turn_of(const Mat3& A) {
  const Eigen::JacobiSVD<Mat3> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

struct Aligned {
  std::vector<Alignment> joints;
  std::vector<double> errors;  // RMS, m; < 0: follows its parent
};

Aligned align_joints(const Anatomy& anatomy, const Parts& parts, const Table& table) {
  std::map<int, std::vector<BonePair>> bones;
  for (int row = 0; row < table.rows(); ++row) {
    const int i = find_bone(anatomy, table.text(row, "ours"));
    if (i < 0)
      throw InputError(fmt::format("{}: no bone '{}'", table.where(row), table.text(row, "ours")));
    BonePair pair{table.text(row, "ours"),
                  anatomy.bones[i].mesh,
                  parts.read(table.text(row, "theirs")),
                  nullptr,
                  nullptr,
                  {},
                  {}};
    pair.on_ours = std::make_unique<NearestSurface>(pair.ours);
    pair.on_theirs = std::make_unique<NearestSurface>(pair.theirs);
    pair.from_ours = spread(pair.ours, 300);
    pair.from_theirs = spread(pair.theirs, 300);
    bones[anatomy.bones[i].joint].push_back(std::move(pair));
  }
  Aligned out;
  const auto& joints = anatomy.skeleton.joints;
  out.joints.resize(joints.size());
  out.errors.assign(joints.size(), -1);
  // Joints above the first one that has bones stand as the trunk does.
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent >= 0) out.joints[j] = out.joints[joints[j].parent];
    const auto own = bones.find(int(j));
    if (own == bones.end()) continue;
    std::vector<const BonePair*> pairs;
    for (const BonePair& pair : own->second) pairs.push_back(&pair);
    const Mat3 start =
        joints[j].parent >= 0 ? turn_of(out.joints[joints[j].parent].A) : Mat3::Identity();
    out.joints[j] = align(pairs, start, out.errors[j]);
  }
  return out;
}

struct Compared {
  std::string ours, theirs;
  double centres = 0;  // between the centroids, m
  double volume = 0, theirs_volume = 0;
  double dice = 0;
  TriMesh mesh, theirs_mesh;
};

Vec3 centroid(const TriMesh& mesh) {
  const Vec3 base = mesh.V.colwise().mean();
  Vec3 sum = Vec3::Zero();
  double volume = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)).transpose() - base,
               b = mesh.V.row(mesh.F(f, 1)).transpose() - base,
               c = mesh.V.row(mesh.F(f, 2)).transpose() - base;
    const double v = a.dot(b.cross(c)) / 6;
    sum += v / 4 * (a + b + c);
    volume += v;
  }
  return base + sum / volume;
}

// The volumes that a fit gives the muscles of a man of their stature and mass, before they grow
// into their room.
std::vector<double> volumes_in_their_man(const Anatomy& anatomy) {
  const Body man = make_body(
      read_body_package(test_assets()),
      {.sex = Sex::male, .age = 22, .height = kTheirStature, .mass = kTheirMass, .name = "theirs"});
  const Anatomy fitted = fit_anatomy(read_template(test_assets()), man).anatomy;
  std::vector<double> out;
  for (const Muscle& muscle : anatomy.muscles) {
    const int m = find_muscle(fitted, muscle.name);
    if (m < 0) throw InputError(fmt::format("the template has no muscle '{}'", muscle.name));
    out.push_back(fitted.muscles[m].volume);
  }
  return out;
}

// The muscles carried, and of these volumes.
Anatomy carried(const Anatomy& anatomy, const std::vector<double>& volumes,
                const Aligned& aligned) {
  Anatomy out = anatomy;
  out.muscles = carry_muscles(anatomy.muscles,
                              [&](const Vec3& p, int joint) { return aligned.joints[joint](p); });
  for (std::size_t m = 0; m < volumes.size(); ++m) {
    const double now = rest_volume(out.muscles[m]);
    for (Strip& strip : out.muscles[m].strips)
      scale_radii(strip, Vec2::Constant(std::sqrt(volumes[m] / now)));
  }
  return out;
}

Compared compare(const Table& table, int row, const Anatomy& anatomy, const MuscleSurface& surface,
                 const Points& positions, const Parts& parts) {
  Compared out{table.text(row, "ours"), table.text(row, "theirs"), 0, 0, 0, 0, {}, {}};
  std::vector<TriMesh> ours;
  for (const std::string& name : split_plus(out.ours)) {
    const int m = find_muscle(anatomy, name + "_l");
    if (m < 0) throw InputError(fmt::format("{}: no muscle '{}_l'", table.where(row), name));
    ours.push_back(part_mesh(surface, surface.parts[m], positions));
  }
  out.mesh = joined(ours);
  out.theirs_mesh = capped(parts.read(out.theirs)).mesh;
  out.centres = (centroid(out.mesh) - centroid(out.theirs_mesh)).norm();
  out.volume = mesh_volume(out.mesh);
  out.theirs_volume = mesh_volume(out.theirs_mesh);
  const std::vector<Solid> both{
      {Solid::Kind::muscle, &out.mesh.V, &out.mesh.F, 0, int(out.mesh.F.rows())},
      {Solid::Kind::bone, &out.theirs_mesh.V, &out.theirs_mesh.F, 0,
       int(out.theirs_mesh.F.rows())}};
  const SolidVolumes volumes = measure_solids(both, 0.5e-3);
  out.dice = 2 * volumes.in_bone[0] / (volumes.volume[0] + volumes.volume[1]);
  return out;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

bool compare_all(const Parts& parts, const fs::path& tables, const fs::path& folder) {
  Anatomy anatomy = read_source_skeleton(test_assets());
  anatomy.muscles = place_muscles(read_muscle_table(test_assets().tables), anatomy);
  const Aligned aligned = align_joints(anatomy, parts, Table(tables / "bodyparts_bones.csv"));
  std::vector<double> errors;
  fmt::print("{:<14} {:>8} {:>7}\n", "bones of", "RMS mm", "scale");
  for (std::size_t j = 0; j < aligned.joints.size(); ++j) {
    if (aligned.errors[j] < 0) continue;
    errors.push_back(aligned.errors[j]);
    fmt::print("{:<14} {:>8.1f} {:>7.3f}\n", anatomy.skeleton.joints[j].name,
               1e3 * aligned.errors[j], aligned.joints[j].scale());
  }
  const std::vector<double> volumes = volumes_in_their_man(anatomy);
  double sum = 0, by_stature = 0;
  for (std::size_t m = 0; m < volumes.size(); ++m)
    sum += volumes[m],
        by_stature += anatomy.muscles[m].volume * std::pow(kTheirStature / kTableStature, 3);
  const Anatomy there = carried(anatomy, volumes, aligned);
  const MuscleSurface surface = make_muscle_surface(there);
  Points positions;
  update_muscle_surface(surface, rest_slices(there), positions);
  const Table matches(tables / "bodyparts_matches.csv");
  std::vector<Compared> all;
  for (int row = 0; row < matches.rows(); ++row)
    all.push_back(compare(matches, row, there, surface, positions, parts));
  std::sort(all.begin(), all.end(),
            [](const Compared& a, const Compared& b) { return a.dice < b.dice; });

  std::string rows = "ours,theirs,centroids_mm,volume_ml,theirs_ml,dice\n";
  std::vector<double> centres, ratios, dice;
  fmt::print("\n{:<34} {:>11} {:>9} {:>9} {:>7} {:>6}\n", "muscle, worst overlap first",
             "centres mm", "ml", "theirs", "ratio", "Dice");
  for (const Compared& c : all) {
    const std::string name =
        c.ours.find('+') == std::string::npos ? c.ours : split_plus(c.ours)[0] + " ...";
    fmt::print("{:<34} {:>11.1f} {:>9.1f} {:>9.1f} {:>7.2f} {:>6.2f}\n", name, 1e3 * c.centres,
               1e6 * c.volume, 1e6 * c.theirs_volume, c.volume / c.theirs_volume, c.dice);
    rows += fmt::format("{},{},{:.2f},{:.2f},{:.2f},{:.4f}\n", c.ours, c.theirs, 1e3 * c.centres,
                        1e6 * c.volume, 1e6 * c.theirs_volume, c.dice);
    centres.push_back(c.centres), ratios.push_back(c.volume / c.theirs_volume),
        dice.push_back(c.dice);
  }
  fmt::print("\nbones lie on theirs to {:.1f} mm RMS (median of {} joints)\n", 1e3 * median(errors),
             errors.size());
  // Their man holds less muscle than any regression gives the living; what is compared is how it is
  // shared out.
  double ours = 0, theirs = 0;
  for (const Compared& c : all) ours += c.volume, theirs += c.theirs_volume;
  for (double& ratio : ratios) ratio *= theirs / ours;
  fmt::print(
      "{} muscles: centroids {:.1f} mm apart (median; asked 15), share of the whole {:.2f} times "
      "theirs (median; asked 0.7 to 1.4), Dice {:.2f} (median)\n",
      all.size(), 1e3 * median(centres), median(ratios), median(dice));
  fmt::print("together ours hold {:.2f} l, theirs {:.2f} l: {:.2f} times as much\n", 1e3 * ours,
             1e3 * theirs, ours / theirs);
  fmt::print(
      "a fit gives their man {:.1f} l of muscle; the table's, as the cube of stature alone, would "
      "be {:.1f} l\n",
      1e3 * sum, 1e3 * by_stature);
  if (!folder.empty()) {
    write_file_atomically(folder / "muscles.csv", rows);
    for (std::size_t i = 0; i < std::min<std::size_t>(10, all.size()); ++i) {
      write_ply(folder / fmt::format("worst{}_ours.ply", i), all[i].mesh);
      write_ply(folder / fmt::format("worst{}_theirs.ply", i), all[i].theirs_mesh);
    }
  }
  const bool met = all.size() >= kMuscles && median(centres) <= kCentres &&
                   median(ratios) >= kLeastRatio && median(ratios) <= kMostRatio;
  if (!met) fmt::print("SHORT of what is asked\n");
  return met;
}

int run(int count, char** arguments) {
  if (count < 2 || count > 3) throw UsageError("usage: bodyparts MODELS [FOLDER]");
  const Parts parts(arguments[1]);
  const fs::path folder = count > 2 ? arguments[2] : "";
  if (!folder.empty()) fs::create_directories(folder);
  const bool alike = compare_all(parts, fs::path(ECORCHE_TEST_DIR) / "muscles", folder);
  std::vector<ShellMuscle> muscles;
  for (const std::string& name : parts.muscles()) muscles.push_back({name, parts.read(name)});
  const bool shells = resample_shells(muscles, folder.empty() ? folder : folder / "shells.csv");
  return alike && shells ? 0 : 1;
}

}  // namespace
}  // namespace ecorche

int main(int count, char** arguments) {
  try {
    return ecorche::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bodyparts: %s\n", error.what());
    return 2;
  }
}
