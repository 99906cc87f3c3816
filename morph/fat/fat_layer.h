// The layer of fat and skin between the muscles and the surface, by site of the body.
//
// data/fat.csv gives thicknesses at some fifty named sites for three builds of each sex. The sites
// are found on a skin with the help of the joints inside it, and every skin vertex takes a smooth
// mean of the sites that are near and face the same way.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/files/assets.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {

struct FatOptions {
  Sex sex = Sex::male;
  // 0 lean (athletic), 1 average, 2 obese: the builds of the table; in between and beyond by
  // straight lines, never less than 0.4 of lean.
  double fatness = 1;
};

// data/fat.csv: thicknesses of fat by site, sex and fatness, without the skin.
class FatTable {
 public:
  // `tables`: Assets::tables. Throws InputError when the file cannot be read.
  explicit FatTable(const std::filesystem::path& tables);
  // m. Throws InputError for a site that the table does not have.
  double thickness(const std::string& site, const FatOptions& options) const;
  double thickness(int row, const FatOptions& options) const;
  const Table& table() const { return table_; }

 private:
  Table table_;
};

// What a fat layer is made by: data/fat.csv and data/bare.csv.
struct FatTables {
  FatTable sites;
  Table subcutaneous_bone;

  // Throws InputError when one of the files cannot be read.
  explicit FatTables(const std::filesystem::path& tables);
};

struct FatSite {
  std::string name;              // "triceps_l"
  Vec3 position = Vec3::Zero();  // on the skin
  Vec3 normal = Vec3::UnitY();   // outwards
  double thickness = 0;          // fat and skin, m
  double skin = 0;               // of it, m
  bool of_trunk_or_limb = true;  // its fat goes with all of the body's: not on head and neck
};

struct FatLayer {
  std::vector<float> thickness;  // fat and skin, m; one a vertex of the skin it was made for
  std::vector<FatSite> sites;
  std::vector<float> skin;  // of it the skin alone, m; empty: not known
  // m: without what reaches further down to subcutaneous bone; empty: nothing does
  std::vector<float> over_muscles;
  std::vector<float> with_body;  // 0 on head and neck .. 1: goes with all of the body's fat

  // At a ray's end.
  float at(const Triangles& F, const RayHit& hit) const { return value_at(F, hit, thickness); }
};

// The skin without its fat, under which muscles that move it lie (Muscle::layer "subcutaneous").
FatLayer skin_of(const FatLayer& layer);
// The layer under which all others lie, tendons over subcutaneous bone among them.
FatLayer layer_over_muscles(const FatLayer& layer);

// `rays` are of the skin; `skeleton` lies inside it at rest. Sites whose ray meets nothing are left
// out. Throws InputError when the table names a joint that the skeleton lacks.
FatLayer make_fat_layer(const FatTable& fat, const SkinRays& rays, const Skeleton& skeleton,
                        const FatOptions& options);
// The same with the body's sex and estimated fatness (body_composition.h), all of it thicker or
// thinner by what fat the body has; over subcutaneous bone of `anatomy` the layer
// reaches down to the bone (subcutaneous_bone.h).
FatLayer make_fat_layer(const FatTables& tables, const SkinRays& rays, const Anatomy& anatomy,
                        const Body& body);

}  // namespace ecorche::inline v1
