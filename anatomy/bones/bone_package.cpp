#include "anatomy/bones/bone_package.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "anatomy/bones/bone_hollows.h"
#include "anatomy/bones/bone_rules.h"
#include "anatomy/bones/bone_surface.h"
#include "anatomy/bones/joint_rules.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/geometry/mirror_mesh.h"
#include "anatomy/mesh_files/stl_io.h"
#include "anatomy/model_files/mjcf_meshes.h"

namespace ecorche::inline v1 {

namespace {

constexpr const char* kPackage = "musclemimic-models";
constexpr const char* kFolder = "musclemimic_models/model/";
constexpr const char* kModel = "body/myofullbody.xml";

Mjcf read_model(const PackageArchive& archive) {
  return read_mjcf([&](const std::string& path) { return archive.read(kFolder + path); }, kModel);
}

// Components of the package's mesh files, read once each.
class Meshes {
 public:
  explicit Meshes(const PackageArchive& archive) : archive_(archive) {}
  const std::vector<TriMesh>& components(const std::string& file) {
    auto [entry, fresh] = read_.try_emplace(file);
    if (fresh) entry->second = connected_components(parse_stl(archive_.read(kFolder + file), file));
    return entry->second;
  }

 private:
  const PackageArchive& archive_;
  std::map<std::string, std::vector<TriMesh>> read_;
};

// From the mesh file's frame to the world. A scale of odd sign turns the mesh inside out, so its
// winding is flipped back.
TriMesh placed(TriMesh mesh, const Vec3& scale, const Transform& X_WG) {
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
    mesh.V.row(i) = world_from_mjcf(X_WG * mesh.V.row(i).transpose().cwiseProduct(scale));
  }
  if (scale.prod() < 0) mesh.F.col(1).swap(mesh.F.col(2));
  return mesh;
}

}  // namespace

Anatomy read_source_skeleton(const Assets& assets) {
  const PackageArchive archive(assets.packages, kPackage);
  const Mjcf mjcf = read_model(archive);
  const Table table(assets.tables / "bones.csv");
  Meshes meshes(archive);
  std::vector<Bone> bones;
  for (int row = 0; row < table.rows(); ++row) {
    const std::string& geom_name = table.text(row, "geom");
    const auto geom = mjcf.geoms.find(geom_name);
    if (geom == mjcf.geoms.end())
      throw InputError(fmt::format("{}: unknown geom '{}'", table.where(row), geom_name));
    const MjcfMesh& mesh = mjcf.meshes.at(geom->second.mesh);
    Bone bone;
    bone.side = table.text(row, "paired") == "yes" ? Side::left : Side::middle;
    bone.name = table.text(row, "name") + side_suffix(bone.side);
    bone.mesh =
        placed(select_bone(meshes.components(mesh.file), table.text(row, "rule"), table.where(row)),
               mesh.scale, geom->second.X_WG);
    bones.push_back(std::move(bone));
  }
  press_hollows(Table(assets.tables / "hollows.csv"), bones);

  Anatomy anatomy;
  anatomy.skeleton = place_joints(Table(assets.tables / "joints.csv"), mjcf, bones);
  tbb::parallel_for(std::size_t{0}, bones.size(),
                    [&](std::size_t row) { bones[row].mesh = closed_bone(bones[row].mesh); });
  for (int row = 0; row < table.rows(); ++row) {
    Bone& bone = bones[row];
    const auto carrier = [&](Side side) {
      const std::string& name = table.text(row, "joint");
      const int paired = find_joint(anatomy.skeleton, name + side_suffix(side));
      const int joint = paired >= 0 ? paired : find_joint(anatomy.skeleton, name);
      if (joint < 0)
        throw InputError(fmt::format("{}: unknown joint '{}'", table.where(row), name));
      return joint;
    };
    bone.joint = carrier(bone.side);
    anatomy.bones.push_back(bone);
    if (bone.side != Side::left) continue;
    anatomy.bones.push_back({mirror_name(bone.name), Side::right, carrier(Side::right),
                             mirror_mesh(bone.mesh, kSourceMidPlane)});
  }
  validate(anatomy);
  return anatomy;
}

std::vector<TendonPath> read_tendon_paths(const Assets& assets, const Anatomy& skeleton) {
  const PackageArchive archive(assets.packages, kPackage);
  const Mjcf mjcf = read_model(archive);
  const Table table(assets.tables / "bones.csv");
  std::map<std::string, std::vector<const Bone*>> carried;  // by MJCF body
  for (int row = 0; row < table.rows(); ++row) {
    const auto geom = mjcf.geoms.find(table.text(row, "geom"));
    if (geom == mjcf.geoms.end()) continue;
    const std::string name =
        table.text(row, "name") + (table.text(row, "paired") == "yes" ? "_l" : "");
    const int bone = find_bone(skeleton, name);
    if (bone >= 0) carried[geom->second.body].push_back(&skeleton.bones[bone]);
  }
  const auto nearest = [&](const std::string& body, const Vec3& point) {
    std::string name;
    double best = std::numeric_limits<double>::infinity();
    for (const Bone* bone : carried[body]) {
      const double distance =
          (bone->mesh.V.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff();
      if (distance < best) {
        best = distance;
        name = bone->name;
      }
    }
    return name;
  };

  std::vector<TendonPath> paths;
  for (const MjcfTendon& tendon : mjcf.tendons) {
    // Arm tendons are declared in the arm's files; the right side mirrors the left one.
    if (tendon.file.starts_with("arm/")) continue;
    TendonPath path;
    path.name = tendon.name.ends_with("_tendon") ? tendon.name.substr(0, tendon.name.size() - 7)
                                                 : tendon.name;
    if (path.name.ends_with("_r") || path.name.find("_r_") != std::string::npos) continue;
    for (const std::string& site : tendon.sites) {
      const auto found = mjcf.sites.find(site);
      if (found == mjcf.sites.end())
        throw InputError(
            fmt::format("{}: tendon '{}': unknown site '{}'", tendon.file, tendon.name, site));
      path.points.push_back(world_from_mjcf(found->second.position));
      path.bones.push_back(nearest(found->second.body, path.points.back()));
    }
    paths.push_back(std::move(path));
  }
  return paths;
}

}  // namespace ecorche::inline v1
