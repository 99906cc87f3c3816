#include "skinning/evaluation/skin_methods.h"

#include <fmt/format.h>

#include <stdexcept>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {

std::string_view short_name(SkinMethod method) {
  switch (method) {
    case SkinMethod::linear_blend:
      return "lbs";
    case SkinMethod::dual_quaternion:
      return "dqs";
    case SkinMethod::delta_mush:
      return "deltamush";
    case SkinMethod::paper:
      return "paper";
    case SkinMethod::anchors:
      return "anchors";
    case SkinMethod::ecorche:
      break;
  }
  return "ecorche";
}

std::string_view long_name(SkinMethod method) {
  switch (method) {
    case SkinMethod::linear_blend:
      return "linear blend";
    case SkinMethod::dual_quaternion:
      return "dual quaternion";
    case SkinMethod::delta_mush:
      return "delta mush";
    case SkinMethod::paper:
      return "nearest part";
    case SkinMethod::anchors:
      return "ecorche, not settled";
    case SkinMethod::ecorche:
      break;
  }
  return "ecorche";
}

std::optional<SkinMethod> skin_method(std::string_view name) {
  for (const SkinMethod method : kSkinMethods)
    if (short_name(method) == name) return method;
  return std::nullopt;
}

BaselineSkins make_baseline_skins(const BodyPackage& package, const Anatomy& anatomy,
                                  const PosedAnatomy& rest, const TriMesh& skin,
                                  const Binding& binding) {
  if (skin.V.rows() != package.skin_size)
    throw UnfitError(
        fmt::format("the body package's weights are for {} vertices, this skin has {}; only --skin "
                    "ecorche can move it",
                    package.skin_size, skin.V.rows()));
  BaselineSkins out;
  out.blend = make_linear_baseline(package, anatomy.skeleton, skin);
  SkinFrame blended;
  deform_linear_baseline(out.blend, anatomy.skeleton, rest.X_WJ, blended);
  out.mush = make_mush(skin, blended.positions);
  out.paper = make_nearest_part_skin(anatomy, rest, skin, binding);
  return out;
}

void deform_by(const BaselineSkins& skins, SkinMethod method, const Skeleton& skeleton,
               const PosedAnatomy& posed, BaselineWorkspace& workspace, SkinFrame& out) {
  if (is_ours(method))
    throw std::invalid_argument("deform_by: deform_skin() is for our own method");
  if (method == SkinMethod::paper) return deform_nearest_part(skins.paper, posed, out);
  pose_rig(skins.blend.rig, skins.blend.links, skeleton, posed.X_WJ, workspace.bones);
  if (method == SkinMethod::dual_quaternion)
    return deform_dual_quaternion(skins.blend.skin, workspace.bones, out);
  deform_linear(skins.blend.skin, workspace.bones, out);
  if (method == SkinMethod::delta_mush) deform_mush(skins.mush, workspace.mush, out);
}

}  // namespace ecorche::inline v1
