#include "morph/fit/template_tissue.h"

#include <algorithm>
#include <cstdint>

#include "anatomy/errors.h"
#include "anatomy/files/byte_stream.h"
#include "anatomy/files/cache.h"
#include "anatomy/files/package_archive.h"
#include "tissue_code.h"  // generated: kTissueCode

namespace ecorche::inline v1 {
namespace {

// An anchor as numbers.
struct PackedAnchor {
  std::int32_t kind, bone, vertices[3], unused = 0;
  double weights[3];
};

// Vertices in the middle of a cap over mouth or eye are no vertices of the skin: what hangs on one
// is let go.
void free_caps(Eigen::Index skin_size, TissueMesh& mesh) {
  for (TissueAnchor& anchor : mesh.anchors) {
    const bool capped = std::ranges::any_of(anchor.vertices, [&](int v) { return v >= skin_size; });
    if (anchor.kind == TissueAnchor::Kind::skin && capped) anchor = {};
  }
}

}  // namespace

std::string write_tissue_bytes(const TissueMesh& mesh) {
  std::string out;
  const std::int64_t counts[] = {mesh.V.rows(), mesh.T.rows()};
  put_bytes(out, counts, 2);
  put_bytes(out, mesh.V.data(), std::size_t(mesh.V.size()));
  put_bytes(out, mesh.T.data(), std::size_t(mesh.T.size()));
  put_bytes(out, mesh.in_bone.data(), mesh.in_bone.size());
  for (const TissueAnchor& a : mesh.anchors) {
    const PackedAnchor packed{std::int32_t(a.kind),
                              a.bone,
                              {a.vertices[0], a.vertices[1], a.vertices[2]},
                              0,
                              {a.weights[0], a.weights[1], a.weights[2]}};
    put_bytes(out, &packed, 1);
  }
  return sealed(std::move(out));
}

TissueMesh read_tissue_bytes(std::string_view bytes) {
  bytes = unsealed(bytes);
  std::int64_t counts[2];
  take_bytes(bytes, counts, 2);
  const std::size_t nodes = counts[0], tetrahedra = counts[1];
  if (counts[0] < 0 || counts[1] < 0 || nodes > bytes.size() / 24 || tetrahedra > bytes.size() / 16)
    throw InputError("tissue cache: shorter than its contents say");
  TissueMesh mesh;
  mesh.V.resize(counts[0], 3);
  mesh.T.resize(counts[1], 4);
  mesh.in_bone.resize(tetrahedra);
  take_bytes(bytes, mesh.V.data(), 3 * nodes);
  take_bytes(bytes, mesh.T.data(), 4 * tetrahedra);
  take_bytes(bytes, mesh.in_bone.data(), tetrahedra);
  for (std::size_t n = 0; n < nodes; ++n) {
    PackedAnchor packed;
    take_bytes(bytes, &packed, 1);
    mesh.anchors.push_back({static_cast<TissueAnchor::Kind>(packed.kind),
                            packed.bone,
                            {packed.vertices[0], packed.vertices[1], packed.vertices[2]},
                            Vec3(packed.weights[0], packed.weights[1], packed.weights[2])});
  }
  return mesh;
}

TissueMesh template_tissue(const Template& body_template, Interior interior) {
  if (interior != Interior::tetgen && interior != Interior::lattice)
    throw std::invalid_argument("template_tissue: this interior has no mesh");
  const FitTables& tables = body_template.tables;
  const Anatomy& anatomy = table_anatomy(body_template);
  const Points skin = body_template.body.skin.V.topRows(tables.topology.skin_size);
  std::string made_of =
      std::string(kTissueCode) + (interior == Interior::tetgen ? " tetgen" : " lattice");
  put_bytes(made_of, skin.data(), std::size_t(skin.size()));
  for (const Bone& bone : anatomy.bones)
    put_bytes(made_of, bone.mesh.V.data(), std::size_t(bone.mesh.V.size()));
  const std::string name = sha256(made_of) + ".tissue";
  if (const std::optional<std::string> bytes = read_cached(name)) {
    try {
      return read_tissue_bytes(*bytes);
    } catch (const InputError&) {
      // damaged: made anew and overwritten below
    }
  }
  const TriMesh closed = capped_skin(tables.topology, skin);
  TissueMesh mesh = interior == Interior::tetgen ? tetgen_tissue(closed, anatomy.bones)
                                                 : lattice_tissue(closed, anatomy.bones);
  free_caps(skin.rows(), mesh);
  write_cached(name, write_tissue_bytes(mesh));
  return mesh;
}

}  // namespace ecorche::inline v1
