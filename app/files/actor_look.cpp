#include "app/files/actor_look.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "skinning/relief/skin_relief.h"

namespace ecorche {
namespace {

// What a vein multiplies the skin's colour by where its ridge is of kFullTint (m) and more: blood
// under skin takes red away most (Kienle et al. 1996, "Why do veins appear blue?").
const Eigen::Vector3f kVeinTint(0.80f, 0.90f, 0.98f);
constexpr float kFullTint = 0.0008f;

// The mesh that relaxes, at rest, its vertices in the base mesh's order.
Points rest_base(const Actor& actor) {
  CharacterState state(actor);
  evaluate_skin(actor, rest_pose(actor.character.anatomy.skeleton), {}, state);
  const std::vector<float>& at = state.relaxed.positions;
  const std::vector<int>& order = actor.skin.base_blend->mesh.order;
  Points out(Eigen::Index(at.size() / 4), 3);
  for (std::size_t s = 0; s < at.size() / 4; ++s)
    for (std::size_t k = 0; k < 3; ++k)
      out(order.empty() ? Eigen::Index(s) : Eigen::Index(order[s]), Eigen::Index(k)) =
          double(at[4 * s + k]);
  return out;
}

}  // namespace

std::vector<Eyeball> actor_eyes(const Assets& assets, const Actor& actor) {
  const Skeleton& skeleton = actor.character.anatomy.skeleton;
  const TriMesh& skin = actor.character.body.skin;
  if (actor.character.own || !actor.skin.refined) return find_eyes(assets, skin, skeleton);
  return find_eyes(assets, {rest_base(actor), Triangles(0, 3)}, skeleton);
}

std::vector<Eigen::Vector3f> vein_colors(const Actor& actor, const Eigen::Vector3f& color) {
  const std::span<const float> heights = vein_heights(actor.relief);
  std::vector<Eigen::Vector3f> out;
  for (const float height : heights) {
    const float share = std::min(height / kFullTint, 1.0f);
    out.push_back(color.cwiseProduct(Eigen::Vector3f::Ones() +
                                     share * (kVeinTint - Eigen::Vector3f::Ones())));
  }
  return out;
}

}  // namespace ecorche
