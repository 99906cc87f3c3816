#include "morph/fat/scale_fat.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kReach = 0.075;  // m: at this distance a site counts by a third

// Its factor, by its name with or without side; null: it has none.
const double* factor_of(const SiteFactors& sites, const std::string& name) {
  auto found = sites.find(name);
  if (found == sites.end() && (name.ends_with("_l") || name.ends_with("_r")))
    found = sites.find(name.substr(0, name.size() - 2));
  return found == sites.end() ? nullptr : &found->second;
}

// Factor at a point of the skin; 1 far from all sites.
double factor_at(const FatLayer& layer, const SiteFactors& sites, const Vec3& point,
                 const Vec3& normal) {
  double weights = 0, sum = 0;
  for (const FatSite& site : layer.sites) {
    const double* factor = factor_of(sites, site.name);
    if (!factor) continue;
    const double facing = std::max(0.0, normal.dot(site.normal));
    const double far = (point - site.position).norm() / kReach;
    const double weight = facing * std::exp(-far * far);
    weights += weight;
    sum += weight * (*factor - 1);
  }
  return 1 + sum / std::max(weights, 1.0);
}

}  // namespace

void scale_fat(double all, const SiteFactors& sites, const TriMesh& skin, FatLayer& layer) {
  std::vector<float> factors(layer.thickness.size(), float(all));
  if (!sites.empty()) {
    const Points normals = vertex_normals(skin);
    for (std::size_t i = 0; i < factors.size(); ++i)
      factors[i] *=
          float(factor_at(layer, sites, skin.V.row(Eigen::Index(i)), normals.row(Eigen::Index(i))));
  }
  for (std::vector<float>* each : {&layer.thickness, &layer.over_muscles})
    for (std::size_t i = 0; i < each->size(); ++i) {
      const float skin_alone = i < layer.skin.size() ? layer.skin[i] : 0;
      (*each)[i] = skin_alone + factors[i] * std::max(0.0f, (*each)[i] - skin_alone);
    }
}

}  // namespace ecorche::inline v1
