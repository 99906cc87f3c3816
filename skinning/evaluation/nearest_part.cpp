#include "skinning/evaluation/nearest_part.h"

#include <algorithm>
#include <stdexcept>

#include "anatomy/geometry/vertex_normals.h"

namespace ecorche::inline v1 {
namespace {

NearestPartSkin::PartAnchor anchor_on_slice(const Ellipse& slice, int part, const Vec3& anchor,
                                            const Vec3& vertex, double weight) {
  NearestPartSkin::PartAnchor hold;
  hold.part = part;
  hold.muscle = true;
  hold.at = slice.axes.transpose() * (anchor - slice.center);
  hold.at.head<2>() = hold.at.head<2>().cwiseQuotient(slice.radii.cwiseMax(1e-6));
  hold.offset = slice.axes.transpose() * (vertex - anchor);
  hold.weight = weight;
  return hold;
}

Vec3 carried(const NearestPartSkin::PartAnchor& hold, const PosedAnatomy& posed) {
  if (!hold.muscle) return posed.X_WJ[hold.part] * hold.at;
  const Ellipse& slice = posed.slices[hold.part];
  Vec3 local = hold.at;
  local.head<2>() = local.head<2>().cwiseProduct(slice.radii.cwiseMax(1e-6));
  return slice.center + slice.axes * (local + hold.offset);
}

}  // namespace

NearestPartSkin make_nearest_part_skin(const Anatomy& anatomy, const PosedAnatomy& rest,
                                       const TriMesh& skin, const Binding& binding) {
  const std::size_t n = skin.V.rows();
  if (binding.anchors.size() != n)
    throw std::invalid_argument("make_nearest_part_skin: the binding belongs to another skin");
  std::vector<char> has_next(rest.slices.size(), 0);
  for (const SliceRange& range : slice_ranges(anatomy))
    for (int s = range.begin; s + 1 < range.end; ++s) has_next[s] = 1;
  const std::vector<Vec3> origins = rest_positions(anatomy.skeleton);
  NearestPartSkin out;
  out.triangles.assign(skin.F.data(), skin.F.data() + skin.F.size());
  out.anchors.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Anchor& anchor = binding.anchors[i];
    const Vec3 X = skin.V.row(i);
    if (anchor.kind != Anchor::Kind::muscle) {
      const int joint = anchor.part < 0 ? 0 : anatomy.bones[anchor.part].joint;
      out.anchors[i][0] = {joint, false, X - origins[joint], Vec3::Zero(), 1};
      continue;
    }
    const std::size_t s = anchor.part;
    double share = 0;
    if (has_next[s]) {
      const Vec3 step = rest.slices[s + 1].center - rest.slices[s].center;
      share = std::clamp(
          step.dot(anchor.point - rest.slices[s].center) / std::max(step.squaredNorm(), 1e-12), 0.0,
          1.0);
      out.anchors[i][1] =
          anchor_on_slice(rest.slices[s + 1], anchor.part + 1, anchor.point, X, share);
    }
    out.anchors[i][0] = anchor_on_slice(rest.slices[s], anchor.part, anchor.point, X, 1 - share);
  }
  return out;
}

void deform_nearest_part(const NearestPartSkin& skin, const PosedAnatomy& posed, SkinFrame& out) {
  out.positions.resize(4 * skin.anchors.size());
  out.normals.resize(4 * skin.anchors.size());
  for (std::size_t i = 0; i < skin.anchors.size(); ++i) {
    Vec3 p = skin.anchors[i][0].weight * carried(skin.anchors[i][0], posed);
    if (skin.anchors[i][1].weight > 0)
      p += skin.anchors[i][1].weight * carried(skin.anchors[i][1], posed);
    for (int k = 0; k < 3; ++k) out.positions[4 * i + k] = float(p[k]);
    out.positions[4 * i + 3] = 1;
  }
  vertex_normals(out.positions, skin.triangles, out.normals);
}

}  // namespace ecorche::inline v1
