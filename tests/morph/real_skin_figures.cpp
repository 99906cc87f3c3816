// Fits real people's skins and prints what ends where it should not: bones outside, muscle points
// outside, palpable points off their brackets.
//   real_skin_figures [--count N] [--seed S] [--package] [--bones] [--skin FILE]...   ends with 77
//   (skipped) where the packages are not there, with 1 where bones are outside, too many muscle
//   points, or a muscle is pierced.
// --package: the bodies that the skins were made from, not moved. --bones: no muscles are grown.
// --skin: a mesh in the base mesh's vertex order, metres, instead of the family.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include <Eigen/SVD>

#include "anatomy/errors.h"
#include "anatomy/mesh_files/mesh_io.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/fit/fit_character.h"
#include "morph/template/template_cache.h"
#include "tests/morph/real_skins.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {

constexpr double kMuscleLimit = 5e-4;   // share of muscle points outside
constexpr double kPiercedLimit = 0.05;  // share of one muscle's volume in bones

struct Totals {
  int fits = 0, with_bones = 0, with_muscles = 0, bone_vertices = 0, off = 0, landmarks = 0;
  int pierced = 0;
  double furthest = 0, milliseconds = 0, stretched = 0, pierced_most = 0;
  std::size_t points = 0, points_outside = 0;
  std::map<std::string, int> bones, palpable;
  std::map<std::string, double> depth_off;
};

// Of thoracic and lumbar vertebrae: the largest stretch, over stature's, of the affine map that is
// nearest to what takes the template's to the fitted one.
double vertebra_stretch(const Template& own, const Anatomy& fitted, double size) {
  double most = 0;
  for (std::size_t b = 0; b < own.anatomy.bones.size(); ++b) {
    const std::string& name = own.anatomy.bones[b].name;
    if (name.size() > 3 || (name[0] != 't' && name[0] != 'l')) continue;
    const Points& V = own.anatomy.bones[b].mesh.V;
    const Points from = V.rowwise() - V.colwise().mean(),
                 to = fitted.bones[b].mesh.V.rowwise() - fitted.bones[b].mesh.V.colwise().mean();
    const Mat3 inner = from.transpose() * from, cross = from.transpose() * to;
    const Mat3 map = inner.inverse() * cross;
    most = std::max(most, map.jacobiSvd().singularValues()[0] / size);
  }
  return most;
}

void fit_one(const Template& own, const BodyPackage& package, const Body& body, bool muscles,
             Totals& totals) {
  FittingOptions options;
  options.tissues = false;
  options.dilated = muscles;
  const FittedCharacter fitted = fit_character(own, body, package, options);
  const FittingReport& report = fitted.report;
  ++totals.fits;
  totals.milliseconds += report.fit.bones_ms;
  std::string line;
  const SkinField field(capped_skin(package, body.skin.V));
  int outside = 0;
  for (const Bone& bone : fitted.anatomy.bones) {
    int count = 0;
    double furthest = 0;
    SkinPoint at;
    for (Eigen::Index i = 0; i < bone.mesh.V.rows(); ++i) {
      at = field.nearest_judged(bone.mesh.V.row(i), at.triangle);
      if (at.distance <= 0) continue;
      ++count;
      furthest = std::max(furthest, at.distance);
    }
    if (count == 0) continue;
    outside += count;
    ++totals.bones[bone.name];
    totals.furthest = std::max(totals.furthest, furthest);
    line += fmt::format(" {} {} ({:.1f})", bone.name, count, 1e3 * furthest);
  }
  totals.with_bones += outside > 0;
  totals.bone_vertices += outside;
  std::string off;
  for (const LandmarkDepth& landmark : report.fit.landmarks) {
    ++totals.landmarks;
    if (!is_off(landmark)) continue;
    ++totals.off;
    ++totals.palpable[landmark.name];
    const double by = landmark.depth < landmark.low ? landmark.depth - landmark.low
                                                    : landmark.depth - landmark.high;
    double& worst = totals.depth_off[landmark.name];
    if (std::abs(by) > std::abs(worst)) worst = by;
    off += fmt::format(" {} {:+.1f}", landmark.name, 1e3 * by);
  }
  totals.points += std::size_t(report.fill.points);
  totals.points_outside += std::size_t(report.fill.points_outside);
  const double share = double(report.fill.points_outside) / std::max(report.fill.points, 1);
  totals.with_muscles += muscles && share > kMuscleLimit;
  totals.pierced += report.fill.pierced_share > kPiercedLimit;
  totals.pierced_most = std::max(totals.pierced_most, report.fill.pierced_share);
  const double stretch =
      vertebra_stretch(own, fitted.anatomy, report.fit.stature / own.tables.stature);
  totals.stretched = std::max(totals.stretched, stretch);
  fmt::print(
      "{:14} {} {:.2f} m, said outside {}; {} outside{}; muscles {:.3f} %, {:.1f} % of {} in bone; "
      "vertebrae {:.2f}; off:{}\n",
      body.name, body.sex == Sex::male ? "m" : "f", report.fit.stature, report.fit.bones_outside,
      outside, line, 100 * share, 100 * report.fill.pierced_share, report.fill.pierced_muscle,
      stretch, off);
  fflush(stdout);
}

int figures(int count, unsigned seed, bool unmoved, bool muscles,
            const std::vector<std::string>& files) {
  const Template own = read_template(test_assets());
  const BodyModel model(test_assets());
  const RealSkins family(model);
  Totals totals;
  for (const std::string& file : files) {
    Body body;
    body.skin = skin_mesh(model.package(), read_mesh(file).V);
    body.name = file;
    fit_one(own, model.package(), body, muscles, totals);
  }
  for (int k = 0; k < (files.empty() ? count : 0); ++k) {
    const RealSkin skin = family.make(seed + unsigned(k));
    if (unmoved) {
      Body body = make_body(model, skin.spec);
      body.name = skin.body.name;
      fit_one(own, model.package(), body, muscles, totals);
    } else {
      fit_one(own, model.package(), skin.body, muscles, totals);
    }
  }
  fmt::print("\n{} skins, {:.0f} ms a skeleton\n", totals.fits, totals.milliseconds / totals.fits);
  fmt::print("{} fits with bones outside, {} vertices, furthest {:.1f} mm\n", totals.with_bones,
             totals.bone_vertices, 1e3 * totals.furthest);
  for (const auto& [name, fits] : totals.bones) fmt::print("  {:24} {}\n", name, fits);
  fmt::print("muscle points outside {:.4f} %, {} fits beyond {:.2f} %\n",
             100.0 * double(totals.points_outside) / double(totals.points), totals.with_muscles,
             100 * kMuscleLimit);
  fmt::print("bones take at most {:.1f} % of a muscle, {} fits beyond {:.0f} %\n",
             100 * totals.pierced_most, totals.pierced, 100 * kPiercedLimit);
  fmt::print("palpable points off {} of {} ({:.2f} %)\n", totals.off, totals.landmarks,
             100.0 * totals.off / totals.landmarks);
  for (const auto& [name, fits] : totals.palpable)
    fmt::print("  {:24} {:4}   worst {:+.1f} mm\n", name, fits, 1e3 * totals.depth_off[name]);
  fmt::print("vertebrae stretched beyond stature by at most {:.2f}\n", totals.stretched);
  return totals.bone_vertices > 0 || totals.with_muscles > 0 || totals.pierced > 0 ? 1 : 0;
}

}  // namespace
}  // namespace ecorche

int main(int count_of_words, char** words) {
  int count = 200;
  unsigned seed = 1;
  bool unmoved = false, muscles = true;
  std::vector<std::string> files;
  for (int i = 1; i < count_of_words; ++i) {
    const std::string word = words[i];
    if (word == "--count" && i + 1 < count_of_words)
      count = std::atoi(words[++i]);
    else if (word == "--seed" && i + 1 < count_of_words)
      seed = unsigned(std::atoi(words[++i]));
    else if (word == "--skin" && i + 1 < count_of_words)
      files.emplace_back(words[++i]);
    else if (word == "--package")
      unmoved = true;
    else if (word == "--bones")
      muscles = false;
    else
      return fmt::print(stderr, "unknown '{}'\n", word), 2;
  }
  try {
    return ecorche::figures(count, seed, unmoved, muscles, files);
  } catch (const ecorche::InputError& e) {
    return fmt::print(stderr, "skipped: {}\n", e.what()), 77;
  }
}
