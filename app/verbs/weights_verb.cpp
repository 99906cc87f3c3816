#include "app/verbs/weights_verb.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <sstream>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/geometry/mesh_measures.h"
#include "app/files/actor.h"
#include "app/files/open_character.h"
#include "app/options/motion_options.h"
#include "app/options/subject_options.h"
#include "skinning/bind/painted_weights.h"
#include "skinning/motion/no_such_joint.h"
#include "viewer/camera.h"
#include "viewer/draw_mesh.h"
#include "viewer/gl/renderer.h"
#include "viewer/lettering.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

struct WeightsVerbOptions {
  fs::path character, table, picture, weights;
  std::string joints;
};

std::vector<int> read_joints(const std::string& text, const Skeleton& skeleton) {
  std::vector<int> out;
  std::istringstream names(text);
  for (std::string name; std::getline(names, name, ',');) {
    out.push_back(find_joint(skeleton, name));
    if (out.back() < 0) throw UsageError("--joint: " + no_such_joint(skeleton, name));
  }
  return out;
}

// Colour ramp from pale to red over 0 .. 1.
Vec3f colour_of(float weight) {
  const Vec3f pale(0.86f, 0.86f, 0.84f), yellow(0.99f, 0.85f, 0.45f), red(0.72f, 0.08f, 0.10f);
  return weight < 0.5f ? Vec3f(pale + 2 * weight * (yellow - pale))
                       : Vec3f(yellow + (2 * weight - 1) * (red - yellow));
}

// One row per joint, with three views of the body.
Image picture_of(const TriMesh& skin, const Skeleton& skeleton,
                 const std::vector<std::vector<Influence>>& rows, const std::vector<int>& joints) {
  constexpr int kWidth = 420, kHeight = 620, kTitle = 34;
  constexpr const char* kViews[] = {"front", "left", "back"};
  Renderer renderer;
  Image whole = make_image(3 * kWidth, int(joints.size()) * (kHeight + kTitle));
  DrawList list;
  list.meshes.push_back(make_draw_mesh(skin));
  list.items.push_back(
      {.mesh = 0, .surface = {.roughness = 0.8f}, .casts_shadow = false, .closed = true});
  light_from_camera(0.6f, list.lighting);
  list.background_top = list.background_bottom = Vec3f(1.2f, 1.2f, 1.2f);
  const Vec3 low = skin.V.colwise().minCoeff(), high = skin.V.colwise().maxCoeff();
  for (size_t j = 0; j < joints.size(); ++j) {
    DrawMesh& mesh = list.meshes[0];
    mesh.colors.clear();
    for (const std::vector<Influence>& row : rows) {
      const auto own = std::find_if(row.begin(), row.end(),
                                    [&](const Influence& w) { return w.joint == joints[j]; });
      mesh.colors.push_back(colour_of(own == row.end() ? 0.0f : float(own->weight)));
    }
    const int y = int(j) * (kHeight + kTitle);
    for (int view = 0; view < 3; ++view) {
      const ViewAngles angles = view_angles(kViews[view]);
      list.camera =
          orbit_camera((0.5 * (low + high)).cast<float>(), float(0.55 * (high - low).norm()),
                       angles.azimuth, angles.elevation, 0.3f);
      list.camera.ortho_height =
          float(1.06 * std::max((high - low).y(), (high - low).x() * kHeight / kWidth));
      const Image cell = renderer.render(list, kWidth, kHeight);
      for (int row = 0; row < kHeight; ++row)
        std::copy_n(cell.pixel(0, row), 4 * std::size_t(kWidth),
                    whole.pixel(view * kWidth, y + kTitle + row));
    }
    draw_text(
        whole,
        fmt::format("weights of {}: pale 0, yellow 1/2, red 1", skeleton.joints[joints[j]].name),
        10, float(y + 24), {.size = 18});
  }
  return whole;
}

int run_weights(const WeightsVerbOptions& options, const Common& common, Report& report) {
  if (options.table.empty() && options.picture.empty())
    throw UsageError(
        "weights: nothing to do; give -o FILE.csv, or --joint NAME and --picture FILE.png");
  if (options.picture.empty() != options.joints.empty())
    throw UsageError("weights: --joint and --picture belong together");
  check_outputs(common, {options.table, options.picture}, {options.character, options.weights});
  Character character = open_character(options.character, common, report);
  const std::vector<int> joints = read_joints(options.joints, character.anatomy.skeleton);
  const std::optional<BaseSkin> base = find_base(common.assets, character);
  const Actor actor = make_actor(common.assets, std::move(character), report,
                                 {base ? &*base : nullptr, options.weights, MuscleMotion::lines});
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const std::vector<std::vector<Influence>> rows = joint_weights_of(*actor.skin.base_blend);
  size_t entries = 0;
  for (const std::vector<Influence>& row : rows) entries += row.size();
  report.set("weights.vertices", int(rows.size()));
  report.set("weights.entries", int(entries));
  if (!options.table.empty()) {
    write_weights(options.table, skeleton, *actor.skin.base_blend);
    note(common, fmt::format("{}: {} weights of {} vertices", options.table.string(), entries,
                             rows.size()));
  }
  if (!joints.empty()) {
    write_png(options.picture,
              picture_of(base ? base->mesh : actor.character.body.skin, skeleton, rows, joints));
    note(common, options.picture.string());
  }
  return 0;
}

}  // namespace

void add_weights_verb(VerbRegistry& registry) {
  auto options = std::make_shared<WeightsVerbOptions>();
  CLI::App* verb = add_verb(
      registry, registry.app, "weights",
      "How much each joint moves each vertex of the skin, as a table and as pictures",
      "ecorche weights anna-anatomy.glb -o weights.csv --joint scapula_l,shoulder_l --picture "
      "weights.png",
      [options](const Common& common, Report& report) {
        return run_weights(*options, common, report);
      });
  add_character_option(*verb, options->character);
  verb->add_option(
      "-o,--output", options->table,
      "Table to write (.csv): vertex, joint, weight; change it and give it back with --weights");
  verb->add_option("--joint", options->joints,
                   "Joints that the picture shows, separated by commas");
  verb->add_option("--picture", options->picture,
                   "Picture to write (.png): the body coloured by these joints' weights");
  add_weights_option(*verb, options->weights);
}

}  // namespace ecorche
