// Skinning methods by name: ours, and the baselines that users have today, with the body package's
// own rig and weights.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "anatomy/base_mesh/body_package.h"
#include "skinning/evaluation/delta_mush.h"
#include "skinning/evaluation/nearest_part.h"
#include "skinning/evaluation/package_blend.h"

namespace ecorche::inline v1 {

// anchors: ours, but it does not settle.
enum class SkinMethod { linear_blend, dual_quaternion, delta_mush, paper, anchors, ecorche };

inline constexpr std::array kSkinMethods{SkinMethod::linear_blend, SkinMethod::dual_quaternion,
                                         SkinMethod::delta_mush,   SkinMethod::paper,
                                         SkinMethod::anchors,      SkinMethod::ecorche};

inline bool is_ours(SkinMethod method) {
  return method == SkinMethod::anchors || method == SkinMethod::ecorche;
}

std::string_view short_name(
    SkinMethod method);  // "lbs", "dqs", "deltamush", "paper", "anchors", "ecorche"
std::string_view long_name(SkinMethod method);  // "linear blend", ...
std::optional<SkinMethod> skin_method(std::string_view short_name);

// All but ours, for one character.
struct BaselineSkins {
  LinearBaseline blend;
  MushTables mush;  // over the linear blend
  NearestPartSkin paper;
};

struct BaselineWorkspace {
  std::vector<Transform> bones;
  MushWorkspace mush;
};

// Throws UnfitError unless `skin` has the base mesh's vertices. Precondition: the binding and
// `rest` (the anatomy's rest pose) belong to it.
BaselineSkins make_baseline_skins(const BodyPackage& package, const Anatomy& anatomy,
                                  const PosedAnatomy& rest, const TriMesh& skin,
                                  const Binding& binding);

// Precondition: method is none of ours (std::invalid_argument), `posed` is of the skeleton's
// anatomy.
void deform_by(const BaselineSkins& skins, SkinMethod method, const Skeleton& skeleton,
               const PosedAnatomy& posed, BaselineWorkspace& workspace, SkinFrame& out);

}  // namespace ecorche::inline v1
