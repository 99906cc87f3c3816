// Laws of the relief: what a layer lets through of a ripple beneath it, that it is continuous, and
// that it takes nothing away and adds nothing.
#include "skinning/relief/skin_relief.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

#include "anatomy/geometry/mesh_measures.h"
#include "skinning/relief/layer_filter.h"
#include "skinning/relief/relief_nodes.h"

namespace ecorche {
namespace {

constexpr double kSide = 0.6;  // m, of the sheets

TriMesh sheet(double spacing, double height, double amplitude, double wavelength) {
  const int n = int(std::lround(kSide / spacing)) + 1;
  TriMesh out{Points(n * n, 3), Triangles(2 * (n - 1) * (n - 1), 3)};
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = i * spacing - kSide / 2;
      const double ripple = amplitude * std::sin(2 * std::numbers::pi * x / wavelength);
      out.V.row(i * n + j) << x, height + ripple, j * spacing - kSide / 2;
    }
  Eigen::Index f = 0;
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      const int a = i * n + j, b = a + 1, c = a + n, d = c + 1;
      out.F.row(f++) << a, b, c;
      out.F.row(f++) << c, b, d;
    }
  return out;
}

// A flat skin over a rippled plate of bone.
struct Plate {
  TriMesh base, fine;
  Refinement refinement;
  std::vector<JointWeights> weights;
  Anatomy anatomy;
  PosedAnatomy rest;

  Plate(double thickness, double amplitude, double wavelength) {
    base = sheet(0.012, 1, 0, 1);
    refinement = refine(base.F, int(base.V.rows()));
    fine = {refine_points(refinement, base.V), refinement.F};
    weights.resize(std::size_t(fine.V.rows()));
    for (JointWeights& row : weights) row[0] = {0, 1};
    anatomy.skeleton.joints.push_back({.name = "pelvis"});
    anatomy.bones.push_back(
        {"plate", Side::middle, 0, sheet(0.003, 1 - thickness, amplitude, wavelength)});
    forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
  }

  SkinRelief relief(double definition, double layer = 0,
                    std::span<const VeinPath> veins = {}) const {
    return make_skin_relief(anatomy, rest, {fine, base, refinement, weights},
                            {.definition = definition, .layer = layer, .veins = veins});
  }

  SkinFrame frame() const {
    SkinFrame out;
    const Points normals = vertex_normals(fine);
    for (Eigen::Index v = 0; v < fine.V.rows(); ++v)
      for (int k = 0; k < 4; ++k) {
        out.positions.push_back(k < 3 ? float(fine.V(v, k)) : 1);
        out.normals.push_back(k < 3 ? float(normals(v, k)) : 0);
      }
    return out;
  }

  // Whether a vertex is so far from the sheet's edge that nothing of it is felt.
  bool inner(Eigen::Index v) const {
    return std::abs(fine.V(v, 0)) < 0.15 && std::abs(fine.V(v, 2)) < 0.15;
  }

  // Amplitude of the skin's ripple of a wavelength.
  double amplitude(const std::vector<float>& relief, double wavelength) const {
    double sine = 0, cosine = 0, count = 0;
    for (Eigen::Index v = 0; v < fine.V.rows(); ++v) {
      if (!inner(v)) continue;
      const double phase = 2 * std::numbers::pi * fine.V(v, 0) / wavelength;
      sine += std::sin(phase) * double(relief[std::size_t(v)]);
      cosine += std::cos(phase) * double(relief[std::size_t(v)]);
      ++count;
    }
    return 2 * std::hypot(sine, cosine) / count;
  }
};

TEST(Relief, BandsPassWhatALayerLetsThrough) {
  for (const double thickness : {0.002, 0.004, 0.008, 0.015, 0.03}) {
    const BandWeights weights = band_weights(thickness);
    double sum = 0;
    for (const float weight : weights) sum += double(weight);
    EXPECT_NEAR(sum, 0, 1e-5);
    double worst = 0;
    for (double length = 0.012; length < 0.3; length *= 1.1) {
      double passed = 0;
      for (int k = 0; k < kBands; ++k)
        passed += double(weights[k]) * kept(k, 2 * std::numbers::pi / length);
      worst = std::max(worst, std::abs(passed - transmitted(thickness, length)));
    }
    EXPECT_LT(worst, 0.06) << thickness;
  }
}

TEST(Relief, ARippleComesThroughAsTheLayerIsThin) {
  constexpr double kAmplitude = 0.0006;
  for (const double thickness : {0.004, 0.008})
    for (const double wavelength : {0.03, 0.05, 0.075}) {
      const Plate plate(thickness, kAmplitude, wavelength);
      SkinFrame frame = plate.frame();
      ReliefWorkspace workspace;
      add_relief(plate.relief(1), plate.rest, {}, frame, workspace);
      const double share = plate.amplitude(workspace.relief, wavelength) / kAmplitude;
      EXPECT_NEAR(share, transmitted(thickness, wavelength), 0.09)
          << thickness << " " << wavelength;
    }
}

TEST(Relief, NothingComesThroughAThickLayer) {
  const Plate plate(0.03, 0.002, 0.04);
  SkinFrame frame = plate.frame();
  ReliefWorkspace workspace;
  add_relief(plate.relief(1), plate.rest, {}, frame, workspace);
  for (Eigen::Index v = 0; v < plate.fine.V.rows(); ++v)
    if (plate.inner(v)) EXPECT_LT(std::abs(workspace.relief[std::size_t(v)]), 0.03f * 0.002f);
}

TEST(Relief, HalfADefinitionIsHalfTheRelief) {
  const Plate plate(0.004, 0.0003, 0.05);
  EXPECT_TRUE(plate.relief(0).empty());
  ReliefWorkspace workspace;
  SkinFrame frame = plate.frame();
  EXPECT_THROW(add_relief(plate.relief(0), plate.rest, {}, frame, workspace),
               std::invalid_argument);
  add_relief(plate.relief(1), plate.rest, {}, frame, workspace);
  const double whole = plate.amplitude(workspace.relief, 0.05);
  frame = plate.frame();
  add_relief(plate.relief(0.5), plate.rest, {}, frame, workspace);
  EXPECT_NEAR(plate.amplitude(workspace.relief, 0.05) / whole, 0.5, 0.02);
}

TEST(Relief, FollowsWhatSlidesBeneathWithoutLeaps) {
  const Plate plate(0.004, 0.001, 0.04);
  const SkinRelief relief = plate.relief(1);
  ReliefWorkspace workspace;
  std::vector<float> before;
  float leap = 0, travelled = 0;
  for (int step = 0; step <= 100; ++step) {
    PosedAnatomy posed = plate.rest;
    for (Transform& X : posed.X_WJ) X.pretranslate(Vec3(2e-4 * step, 0, 0));
    SkinFrame frame = plate.frame();
    add_relief(relief, posed, {}, frame, workspace);
    for (Eigen::Index v = 0; v < plate.fine.V.rows() && !before.empty(); ++v)
      if (plate.inner(v))
        leap = std::max(leap, std::abs(workspace.relief[std::size_t(v)] - before[std::size_t(v)]));
    before = workspace.relief;
    const Eigen::Index middle = plate.fine.V.rows() / 2;
    travelled = std::max(travelled, std::abs(workspace.relief[std::size_t(middle)]));
  }
  // the steepest the ripple itself is, 0.157, times the step, with what sampling adds
  EXPECT_LT(leap, 1.3f * 0.157f * 2e-4f);
  EXPECT_GT(travelled, 1e-4f);
}

TEST(Relief, KeepsTheVolumeBeneathTheSkin) {
  const Plate plate(0.004, 0.004, 0.06);  // so high that bounds are met
  SkinFrame frame = plate.frame();
  ReliefWorkspace workspace;
  add_relief(plate.relief(1), plate.rest, {}, frame, workspace);
  double mean = 0, size = 0, count = 0;
  for (Eigen::Index v = 0; v < plate.fine.V.rows(); ++v) {
    if (!plate.inner(v)) continue;
    mean += double(workspace.relief[std::size_t(v)]);
    size += std::abs(double(workspace.relief[std::size_t(v)]));
    ++count;
  }
  EXPECT_GT(size / count, 5e-4);
  EXPECT_LT(std::abs(mean), 0.02 * size);
}

TEST(Relief, NothingIsSeenOfWhatIsFlat) {
  const Plate plate(0.004, 0, 1);
  SkinFrame frame = plate.frame();
  ReliefWorkspace workspace;
  add_relief(plate.relief(1), plate.rest, {}, frame, workspace);
  for (Eigen::Index v = 0; v < plate.fine.V.rows(); ++v)
    if (plate.inner(v)) EXPECT_LT(std::abs(workspace.relief[std::size_t(v)]), 1e-5f);
}

TEST(Relief, MoreIsSeenOfTheThinner) {
  const Plate plate(0.01, 0.001, 0.05);
  double before = 0;
  for (const double layer : {0.0, 0.008, 0.006, 0.004}) {
    SkinFrame frame = plate.frame();
    ReliefWorkspace workspace;
    add_relief(plate.relief(1, layer), plate.rest, {}, frame, workspace);
    const double now = plate.amplitude(workspace.relief, 0.05);
    EXPECT_GT(now, 1.05 * before) << layer;
    before = now;
  }
  EXPECT_LT(before, 0.001);
}

TEST(Relief, TheSkinFollowsWhatSwellsBeneath) {
  const Plate plate(0.006, 0, 1);
  const SkinRelief relief = plate.relief(1);
  PosedAnatomy posed = plate.rest;
  for (Transform& X : posed.X_WJ) X.pretranslate(Vec3(0, 0.001, 0));
  SkinFrame frame = plate.frame();
  ReliefWorkspace workspace;
  add_relief(relief, posed, {}, frame, workspace);
  for (Eigen::Index v = 0; v < plate.fine.V.rows(); ++v)
    if (plate.inner(v)) EXPECT_NEAR(workspace.relief[std::size_t(v)], 0.001, 1e-4);
}

// A vein along the middle of the sheet.
VeinPath straight_vein() {
  return {"straight", {Vec3(0, 1, -0.2), Vec3(0, 1, 0), Vec3(0, 1, 0.2)}, 0.004, 0.001};
}

TEST(Relief, VeinsAreSeenInTheLeanAndMoreInEffort) {
  const VeinPath vein = straight_vein();
  const auto height = [&](double thickness, double activation) {
    const Plate plate(thickness, 0, 1);
    SkinFrame frame = plate.frame();
    ReliefWorkspace workspace;
    const std::vector<double> muscles(8, activation);
    add_relief(plate.relief(1, 0, {&vein, 1}), plate.rest, muscles, frame, workspace);
    float highest = 0;
    for (Eigen::Index v = 0; v < plate.fine.V.rows(); ++v) {
      if (!plate.inner(v)) continue;
      EXPECT_LT(workspace.relief[std::size_t(v)], vein.height);
      highest = std::max(highest, workspace.relief[std::size_t(v)]);
    }
    return double(highest);
  };
  const double lean = height(0.002, 0);
  EXPECT_GT(lean, 2e-4);
  EXPECT_GT(height(0.002, 0.5), 1.3 * lean);
  EXPECT_LT(height(0.004, 0), 0.6 * lean);
  EXPECT_LT(height(0.015, 0), 0.01 * lean);
}

TEST(Relief, NodesKeepWhatIsConstant) {
  const TriMesh skin = sheet(0.004, 1, 0.01, 0.1);
  const std::vector<char> wanted(std::size_t(skin.V.rows()), 1);
  const ReliefNodes nodes = make_relief_nodes(graph_of(skin), wanted);
  EXPECT_LT(5 * nodes.vertex.size(), wanted.size() * 2);
  const std::vector<float> ones(wanted.size(), 1);
  std::vector<float> at(nodes.vertex.size()), back(wanted.size());
  smooth(nodes.to, ones, at);
  smooth(nodes.from, at, back);
  for (const float value : back) EXPECT_NEAR(value, 1, 1e-5);
}

}  // namespace
}  // namespace ecorche
