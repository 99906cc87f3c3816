// Changes of the normals that the shapes carry. Private to the room.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "skinning/bake/bake_samples.h"

namespace ecorche::inline v1 {

// The shapes' changes of the rest normals: those that, with the `curves` that the samples have,
// bring the posed normals closest to the exact ones. `curves`: #shapes x #samples. Each #V x 3
std::vector<Points> fit_normals(const BakeScene& scene, Influences influences,
                                const std::vector<BakeFrame>& samples,
                                const Eigen::MatrixXd& curves);

// The angle between a normal as an engine has it and the exact one, degrees.
double angle_off(const std::array<Influence, 4>& influences, std::span<const Transform> bones,
                 const Vec3& shaped, const Vec3& exact);

}  // namespace ecorche::inline v1
