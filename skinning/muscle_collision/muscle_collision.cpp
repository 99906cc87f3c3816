#include "skinning/muscle_collision/muscle_collision.h"

#include <algorithm>

#include "anatomy/muscles/muscle_surface.h"
#include "skinning/muscle_collision/collision_tables.h"

namespace ecorche::inline v1 {

MuscleCollision make_muscle_collision(const Anatomy& anatomy, const PosedAnatomy& rest,
                                      const TriMesh& skin, const MuscleCollision& before) {
  auto data = std::make_shared<CollisionTables>();
  data->sections = rest.slices.size();
  data->vertices = skin.V.rows();
  data->strips = slice_ranges(anatomy);
  data->rings = make_skin_rings(skin);
  data->triangles.assign(skin.F.data(), skin.F.data() + skin.F.size());
  const MuscleSurface surface = make_muscle_surface(anatomy, {kOutlinePoints, true});
  data->thickness.assign(rest.slices.size(), 1);
  data->on_bone.assign(rest.slices.size(), 0);
  for (const SliceRange& range : data->strips) {
    const Muscle& muscle = anatomy.muscles[range.muscle];
    const auto [origin, insertion] = end_joints(muscle, muscle.strips[range.strip]);
    data->on_bone[range.begin] = origin >= 0;
    data->on_bone[range.end - 1] = insertion >= 0;
    const MuscleSurface::Part& part = surface.parts[range.muscle];
    if (part.sheet)
      std::fill(data->thickness.begin() + range.begin, data->thickness.begin() + range.end,
                part.thickness);
  }
  data->bones = !before.empty() && before.data->triangles == data->triangles
                    ? before.data->bones
                    : place_bone_probes(anatomy, skin, data->rings);
  data->joints = anatomy.skeleton.joints.size();
  data->probes = place_probes(rest.slices, data->thickness, skin, data->rings);
  for (const SliceRange& range : data->strips) {
    const auto first =
        std::find_if(data->probes.begin(), data->probes.end(),
                     [&](const SectionProbes& p) { return p.section >= range.begin; });
    data->strip_begin.push_back(int(first - data->probes.begin()));
  }
  data->strip_begin.push_back(int(data->probes.size()));
  data->following.assign(data->probes.size(), 0);
  for (std::size_t s = 0; s < data->strips.size(); ++s)
    if (lies_in_fat(anatomy.muscles[data->strips[s].muscle]))
      std::fill(data->following.begin() + data->strip_begin[s],
                data->following.begin() + data->strip_begin[s + 1], 1);
  return {data};
}

}  // namespace ecorche::inline v1
