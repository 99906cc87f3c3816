#include "app/files/definition.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/compute/smooth_step.h"
#include "morph/measures/body_volume.h"
#include "morph/measures/measure_table.h"
#include "morph/measures/tape_measure.h"
#include "morph/shapes/modify_body.h"

namespace ecorche {
namespace {

// By girths and height, 0 .. 1; none of a skin that is not on the base mesh.
std::optional<double> fat_share_of(const BodyPackage& package, Sex sex, const Points& base_skin) {
  if (base_skin.rows() != package.skin_size) return std::nullopt;
  const TapeMeasure tape(package, read_measure_table(package, package.tables / "body"));
  return 0.01 * fat_percentage(tape, sex, base_skin);
}

}  // namespace

double definition_of(Sex sex, double fat_share) {
  const double all = sex == Sex::male ? 0.08 : 0.15, nothing = sex == Sex::male ? 0.18 : 0.25;
  return 1 - smooth_step(all, nothing, fat_share);
}

double definition_of(const Assets& assets, Sex sex, const Points& base_skin) {
  const std::optional<double> share = fat_share_of(read_body_package(assets), sex, base_skin);
  return share ? definition_of(sex, *share) : 0;
}

double layer_of(Sex sex, double fat_share, double mass, double stature) {
  constexpr double kUnderSkin = 0.8, kDensity = 920, kSkin = 0.0015;
  const double essential = sex == Sex::male ? 0.03 : 0.08;
  const double surface = 0.007184 * std::pow(mass, 0.425) * std::pow(100 * stature, 0.725);
  return kSkin + kUnderSkin * mass * std::max(fat_share - essential, 0.0) / (kDensity * surface);
}

double layer_of(const Assets& assets, Sex sex, double mass, const Points& base_skin) {
  const BodyPackage package = read_body_package(assets);
  const std::optional<double> share = fat_share_of(package, sex, base_skin);
  if (!share) return 0;
  if (mass <= 0) mass = kBodyDensity * skin_volume(package, base_skin);
  return layer_of(sex, *share, mass, stature(package, base_skin));
}

}  // namespace ecorche
