#include "skinning/files/light_character.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "anatomy/bones/cartilage.h"
#include "anatomy/geometry/simplify.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/fascia_surface.h"
#include "skinning/files/character_nodes.h"
#include "skinning/files/layer_mesh.h"
#include "skinning/files/morph_targets.h"
#include "skinning/files/slice_influences.h"
#include "skinning/files/tissue_meshes.h"
#include "skinning/morphs/join_shapes.h"

namespace ecorche::inline v1 {
namespace {

using gltf::GlbBuilder;
using tinygltf::Value;

// Parts joined into one mesh.
struct Joined {
  std::vector<Vec3> V, normals;
  std::vector<int> F;
  std::vector<char> second;  // #F, of the second of two tissues
  std::vector<std::array<Influence, 4>> shares;
  std::vector<float> part;
  std::vector<gltf::Tint> first_tints, second_tints;
  gltf::Array names;
  std::vector<MeshShapes> shapes;  // a part, where a motion is shown

  void add(const TriMesh& mesh, const Points& mesh_normals) {
    const int begin = V.size();
    for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) {
      V.emplace_back(mesh.V.row(i));
      normals.emplace_back(mesh_normals.row(i));
      part.push_back(float(names.size()));
    }
    for (const int corner : mesh.F.reshaped<Eigen::RowMajor>()) F.push_back(begin + corner);
  }
  // Of two tissues that fade into each other.
  void add(const TriMesh& mesh, const Points& mesh_normals, const gltf::MuscleTints& tints) {
    add(mesh, mesh_normals);
    second.insert(second.end(), tints.tendon.begin(), tints.tendon.end());
    first_tints.insert(first_tints.end(), tints.belly.begin(), tints.belly.end());
    second_tints.insert(second_tints.end(), tints.fading.begin(), tints.fading.end());
  }
  Points all_normals() const {
    return Eigen::Map<const Points>(normals.data()->data(), Eigen::Index(normals.size()), 3);
  }
  TriMesh mesh() const {
    return {Eigen::Map<const Points>(V.data()->data(), Eigen::Index(V.size()), 3),
            Eigen::Map<const Triangles>(F.data(), Eigen::Index(F.size() / 3), 3)};
  }
};

// How many triangles each part may keep: the same share of all, but few are not made fewer. Falls
// short of `most` rather than over.
std::vector<int> budgets(const std::vector<int>& sizes, int most, int least) {
  double low = 0, high = 1;
  const auto budget = [&](int size, double share) {
    return std::min(size, std::max(least, int(share * size)));
  };
  const auto total = [&](double share) {
    long long sum = 0;
    for (const int size : sizes) sum += budget(size, share);
    return sum;
  };
  for (int round = 0; round < 40; ++round) {
    const double middle = 0.5 * (low + high);
    (total(middle) <= most ? low : high) = middle;
  }
  std::vector<int> out;
  for (const int size : sizes) out.push_back(budget(size, total(1) <= most ? 1 : low));
  return out;
}

// Rows of the whole mesh's normals, for the light one to be shaded like it.
Points shading(const TriMesh& whole, const std::vector<int>& nearest) {
  const Points normals = GlbBuilder::unit_normals(whole);
  Points out(nearest.size(), 3);
  for (std::size_t i = 0; i < nearest.size(); ++i) out.row(i) = normals.row(nearest[i]);
  return out;
}

// A mesh node of the joined parts, skinned. Returns its index.
int add_joined(GlbBuilder& glb, const std::string& name, const Joined& joined,
               const TissueLook& first, const TissueLook& second, float brighter) {
  const int one = glb.material(first, brighter), other = glb.material(second);
  auto primitives =
      gltf::two_tissues(glb, joined.mesh(), joined.all_normals(), joined.second, one, other);
  tinygltf::Primitive& front = primitives.front();
  glb.add_influences(front, joined.shares);
  front.attributes["_PART"] = glb.add_scalars(joined.part, false, TINYGLTF_TARGET_ARRAY_BUFFER);
  for (tinygltf::Primitive& primitive : primitives) {
    primitive.attributes = front.attributes;
    if (!joined.first_tints.empty())
      primitive.attributes["COLOR_0"] =
          glb.add_tints(primitive.material == one ? joined.first_tints : joined.second_tints);
  }
  tinygltf::Node node;
  node.name = name;
  node.mesh = glb.add_mesh(name, std::move(primitives));
  node.skin = 0;
  node.extras = Value(gltf::Object{{"parts", Value(joined.names)}});
  return glb.add_node(std::move(node));
}

Points face_centers(const TriMesh& mesh) {
  Points out(mesh.F.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    out.row(f) =
        (mesh.V.row(mesh.F(f, 0)) + mesh.V.row(mesh.F(f, 1)) + mesh.V.row(mesh.F(f, 2))) / 3;
  return out;
}

void add_bones_light_character(GlbBuilder& glb, const Anatomy& anatomy,
                               const std::vector<CartilageRule>& rules, const LightDetail& detail) {
  std::vector<int> sizes;
  for (const Bone& bone : anatomy.bones) sizes.push_back(int(bone.mesh.F.rows()));
  const std::vector<int> most = budgets(sizes, detail.bones, detail.least);
  Joined joined;
  for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
    const Bone& bone = anatomy.bones[b];
    const TriMesh light = simplify(bone.mesh, most[b]);
    joined.add(light, shading(bone.mesh, nearest_rows(light.V, bone.mesh.V)));
    const std::vector<char> cartilage = cartilage_faces(rules, bone);
    if (std::count(cartilage.begin(), cartilage.end(), 1) > 0)
      for (const int f : nearest_rows(face_centers(light), face_centers(bone.mesh)))
        joined.second.push_back(cartilage[std::size_t(f)]);
    joined.second.resize(joined.F.size() / 3, 0);
    joined.shares.resize(joined.V.size(), {Influence{bone.joint, 1}});
    joined.names.push_back(gltf::text(bone.name));
  }
  if (!joined.V.empty()) add_joined(glb, "bones", joined, kBoneLook, kCartilageLook, 1);
}

// Meshes of muscles where these have shapes: few, so that they are drawn quickly, and each of
// muscles that move by the same joints, so that few shapes do.
std::string region_of(const std::string& group, Side side) {
  static const std::map<std::string, std::string, std::less<>> kRegions{
      {"trunk_shoulder", "shoulder"},
      {"shoulder", "shoulder"},
      {"arm", "arm"},
      {"forearm", "arm"},
      {"hand", "hand"},
      {"hip", "thigh"},
      {"thigh", "thigh"},
      {"leg", "leg"},
      {"foot", "leg"},
      {"trunk_back", "back"},
      {"trunk_thorax", "thorax"},
      {"trunk_abdomen", "abdomen"}};
  static const std::set<std::string, std::less<>> kUnpaired{"back", "thorax", "abdomen", "neck"};
  const auto found = kRegions.find(group);
  const std::string region = found == kRegions.end() ? "neck" : found->second;
  if (side == Side::middle || kUnpaired.contains(region)) return "muscles/" + region;
  return "muscles/" + region + (side == Side::left ? "_l" : "_r");
}

gltf::MorphedNodes add_muscles_light_character(GlbBuilder& glb, const Anatomy& anatomy,
                                               const LightDetail& detail,
                                               const ClipShapes* shapes) {
  const auto influences = slice_influences(anatomy);
  const auto [surface, positions] = gltf::lofted_muscles(anatomy);
  const FasciaSurface fascia = make_fascia_surface(anatomy);
  const auto fascia_shares = fascia_influences(fascia, influences);
  std::vector<int> sizes;
  for (const MuscleSurface::Part& part : surface.parts)
    sizes.push_back(part.face_end - part.face_begin);
  for (const FasciaSurface::Part& part : fascia.parts)
    sizes.push_back(part.face_end - part.face_begin);
  const std::vector<int> most = budgets(sizes, detail.muscles, detail.least);
  std::map<std::string, Joined> meshes;
  for (std::size_t p = 0; p < surface.parts.size(); ++p) {
    const MuscleSurface::Part& part = surface.parts[p];
    const Muscle& muscle = anatomy.muscles[part.muscle];
    Joined& joined = meshes[shapes ? region_of(muscle.group, muscle.side) : "muscles"];
    const TriMesh whole = part_mesh(surface, part, positions), light = simplify(whole, most[p]);
    const std::vector<int> nearest = nearest_rows(light.V, whole.V);
    std::vector<float> belly;
    for (const int i : nearest) {
      const std::size_t v = part.vertex_begin + i;
      belly.push_back(surface.belly[v]);
      joined.shares.push_back(influences[surface.slice[v]]);
    }
    joined.add(light, shading(whole, nearest), gltf::muscle_tints(part.muscle, belly, light.F));
    joined.names.push_back(gltf::text(muscle.name));
    // Simplifying keeps vertices where they were, so that these are the nearest ones' own.
    if (shapes) joined.shapes.push_back(shape_rows(shapes->muscles[p], nearest));
  }
  for (std::size_t n = 0; n < fascia.parts.size(); ++n) {
    const FasciaSurface::Part& part = fascia.parts[n];
    const FasciaSheet& sheet = anatomy.fascia[part.sheet];
    Joined& joined = meshes[shapes ? region_of(sheet.group, sheet.side) : "muscles"];
    const TriMesh whole{sheet.V, grid_triangles(sheet.rows, sheet.columns)};
    const TriMesh light = simplify(whole, most[surface.parts.size() + n]);
    const std::vector<int> nearest = nearest_rows(light.V, whole.V);
    std::vector<float> belly;
    for (const int i : nearest) {
      belly.push_back(sheet.belly[i]);
      joined.shares.push_back(fascia_shares[part.vertex_begin + i]);
    }
    joined.add(light, shading(whole, nearest), gltf::fascia_tints(belly, light.F));
    joined.names.push_back(gltf::text(sheet.name));
    if (shapes) joined.shapes.push_back(shape_rows(shapes->fascia[n], nearest));
  }
  gltf::MorphedNodes out;
  for (const auto& [name, joined] : meshes) {
    const int node = add_joined(glb, name, joined, kMuscleLook, kTendonLook, kHighestTone);
    if (shapes) out.emplace_back(node, join_shapes(joined.shapes, {}));
  }
  return out;
}

// Both eyes as one mesh, a primitive a tissue.
void add_eyes_light_character(GlbBuilder& glb, const std::vector<Eyeball>& eyes) {
  if (eyes.empty()) return;
  std::vector<std::vector<EyePart>> globes;
  for (const Eyeball& eye : eyes) globes.push_back(eye_parts(eye));
  std::vector<tinygltf::Primitive> primitives;
  for (std::size_t tissue = 0; tissue < globes[0].size(); ++tissue) {
    Joined joined;
    for (std::size_t e = 0; e < eyes.size(); ++e) {
      joined.add(globes[e][tissue].mesh, globes[e][tissue].normals);
      joined.shares.resize(joined.V.size(), {Influence{eyes[e].joint, 1}});
    }
    const TriMesh mesh = joined.mesh();
    primitives.push_back(glb.surface(mesh.V, joined.all_normals(), glb.add_indices(mesh.F),
                                     glb.material(globes[0][tissue].look)));
    glb.add_influences(primitives.back(), joined.shares);
  }
  tinygltf::Node node;
  node.name = "eyes";
  node.mesh = glb.add_mesh("eyes", std::move(primitives));
  node.skin = 0;
  glb.add_node(std::move(node));
}

}  // namespace

void write_light_character(const std::filesystem::path& file, const Character& character,
                           const Binding& binding, const LightDetail& detail, const Motion* motion,
                           const CharacterLook& look, const ClipShapes* shapes) {
  gltf::check_parts(character, binding, motion, look);
  gltf::check_shapes(character, motion, shapes);
  AtomicFile out(file);
  GlbBuilder glb;
  gltf::add_joints(glb, character.anatomy.skeleton);
  const int skin = gltf::add_skin(glb, character.body.skin, binding.joint_weights, look.texture);
  add_bones_light_character(glb, character.anatomy, look.cartilage, detail);
  gltf::MorphedNodes morphed = add_muscles_light_character(glb, character.anatomy, detail, shapes);
  add_eyes_light_character(glb, look.eyes);
  gltf::Object notes{{"detail", gltf::text(detail.name)}};
  if (shapes) {
    morphed.emplace_back(skin, gltf::seamed_shapes(shapes->skin, look.texture));
    notes["shapes"] = gltf::shapes_notes(glb, morphed);
  }
  if (motion) {
    const int times = gltf::add_motion(glb, character.anatomy.skeleton, *motion, "motion");
    gltf::add_morphs(glb, morphed, times);
  }
  gltf::finish(glb, character.body, std::move(notes), out);
}

}  // namespace ecorche::inline v1
