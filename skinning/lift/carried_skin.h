// The skin of a patient in a pose: linear blend of its joints, over a shape that may change with
// the pose.
#pragma once

#include <functional>
#include <vector>

#include "skinning/lift/patient.h"

namespace ecorche::inline v1 {

// Puts every vertex of the skin as a better deformer has it in a pose, world, #V x 3.
using SkinShaper = std::function<void(const Pose&, Points&)>;

// out: #V x 3, resized once. `shape`: offsets of the vertices at rest, #V x 3, or empty.
void carried_skin(const Patient& patient, const Pose& pose, const Points& shape, Points& out);
void carried_skin(const Patient& patient, const std::vector<Transform>& X_WJ, const Points& shape,
                  Points& out);

// Offsets at rest by which carried_skin() gives the skin `shaped` in this pose.
void fit_shape(const Patient& patient, const std::vector<Transform>& X_WJ, const Points& shaped,
               Points& shape);

}  // namespace ecorche::inline v1
