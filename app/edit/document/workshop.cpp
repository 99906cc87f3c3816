#include "app/edit/document/workshop.h"

#include <fmt/format.h>

#include <algorithm>

#include "anatomy/bones/bone_package.h"
#include "anatomy/bones/bone_surface.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/similar_names.h"
#include "morph/placement/bone_groups.h"
#include "morph/template/build_template.h"
#include "morph/template/template_cache.h"
#include "skinning/motion/pose_book.h"

namespace ecorche {
namespace {

template <class Part>
std::vector<std::string> names_without_side(const std::vector<Part>& parts) {
  std::vector<std::string> out;
  for (const Part& part : parts) {
    std::string name = split_side(part.name).first;
    if (std::ranges::find(out, name) == out.end()) out.push_back(std::move(name));
  }
  return out;
}

}  // namespace

const Document& Workshop::built_in() {
  if (!built_in_) built_in_ = std::make_unique<Document>(built_in_document(assets_.tables));
  return *built_in_;
}

const Anatomy& Workshop::source() {
  if (!source_) source_ = std::make_unique<Anatomy>(read_source_skeleton(assets_));
  return *source_;
}

const Template& Workshop::base() {
  if (!base_) base_ = std::make_unique<Template>(read_template(assets_));
  return *base_;
}

const BodyPackage& Workshop::package() {
  if (!package_) package_ = std::make_unique<BodyPackage>(read_body_package(assets_));
  return *package_;
}

const SkeletonWarp& Workshop::warp() {
  if (!warp_) {
    const FitRules& rules = base().tables.rules;
    warp_ = std::make_unique<SkeletonWarp>(source(), rules, place_source(assets_, source(), rules));
  }
  return *warp_;
}

const MuscleGroups& Workshop::groups() {
  if (!groups_) groups_ = std::make_unique<MuscleGroups>(read_muscle_groups(assets_.tables));
  return *groups_;
}

const std::vector<std::string>& Workshop::fat_sites() {
  if (fat_sites_.empty()) {
    const Table table(assets_.tables / "fat.csv");
    for (int row = 0; row < table.rows(); ++row) fat_sites_.push_back(table.text(row, "site"));
  }
  return fat_sites_;
}

std::vector<std::string> Workshop::bone_names() { return names_without_side(source().bones); }

std::vector<std::string> Workshop::joint_names() {
  return names_without_side(source().skeleton.joints);
}

std::vector<std::string> Workshop::pose_names() {
  std::vector<std::string> out;
  for (const NamedPose& pose :
       read_pose_book(assets_.tables / "poses" / "poses.csv", source().skeleton))
    out.push_back(pose.name);
  return out;
}

std::optional<TriMesh> Workshop::source_mesh(const Bone& of_body) {
  const std::vector<Bone>& bones = source().bones;
  const auto same = std::ranges::find(bones, of_body.name, &Bone::name);
  if (same == bones.end()) return std::nullopt;
  const Eigen::Index wanted = of_body.mesh.V.rows();
  TriMesh out = same->mesh.V.rows() == wanted ? same->mesh : rounded_bone(same->mesh);
  if (out.V.rows() != wanted) return std::nullopt;
  return out;
}

Vec3 Workshop::on_bone(const std::string& bone, const Vec3& place) {
  auto found = surfaces_.find(bone);
  if (found == surfaces_.end()) {
    const std::vector<Bone>& bones = source().bones;
    const auto named = std::ranges::find_if(bones, [&](const Bone& each) {
      return each.side != Side::right && split_side(each.name).first == bone;
    });
    if (named == bones.end())
      throw InputError(fmt::format("'{}': no bone has that name{}; `ecorche list bones` names them",
                                   bone, did_you_mean(bone, bone_names())));
    found = surfaces_.emplace(bone, std::make_unique<NearestSurface>(named->mesh)).first;
  }
  return found->second->nearest(place).point;
}

}  // namespace ecorche
