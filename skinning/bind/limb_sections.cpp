#include "skinning/bind/limb_sections.h"

#include <set>

namespace ecorche::inline v1 {

std::vector<LimbSection> limb_sections(const Skeleton& skeleton, const TriMesh& skin,
                                       std::span<const JointWeights> joint_weights) {
  const std::vector<Vec3> origins = rest_positions(skeleton);
  std::vector<LimbSection> out;
  for (const auto& [upper, middle, lower] :
       {std::array{"shoulder", "elbow", "wrist"}, std::array{"hip", "knee", "ankle"}})
    for (const std::string side : {"_l", "_r"}) {
      const int u = find_joint(skeleton, upper + side), m = find_joint(skeleton, middle + side),
                l = find_joint(skeleton, lower + side);
      if (u < 0 || m < 0 || l < 0) continue;
      std::set<int> limb{u, m};  // the upper joint and everything below it
      for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
        if (limb.count(skeleton.joints[j].parent) > 0) limb.insert(int(j));
      const auto at = [&](int j) { return origins[j]; };
      LimbSection section{middle + side, {}, {}};
      for (Eigen::Index f = 0; f < skin.F.rows(); ++f) {
        double weight = 0;
        for (int k = 0; k < 3; ++k)
          for (const Influence& w : joint_weights[skin.F(f, k)])
            if (limb.count(w.joint) > 0) weight += w.weight / 3;
        const Vec3 p =
            (skin.V.row(skin.F(f, 0)) + skin.V.row(skin.F(f, 1)) + skin.V.row(skin.F(f, 2))) / 3;
        const bool below = (p - 0.5 * (at(u) + at(m))).dot(at(m) - at(u)) > 0;
        const bool above = (p - 0.5 * (at(m) + at(l))).dot(at(l) - at(m)) < 0;
        if (weight > 0.5 && below && above) section.triangles.push_back(int(f));
      }
      section.rims = open_rims(section.triangles, skin.F);
      out.push_back(std::move(section));
    }
  return out;
}

double section_volume(const LimbSection& section, const Triangles& F, const Points& V) {
  double six = 0;
  for (int f : section.triangles)
    six += Vec3(V.row(F(f, 0))).dot(Vec3(V.row(F(f, 1))).cross(Vec3(V.row(F(f, 2)))));
  for (const MeshRim& rim : section.rims) {
    Vec3 center = Vec3::Zero();
    for (const std::array<int, 2>& edge : rim) center += V.row(edge[0]);
    center /= double(rim.size());
    for (const std::array<int, 2>& edge : rim)
      six += center.dot(Vec3(V.row(edge[0])).cross(Vec3(V.row(edge[1]))));
  }
  return six / 6;
}

}  // namespace ecorche::inline v1
