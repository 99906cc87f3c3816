#include "skinning/interior/body_map.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "anatomy/compute/smooth_step.h"
#include "anatomy/errors.h"
#include "anatomy/queries/nearest_surface.h"
#include "skinning/interior/skin_controls.h"

namespace ecorche::inline v1 {
namespace {

using DualQuat = Eigen::Array<double, 8, 1>;  // w x y z of the rotation, then of the dual part

constexpr double kSpacing = 0.012;        // m, of the lattice
constexpr double kControlSpacing = 0.04;  // m
constexpr int kCoarseRounds = 60, kFineRounds = 20;
constexpr double kStep = 0.012;        // m, to the points by which stretch is measured
constexpr double kLeastReach = 0.002;  // m, of an outline, so that tendons have axes, too
constexpr double kStretched = 1.6;     // of volume, from which on lines are straight
constexpr std::size_t kRight = 0, kUp = kOutlinePoints / 4, kLeft = kOutlinePoints / 2,
                      kDown = 3 * kOutlinePoints / 4;

SourceWeights one_source(int source) {
  SourceWeights out;
  out.source[0] = short(source);
  out.weight[0] = 1;
  out.count = 1;
  return out;
}

// The joint whose bones have most vertices in a node's cell holds the node.
std::vector<SourceWeights> bone_nodes(const BodyLattice& lattice, const Anatomy& anatomy) {
  std::vector<std::map<int, int>> vertices(lattice.nodes());
  for (const Bone& bone : anatomy.bones)
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
      const int node = lattice.node(lattice.cell(bone.mesh.V.row(v)));
      if (node >= 0) ++vertices[node][bone.joint];
    }
  std::vector<SourceWeights> out(lattice.nodes());
  for (int i = 0; i < lattice.nodes(); ++i) {
    int most = 0;
    for (const auto& [joint, count] : vertices[i])
      if (count > most) {
        most = count;
        out[i] = one_source(joint);
      }
  }
  return out;
}

// Nodes beside the skin have the weights of the nearest vertex, bones are one source more.
std::vector<SourceWeights> skin_nodes(const BodyLattice& lattice, const TriMesh& skin,
                                      const SkinControls& controls,
                                      std::span<const SourceWeights> bones) {
  const NearestSurface surface(skin);
  std::vector<SourceWeights> out(lattice.nodes());
  tbb::parallel_for(0, lattice.nodes(), [&](int i) {
    if (bones[i].count > 0) {
      out[i] = one_source(int(controls.vertices.size()));
      return;
    }
    if (std::ranges::all_of(lattice.links[i], [](int other) { return other >= 0; })) return;
    const SurfacePoint p = surface.nearest(lattice.points[i]);
    const auto distance = [&](int v) {
      return (skin.V.row(v).transpose() - p.point).squaredNorm();
    };
    int nearest = skin.F(p.triangle, 0);
    for (int k = 1; k < 3; ++k)
      if (distance(skin.F(p.triangle, k)) < distance(nearest)) nearest = skin.F(p.triangle, k);
    out[i] = controls.weights[nearest];
  });
  return out;
}

// Two lattices of a skin: harmonic weights are found in the coarse one first.
struct Lattices {
  Lattices(const SkinRays& rays)
      : skin(rays),
        coarse(make_body_lattice(rays, 2 * kSpacing)),
        fine(make_body_lattice(rays, kSpacing)) {}

  std::vector<SourceWeights> solve(std::span<const SourceWeights> on_coarse,
                                   std::span<const SourceWeights> on_fine, int sources) const {
    const auto first = harmonic_weights(coarse, on_coarse, sources, {}, kCoarseRounds);
    std::vector<SourceWeights> start(fine.nodes());
    tbb::parallel_for(0, fine.nodes(), [&](int i) {
      start[i] = mix_weights(lattice_shares(coarse, skin, fine.points[i]), first);
    });
    return harmonic_weights(fine, on_fine, sources, start, kFineRounds);
  }

  const SkinRays& skin;
  BodyLattice coarse, fine;
};

// Places points in the map.
class Placer {
 public:
  Placer(const Lattices& lattices, std::span<const SourceWeights> joints,
         std::span<const SourceWeights> skin)
      : lattices_(lattices), joints_(joints), skin_(skin) {}

  MapPoint point(const Vec3& p) const {
    const auto shares = lattice_shares(lattices_.fine, lattices_.skin, p);
    MapPoint out{p, mix_weights(shares, joints_), mix_weights(shares, skin_)};
    if (out.joints.count == 0) out.joints = one_source(0);  // far from all flesh: with the root
    return out;
  }
  MapPlace place(const Vec3& p, const Mat3& axes) const {
    MapPlace out{point(p), {}};
    for (int k = 0; k < 3; ++k) out.beside[k] = point(p + kStep * axes.col(k));
    return out;
  }
  MapSection section(const Ellipse& rest) const {
    MapSection out;
    out.rest = rest;
    out.center = place(rest.center, rest.axes);
    const auto reach = [&](std::size_t direction, double radius) {
      return std::max(double(rest.outline[direction]) * radius, kLeastReach);
    };
    const double right = reach(kRight, rest.radii.x()), left = reach(kLeft, rest.radii.x()),
                 up = reach(kUp, rest.radii.y()), down = reach(kDown, rest.radii.y());
    out.right = point(rest.center + right * rest.axes.col(0));
    out.left = point(rest.center - left * rest.axes.col(0));
    out.up = point(rest.center + up * rest.axes.col(1));
    out.down = point(rest.center - down * rest.axes.col(1));
    out.width = right + left;
    out.thickness = up + down;
    return out;
  }

 private:
  const Lattices& lattices_;
  std::span<const SourceWeights> joints_, skin_;
};

DualQuat dual_quat(const Transform& X) {
  const Quat q = Quat(X.linear()).normalized();
  const Vec3 t = X.translation();
  const Quat dual = Quat(0, t.x(), t.y(), t.z()) * q;
  DualQuat out;
  out << q.w(), q.x(), q.y(), q.z(), 0.5 * dual.w(), 0.5 * dual.x(), 0.5 * dual.y(), 0.5 * dual.z();
  return out;
}

// The map in one pose, but for the skin's part.
class PosedMap {
 public:
  PosedMap(const BodyMap& map, const PosedAnatomy& posed, BodyMapWorkspace& workspace)
      : workspace_(workspace) {
    const std::size_t joints = map.joints.size();
    workspace.motions.resize(joints);
    workspace.rotations.resize(joints);
    for (std::size_t j = 0; j < joints; ++j) {
      workspace.motions[j] = posed.X_WJ[j] * Eigen::Translation3d(-map.joints[j]);
      DualQuat own = dual_quat(workspace.motions[j]);
      if (const int parent = map.parents[j]; parent >= 0) {  // the way round that is shorter
        const DualQuat before = rotation(parent);
        if ((own.head<4>() * before.head<4>()).sum() < 0) own = -own;
      }
      DualQuat::Map(workspace.rotations[j].data()) = own;
    }
  }

  // `straight`: share of the linear blend.
  Vec3 moved(const MapPoint& p, double straight) const {
    DualQuat sum = DualQuat::Zero();
    for (int k = 0; k < p.joints.count; ++k)
      sum += double(p.joints.weight[k]) * rotation(p.joints.source[k]);
    sum /= sum.head<4>().matrix().norm();
    const Vec3 v = sum.segment<3>(1).matrix(), e = sum.segment<3>(5).matrix();
    const double w = sum[0];
    const Vec3 turned =
        p.rest + 2 * v.cross(v.cross(p.rest) + w * p.rest) + 2 * (w * e - sum[4] * v + v.cross(e));
    if (!(straight > 0)) return turned;
    Vec3 linear = Vec3::Zero();
    for (int k = 0; k < p.joints.count; ++k)
      linear += double(p.joints.weight[k]) * (workspace_.motions[p.joints.source[k]] * p.rest);
    return turned + straight * (linear - turned);
  }

  // How straight lines are at a place, 0 .. 1, by the volume that turning would give it.
  double straightness(const MapPlace& place) const {
    const Vec3 at = moved(place.at, 0);
    Mat3 stretch;
    for (int k = 0; k < 3; ++k) stretch.col(k) = (moved(place.beside[k], 0) - at) / kStep;
    return smooth_step(1.0, kStretched, stretch.determinant());
  }

 private:
  DualQuat rotation(int joint) const {
    return DualQuat::Map(workspace_.rotations[std::size_t(joint)].data());
  }

  const BodyMapWorkspace& workspace_;
};

// How far the skin lies below where the map alone would bring it, along its normal.
void find_shifts(const BodyMap& map, const PosedMap& posed, std::span<const float> positions,
                 std::span<const float> normals, std::vector<Vec3>& shifts) {
  shifts.assign(map.controls.size() + 1, Vec3::Zero());
  tbb::parallel_for(std::size_t{0}, map.controls.size(), [&](std::size_t c) {
    const SkinControl& control = map.controls[c];
    const std::size_t v = 4 * std::size_t(control.vertex);
    const Vec3 skin(positions[v], positions[v + 1], positions[v + 2]),
        normal(normals[v], normals[v + 1], normals[v + 2]);
    const Vec3 mapped = posed.moved(control.place.at, posed.straightness(control.place));
    shifts[c] = std::min(0.0, (skin - mapped).dot(normal)) * normal;
  });
}

// The share by which posing changes radii of a section, without the factor that keeps its volume.
Vec2 sliding(const MapSection& section, const Vec2& posed, double swelling, double belly) {
  const double scale = section.sheet ? swelling * swelling : swelling,
               thick = 1 + belly * (scale - 1), wide = section.sheet ? 1 : thick;
  const Vec2& rest = section.rest.radii;
  return {rest.x() > 0 ? posed.x() / (rest.x() * wide) : 1,
          rest.y() > 0 ? posed.y() / (rest.y() * thick) : 1};
}

}  // namespace

BodyMap make_body_map(const Anatomy& anatomy, const TriMesh& skin, std::span<const int> order,
                      const PosedAnatomy& rest) {
  const SkinRays rays(skin);
  const Lattices lattices(rays);
  const auto coarse_bones = bone_nodes(lattices.coarse, anatomy),
             fine_bones = bone_nodes(lattices.fine, anatomy);
  if (std::ranges::none_of(fine_bones, [](const SourceWeights& node) { return node.count > 0; }))
    throw UnfitError("map of the body's inside: no bone lies within the skin");
  const int joints = int(anatomy.skeleton.joints.size());
  const auto of_joints = lattices.solve(coarse_bones, fine_bones, joints);
  const SkinControls controls = choose_skin_controls(skin, kControlSpacing);
  const auto of_skin = lattices.solve(skin_nodes(lattices.coarse, skin, controls, coarse_bones),
                                      skin_nodes(lattices.fine, skin, controls, fine_bones),
                                      int(controls.vertices.size()) + 1);
  const Placer placer(lattices, of_joints, of_skin);
  BodyMap out;
  out.joints = rest_positions(anatomy.skeleton);
  for (const Joint& joint : anatomy.skeleton.joints) out.parents.push_back(joint.parent);
  std::vector<int> sorted(skin.V.rows());
  std::iota(sorted.begin(), sorted.end(), 0);
  for (std::size_t s = 0; s < order.size(); ++s) sorted[order[s]] = int(s);
  for (const int v : controls.vertices)
    out.controls.push_back({sorted[v], placer.place(skin.V.row(v), Mat3::Identity())});
  out.sections.resize(rest.slices.size());
  tbb::parallel_for(std::size_t{0}, out.sections.size(),
                    [&](std::size_t k) { out.sections[k] = placer.section(rest.slices[k]); });
  const std::vector<SliceRange> strips = slice_ranges(anatomy);
  for (std::size_t s = 0; s < strips.size(); ++s)
    for (int k = strips[s].begin; k < strips[s].end; ++k) {
      out.sections[k].strip = int(s);
      out.sections[k].sheet = anatomy.muscles[strips[s].muscle].sheet;
    }
  return out;
}

void carry_muscles(const BodyMap& map, std::span<const float> positions,
                   std::span<const float> normals, PosedAnatomy& posed,
                   BodyMapWorkspace& workspace) {
  const PosedMap pose(map, posed, workspace);
  find_shifts(map, pose, positions, normals, workspace.shifts);
  tbb::parallel_for(std::size_t{0}, map.sections.size(), [&](std::size_t k) {
    const MapSection& section = map.sections[k];
    const double straight = pose.straightness(section.center);
    const auto carried = [&](const MapPoint& p) {
      Vec3 at = pose.moved(p, straight);
      for (int i = 0; i < p.skin.count; ++i)
        at += double(p.skin.weight[i]) * workspace.shifts[p.skin.source[i]];
      return at;
    };
    const Vec3 width = (carried(section.right) - carried(section.left)) / section.width,
               thickness = (carried(section.up) - carried(section.down)) / section.thickness;
    Ellipse& out = posed.slices[k];
    const Vec2 slid =
        sliding(section, out.radii, posed.swelling[section.strip], double(posed.belly[k]));
    out.center = carried(section.center.at);
    out.radii =
        section.rest.radii.cwiseProduct(slid).cwiseProduct(Vec2(width.norm(), thickness.norm()));
    out.outline = section.rest.outline;
    out.axes.col(0) = width.stableNormalized();
    out.axes.col(1) = thickness.stableNormalized();
    out.axes.col(2) = width.cross(thickness).stableNormalized();
  });
}

}  // namespace ecorche::inline v1
