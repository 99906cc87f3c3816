// Subcutaneous bone: where no muscle lies between bone and skin (shin, elbow, ...), the layer of
// skin and fat reaches down to the bone.
//
// data/bare.csv names the bones, near which joint, how deep under the skin, and how nearly parallel
// to it.
#pragma once

#include <span>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

// `fatter`: #vertices, m, by how much the layer is thicker than an average build's, or empty: so
// much deeper under the skin bone still counts as bare.
// Increases `thickness` (m, one a vertex of the skin of `rays`) down to the subcutaneous faces of
// the bones of `anatomy`; decreases it nowhere. Bones and joints that the anatomy lacks are left
// out. `table`: data/bare.csv. Throws InputError for a malformed one.
void reach_subcutaneous_bone(const Table& table, const SkinRays& rays, const Anatomy& anatomy,
                             std::span<const float> fatter, std::vector<float>& thickness);

}  // namespace ecorche::inline v1
