#include "skinning/relief/surface_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kDeepest = 0.04;       // m below the skin: nothing shows from further down
constexpr double kCovered = 0.0015;     // m: what lies nearer over a point does not hide it
constexpr double kFacing = 0.1;         // cosine between surface and skin, from which it is seen
constexpr double kBoneSpacing = 0.004;  // m
// m, sides of cubes of which each has one sample of muscles and fascia. Smaller: frames take
// longer.
constexpr double kSpacing = 0.0045;
constexpr std::size_t kPieceVertices = 8192;
// Tendinous intersections: m, how deep they bind the surface and half their length along it.
// Depth: grooves over the rectus of lean men in photographs and ultrasound are of 2 to 4 mm.
constexpr double kDent = 0.003, kDentLength = 0.008;

// What can be seen from the skin along a straight line.
class SkinView {
 public:
  SkinView(const TriMesh& skin, const TriMesh& inside) : skin_(skin), inside_(inside) {}

  bool sees(const Vec3& point, const Vec3& normal) const {
    const RayHit along = skin_.first_hit(point, normal, kDeepest);
    if (along.triangle < 0) return false;
    const Vec3 out = along.normal.cast<double>();
    if (out.dot(normal) < kFacing) return false;
    const RayHit hit = skin_.first_hit(point, out, kDeepest);
    if (hit.triangle < 0) return false;
    return inside_.first_hit(point, out, double(hit.distance), kCovered).triangle < 0;
  }

 private:
  SkinRays skin_, inside_;
};

// Appends the faces of a mesh.
void append(const Points& V, const Triangles& F, std::vector<Vec3>& points,
            std::vector<Eigen::RowVector3i>& faces) {
  const int begin = points.size();
  for (Eigen::Index v = 0; v < V.rows(); ++v) points.push_back(V.row(v));
  for (Eigen::Index f = 0; f < F.rows(); ++f)
    faces.push_back(Eigen::RowVector3i(F.row(f)).array() + begin);
}

TriMesh to_mesh(const std::vector<Vec3>& points, const std::vector<Eigen::RowVector3i>& faces) {
  TriMesh out{Points(points.size(), 3), Triangles(faces.size(), 3)};
  for (std::size_t i = 0; i < points.size(); ++i) out.V.row(Eigen::Index(i)) = points[i];
  for (std::size_t i = 0; i < faces.size(); ++i) out.F.row(Eigen::Index(i)) = faces[i];
  return out;
}

// Part of a surface: the faces about the seen vertices.
SurfaceSamples::Piece piece_of(const MuscleSurface& whole, const std::vector<char>& seen, int begin,
                               int end) {
  SurfaceSamples::Piece out;
  std::vector<int> number(whole.muscle.size(), -1);
  std::vector<Eigen::RowVector3i> faces;
  out.surface.term_begin.push_back(0);
  const auto take = [&](int v) {
    if (number[v] >= 0) return number[v];
    number[v] = out.surface.vertices();
    out.surface.terms.insert(out.surface.terms.end(), whole.terms.begin() + whole.term_begin[v],
                             whole.terms.begin() + whole.term_begin[v + 1]);
    out.surface.term_begin.push_back(int(out.surface.terms.size()));
    out.surface.muscle.push_back(whole.muscle[v]);
    out.surface.along.push_back(whole.along[v]);
    out.surface.slice.push_back(whole.slice[v]);
    out.surface.belly.push_back(whole.belly[v]);
    if (seen[v]) out.sample.push_back(number[v]);
    return number[v];
  };
  for (int f = begin; f < end; ++f) {
    const auto face = whole.F.row(f);
    if (!seen[face[0]] && !seen[face[1]] && !seen[face[2]]) continue;
    faces.emplace_back(take(face[0]), take(face[1]), take(face[2]));
  }
  out.surface.F.resize(Eigen::Index(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i) out.surface.F.row(Eigen::Index(i)) = faces[i];
  return out;
}

// How far intersections bind the samples of a piece down. `strip_of`: #slices.
void find_dents(const std::vector<const Strip*>& strip_of, SurfaceSamples::Piece& piece) {
  for (const int v : piece.sample) {
    double dent = 0;
    const Strip& strip = *strip_of[piece.surface.slice[v]];
    for (const double s : strip.intersections) {
      const double far = (piece.surface.along[v] - s) * strip.rest_length / kDentLength;
      dent = std::max(dent, kDent * std::exp(-far * far));
    }
    piece.dent.push_back(float(dent));
    piece.belly.push_back(piece.surface.belly[v]);
  }
}

using Cube = std::array<int, 3>;
Cube cube_at(const Vec3& p, double side) {
  Cube out{};
  for (int k = 0; k < 3; ++k) out[k] = int(std::floor(p[k] / side));
  return out;
}

// Keeps the first of the seen points in each cube that is not taken yet.
void thin_out(const Points& V, std::set<Cube>& taken, std::vector<char>& seen) {
  for (std::size_t v = 0; v < seen.size(); ++v)
    seen[v] = seen[v] && taken.insert(cube_at(V.row(Eigen::Index(v)), kSpacing)).second;
}

// Seen points of a bone, one in a cube of kBoneSpacing.
void add_bone(const Bone& bone, const Vec3& joint, const SkinView& view, SurfaceSamples& out) {
  const Points normals = vertex_normals(bone.mesh);
  std::map<Cube, std::pair<Vec3, Vec3>> cubes;
  std::map<Cube, int> members;
  const auto add = [&](const Vec3& p, const Vec3& n) {
    if (n.norm() < 0.5 || !view.sees(p, n)) return;
    const Cube cube = cube_at(p, kBoneSpacing);
    auto [at, fresh] = cubes.try_emplace(cube, Vec3::Zero(), Vec3::Zero());
    at->second.first += p;
    at->second.second += n;
    ++members[cube];
  };
  for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) add(bone.mesh.V.row(v), normals.row(v));
  // Shafts have triangles of some centimetres.
  for (Eigen::Index f = 0; f < bone.mesh.F.rows(); ++f) {
    const auto corner = [&](const Points& of, int k) { return Vec3(of.row(bone.mesh.F(f, k))); };
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest =
          std::max(longest, (corner(bone.mesh.V, k) - corner(bone.mesh.V, (k + 1) % 3)).norm());
    const int steps = int(std::ceil(longest / kBoneSpacing));
    for (int i = 0; i < steps && steps > 1; ++i)
      for (int j = 0; i + j < steps; ++j) {
        const double s = (i + 1.0 / 3) / steps, t = (j + 1.0 / 3) / steps;
        const auto at = [&](const Points& of) {
          return Vec3((1 - s - t) * corner(of, 0) + s * corner(of, 1) + t * corner(of, 2));
        };
        add(at(bone.mesh.V), at(normals));
      }
  }
  for (const auto& [cube, sums] : cubes) {
    if (sums.second.norm() < 1e-6) continue;
    out.bones.push_back({bone.joint, (sums.first / members[cube] - joint).cast<float>(),
                         sums.second.normalized().cast<float>()});
  }
}

std::vector<const Strip*> strips_of_slices(const Anatomy& anatomy) {
  std::vector<const Strip*> out;
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) out.insert(out.end(), strip.slices.size(), &strip);
  return out;
}

std::vector<char> seen_vertices(const SkinView& view, const Points& V, const Triangles& F,
                                const std::vector<char>& counts) {
  const Points normals = vertex_normals({V, F});
  std::vector<char> seen(std::size_t(V.rows()), 0);
  parallel_for_ranges(seen.size(), 1024, Threads::all, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 n = normals.row(Eigen::Index(v));
      seen[v] = counts[v] && n.norm() > 0.5 && view.sees(V.row(Eigen::Index(v)), n);
    }
  });
  return seen;
}

}  // namespace

SurfaceSamples sample_surfaces(const Anatomy& anatomy, const PosedAnatomy& rest,
                               const TriMesh& skin) {
  SurfaceSamples out;
  MuscleSurface muscles;
  Points at(0, 3);
  if (!anatomy.muscles.empty()) {
    muscles = make_muscle_surface(anatomy, {.points_per_slice = 24, .rows_between = 3});
    update_muscle_surface(muscles, rest.slices, at);
  }
  out.fascia = make_fascia_surface(anatomy);
  PointsF fascia;
  update_fascia_surface(out.fascia, rest, fascia);
  std::vector<char> counts(std::size_t(at.rows()));
  std::vector<Vec3> points;
  std::vector<Eigen::RowVector3i> faces;
  for (std::size_t v = 0; v < counts.size(); ++v)
    counts[v] = !lies_in_fat(anatomy.muscles[muscles.muscle[v]]);
  append(at, Triangles(0, 3), points, faces);
  for (Eigen::Index f = 0; f < muscles.F.rows(); ++f)
    if (counts[muscles.F(f, 0)]) faces.emplace_back(muscles.F.row(f));
  append(fascia.cast<double>(), out.fascia.F, points, faces);
  for (const Bone& bone : anatomy.bones) append(bone.mesh.V, bone.mesh.F, points, faces);
  const SkinView view(skin, to_mesh(points, faces));

  std::vector<char> seen = seen_vertices(view, at, muscles.F, counts);
  std::set<Cube> taken;
  thin_out(at, taken, seen);
  const std::vector<const Strip*> strip_of = strips_of_slices(anatomy);
  for (std::size_t p = 0; p < muscles.parts.size();) {
    const int begin = muscles.parts[p].face_begin, first = muscles.parts[p].vertex_begin;
    std::size_t next = p;
    while (next < muscles.parts.size() &&
           muscles.parts[next].vertex_end - first <= int(kPieceVertices))
      ++next;
    next = std::max(next, p + 1);
    SurfaceSamples::Piece piece = piece_of(muscles, seen, begin, muscles.parts[next - 1].face_end);
    find_dents(strip_of, piece);
    if (!piece.sample.empty()) out.pieces.push_back(std::move(piece));
    p = next;
  }
  std::vector<char> seen_fascia = seen_vertices(view, fascia.cast<double>(), out.fascia.F,
                                                std::vector<char>(std::size_t(fascia.rows()), 1));
  thin_out(fascia.cast<double>(), taken, seen_fascia);
  for (std::size_t v = 0; v < seen_fascia.size(); ++v)
    if (seen_fascia[v]) out.fascia_sample.push_back(int(v));
  const std::vector<Vec3> joints = rest_positions(anatomy.skeleton);
  for (const Bone& bone : anatomy.bones) add_bone(bone, joints[bone.joint], view, out);
  out.count = out.fascia_sample.size() + out.bones.size();
  for (const SurfaceSamples::Piece& piece : out.pieces) out.count += piece.sample.size();
  return out;
}

void pose_samples(const SurfaceSamples& samples, const PosedAnatomy& posed,
                  std::span<const double> activation, PosedSamples& out) {
  out.positions.resize(4 * samples.count);
  out.normals.resize(4 * samples.count);
  const std::size_t pieces = samples.pieces.size();
  out.piece_positions.resize(pieces);
  out.piece_normals.resize(pieces);
  const auto put = [&](std::size_t i, const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
    for (std::size_t k = 0; k < 3; ++k) {
      out.positions[4 * i + k] = p[Eigen::Index(k)];
      out.normals[4 * i + k] = n[Eigen::Index(k)];
    }
    out.positions[4 * i + 3] = out.normals[4 * i + 3] = 0;
  };
  std::vector<std::size_t> first{0};
  for (const SurfaceSamples::Piece& piece : samples.pieces)
    first.push_back(first.back() + piece.sample.size());
  parallel_for_ranges(pieces + 2, 1, Threads::all, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      std::size_t i = first[std::min(p, pieces)];
      if (p < pieces) {
        const SurfaceSamples::Piece& piece = samples.pieces[p];
        PointsF &V = out.piece_positions[p], &N = out.piece_normals[p];
        update_muscle_surface(piece.surface, posed, V, &N);
        for (std::size_t k = 0; k < piece.sample.size(); ++k) {
          const Eigen::Vector3f n = N.row(piece.sample[k]);
          const int muscle = piece.surface.muscle[piece.sample[k]];
          const float tensed =
              activation.empty() ? 0 : kTensed * piece.belly[k] * float(activation[muscle]);
          // Intersections are deeper in a tensed muscle, which rises beside them.
          const float out_by = tensed - piece.dent[k] * (1 + tensed / kTensed);
          put(i++, V.row(piece.sample[k]).transpose() + out_by * n, n);
        }
      } else if (p == pieces) {
        update_fascia_surface(samples.fascia, posed, out.fascia_positions, &out.fascia_normals);
        for (const int v : samples.fascia_sample)
          put(i++, out.fascia_positions.row(v), out.fascia_normals.row(v));
      } else {
        i += samples.fascia_sample.size();
        for (const SurfaceSamples::BoneSample& bone : samples.bones) {
          const Eigen::Isometry3f X = posed.X_WJ[bone.joint].cast<float>();
          put(i++, X * bone.at, X.linear() * bone.normal);
        }
      }
    }
  });
}

}  // namespace ecorche::inline v1
