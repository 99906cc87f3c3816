// Triangles of a posed skin in contact folds, where it lies against itself, found by geometry
// alone.
#pragma once

#include <span>
#include <vector>

#include "anatomy/types.h"

namespace ecorche::inline v1 {

// A triangle lies in a contact fold if other skin lies against it: a triangle
// - that comes within 5 mm of its middle,
// - whose middle was at least 20 mm away from its own at rest, so that it is another part of the
// skin,
// - that it faces: the mean normal of the triangles about it (it alone may be flipped) and that
// triangle's are more than a right angle apart,
// - and whose front it lies before, or behind by 1 mm at most: sides of a limb that has collapsed
// lie behind each other. 1 or 0 for each of `triangles`. `V`: the posed skin, as many vertices as
// at rest.
std::vector<char> in_contact_folds(const TriMesh& rest, const Points& V,
                                   std::span<const int> triangles);

}  // namespace ecorche::inline v1
