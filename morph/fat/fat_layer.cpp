#include "morph/fat/fat_layer.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "morph/fat/body_composition.h"
#include "morph/fat/subcutaneous_bone.h"

namespace ecorche::inline v1 {

namespace {

constexpr double kMillimetre = 1e-3;
// m: a site that faces the other way counts as this much further off
constexpr double kFaceAway = 0.16;

// Value of three builds at a fatness; the ends go on straight.
double between_builds(double lean, double average, double obese, double fatness) {
  const double value =
      fatness < 1 ? lean + (average - lean) * fatness : average + (obese - average) * (fatness - 1);
  return std::max(value, 0.4 * lean);
}

// Frames of sites on head and neck.
bool is_of_head(const std::string& frame) { return frame == "head" || frame == "c5"; }

class SiteFinder {
 public:
  SiteFinder(const Table& table, const Skeleton& skeleton, const SkinRays& rays)
      : table_(table), skeleton_(skeleton), positions_(rest_positions(skeleton)), rays_(rays) {}

  // The site of one row on one side; false when its ray meets nothing.
  bool find(int row, Side side, FatSite& site) const {
    const Joint& frame = skeleton_.joints[joint(row, "frame", side)];
    const Vec3 from = position(row, "from", side), to = position(row, "to", side);
    const Vec3 along = (to - from).normalized();
    const double mirror =
        side == Side::right && find_joint(skeleton_, table_.text(row, "frame")) >= 0 ? -1 : 1;
    const Vec3 direction = (table_.number(row, "flex") * frame.axes.col(0).cross(along) +
                            mirror * table_.number(row, "out") * frame.axes.col(1).cross(along) +
                            table_.number(row, "along") * along)
                               .normalized();
    const Vec3 start = from + table_.number(row, "at") * (to - from);
    const RayHit hit = rays_.first_hit(start, direction);
    if (hit.triangle < 0) return false;
    const TriMesh& skin = rays_.mesh();
    const Vec3 a = skin.V.row(skin.F(hit.triangle, 0)), b = skin.V.row(skin.F(hit.triangle, 1)),
               c = skin.V.row(skin.F(hit.triangle, 2));
    site.name = table_.text(row, "site") + side_suffix(side);
    site.position = start + hit.distance * direction;
    site.normal = (b - a).cross(c - a).normalized();
    return true;
  }

  bool is_paired(int row) const {
    for (const char* column : {"frame", "from", "to"}) {
      if (find_joint(skeleton_, table_.text(row, column)) < 0) return true;
    }
    return table_.number(row, "out") != 0;
  }

 private:
  int joint(int row, const char* column, Side side) const {
    const std::string& name = table_.text(row, column);
    const int index =
        std::max(find_joint(skeleton_, name), find_joint(skeleton_, name + side_suffix(side)));
    if (index < 0)
      throw InputError(
          fmt::format("{}: column '{}': unknown joint '{}'", table_.where(row), column, name));
    return index;
  }
  Vec3 position(int row, const char* column, Side side) const {
    return positions_[joint(row, column, side)];
  }

  const Table& table_;
  const Skeleton& skeleton_;
  const std::vector<Vec3> positions_;
  const SkinRays& rays_;
};

std::vector<Vec3> area_normals(const TriMesh& mesh) {
  std::vector<Vec3> normals(mesh.V.rows(), Vec3::Zero());
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    for (int k = 0; k < 3; ++k) normals[mesh.F(f, k)] += (b - a).cross(c - a);
  }
  for (Vec3& n : normals) n.normalize();
  return normals;
}

// Shepard's weights, 1 / distance^4, so that the mean is flat around each site.
struct SitesMean {
  double thickness = 0, skin = 0;
  double with_body = 0;  // share of sites of trunk and limbs
};
SitesMean mean_of_sites(const std::vector<FatSite>& sites, const Vec3& point, const Vec3& normal) {
  SitesMean mean;
  double weights = 0;
  for (const FatSite& site : sites) {
    const double away = kFaceAway * (1 - normal.dot(site.normal)) / 2;
    const double squared = (point - site.position).squaredNorm() + away * away + 1e-6;
    const double weight = 1 / (squared * squared);
    mean.thickness += weight * site.thickness;
    mean.skin += weight * site.skin;
    mean.with_body += site.of_trunk_or_limb ? weight : 0;
    weights += weight;
  }
  if (weights > 0) mean.thickness /= weights, mean.skin /= weights, mean.with_body /= weights;
  return mean;
}

// Bones over which muscle lies that the layer has to leave room for.
struct CoveredBone {
  const char* prefix;
  double room;  // m in a body of 1.75 m. Smaller: the bone comes through its muscles
  float least;  // share of the table's thickness that is left at least
  int spreads;  // rings of vertices about those above it: rays pass between ribs
};
constexpr std::array kCovered = {CoveredBone{"rib", 0.009, 0.35f, 2},
                                 CoveredBone{"scapula", 0.016, 0.5f, 0}};

// Muscle lies over every rib and over the blades: where they come near to the skin the layer is
// thinner, by no more than to a share of it.
void leave_room_over(const CoveredBone& covered, const SkinRays& rays,
                     const std::vector<Vec3>& normals, const Anatomy& anatomy,
                     std::vector<float>& thickness) {
  constexpr double kFarthest = 0.06;
  std::vector<const TriMesh*> bones;
  for (const Bone& bone : anatomy.bones)
    if (bone.name.starts_with(covered.prefix)) bones.push_back(&bone.mesh);
  if (bones.empty()) return;
  const SkinRays bone_rays(join_meshes(bones), RayBuild::quick);
  const TriMesh& skin = rays.mesh();
  const double size = (skin.V.col(1).maxCoeff() - skin.V.col(1).minCoeff()) / 1.75;
  std::vector<float> most(thickness.size(), 1e3f);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, most.size(), 512), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (!(normals[i].squaredNorm() > 0.5)) continue;
      const RayHit hit = bone_rays.first_hit(skin.V.row(i), -normals[i], kFarthest);
      if (hit.triangle >= 0) most[i] = hit.distance - float(covered.room * size);
    }
  });
  for (int spread = 0; spread < covered.spreads; ++spread) {
    const std::vector<float> before = most;
    for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
      for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j)
          most[skin.F(f, k)] = std::min(most[skin.F(f, k)], before[skin.F(f, j)]);
  }
  for (std::size_t i = 0; i < thickness.size(); ++i)
    thickness[i] = std::max(std::min(thickness[i], most[i]), covered.least * thickness[i]);
}

// m^3 between the skin and a surface below it.
double volume_above(const TriMesh& skin, const std::vector<Vec3>& normals,
                    std::span<const double> depths) {
  TriMesh inner = skin;
  for (std::size_t i = 0; i < depths.size(); ++i)
    inner.V.row(Eigen::Index(i)) -= depths[i] * normals[i].transpose();
  return mesh_volume(skin) - mesh_volume(inner);
}

// The table gives shares, the body's fat their sum: what lies under the skin in all, less what is
// in the breasts, which lie over the layer.
void fit_to_fat(const TriMesh& wall, const Body& body, FatLayer& layer) {
  // Within what the table's thicknesses are uncertain by, and regressions.
  constexpr double kThinnest = 0.85, kThickest = 1.35;
  constexpr double kFatOfBreasts = 0.75;
  constexpr int kRounds = 3;
  const std::vector<Vec3> normals = area_normals(wall);
  std::vector<double> depths(layer.skin.begin(), layer.skin.end());
  const double skin = volume_above(wall, normals, depths);
  const double breasts = std::max(0.0, mesh_volume(body.skin) - mesh_volume(wall));
  const double wanted = subcutaneous_fat(body) - kFatOfBreasts * breasts;
  const auto thickness_at = [&](std::size_t i, double factor) {
    const double fat = double(layer.thickness[i]) - double(layer.skin[i]);
    return double(layer.skin[i]) + fat * (1 + (factor - 1) * double(layer.with_body[i]));
  };
  double factor = 1;
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = thickness_at(i, factor);
    const double now = volume_above(wall, normals, depths) - skin;
    if (!(now > 0)) return;
    factor = std::clamp(factor * wanted / now, kThinnest, kThickest);
  }
  for (std::size_t i = 0; i < layer.thickness.size(); ++i)
    layer.thickness[i] = float(thickness_at(i, factor));
}

}  // namespace

FatTable::FatTable(const std::filesystem::path& tables) : table_(tables / "fat.csv") {}

FatTables::FatTables(const std::filesystem::path& tables)
    : sites(tables), subcutaneous_bone(tables / "bare.csv") {}

double FatTable::thickness(int row, const FatOptions& options) const {
  const char* sex = options.sex == Sex::male ? "male" : "female";
  const auto fat = [&](const char* build) {
    return table_.number(row, fmt::format("fat_{}_{}", sex, build));
  };
  return kMillimetre * between_builds(fat("lean"), fat("average"), fat("obese"), options.fatness);
}

double FatTable::thickness(const std::string& site, const FatOptions& options) const {
  for (int row = 0; row < table_.rows(); ++row)
    if (table_.text(row, "site") == site) return thickness(row, options);
  throw InputError(fmt::format("fat.csv: no site '{}'", site));
}

FatLayer skin_of(const FatLayer& layer) {
  return {layer.skin.empty() ? layer.thickness : layer.skin, layer.sites, layer.skin, {}, {}};
}

FatLayer layer_over_muscles(const FatLayer& layer) {
  return {layer.over_muscles.empty() ? layer.thickness : layer.over_muscles,
          layer.sites,
          layer.skin,
          {}};
}

FatLayer make_fat_layer(const FatTable& fat, const SkinRays& rays, const Skeleton& skeleton,
                        const FatOptions& options) {
  const Table& table = fat.table();
  const SiteFinder finder(table, skeleton, rays);
  const char* sex = options.sex == Sex::male ? "male" : "female";
  FatLayer layer;
  for (int row = 0; row < table.rows(); ++row) {
    const double skin = kMillimetre * table.number(row, fmt::format("skin_{}", sex));
    const std::vector<Side> sides =
        finder.is_paired(row) ? std::vector{Side::left, Side::right} : std::vector{Side::middle};
    for (const Side side : sides) {
      FatSite site;
      site.thickness = fat.thickness(row, options) + skin;
      site.skin = skin;
      site.of_trunk_or_limb = !is_of_head(table.text(row, "frame"));
      if (finder.find(row, side, site)) layer.sites.push_back(site);
    }
  }
  const TriMesh& skin = rays.mesh();
  const std::vector<Vec3> normals = area_normals(skin);
  layer.thickness.resize(normals.size());
  layer.skin.resize(normals.size());
  layer.with_body.resize(normals.size());
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, normals.size(), 512), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const SitesMean mean = mean_of_sites(layer.sites, skin.V.row(i), normals[i]);
          layer.thickness[i] = float(mean.thickness);
          layer.skin[i] = float(mean.skin);
          layer.with_body[i] = float(mean.with_body);
        }
      });
  return layer;
}

FatLayer make_fat_layer(const FatTables& tables, const SkinRays& rays, const Anatomy& anatomy,
                        const Body& body) {
  FatLayer layer = make_fat_layer(tables.sites, rays, anatomy.skeleton,
                                  FatOptions{body.sex, estimate_fatness(body)});
  fit_to_fat(rays.mesh(), body, layer);
  const FatLayer average =
      make_fat_layer(tables.sites, rays, anatomy.skeleton, FatOptions{body.sex, 1});
  std::vector<float> fatter(layer.thickness.size());
  for (std::size_t i = 0; i < fatter.size(); ++i)
    fatter[i] = layer.thickness[i] - average.thickness[i];
  const std::vector<Vec3> normals = area_normals(rays.mesh());
  for (const CoveredBone& covered : kCovered)
    leave_room_over(covered, rays, normals, anatomy, layer.thickness);
  layer.over_muscles = layer.thickness;
  reach_subcutaneous_bone(tables.subcutaneous_bone, rays, anatomy, fatter, layer.thickness);
  return layer;
}

}  // namespace ecorche::inline v1
