#include "skinning/files/tissue_meshes.h"

#include <algorithm>
#include <cmath>

#include "anatomy/muscles/action_line.h"
#include "skinning/files/layer_mesh.h"

namespace ecorche::inline v1::gltf {
namespace {

// Of a colour, over the colour that it is multiplied with.
Tint tint(const Rgb& color, const Rgb& over) {
  const Rgb share = linear_light(color).cwiseQuotient(linear_light(over));
  Tint out{255, 255, 255, 255};
  for (int k = 0; k < 3; ++k)
    out[k] = std::uint8_t(std::lround(255 * std::clamp(share[k], 0.0f, 1.0f)));
  return out;
}

}  // namespace

std::vector<tinygltf::Primitive> two_tissues(GlbBuilder& glb, const TriMesh& mesh,
                                             const Points& normals, const std::vector<char>& second,
                                             int first_material, int second_material) {
  std::vector<tinygltf::Primitive> out;
  for (int tissue = 0; tissue < 2; ++tissue) {
    const Triangles F = faces_with(mesh.F, second, char(tissue));
    if (F.rows() == 0) continue;
    const int material = tissue == 0 ? first_material : second_material,
              indices = glb.add_indices(F);
    out.push_back(out.empty() ? glb.surface(mesh.V, normals, indices, material) : out.front());
    out.back().indices = indices;
    out.back().material = material;
  }
  return out;
}

LoftedMuscles lofted_muscles(const Anatomy& anatomy) {
  LoftedMuscles out{make_muscle_surface(anatomy, {.points_per_slice = kLoftPoints}), {}};
  update_muscle_surface(out.surface, rest_slices(anatomy), out.positions);
  return out;
}

MuscleTints muscle_tints(int muscle, std::span<const float> belly, const Triangles& F) {
  MuscleTints out;
  out.tendon = tendon_faces(belly, F);
  for (const float share : belly) {
    out.belly.push_back(tint(muscle_color(muscle, 1), kHighestTone * kMuscleLook.color));
    out.fading.push_back(tint(muscle_color(muscle, share), kTendonLook.color));
  }
  return out;
}

std::vector<tinygltf::Primitive> muscle_tissues(GlbBuilder& glb, const TriMesh& mesh,
                                                const MuscleTints& tints) {
  const int belly = glb.material(kMuscleLook, kHighestTone), tendon = glb.material(kTendonLook);
  auto out = two_tissues(glb, mesh, GlbBuilder::unit_normals(mesh), tints.tendon, belly, tendon);
  for (tinygltf::Primitive& primitive : out)
    primitive.attributes["COLOR_0"] =
        glb.add_tints(primitive.material == belly ? tints.belly : tints.fading);
  return out;
}

MuscleTints fascia_tints(std::span<const float> belly, const Triangles& F) {
  MuscleTints out;
  out.tendon.assign(std::size_t(F.rows()), 1);
  for (const float share : belly) {
    const Rgb color = (1 - share) * kTendonLook.color + share * kMuscleLook.color;
    out.fading.push_back(tint(color, kTendonLook.color));
  }
  out.belly = out.fading;
  return out;
}

tinygltf::Primitive fascia_tissue(GlbBuilder& glb, const FasciaSheet& sheet) {
  const TriMesh mesh{sheet.V, grid_triangles(sheet.rows, sheet.columns)};
  tinygltf::Primitive out = glb.surface(mesh.V, GlbBuilder::unit_normals(mesh),
                                        glb.add_indices(mesh.F), glb.material(kTendonLook));
  out.attributes["COLOR_0"] = glb.add_tints(fascia_tints(sheet.belly, mesh.F).fading);
  return out;
}

std::vector<tinygltf::Primitive> eye_tissues(GlbBuilder& glb, const Eyeball& eye) {
  std::vector<tinygltf::Primitive> out;
  for (const EyePart& part : eye_parts(eye))
    out.push_back(glb.surface(part.mesh.V, part.normals, glb.add_indices(part.mesh.F),
                              glb.material(part.look)));
  return out;
}

}  // namespace ecorche::inline v1::gltf
