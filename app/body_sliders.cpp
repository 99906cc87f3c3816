#include "app/body_sliders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/mesh_measures.h"
#include "anatomy/package.h"
#include "app/live_anatomy.h"
#include "morph/body.h"
#include "morph/modify_body.h"

namespace ecorche {
namespace {

constexpr const char* kShown[] = {"stature",      "crotch_height", "arm_length_outseam", "biacromial_breadth", "neck_girth",
                                  "chest_girth",  "waist_girth",   "hip_girth",          "thigh_girth",        "calf_girth",
                                  "upper_arm_girth_relaxed", "forearm_girth", "weight"};

Vec3f to_float(const Points& P, Eigen::Index row) { return P.row(row).transpose().cast<float>(); }

}  // namespace

struct BodySliders::Impl {
  Impl(const Actor& a, SceneModel& m) : actor(a), model(m) {}

  const Actor& actor;
  SceneModel& model;
  BodyPackage package = read_body_package(find_packages());
  TapeMeasure tape{package, read_measure_table(package, data_folder() / "body")};
  ShapeSpace space;
  Points skin;               // as reshaped
  std::vector<int> shown;
  LiveAnatomy inside{actor};
  PosedAnatomy base;
};

BodySliders::BodySliders(const Actor& actor, SceneModel& model) : impl_(std::make_unique<Impl>(actor, model)) {
  Impl& s = *impl_;
  const Character& character = actor.character;
  if (character.body.skin.V.rows() != s.package.skin_size)
    throw UnfitError(fmt::format("{} skin vertices: sliders need a skin of the base mesh's {}; leave --skin fine away", character.body.skin.V.rows(), s.package.skin_size));
  s.space = read_shape_space(s.package, s.tape, character.body.sex);
  s.skin = character.body.skin.V;
  for (const char* id : kShown) s.shown.push_back(s.tape.table().at(id));
  forward_kinematics(character.anatomy.skeleton, rest_pose(character.anatomy.skeleton), s.base.X_WJ);
  pose_anatomy(actor.table, character.anatomy.skeleton, rest_pose(character.anatomy.skeleton), s.base);
}

BodySliders::~BodySliders() = default;

std::vector<Slider> BodySliders::sliders() const {
  const Impl& s = *impl_;
  std::vector<Slider> out;
  constexpr double kReach = 3.5;  // standard deviations to both sides
  for (int k : s.shown) {
    const Measure& m = s.tape.measure(k);
    const double mean = s.space.law_mean[k], sd = std::sqrt(s.space.law_covariance(k, k));
    const bool mass = m.kind == MeasureKind::mass;
    out.push_back({m.name, mass ? "kg" : "cm", mass ? 1.0 : 100.0, std::max(0.3 * mean, mean - kReach * sd), mean + kReach * sd});
  }
  out.push_back({"fat", "%", 1, 4, 50});
  out.push_back({"hip to waist", "", 1, 0.8, 1.6});
  return out;
}

std::vector<std::optional<double>> BodySliders::asked_by(const std::vector<std::string>& measures) const {
  const Impl& s = *impl_;
  std::vector<std::optional<double>> out(sliders().size());
  for (const std::string& text : measures) {
    const Wish wish = parse_wish(text, s.tape);
    const auto at = std::find(s.shown.begin(), s.shown.end(), wish.measure);
    if (at == s.shown.end()) throw UsageError(fmt::format("--measure {}: no slider shows it", text));
    out[static_cast<std::size_t>(at - s.shown.begin())] = wish.value;
  }
  return out;
}

void BodySliders::reshape(const std::vector<std::optional<double>>& asked, std::vector<double>& achieved) {
  Impl& s = *impl_;
  std::vector<Wish> wishes;
  for (std::size_t i = 0; i < s.shown.size(); ++i)
    if (i < asked.size() && asked[i]) wishes.push_back({s.shown[i], *asked[i]});
  BodyChange change;
  if (asked.size() > s.shown.size()) change.fat = asked[s.shown.size()];
  if (asked.size() > s.shown.size() + 1) change.hip_waist = asked[s.shown.size() + 1];
  // Fat and girths change at a given height; with a length, the others follow it.
  const auto is_length = [&](const Wish& wish) { return s.tape.measure(wish.measure).kind != MeasureKind::girth && s.tape.measure(wish.measure).kind != MeasureKind::mass; };
  change.keep_lengths = std::none_of(wishes.begin(), wishes.end(), is_length);
  change.measures = wishes;
  const Points& character = s.actor.character.body.skin.V;
  if (wishes.empty() && !change.fat && !change.hip_waist) s.skin = character;
  else s.skin = change_body(s.package, s.tape, s.space, character, change).points;
  achieved.clear();
  for (int k : s.shown) achieved.push_back(s.tape.take(k, s.skin));
  achieved.push_back(fat_percentage(s.tape, s.space.sex, s.skin));
  achieved.push_back(hip_waist_ratio(s.tape, s.skin));

  s.inside.follow(s.skin);
  const std::vector<Bone>& bones = s.inside.character().anatomy.bones;
  for (std::size_t b = 0; b < s.model.bones.size(); ++b) {
    DrawMesh& drawn = s.model.bones[b];
    for (std::size_t v = 0; v < drawn.positions.size(); ++v) drawn.positions[v] = to_float(bones[b].mesh.V, static_cast<Eigen::Index>(v));
    ++drawn.revision;
  }
}

void BodySliders::write(const std::filesystem::path& file) const {
  Character character = impl_->inside.character();
  character.body.mass = kBodyDensity * skin_volume(impl_->package, impl_->skin);
  write_character(file, character, impl_->inside.binding());
}

void BodySliders::pose(PosedAnatomy& posed, SkinFrame& frame) const {
  const Impl& s = *impl_;
  posed = s.base;
  posed.slices = s.inside.slices();
  const Skeleton& skeleton = s.inside.character().anatomy.skeleton;
  forward_kinematics(skeleton, rest_pose(skeleton), posed.X_WJ);
  const TriMesh mesh{s.skin, s.package.triangles};
  const Points normals = vertex_normals(mesh);
  frame.positions.resize(4 * static_cast<std::size_t>(s.skin.rows()));
  frame.normals.resize(frame.positions.size());
  for (Eigen::Index v = 0; v < s.skin.rows(); ++v)
    for (int axis = 0; axis < 4; ++axis) {
      const auto at = static_cast<std::size_t>(4 * v + axis);
      frame.positions[at] = axis < 3 ? static_cast<float>(s.skin(v, axis)) : 1;
      frame.normals[at] = axis < 3 ? static_cast<float>(normals(v, axis)) : 0;
    }
}

}  // namespace ecorche
