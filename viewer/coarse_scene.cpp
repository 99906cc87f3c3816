#include "viewer/coarse_scene.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "anatomy/muscles/thinned_fascia.h"
#include "anatomy/posing/pose_anatomy.h"
#include "viewer/coarse_mesh.h"

namespace ecorche {
namespace {

// Added to the keys of the fine model's meshes, which are fewer.
constexpr std::uint64_t kCoarseKeys = std::uint64_t{1} << 24;
constexpr std::uint32_t kGone = std::numeric_limits<std::uint32_t>::max();

// What is left of a mesh: its vertices, rising, and triangles between them.
struct Thinned {
  std::vector<std::uint32_t> from;
  std::vector<Triangle32> triangles;
  std::vector<PartFaces> faces;
};

Thinned thin(std::span<const Vec3f> positions, std::span<const Vec3f> normals,
             std::span<const Triangle32> triangles, std::span<const PartFaces> parts, float reach) {
  Thinned out;
  const std::vector<std::uint32_t> standing = standing_for(positions, normals, triangles, reach);
  for (const PartFaces& part : parts) {
    const std::size_t begin = out.triangles.size();
    const std::vector<Triangle32> own =
        coarse_triangles(triangles.subspan(part.begin, part.end - part.begin), standing);
    out.triangles.insert(out.triangles.end(), own.begin(), own.end());
    out.faces.push_back({part.part, begin, out.triangles.size()});
  }
  std::vector<std::uint32_t> place(positions.size(), kGone);
  for (const Triangle32& t : out.triangles)
    for (int k = 0; k < 3; ++k) place[t[k]] = 0;
  for (std::uint32_t v = 0; v < place.size(); ++v) {
    if (place[v] == kGone) continue;
    place[v] = std::uint32_t(out.from.size());
    out.from.push_back(v);
  }
  for (Triangle32& t : out.triangles) t = Triangle32(place[t[0]], place[t[1]], place[t[2]]);
  return out;
}

Thinned thin(const DrawMesh& mesh, float reach) {
  const PartFaces all{0, 0, mesh.triangles.size()};
  return thin(mesh.positions, mesh.normals, mesh.triangles, {&all, 1}, reach);
}

template <class T>
std::vector<T> taken(const std::vector<T>& all, std::span<const std::uint32_t> from) {
  std::vector<T> out;
  if (all.empty()) return out;
  for (const std::uint32_t v : from) out.push_back(all[v]);
  return out;
}

// Without fibres, which quick pictures do not have.
DrawMesh taken(const DrawMesh& mesh, Thinned& thinned) {
  DrawMesh out;
  out.key = mesh.key + kCoarseKeys;
  out.positions = taken(mesh.positions, thinned.from);
  out.normals = taken(mesh.normals, thinned.from);
  out.colors = taken(mesh.colors, thinned.from);
  out.occlusion = taken(mesh.occlusion, thinned.from);
  out.dissolve = taken(mesh.dissolve, thinned.from);
  out.parts = taken(mesh.parts, thinned.from);
  out.triangles = std::move(thinned.triangles);
  return out;
}

std::vector<Vec3f> values_of(const PointsF& points) {
  std::vector<Vec3f> out(std::size_t(points.rows()));
  for (Eigen::Index i = 0; i < points.rows(); ++i) out[std::size_t(i)] = points.row(i).transpose();
  return out;
}

// The surface over the vertices that are left.
MuscleSurface taken(const MuscleSurface& surface, const Thinned& thinned) {
  MuscleSurface out;
  out.term_begin.push_back(0);
  for (const std::uint32_t v : thinned.from) {
    out.terms.insert(out.terms.end(), surface.terms.begin() + surface.term_begin[v],
                     surface.terms.begin() + surface.term_begin[v + 1]);
    out.term_begin.push_back(int(out.terms.size()));
  }
  out.muscle = taken(surface.muscle, thinned.from);
  out.slice = taken(surface.slice, thinned.from);
  out.angle = taken(surface.angle, thinned.from);
  out.belly = taken(surface.belly, thinned.from);
  out.along = taken(surface.along, thinned.from);
  const auto begin_of = [&](int vertex) {
    return int(std::ranges::lower_bound(thinned.from, std::uint32_t(vertex)) -
               thinned.from.begin());
  };
  for (std::size_t p = 0; p < surface.parts.size(); ++p) {
    MuscleSurface::Part part = surface.parts[p];
    part.vertex_begin = begin_of(part.vertex_begin);
    part.vertex_end = begin_of(part.vertex_end);
    part.face_begin = int(thinned.faces[p].begin);
    part.face_end = int(thinned.faces[p].end);
    out.parts.push_back(part);
  }
  out.F.resize(Eigen::Index(thinned.triangles.size()), 3);
  for (std::size_t f = 0; f < thinned.triangles.size(); ++f)
    out.F.row(Eigen::Index(f)) = thinned.triangles[f].cast<int>().transpose();
  return out;
}

void add_bone(const DrawMesh& bone, std::uint32_t part, int joint, SceneModel& model) {
  DrawMesh& all = model.bones[0];
  const std::uint32_t first = std::uint32_t(all.positions.size());
  const std::size_t begin = all.triangles.size();
  all.positions.insert(all.positions.end(), bone.positions.begin(), bone.positions.end());
  all.normals.insert(all.normals.end(), bone.normals.begin(), bone.normals.end());
  all.parts.resize(all.positions.size(), part);
  for (const Triangle32& t : bone.triangles) all.triangles.emplace_back(t.array() + first);
  model.together_joints.resize(all.positions.size(), joint);
  model.bone_faces.push_back({part, begin, all.triangles.size()});
}

}  // namespace

std::shared_ptr<const SceneModel> make_coarse(const Anatomy& anatomy, const SceneModel& fine,
                                              double reach) {
  auto out = std::make_shared<SceneModel>();
  out->number = fresh_scene_key();
  out->eye_joints = fine.eye_joints;
  out->joint_rest = fine.joint_rest;
  out->strips = fine.strips;
  out->rest_lengths = fine.rest_lengths;
  out->muscle_count = fine.muscle_count;
  const float sides = float(reach);
  Thinned skin = thin(fine.skin, sides);
  out->skin_from = skin.from;
  out->skin = taken(fine.skin, skin);
  if (!fine.bones.empty()) {
    out->bones.emplace_back().key = fine.bones[0].key + kCoarseKeys;
    for (std::size_t b = 0; b < fine.bones.size(); ++b) {
      Thinned bone = thin(fine.bones[b], sides);
      add_bone(taken(fine.bones[b], bone), kFirstBonePart + std::uint32_t(b), fine.bone_joints[b],
               *out);
    }
  }
  for (const DrawMesh& eye : fine.eyes) {
    Thinned thinned = thin(eye, sides);
    out->eyes.push_back(taken(eye, thinned));
  }
  PosedAnatomy rest;
  forward_kinematics(anatomy.skeleton, rest_pose(anatomy.skeleton), rest.X_WJ);
  rest.slices = rest_slices(anatomy);
  PointsF positions, normals;
  out->muscles.key = fine.muscles.key + kCoarseKeys;
  if (fine.muscle_count > 0) {
    update_muscle_surface(fine.surface, rest, positions, &normals);
    Thinned left = thin(values_of(positions), values_of(normals), fine.muscles.triangles,
                        fine.muscle_faces, sides);
    out->surface = taken(fine.surface, left);
    out->muscle_faces = left.faces;
    out->muscles = taken(fine.muscles, left);
  }
  out->fascia.key = fine.fascia.key + kCoarseKeys;
  set_fascia(thinned_fascia(fine.fascia_surface, reach), *out);
  return out;
}

}  // namespace ecorche
