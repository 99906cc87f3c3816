#include "morph/fit/refit_character.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/same_muscle.h"
#include "anatomy/queries/ray_caster.h"
#include "morph/fascia/lay_fascia.h"

namespace ecorche::inline v1 {
namespace {

using Clock = std::chrono::steady_clock;

// m between sections of muscles that grow together. Larger: more muscles, more time, nearer to the
// whole fit.
constexpr double kNear = 0.012;
constexpr double kMostGrown = 0.4;    // of all muscles
constexpr double kFasciaNear = 0.03;  // m, from a sheet to what it lies on
constexpr float kWidest = 1.5f;       // factor of an outline that counts for how far a section goes

// How a muscle of the template stands to those that were fitted.
struct Standing {
  std::vector<int> held;        // #muscles: which of them it is, -1: it has changed
  std::vector<int> changed_of;  // of those before: changed, or gone
};

Standing compare(std::span<const Muscle> muscles, std::span<const Muscle> before) {
  std::map<std::string, int> at;
  for (std::size_t m = 0; m < before.size(); ++m) at.emplace(before[m].name, int(m));
  std::vector<char> kept(before.size(), 0);
  Standing out;
  for (const Muscle& muscle : muscles) {
    const auto own = at.find(muscle.name);
    const bool same = own != at.end() && is_same(muscle, before[std::size_t(own->second)]);
    out.held.push_back(same ? own->second : -1);
    if (same) kept[std::size_t(own->second)] = 1;
  }
  for (std::size_t m = 0; m < kept.size(); ++m)
    if (!kept[m]) out.changed_of.push_back(int(m));
  return out;
}

// A ball about a section.
struct Ball {
  Vec3 centre;
  double radius = 0;
};

void add_balls(std::span<const Ellipse> slices, std::vector<Ball>& out) {
  for (const Ellipse& slice : slices)
    out.push_back(
        {slice.center, slice.radii.maxCoeff() *
                           double(std::min(kWidest, *std::ranges::max_element(slice.outline)))});
}

// Of muscles that are not held.
void add_free_balls(std::span<const Muscle> muscles, std::span<const int> held,
                    std::vector<Ball>& out) {
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (held[m] < 0)
      for (const Strip& strip : muscles[m].strips)
        if (strip.slices.size() >= 2) add_balls(rest_slices(strip), out);
}

bool is_near(const Ball& ball, std::span<const Ball> others, double distance) {
  return std::ranges::any_of(others, [&](const Ball& other) {
    return (ball.centre - other.centre).norm() < ball.radius + other.radius + distance;
  });
}

std::span<const Ellipse> sections_of(const DilationRecord& record, int muscle) {
  const std::size_t begin = record.muscle_begin[std::size_t(muscle)];
  return std::span(record.finished)
      .subspan(begin, record.muscle_begin[std::size_t(muscle) + 1] - begin);
}

// Names of muscles with the side that is grown where both are even.
std::string even_name(const Muscle& muscle) {
  std::string out = muscle.name;
  if (muscle.side == Side::right) out.back() = 'l';
  return out;
}

// Lets go of those near what has changed, and of their other sides.
void let_go_of_neighbours(std::span<const Muscle> muscles, const DilationRecord& before,
                          std::span<const Ball> changed, std::vector<int>& held) {
  std::map<std::string, bool> grown;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    bool& either = grown[even_name(muscles[m])];
    if (held[m] >= 0 && !either) {
      std::vector<Ball> own;
      add_balls(sections_of(before, held[m]), own);
      either =
          std::ranges::any_of(own, [&](const Ball& ball) { return is_near(ball, changed, kNear); });
    }
    either = either || held[m] < 0;
  }
  for (std::size_t m = 0; m < muscles.size(); ++m)
    if (grown[even_name(muscles[m])]) held[m] = -1;
}

// Sheets near what has grown are laid anew.
std::vector<FasciaSheet> lay_again(const FitRecord& before, std::span<const Ball> grown,
                                   const Anatomy& anatomy, const SkinRays& wall) {
  std::vector<FasciaSheet> out = before.fascia;
  std::vector<FasciaPlan> plans;
  for (const FasciaPlan& plan : before.fit.fascia) {
    const auto sheet = std::ranges::find(out, plan.name, &FasciaSheet::name);
    if (sheet == out.end()) continue;
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < sheet->V.rows(); ++i) box.extend(sheet->V.row(i).transpose());
    if (std::ranges::any_of(grown, [&](const Ball& ball) {
          return box.exteriorDistance(ball.centre) < ball.radius + kFasciaNear;
        }))
      plans.push_back(plan);
  }
  for (FasciaSheet& sheet : lay_fascia(plans, anatomy, wall))
    *std::ranges::find(out, sheet.name, &FasciaSheet::name) = std::move(sheet);
  return out;
}

}  // namespace

std::optional<FittedCharacter> refit_character(const Template& body_template, const Body& body,
                                               const BodyPackage& package,
                                               const FittingOptions& options,
                                               const FitRecord& before) {
  const std::vector<Muscle>& muscles = body_template.tables.muscles;
  if (!options.dilated || options.dilate.method != DilateMethod::ecorche || !options.dilate.share ||
      options.fit.interior != Interior::bones || before.dilation.finished.empty())
    return std::nullopt;
  Standing standing = compare(muscles, before.of);
  std::vector<int>& held = standing.held;
  FittedCharacter fitted;
  FittingReport& report = fitted.report;
  report.fit = before.fit.report;
  fitted.anatomy.skeleton = before.fit.anatomy.skeleton;
  fitted.anatomy.bones = before.fit.anatomy.bones;
  fitted.anatomy.muscles = carry_muscles_again(body_template, body, before.fit, held);

  std::vector<Ball> changed;
  for (const int m : standing.changed_of) add_balls(sections_of(before.dilation, m), changed);
  add_free_balls(fitted.anatomy.muscles, held, changed);
  let_go_of_neighbours(muscles, before.dilation, changed, held);
  if (double(std::ranges::count(held, -1)) > kMostGrown * double(held.size())) return std::nullopt;
  fitted.undilated = fitted.anatomy;

  const SkinRays wall(chest_wall_skin(package, body.sex, body.skin.V));
  const auto start = Clock::now();
  fitted.fat = fat_of(body_template, body, fitted.anatomy, wall, options);
  report.dilation =
      dilate_muscles(fitted.anatomy, fitted.undilated.muscles, muscles, wall, fitted.fat,
                     dilation_of(options, report.fit), {.before = &before.dilation, .held = held});
  // to the last digit, so that what was worked out for them holds
  for (std::size_t m = 0; m < held.size(); ++m)
    if (held[m] >= 0) fitted.anatomy.muscles[m] = before.grown[std::size_t(held[m])];
  std::vector<Ball> grown = changed;
  add_free_balls(fitted.anatomy.muscles, held, grown);
  fitted.anatomy.fascia = lay_again(before, grown, fitted.anatomy, wall);
  report.dilation_ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  rearrange_joints(options.joints, fitted.anatomy);
  rearrange_joints(options.joints, fitted.undilated);
  return fitted;
}

}  // namespace ecorche::inline v1
