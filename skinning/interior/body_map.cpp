#include "skinning/interior/body_map.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "anatomy/compute/angle_between.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/geometry/mesh_measures.h"
#include "skinning/interior/map_weights.h"
#include "skinning/interior/strip_joints.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kControlSpacing = 0.03;  // m
constexpr double kLeastReach = 0.002;     // m, of an outline, so that tendons have axes, too
constexpr double kStretched = 1.6;        // of volume, from which on lines are straight
constexpr double kLeastFilled = 0.1, kFilled = 0.6;  // of a cell, where it begins to keep volume
constexpr int kFlowRounds = 2;
constexpr int kTendonRounds = 10, kBellyRounds = 1;  // of evening a strip's shifts from its line
constexpr int kGradientRounds = 4;                   // and the map's gradients along it
constexpr double kSlideReach = 0.06;                 // m
constexpr double kMostStretch = 2;                   // of a section's width or thickness
constexpr double kMostLean = 0.7;  // rad, of a section's normal from the line of centres
constexpr std::size_t kRight = 0, kUp = kOutlinePoints / 4, kLeft = kOutlinePoints / 2,
                      kDown = 3 * kOutlinePoints / 4;

// A section's places at rest: its centre, right, left, up and down on its outline.
std::array<Vec3, 5> places_of(const Ellipse& rest) {
  const auto reach = [&](std::size_t direction, double radius) {
    return std::max(double(rest.outline[direction]) * radius, kLeastReach);
  };
  return {rest.center, rest.center + reach(kRight, rest.radii.x()) * rest.axes.col(0),
          rest.center - reach(kLeft, rest.radii.x()) * rest.axes.col(0),
          rest.center + reach(kUp, rest.radii.y()) * rest.axes.col(1),
          rest.center - reach(kDown, rest.radii.y()) * rest.axes.col(1)};
}

// Bonds of the sections of muscles in the skin's fat, in their order.
void bond_to_skin(const Anatomy& anatomy, const SkinRays& skin, std::span<const int> sorted,
                  std::span<const SliceRange> strips, BodyMap& map) {
  std::vector<MapSection*> sections;
  for (const SliceRange& range : strips)
    for (int k = range.begin; k < range.end && lies_in_fat(anatomy.muscles[range.muscle]); ++k) {
      map.sections[k].bonds = int(5 * sections.size());
      sections.push_back(&map.sections[k]);
    }
  if (sections.empty()) return;
  map.bonds.resize(5 * sections.size());
  const SkinBonder bonder(joined_bones(anatomy), skin, vertex_normals(skin.mesh()),
                          find_mouth(anatomy, skin.mesh()));
  tbb::parallel_for(std::size_t{0}, sections.size(), [&](std::size_t i) {
    const Ellipse& rest = sections[i]->rest;
    SkinBond* bonds = &map.bonds[5 * i];
    for (const Vec3& place : places_of(rest)) {
      *bonds = bonder.bond(place, rest.axes.col(1));
      for (int& vertex : bonds->vertices) vertex = sorted[std::size_t(vertex)];
      ++bonds;
    }
  });
}

// The flesh that a strip has in the lattice's cells, m^3, nodes ascending.
std::vector<LatticeShare> flesh_of(const BodyLattice& lattice, const SkinRays& skin,
                                   std::span<const Ellipse> strip) {
  constexpr int kSamples = 16;
  std::map<int, double> found;
  for (std::size_t k = 0; k < strip.size(); ++k) {
    const Ellipse& section = strip[k];
    const Vec3 &before = strip[k > 0 ? k - 1 : 0].center,
               &after = strip[std::min(k + 1, strip.size() - 1)].center;
    const double volume =
        std::numbers::pi * section.radii.prod() * 0.5 * (after - before).norm() / kSamples;
    for (int i = 0; i < kSamples; ++i) {  // on two rings of equal areas
      const double angle = 2 * std::numbers::pi * i / kSamples, ring = i % 2 == 0 ? 0.5 : 0.87;
      const Vec3 p = section.center +
                     ring * section.radii.x() * std::cos(angle) * section.axes.col(0) +
                     ring * section.radii.y() * std::sin(angle) * section.axes.col(1);
      for (const LatticeShare& share : lattice_shares(lattice, skin, p))
        found[share.node] += share.weight * volume;
    }
  }
  std::vector<LatticeShare> out;
  for (const auto& [node, volume] : found) out.push_back({node, volume});
  return out;
}

// The share of each cell that muscles fill, from 0, little or none, to 1, most.
std::vector<double> filled_shares(const BodyLattice& lattice,
                                  std::span<const std::vector<LatticeShare>> flesh) {
  std::vector<double> filled(lattice.nodes(), 0.0);
  const double cell = std::pow(lattice.spacing, 3);
  for (const std::vector<LatticeShare>& strip : flesh)
    for (const LatticeShare& share : strip) filled[share.node] += share.weight / cell;
  for (double& share : filled) share = smooth_step(kLeastFilled, kFilled, share);
  return filled;
}

// Where turning alone brings the nodes, and how straight lines are there by the volume that it
// gives their cells.
void turn_nodes(const BodyMap& map, BodyMapWorkspace& workspace) {
  const BodyLattice& lattice = map.pressure.lattice;
  const int nodes = lattice.nodes();
  workspace.turns.resize(nodes);
  workspace.after.resize(nodes);
  workspace.straight.resize(nodes);
  tbb::parallel_for(0, nodes, [&](int i) {
    workspace.turns[i] = turned(workspace.motions, map.nodes, i);
    workspace.after[i] = moved(workspace.motions, map.nodes, i, 0);
  });
  tbb::parallel_for(0, nodes, [&](int i) {
    workspace.straight[i] = float(
        smooth_step(1.0, kStretched, cell_volume(lattice, workspace.after, workspace.turns[i], i)));
  });
}

// Where the map would bring the skin's controls without shifts and flow.
void map_controls(const BodyMap& map, BodyMapWorkspace& workspace) {
  workspace.controls.resize(map.controls.size());
  tbb::parallel_for(std::size_t{0}, map.controls.size(), [&](std::size_t c) {
    workspace.controls[c] =
        moved(workspace.motions, map.controls, c, cell_value(map.controls, c, workspace.straight));
  });
}

void store_row(const Vec3& value, std::size_t row, std::vector<float>& rows) {
  for (std::size_t k = 0; k < 3; ++k) rows[4 * row + k] = float(value[Eigen::Index(k)]);
}

// How far the skin lies below its controls, along its normal. `flowing`: the nodes' flow counts.
void find_shifts(const BodyMap& map, std::span<const float> positions,
                 std::span<const float> normals, bool flowing, BodyMapWorkspace& workspace) {
  workspace.shifts.assign(4 * (map.controls.size() + 1), 0);
  tbb::parallel_for(std::size_t{0}, map.controls.size(), [&](std::size_t c) {
    const std::size_t v = 4 * std::size_t(map.control_vertices[c]);
    const Vec3 skin(positions[v], positions[v + 1], positions[v + 2]),
        normal(normals[v], normals[v + 1], normals[v + 2]);
    Vec3 mapped = workspace.controls[c];
    if (flowing) mapped += cell_mean(map.controls, c, workspace.flow);
    store_row(std::min(0.0, (skin - mapped).dot(normal)) * normal, c, workspace.shifts);
  });
}

// Displacements of the coarse lattice that bring cells of muscle back to their volumes.
void find_flow(const BodyMap& map, BodyMapWorkspace& workspace) {
  const int nodes = map.pressure.lattice.nodes();
  workspace.before.resize(nodes);
  tbb::parallel_for(0, nodes, [&](int i) {
    const float straight = workspace.straight[i];
    workspace.before[i] =
        (straight > 0 ? moved(workspace.motions, map.nodes, i, straight) : workspace.after[i]) +
        skin_mean(map.nodes, i, workspace.shifts);
  });
  workspace.after.assign(workspace.before.begin(), workspace.before.end());
  restore_cell_volumes(map.pressure, workspace.turns, kFlowRounds, workspace.after,
                       workspace.pressure);
  workspace.flow.assign(4 * std::size_t(nodes), 0);
  for (int i = 0; i < nodes; ++i)
    store_row(workspace.after[i] - workspace.before[i], std::size_t(i), workspace.flow);
}

// How posing stretches a section, in its axes at rest and without the factor that keeps its volume:
// the symmetric part, since the map turns it.
Eigen::Matrix2d sliding(const MapSection& section, const Ellipse& posed, double swelling,
                        double belly) {
  const double scale = section.sheet ? swelling * swelling : swelling,
               thick = 1 + belly * (scale - 1), wide = section.sheet ? 1 : thick;
  const Vec2& rest = section.rest.radii;
  constexpr double kLeast = 1e-9;  // so that axes keep their directions
  const double x = rest.x() > 0 ? std::max(posed.radii.x() / (rest.x() * wide), kLeast) : 1,
               y = rest.y() > 0 ? std::max(posed.radii.y() / (rest.y() * thick), kLeast) : 1,
               aslant = posed.axes.col(0).dot(posed.axes.col(1));
  // The root of  x x        aslant x y
  //              aslant x y  y y
  const double area = x * y * std::sqrt(1 - aslant * aslant),
               sum = std::sqrt(x * x + y * y + 2 * area);
  Eigen::Matrix2d out;
  out << x * x + area, aslant * x * y, aslant * x * y, y * y + area;
  return out / sum;
}

Vec3 limited(const Vec3& stretch) {
  const double size = stretch.stableNorm();
  return std::clamp(size, 1 / kMostStretch, kMostStretch) * stretch.stableNormalized();
}

// At a bond's place: of `rows`, #V x 4.
Vec3 on_skin(const SkinBond& bond, std::span<const float> rows) {
  Vec3 out = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const std::size_t v = 4 * std::size_t(bond.vertices[std::size_t(k)]);
    out += bond.weights[k] * Vec3(rows[v], rows[v + 1], rows[v + 2]);
  }
  return out;
}

// The direction of a strip's line of centres at a section.
Vec3 line_at(std::span<const Ellipse> slices, int begin, int end, std::size_t k) {
  return slices[std::size_t(std::min(int(k) + 1, end - 1))].center -
         slices[std::size_t(std::max(int(k) - 1, begin))].center;
}

// Evens along a strip by how much the map moves it from its line, so that it bends as the line
// does: much along tendons; along bellies by what the lattice is too coarse for.
void even_shifts(std::span<const Vec3> line, std::span<const float> belly,
                 std::span<Ellipse> strip) {
  const auto shift = [&](std::size_t k) { return Vec3(strip[k].center - line[k]); };
  for (int round = 0; round < kTendonRounds; ++round)
    for (std::size_t k = 1; k + 1 < strip.size(); ++k) {
      const double share = round < kBellyRounds ? 1 : 1 - double(belly[k]);
      strip[k].center += 0.5 * share * (0.5 * (shift(k - 1) + shift(k + 1)) - shift(k));
    }
}

// The map's gradient at a section, from where it brings the section's unit axes. Along the line it
// only turns.
Mat3 map_gradient(const Vec3& width, const Vec3& thickness, const Mat3& rest_axes) {
  Mat3 posed;
  posed << width, thickness, width.cross(thickness).stableNormalized();
  return posed * rest_axes.transpose();
}

// Evens a strip's gradients, so that its sections turn into one another without corners.
void even_gradients(std::span<Mat3> strip) {
  for (int round = 0; round < kGradientRounds; ++round) {
    Mat3 before = strip[0];
    for (std::size_t k = 1; k + 1 < strip.size(); ++k) {
      const Mat3 own = strip[k];
      strip[k] = 0.5 * own + 0.25 * (before + strip[k + 1]);
      before = own;
    }
  }
}

// Axes of a section from the directions that the map gives it. Where the map leans it far from its
// line, or over, it is turned back: a section that lies along its line has no volume.
Mat3 section_axes(const Vec3& width, const Vec3& thickness, const Vec3& line, double most_lean) {
  Mat3 out;
  out.col(0) = width.stableNormalized();
  out.col(1) = thickness.stableNormalized();
  if (out.col(0).cross(out.col(1)).norm() < 0.5)  // sheared flat
    out.col(1) = (out.col(1) - out.col(1).dot(out.col(0)) * out.col(0)).stableNormalized();
  out.col(2) = out.col(0).cross(out.col(1)).stableNormalized();
  const Vec3 normal = out.col(2), about = normal.cross(line);
  const double over = angle_between(normal, line) - most_lean;
  if (over <= 0 || about.norm() < 1e-6 * line.norm()) return out;
  return Eigen::AngleAxisd(over, about.normalized()).toRotationMatrix() * out;
}

// Vertices of the skin that the map has as controls, and where they and the lattice's nodes are.
void place_controls(const TriMesh& skin, const SkinRays& rays, const SkinControls& controls,
                    std::span<const int> sorted, BodyMap& out) {
  const MapWeights& weights = *out.weights;
  std::vector<MapPoint> points;
  for (const int v : controls.vertices) {
    out.control_vertices.push_back(sorted[std::size_t(v)]);
    points.push_back(place_point(weights, rays, skin.V.row(v)));
  }
  out.controls = pack_points(points);
  points.resize(weights.coarse.nodes());
  tbb::parallel_for(0, weights.coarse.nodes(), [&](int i) {
    points[i] = place_point(weights, rays, weights.coarse.points[i]);
  });
  out.nodes = pack_points(points);
}

// Points of sections before they are packed.
struct SectionPoints {
  std::vector<MapPoint> centers, outlines;
};

void place_strip(const Anatomy& anatomy, const SkinRays& rays, const PosedAnatomy& rest,
                 const SliceRange& range, BodyMap& out, SectionPoints& points) {
  const MapWeights& weights = *out.weights;
  const Muscle& muscle = anatomy.muscles[range.muscle];
  const Strip& strip = muscle.strips[range.strip];
  const std::span<const Ellipse> slices =
      std::span(rest.slices).subspan(range.begin, std::size_t(range.end - range.begin));
  const std::vector<BoneHold> holds = bone_holds(muscle, strip, slices);
  const std::vector<GlideHold> glides = glide_holds(strip, slices);
  const std::vector<std::vector<double>> owns =
      own_joints(strip, muscle.sheet, out.parents, slices);
  for (int k = range.begin; k < range.end; ++k) {
    MapSection& section = out.sections[k];
    const auto [center, right, left, up, down] = places_of(rest.slices[k]);
    const BoneHold& hold = holds[std::size_t(k - range.begin)];
    const std::span<const double> own = owns[std::size_t(k - range.begin)];
    const GlideHold& glide = glides[std::size_t(k - range.begin)];
    section.held = hold.share;
    points.centers[k] = place_point(weights, rays, center, own, hold, glide);
    for (const auto& [side, place] : {std::pair(0, right), {1, left}, {2, up}, {3, down}})
      points.outlines[4 * std::size_t(k) + std::size_t(side)] =
          place_point(weights, rays, place, own, hold, glide);
    section.rest = rest.slices[k];
    section.width = (right - left).norm();
    section.thickness = (up - down).norm();
    if (k + 1 < range.end) section.gap = (rest.slices[k + 1].center - rest.slices[k].center).norm();
    section.lean = std::max(
        kMostLean,
        angle_between(rest.slices[k].axes.col(2), line_at(rest.slices, range.begin, range.end, k)));
    section.sheet = muscle.sheet;
  }
}

// Where sections were of strips that lie in the pose of rest as they did: muscles beside them may
// push them there.
std::vector<int> sections_before(const BodyMapBefore& before, std::span<const SliceRange> strips,
                                 const PosedAnatomy& rest) {
  constexpr double kSame = 1e-6;  // m
  std::vector<int> out = before.sections;
  for (const SliceRange& strip : strips) {
    bool same = true;
    for (int k = strip.begin; k < strip.end && same; ++k) {
      if (out[std::size_t(k)] < 0) break;
      const Ellipse &here = rest.slices[std::size_t(k)],
                    &there = before.map->sections[std::size_t(out[std::size_t(k)])].rest;
      same = (here.center - there.center).norm() < kSame &&
             (here.radii - there.radii).norm() < kSame && here.axes.isApprox(there.axes, kSame);
    }
    if (!same) std::fill(out.begin() + strip.begin, out.begin() + strip.end, -1);
  }
  return out;
}

}  // namespace

BodyMap make_body_map(const Anatomy& anatomy, const TriMesh& skin, std::span<const int> order,
                      const PosedAnatomy& rest, const BodyMapBefore& before) {
  const SkinRays rays(skin);
  BodyMap out;
  out.joints = rest_positions(anatomy.skeleton);
  for (const Joint& joint : anatomy.skeleton.joints) out.parents.push_back(joint.parent);
  std::vector<int> sorted(skin.V.rows());
  std::iota(sorted.begin(), sorted.end(), 0);
  for (std::size_t s = 0; s < order.size(); ++s) sorted[order[s]] = int(s);
  const BodyMap* was = before.map && before.map->weights ? before.map : nullptr;
  const std::vector<SliceRange> strips = slice_ranges(anatomy);
  std::vector<int> then(rest.slices.size(), -1);  // where sections were
  if (was) {
    then = sections_before(before, strips, rest);
    out.weights = was->weights;
    out.control_vertices = was->control_vertices;
    out.controls = was->controls;
    out.nodes = was->nodes;
  } else {
    const SkinControls controls = choose_skin_controls(skin, kControlSpacing);
    out.weights = std::make_shared<const MapWeights>(make_map_weights(anatomy, rays, controls));
    place_controls(skin, rays, controls, sorted, out);
  }
  out.sections.resize(rest.slices.size());
  out.flesh.resize(strips.size());
  SectionPoints points;
  points.centers.resize(out.sections.size());
  points.outlines.resize(4 * out.sections.size());
  tbb::parallel_for(std::size_t{0}, strips.size(), [&](std::size_t s) {
    const SliceRange& range = strips[s];
    const std::size_t begin = std::size_t(range.begin), count = std::size_t(range.end) - begin;
    if (then[begin] >= 0) {
      const auto first = was->sections.begin() + then[begin];
      std::copy_n(first, count, out.sections.begin() + long(begin));
      out.flesh[s] = was->flesh[std::size_t(first->strip)];
    } else {
      place_strip(anatomy, rays, rest, range, out, points);
      if (!lies_in_fat(anatomy.muscles[range.muscle]))
        out.flesh[s] =
            flesh_of(out.weights->coarse, rays, std::span(rest.slices).subspan(begin, count));
    }
    for (int k = range.begin; k < range.end; ++k) {
      MapSection& section = out.sections[std::size_t(k)];
      section.strip = int(s);
      section.begin = range.begin;
      section.end = range.end;
      section.bonds = -1;
    }
  });
  out.pressure = make_pressure_table(out.weights->coarse, out.weights->bone,
                                     filled_shares(out.weights->coarse, out.flesh));
  std::vector<int> outlines;  // as `then`, of four points each
  for (const int k : then)
    for (int side = 0; side < 4; ++side) outlines.push_back(k < 0 ? -1 : 4 * k + side);
  out.centers = pack_points(points.centers, then, was ? was->centers : MapPoints());
  out.outlines = pack_points(points.outlines, outlines, was ? was->outlines : MapPoints());
  bond_to_skin(anatomy, rays, sorted, strips, out);
  out.beds = make_bone_beds(anatomy, rest.slices);
  return out;
}

void carry_muscles(const BodyMap& map, std::span<const float> positions,
                   std::span<const float> normals, PosedAnatomy& posed,
                   BodyMapWorkspace& workspace) {
  set_motions(map.joints, map.parents, posed, workspace.motions);
  turn_nodes(map, workspace);
  map_controls(map, workspace);
  find_shifts(map, positions, normals, false, workspace);
  find_flow(map, workspace);
  find_shifts(map, positions, normals, true, workspace);
  // `which`: of a section's five points
  const auto placed = [&](const MapSection& section, int which, const MapPoints& points,
                          std::size_t i, float straight) {
    const Vec3 at = moved(workspace.motions, points, i, straight) +
                    skin_mean(points, i, workspace.shifts) + cell_mean(points, i, workspace.flow);
    if (section.bonds < 0) return at;
    const SkinBond& bond = map.bonds[std::size_t(section.bonds + which)];
    const Vec3 bonded = bond.moved(on_skin(bond, positions), on_skin(bond, normals),
                                   turned(workspace.motions, points, i), at);
    return Vec3(bonded + section.held * (at - bonded));
  };
  const std::size_t count = map.sections.size();
  workspace.lines.resize(count);
  const auto straight_at = [&](std::size_t k) {
    return cell_value(map.centers, k, workspace.straight);
  };
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    workspace.lines[k] = posed.slices[k].center;
    posed.slices[k].center = placed(map.sections[k], 0, map.centers, k, straight_at(k));
  });
  const auto each_strip = [&](const auto& act) {  // on its first section and their count
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
      const MapSection& section = map.sections[k];
      if (int(k) == section.begin) act(k, std::size_t(section.end - section.begin));
    });
  };
  each_strip([&](std::size_t begin, std::size_t sections) {
    even_shifts(std::span(workspace.lines).subspan(begin, sections),
                std::span(posed.belly).subspan(begin, sections),
                std::span(posed.slices).subspan(begin, sections));
  });
  workspace.gradients.resize(count);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    const MapSection& section = map.sections[k];
    const float straight = straight_at(k);
    const auto side = [&](int which) {
      return placed(section, 1 + which, map.outlines, 4 * k + std::size_t(which), straight);
    };
    workspace.gradients[k] =
        map_gradient((side(0) - side(1)) / section.width, (side(2) - side(3)) / section.thickness,
                     section.rest.axes);
  });
  workspace.mapped.resize(count);
  each_strip([&](std::size_t begin, std::size_t sections) {
    const std::span<Mat3> gradients = std::span(workspace.gradients).subspan(begin, sections);
    even_gradients(gradients);
    if (map.sections[begin].bonds >= 0) return;  // it goes with the skin
    const std::span<MappedSection> mapped = std::span(workspace.mapped).subspan(begin, sections);
    std::array<double, kMaxStripSlices> gaps{};
    for (std::size_t k = 0; k < sections; ++k) {
      const MapSection& section = map.sections[begin + k];
      gaps[k] = section.gap;
      mapped[k] = {posed.slices[begin + k].center, gradients[k] * section.rest.axes.leftCols<2>()};
    }
    slide_sections(gaps, kSlideReach, mapped);
    for (std::size_t k = 0; k < sections; ++k) {
      posed.slices[begin + k].center = mapped[k].center;
      gradients[k] = map_gradient(mapped[k].axes.col(0), mapped[k].axes.col(1),
                                  map.sections[begin + k].rest.axes);
    }
    even_gradients(gradients);  // sections slid apart turn more from one to the next
  });
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
    const MapSection& section = map.sections[k];
    const Eigen::Matrix<double, 3, 2> stretched =
        workspace.gradients[k] * section.rest.axes.leftCols<2>();
    const Vec3 line = line_at(posed.slices, section.begin, section.end, k);
    Ellipse& out = posed.slices[k];
    Eigen::Matrix<double, 3, 2> axes;
    axes << limited(stretched.col(0)), limited(stretched.col(1));
    axes *= sliding(section, out, posed.swelling[section.strip], double(posed.belly[k]));
    out.radii = section.rest.radii.cwiseProduct(axes.colwise().norm().transpose());
    out.outline = section.rest.outline;
    out.axes = section_axes(axes.col(0), axes.col(1), line, section.lean);
  });
  lift_over_bones(map.beds, posed.X_WJ, posed.slices, workspace.beds);
}

}  // namespace ecorche::inline v1
