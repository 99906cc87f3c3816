#include "morph/template/template.h"

#include <algorithm>
#include <cmath>

namespace ecorche::inline v1 {
namespace {

// m: how well the regressor knows a joint centre. Larger, and bones drift from the centres;
// smaller, and they keep its errors.
constexpr double kCentreTolerance = 4e-3;
// m: fat gathers where there is more tissue than this over a palpable point, and bones do not
// follow the skin there:
constexpr double kThinTissue = 9e-3;
// Weight (0 .. 1) of lying deeper than in the template there: in bodies as wide for their stature
// as the template, in wide ones, and in wide ones at the back, where less fat gathers. Nearer to 1,
// bones are drawn out into the fat; nearer to 0, they may lie too deep.
constexpr double kDeeperLean = 0.75, kDeeperWide = 0.08, kDeeperBack = 0.35;
// Volume over stature cubed, relative to the template's: where the weights begin and end to change.
constexpr double kLean = 1.1, kWide = 1.35;
constexpr double kFreedom = 0.6;  // of the groups' tolerances, once the build is known

}  // namespace

PlaceInput fit_input(const FitTables& tables, const Points& skin, double stature) {
  PlaceInput input;
  input.source = &tables.half;
  input.centres = joint_centres(tables.regressor, skin);
  for (const auto& [name, centre] : input.centres) input.tolerances[name] = kCentreTolerance;
  input.size = stature / tables.stature;
  input.authored = false;
  input.landmarks = tables.landmarks;
  if (tables.build.own.empty()) return input;
  input.build = &tables.build;
  input.stature = stature;
  input.freedom = kFreedom;
  const double width =
      inner_volume(tables.topology, skin) / tables.volume / std::pow(stature / tables.stature, 3);
  const double share = std::clamp((width - kLean) / (kWide - kLean), 0.0, 1.0);
  for (size_t k = 0; k < input.landmarks.size(); ++k)
    if (tables.rules.landmarks[k].high > kThinTissue) {
      const double wide =
          tables.rules.landmarks[k].direction.z() < -0.7 ? kDeeperBack : kDeeperWide;
      input.landmarks[k].deeper = kDeeperLean + share * (wide - kDeeperLean);
    }
  input.margins = &tables.margins;
  input.gaps = tables.gaps;
  return input;
}

double inner_volume(const BodyPackage& topology, const Points& skin) {
  const TriMesh closed = capped_skin(topology, skin);
  double sum = 0;
  for (Eigen::Index f = 0; f < closed.F.rows(); ++f) {
    const Vec3 a = closed.V.row(closed.F(f, 0)), b = closed.V.row(closed.F(f, 1)),
               c = closed.V.row(closed.F(f, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

const Anatomy& table_anatomy(const Template& body_template) {
  return body_template.tables.built_in ? *body_template.tables.built_in : body_template.anatomy;
}

}  // namespace ecorche::inline v1
