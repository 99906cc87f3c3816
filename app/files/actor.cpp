#include "app/files/actor.h"

#include <fmt/format.h>
#include <oneapi/tbb/task_arena.h>

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "anatomy/base_mesh/body_package.h"
#include "anatomy/base_mesh/refined_skin.h"
#include "anatomy/base_mesh/skin_texture.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/split_edges.h"
#include "anatomy/geometry/vertex_order.h"
#include "app/files/definition.h"
#include "morph/fat/vein_paths.h"
#include "skinning/bind/painted_weights.h"

namespace ecorche {
namespace {

// The fine skin of a character on the base mesh, which gets it.
std::optional<BaseSkin> refine_base(const Assets& assets, Character& character) {
  const BodyPackage package = read_body_package(assets);
  TriMesh& skin = character.body.skin;
  if (character.own || skin.V.rows() != package.skin_size ||
      skin.F.rows() != package.triangles.rows())
    return std::nullopt;
  BaseSkin base{skin, refine_skin(package)};
  skin = {refine_points(base.refinement, base.mesh.V), base.refinement.F};
  return base;
}

// How much of the anatomy shows. A skin that is too coarse for that is refined where the options
// say so.
double choose_definition(const Assets& assets, const ActorOptions& options, Character& character,
                         const BaseSkin*& base, std::optional<BaseSkin>& found) {
  if (options.definition == 0.0 || (!options.definition && character.own)) return 0;
  const auto by_fat = [&](const TriMesh& skin) {
    return definition_of(assets, character.body.sex, skin.V);
  };
  const double definition = options.definition   ? *options.definition
                            : base               ? by_fat(base->mesh)
                            : options.refinement ? by_fat(character.body.skin)
                                                 : 0;
  if (definition <= 0 || base) return definition;
  if (options.refinement) found = refine_base(assets, character);
  if (!found && options.definition)
    throw UnfitError(
        "--definition: this skin is too coarse for what shows through it; make a fine one by "
        "`ecorche fit --skin fine`, or ask for 0");
  if (found) base = &*found;
  return found ? definition : 0;
}

// Edges of a skin that is drawn with what shows through it, m, and of those near veins; bands of
// wavelengths and ridges are to be some edges wide.
constexpr double kDrawnEdge = 0.0048, kVeinEdge = 0.0026, kNearVein = 0.005;

// Is a point near one of the veins? Its cell and those about it are looked up.
class NearVeins {
 public:
  explicit NearVeins(std::span<const VeinPath> veins) {
    for (const VeinPath& vein : veins)
      for (const Vec3& p : vein.points)
        for (int k = 0; k < 27; ++k)
          cells_.insert(cell(p + kNearVein * Vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
  }
  bool operator()(const Vec3& p) const { return cells_.count(cell(p)) > 0; }

 private:
  static std::array<int, 3> cell(const Vec3& p) {
    const auto at = [&](int k) { return int(std::floor(p[k] / kNearVein)); };
    return {at(0), at(1), at(2)};
  }
  std::set<std::array<int, 3>> cells_;
};

// Halves the long edges of a fine skin. Vertices are sorted where no triangle has `corners`.
void refine_drawn(std::span<const VeinPath> veins, BaseSkin& base, TriMesh& skin,
                  std::vector<TextureCorner>& corners) {
  const NearVeins near(veins);
  base.refinement = split_long_edges(
      base.refinement, skin.V, [&](const Vec3& p) { return near(p) ? kVeinEdge : kDrawnEdge; },
      corners);
  if (corners.empty()) {
    const std::vector<int> order = spatial_order(skin.V);
    skin.V = Points(skin.V(order, Eigen::all));
    base.refinement = reordered(base.refinement, order);
  }
  skin.F = base.refinement.F;
}

std::vector<TextureCorner> texture_corners(const Assets& assets, const Refinement& fine) {
  const SkinTexture texture = skin_texture(skin_texture(read_body_package(assets)), fine);
  std::vector<TextureCorner> out;
  for (Eigen::Index f = 0; f < texture.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) out.emplace_back(texture.places.row(texture.F(f, k)));
  return out;
}

// What the relief of the anatomy is made by, beyond the definition.
void add_relief_options(const Assets& assets, const ActorOptions& options, Character& character,
                        std::optional<BaseSkin>& found, std::vector<TextureCorner>& corners,
                        CompileOptions& out) {
  if (out.definition <= 0 || character.own || !out.base) return;
  out.layer = layer_of(assets, character.body.sex, character.body.mass, out.base->mesh.V);
  TriMesh& skin = character.body.skin;
  out.veins = vein_paths(assets.tables, character.anatomy.skeleton, skin);
  if (!options.refinement) return;
  if (!found) found = *out.base;
  if (options.texture) corners = texture_corners(assets, found->refinement);
  refine_drawn(out.veins, *found, skin, corners);
  out.base = &*found;
}

// Options of the compiler; `found` keeps the base mesh.
CompileOptions compile_options(const Assets& assets, Character& character,
                               const ActorOptions& options, std::optional<BaseSkin>& found,
                               std::vector<TextureCorner>& corners, Report& report) {
  CompileOptions out;
  out.muscles = options.muscles;
  out.before = options.before;
  if (!options.base) found = find_base(assets, character);
  out.base = found ? &*found : options.base;
  out.definition = choose_definition(assets, options, character, out.base, found);
  add_relief_options(assets, options, character, found, corners, out);
  if (!options.weights.empty()) {
    out.painted = read_painted_weights(
        options.weights, character.anatomy,
        int(out.base ? out.base->mesh.V.rows() : character.body.skin.V.rows()));
    report.set("weights.painted_vertices", int(out.painted.vertices.size()));
  }
  return out;
}

// The skin over the muscles in state.posed.
const SkinFrame& move_skin(const Actor& actor, SkinMethod method,
                           std::span<const float> soft_tissue, CharacterState& state,
                           BaselineWorkspace& workspace) {
  if (method == SkinMethod::ecorche) return evaluate_posed_skin(actor.skin, soft_tissue, state);
  if (method == SkinMethod::anchors) return evaluate_blended_skin(actor.skin, state);
  deform_by(*actor.baselines, method, actor.character.anatomy.skeleton, state.posed, workspace,
            state.skin);
  return state.skin;
}

const SkinFrame& move_posed(const Actor& actor, const Pose& pose, const FrameInputs& inputs,
                            CharacterState& state, BaselineWorkspace& workspace) {
  pose_muscles(actor.muscles, actor.character.anatomy.skeleton, pose, state.posed, state.contact,
               tbb::this_task_arena::max_concurrency(), inputs.activation);
  return move_skin(actor, actor.method, inputs.soft_tissue, state, workspace);
}

}  // namespace

Actor make_actor(const Assets& assets, Character character, Report& report,
                 const ActorOptions& options) {
  std::optional<BaseSkin> found;
  std::vector<TextureCorner> corners;
  CompileOptions compile = compile_options(assets, character, options, found, corners, report);
  CompileTimes times;
  compile.times = &times;
  report.set("definition", compile.definition);
  Actor actor;
  static_cast<CharacterModel&>(actor) = compile_character(std::move(character), compile);
  actor.corners = std::move(corners);
  report.set("timings_ms.posing_table", times.muscles_ms);
  report.set("timings_ms.anchoring", times.skin_ms);
  return actor;
}

BoundCharacter bind_character(const Assets& assets, Character character, Report& report,
                              const ActorOptions& options) {
  std::optional<BaseSkin> found;
  std::vector<TextureCorner> corners;
  CompileOptions compile = compile_options(assets, character, options, found, corners, report);
  CompileTimes times;
  compile.times = &times;
  BoundCharacter out;
  out.binding = bind_for_export(character, compile);
  out.character = std::move(character);
  report.set("timings_ms.anchoring", times.skin_ms);
  return out;
}

void add_baselines(const Assets& assets, Actor& actor) {
  const Anatomy& anatomy = actor.character.anatomy;
  PosedAnatomy rest;
  ContactWorkspace contact;
  pose_muscles(actor.muscles, anatomy.skeleton, rest_pose(anatomy.skeleton), rest, contact);
  actor.baselines = std::make_shared<const BaselineSkins>(make_baseline_skins(
      read_body_package(assets), anatomy, rest, actor.character.body.skin, actor.binding));
}

void choose_skin(const Assets& assets, Actor& actor, const std::string& method) {
  const std::optional<SkinMethod> chosen = skin_method(method);
  if (!chosen)
    throw UsageError(
        fmt::format("--skin: '{}' is no way to move a skin; there are lbs, dqs, deltamush, paper, "
                    "anchors and ecorche",
                    method));
  if (!is_ours(*chosen) && !actor.baselines) add_baselines(assets, actor);
  actor.method = *chosen;
}

const SkinFrame& evaluate_posed_skin(const Actor& actor, SkinMethod method, ActorState& state) {
  return move_skin(actor, method, {}, state, state.baseline);
}

const SkinFrame& evaluate_skin(const Actor& actor, const Pose& pose, const FrameInputs& inputs,
                               ActorState& state) {
  if (actor.method == SkinMethod::ecorche) {
    const CharacterModel& model = actor;
    return evaluate_skin(model, pose, inputs, state);
  }
  return move_posed(actor, pose, inputs, state, state.baseline);
}

void evaluate(const Actor& actor, const Pose& pose, const FrameInputs& inputs,
              CharacterState& state, BaselineWorkspace& workspace) {
  const CharacterModel& model = actor;
  if (actor.method == SkinMethod::ecorche)
    evaluate(model, pose, inputs, state);
  else
    move_posed(actor, pose, inputs, state, workspace);
}

void evaluate(const Actor& actor, const Pose& pose, const FrameInputs& inputs, ActorState& state) {
  evaluate(actor, pose, inputs, state, state.baseline);
}

}  // namespace ecorche
