// Tables of the collision of muscles and skin, and the loop over their probes. Private to the room.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomy/posed_anatomy.h"
#include "skinning/muscle_collision/bone_probes.h"
#include "skinning/muscle_collision/outline_probes.h"
#include "skinning/muscle_collision/project_to_skin.h"

namespace ecorche::inline v1 {

struct CollisionTables {
  int sections = 0;
  Eigen::Index vertices = 0;
  std::vector<SectionProbes> probes;  // owners: sections that have some
  std::vector<char> following;        // #owners: the skin carries them and is not lifted over them
  std::vector<SliceRange> strips;
  std::vector<int> strip_begin;  // #strips + 1 into probes
  std::vector<float> thickness;  // #sections, of sheets as they are drawn
  std::vector<char> on_bone;     // #sections, ends that a bone holds
  std::vector<BoneProbe> bones;
  std::size_t joints = 0;
  SkinRings rings;
  std::vector<int> triangles;
};

// act(owner, its projections) for those of the `wanted` owners with a probe that may be out, in
// parallel.
template <class Wanted, class Act>
void for_probes_near_skin(const CollisionTables& data, const PosedSkin& skin,
                          std::span<const Ellipse> slices, const Wanted& wanted, const Act& act) {
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, data.probes.size(), ShallowProbes::kSections),
      [&](const auto& range) {
        for (std::size_t begin = range.begin(); begin < range.end();
             begin += ShallowProbes::kSections) {
          ShallowProbes shallow;
          for (std::size_t o = begin; o < std::min(begin + ShallowProbes::kSections, range.end());
               ++o) {
            if (!wanted(o)) continue;
            const std::size_t section = data.probes[o].section;
            shallow.add(int(o), data.probes[o], slices[section], data.thickness[section], skin);
          }
          for (std::span<const ProbeProjection> left = shallow.project(data.rings, skin);
               !left.empty();) {
            const int owner = left.front().owner;
            std::size_t count = 1;
            while (count < left.size() && left[count].owner == owner) ++count;
            act(std::size_t(owner), left.first(count));
            left = left.subspan(count);
          }
        }
      });
}

}  // namespace ecorche::inline v1
