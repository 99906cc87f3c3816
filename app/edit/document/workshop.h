// What edits look at and never change: tables, bones, poses, the built-in template. Each is read
// when it is first asked for.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anatomy/anatomy.h"
#include "anatomy/authoring/muscle_groups.h"
#include "anatomy/base_mesh/body_package.h"
#include "anatomy/files/assets.h"
#include "anatomy/queries/nearest_surface.h"
#include "app/edit/document/document.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/template/template.h"

namespace ecorche {

// Of one thread.
class Workshop {
 public:
  explicit Workshop(Assets assets) : assets_(std::move(assets)) {}
  // `built_in`: of another workshop of the same assets, whose documents are worked on here
  Workshop(Assets assets, const Document& built_in)
      : assets_(std::move(assets)), built_in_(std::make_unique<Document>(built_in)) {}

  const Assets& assets() const { return assets_; }
  const Document& built_in();
  const Anatomy& source();  // read_source_skeleton
  const Template& base();   // read_template
  const BodyPackage& package();
  // What carries the source skeleton into the template's body, as build_template does it.
  const SkeletonWarp& warp();
  // Names of the source skeleton's bones and joints, without sides.
  std::vector<std::string> bone_names();
  std::vector<std::string> joint_names();
  std::vector<std::string> pose_names();
  const std::vector<std::string>& fat_sites();  // of data/fat.csv, without sides
  const MuscleGroups& groups();                 // by nerve and function
  // The nearest point of a bone's surface, left side or middle, source frame. Throws InputError for
  // another name.
  Vec3 on_bone(const std::string& bone, const Vec3& place);
  // The source skeleton's mesh of a bone, with the vertices that a body's bone of that name has:
  // coarse ones are rounded once they are placed. None for a bone of one's own.
  std::optional<TriMesh> source_mesh(const Bone& of_body);

 private:
  Assets assets_;
  std::unique_ptr<Document> built_in_;
  std::unique_ptr<Anatomy> source_;
  std::unique_ptr<Template> base_;
  std::unique_ptr<BodyPackage> package_;
  std::unique_ptr<SkeletonWarp> warp_;
  std::unique_ptr<MuscleGroups> groups_;
  std::vector<std::string> fat_sites_;
  std::map<std::string, std::unique_ptr<NearestSurface>> surfaces_;
};

}  // namespace ecorche
