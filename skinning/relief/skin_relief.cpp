#include "skinning/relief/skin_relief.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/compute/simd.h"
#include "anatomy/compute/smooth_step.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/vertex_normals.h"
#include "anatomy/queries/ray_caster.h"
#include "skinning/relief/layer_filter.h"
#include "skinning/relief/relief_nodes.h"
#include "skinning/relief/skin_smoothing.h"
#include "skinning/relief/vein_ridges.h"

namespace ecorche::inline v1 {

// Fine bands: the depth as measured, and smoothed once. The other three live on nodes, each
// smoothed from the one before.
struct ReliefTables {
  Eigen::Index vertices = 0;
  float definition = 0;
  std::size_t slices = 0;
  SurfaceSamples samples;
  DepthGroups groups;
  std::vector<int> triangles;
  std::vector<float> expected;                     // #V m, depth at rest, smooth
  std::vector<float> rest_shape;                   // #nodes m, depth of the shape beneath, at rest
  std::vector<float> veins;                        // #V m, ridges in full effort; empty: none
  std::vector<float> bound;                        // #V m, that relief never reaches; 0: none here
  std::vector<std::array<float, 2>> fine_weights;  // #V, of fine bands, with the definition
  std::vector<std::array<float, 3>> node_weights;  // #nodes
  SkinSmoothing fine;                              // to the second band
  SkinSmoothing to_nodes, from_nodes;
  std::array<SkinSmoothing, 3> wide;  // to the third band and on
  SkinSmoothing region;               // over which the mean is zero
  SkinSmoothing open_at;              // nodes, of the base mesh's openness
  Eigen::Index base = 0;              // vertices of the base mesh
};

namespace {

constexpr std::size_t kReliefGrain = 4096;
// Bound of the relief as a share of half the body's thickness, and in m. Striations of competitors
// are furrows of some 2 mm; a tendon of the wrist rises by as much.
constexpr double kShareOfBody = 0.12, kMostRelief = 0.006;
constexpr double kThinnest = 0.0015;     // m, of a layer: skin alone is 1.2 to 2 mm thick
constexpr double kThinnestShare = 0.35;  // of measured layers, that a lean body's may be
// m, of the layer that a filter is made for: stiffness of skin and fascia. Smaller: the surface of
// the muscles' sections shows as ripples.
constexpr double kStiffLayer = 0.0034;
constexpr double kUnknownDepth = 0.015;  // m, expected before it is measured
// Widest smoothings in edges of the skin and between nodes: more costs time on hands and feet,
// whose edges are short.
constexpr double kFineEdges = 1.6, kNodeWidths = 3;
// Fitted weights are looked up by the thickness in these steps, m.
constexpr double kThicknessStep = 0.00025;
constexpr int kThicknessSteps = 200;

double width_between(double from, double to) { return std::sqrt(to * to - from * from); }

// Standard deviation of a band's values on the nodes; what interpolates them adds the rest.
double width_on_nodes(int band) {
  return band == 1 ? std::hypot(kBandWidths[1], kToNodes)
                   : width_between(kFromNodes, kBandWidths[band]);
}

// Openness at the nodes, of a value a base vertex.
SkinSmoothing base_to_nodes(const Refinement& refinement, const std::vector<int>& nodes) {
  SkinSmoothing out;
  out.first.push_back(0);
  for (const int v : nodes) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(refinement.map, v); it;
         ++it) {
      out.vertex.push_back(int(it.col()));
      out.weight.push_back(float(it.value()));
    }
    out.first.push_back(int(out.vertex.size()));
  }
  return out;
}

// Half the thickness of the body beneath each vertex, smooth. m
std::vector<double> half_thickness(const TriMesh& skin) {
  constexpr double kSkipped = 0.001, kMost = 0.2;  // m
  const SkinRays rays(skin);
  const Points normals = vertex_normals(skin);
  std::vector<double> out(std::size_t(skin.V.rows()));
  parallel_for_ranges(out.size(), 512, Threads::all, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const Vec3 n = normals.row(Eigen::Index(v));
      if (n.norm() < 0.5) continue;
      const RayHit hit = rays.first_hit(skin.V.row(Eigen::Index(v)), -n, kMost, kSkipped);
      out[v] = 0.5 * (hit.triangle < 0 ? kMost : double(hit.distance));
    }
  });
  return out;
}

// Share of each vertex that does not go with the head.
std::vector<double> off_head(const Skeleton& skeleton, std::span<const JointWeights> weights) {
  const int head = find_joint(skeleton, "head"), jaw = find_joint(skeleton, "jaw");
  std::vector<double> out;
  for (const JointWeights& row : weights) {
    double share = 0;
    for (const Influence& influence : row)
      if (influence.weight > 0 && (influence.joint == head || influence.joint == jaw))
        share += influence.weight;
    out.push_back(1 - smooth_step(0.1, 0.6, share));
  }
  return out;
}

std::vector<float> to_rows(const Points& points) {
  std::vector<float> out(4 * std::size_t(points.rows()), 0.0f);
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    for (Eigen::Index k = 0; k < 3; ++k) out[std::size_t(4 * v + k)] = float(points(v, k));
  return out;
}

// The depth at rest: as measured, and smooth as it is expected.
struct RestDepth {
  std::vector<float> measured, smooth;
  std::vector<float> shape;  // #nodes
};

RestDepth measure_rest(const ReliefTables& tables, const PosedAnatomy& rest, const TriMesh& skin) {
  PosedSamples samples;
  SampleGrid grid;
  pose_samples(tables.samples, rest, {}, samples);
  fill_grid(samples, grid);
  const std::vector<float> positions = to_rows(skin.V), normals = to_rows(vertex_normals(skin));
  RestDepth out;
  const std::size_t vertices = std::size_t(skin.V.rows()), base = tables.to_nodes.first.size() - 1;
  std::vector<float> fine(vertices), band(base), wider(base);
  out.smooth.assign(vertices, float(kUnknownDepth));
  // What is expected counts where little is found, so that it is found again with a better guess.
  for (int round = 0; round < 4; ++round) {
    out.measured = out.smooth;
    sample_depths(tables.groups, grid, positions, normals, out.measured);
    smooth(tables.fine, out.measured, fine);
    smooth(tables.to_nodes, fine, band);
    smooth(tables.wide[0], band, wider);
    smooth(tables.wide[1], wider, band);
    smooth(tables.from_nodes, band, out.smooth);
  }
  smooth(tables.wide[2], band, wider);
  out.shape = wider;
  return out;
}

// Thickness of the layer over what stands out: a mean of depths that small ones dominate.
std::vector<double> layer_thickness(const ReliefTables& tables, const std::vector<float>& depth) {
  std::vector<float> inverse(depth.size()), fine(depth.size()),
      band(tables.to_nodes.first.size() - 1), wider(band.size());
  for (std::size_t v = 0; v < depth.size(); ++v) {
    const float h = std::max(depth[v], float(kThinnest));
    inverse[v] = 1 / (h * h);
  }
  smooth(tables.fine, inverse, fine);
  smooth(tables.to_nodes, fine, band);
  smooth(tables.wide[0], band, wider);
  smooth(tables.wide[1], wider, band);
  smooth(tables.from_nodes, band, fine);
  std::vector<double> out;
  for (const float value : fine) out.push_back(1 / std::sqrt(double(std::max(value, 1e-6f))));
  return out;
}

// See ReliefOptions::layer.
void thin_layers(double layer, std::span<const char> wanted, std::vector<double>& thickness) {
  std::vector<double> all;
  for (std::size_t v = 0; v < thickness.size(); ++v)
    if (wanted[v]) all.push_back(thickness[v]);
  if (layer <= 0 || all.empty()) return;
  const auto middle = all.begin() + std::ptrdiff_t(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  const double factor = std::clamp(layer / *middle, kThinnestShare, 1.0);
  for (double& h : thickness) h *= factor;
}

BandWeights weights_at(const std::vector<BandWeights>& table, double thickness) {
  const double at = std::clamp(thickness / kThicknessStep, 0.0, double(kThicknessSteps - 1));
  const std::size_t i = std::min(std::size_t(at), std::size_t(kThicknessSteps - 2));
  const float share = float(at - double(i));
  BandWeights out;
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = (1 - share) * table[i][k] + share * table[i + 1][k];
  return out;
}

void set_weights(ReliefTables& tables, const std::vector<double>& thickness, double definition) {
  std::vector<BandWeights> table;
  for (int i = 0; i < kThicknessSteps; ++i) table.push_back(band_weights(i * kThicknessStep));
  std::vector<BandWeights> fine;
  for (const double h : thickness) fine.push_back(weights_at(table, std::max(h, kStiffLayer)));
  for (const BandWeights& row : fine)
    tables.fine_weights.push_back({float(definition) * row[0], float(definition) * row[1]});
  std::vector<float> values(fine.size()), base(tables.to_nodes.first.size() - 1);
  tables.node_weights.resize(base.size());
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t v = 0; v < fine.size(); ++v) values[v] = float(definition) * fine[v][k + 2];
    smooth(tables.to_nodes, values, base);
    for (std::size_t b = 0; b < base.size(); ++b) tables.node_weights[b][k] = base[b];
  }
}

// Relief before it is bounded, #V, outward.
void filter_depth(const ReliefTables& tables, ReliefWorkspace& w) {
  const std::size_t base = tables.node_weights.size();
  w.fine.resize(w.depth.size());
  w.relief.resize(w.depth.size());
  for (std::vector<float>* values : {&w.band, &w.wider, &w.sum}) values->resize(base);
  smooth(tables.fine, w.depth, w.fine);
  smooth(tables.to_nodes, w.fine, w.band);
  std::fill(w.sum.begin(), w.sum.end(), 0.0f);
  for (std::size_t k = 0; k < 3; ++k) {
    smooth(tables.wide[k], w.band, w.wider);
    w.band.swap(w.wider);
    for (std::size_t b = 0; b < base; ++b) w.sum[b] += tables.node_weights[b][k] * w.band[b];
  }
  smooth(tables.from_nodes, w.sum, w.relief);
  for (std::size_t v = 0; v < w.relief.size(); ++v)
    w.relief[v] = -(w.relief[v] + tables.fine_weights[v][0] * w.depth[v] +
                    tables.fine_weights[v][1] * w.fine[v]);
}

// Veins fill where muscles work: the share of a ridge that stands out at rest, and the mean
// activation of all muscles from which on all of it does (a hard run has some 0.2 to 0.3).
constexpr double kVeinsAtRest = 0.6, kFullEffort = 0.25;

double effort_of(std::span<const double> activation) {
  double sum = 0;
  for (const double a : activation) sum += a;
  return activation.empty() ? 0 : smooth_step(0.0, kFullEffort, sum / double(activation.size()));
}

void add_veins(const ReliefTables& tables, double effort, ReliefWorkspace& w) {
  if (tables.veins.empty()) return;
  const float share = float(kVeinsAtRest + (1 - kVeinsAtRest) * effort);
  for (std::size_t v = 0; v < w.relief.size(); ++v) w.relief[v] += share * tables.veins[v];
}

// The share of the bound up to which the skin follows the shape beneath.
constexpr float kFollowed = 1;

// Bounds the relief and takes its regional mean away; then lets the skin follow the shape beneath,
// so that the layer over bellies stays as thick as at rest. `w.band`: depth of that shape.
void bound_relief(const ReliefTables& tables, ReliefWorkspace& w) {
  w.shape.resize(w.band.size());
  for (std::size_t n = 0; n < w.band.size(); ++n) w.shape[n] = tables.rest_shape[n] - w.band[n];
  if (Eigen::Index(w.openness.size()) == tables.base) {
    smooth(tables.open_at, w.openness, w.band);
    smooth(tables.from_nodes, w.band, w.moved);
  } else
    w.moved.assign(w.relief.size(), 1.0f);
  const auto bound = [&](std::size_t v, float by) {
    const float most = tables.bound[v] * std::clamp(w.moved[v], 0.0f, 1.0f);
    return most > 0 ? by / std::sqrt(1 + by * by / (most * most)) : 0.0f;
  };
  for (std::size_t v = 0; v < w.relief.size(); ++v) w.relief[v] = bound(v, w.relief[v]);
  smooth(tables.to_nodes, w.relief, w.band);
  smooth(tables.region, w.band, w.wider);
  smooth(tables.from_nodes, w.wider, w.fine);
  smooth(tables.from_nodes, w.shape, w.depth);
  for (std::size_t v = 0; v < w.relief.size(); ++v)
    w.relief[v] = tables.bound[v] > 0 ? w.relief[v] - w.fine[v] +
                                            tables.definition * bound(v, kFollowed * w.depth[v])
                                      : 0.0f;
}

}  // namespace

SkinRelief make_skin_relief(const Anatomy& anatomy, const PosedAnatomy& rest,
                            const ReliefSkin& skin, const ReliefOptions& options) {
  if (options.definition <= 0) return {};
  ReliefTables out;
  out.vertices = skin.fine.V.rows();
  out.slices = rest.slices.size();
  out.triangles.assign(skin.fine.F.data(), skin.fine.F.data() + skin.fine.F.size());
  out.samples = sample_surfaces(anatomy, rest, skin.fine);
  const std::vector<double> half = half_thickness(skin.fine),
                            body = off_head(anatomy.skeleton, skin.joint_weights);
  std::vector<char> wanted;
  for (std::size_t v = 0; v < half.size(); ++v) {
    const double bound = body[v] * std::min(kMostRelief, kShareOfBody * half[v]);
    out.bound.push_back(float(bound));
    wanted.push_back(bound > 0);
  }
  const SurfaceGraph graph = graph_of(skin.fine);
  ReliefNodes nodes = make_relief_nodes(graph, wanted);
  out.base = skin.base.V.rows();
  out.open_at = base_to_nodes(skin.refinement, nodes.vertex);
  out.fine =
      make_smoothing(graph, width_between(kBandWidths[0], kBandWidths[1]), kFineEdges, wanted);
  for (int k = 0; k < 3; ++k)
    out.wide[k] =
        make_smoothing(nodes.graph, width_between(width_on_nodes(k + 1), width_on_nodes(k + 2)),
                       kNodeWidths, nodes.wanted);
  out.region = make_smoothing(nodes.graph, kShape, kNodeWidths, nodes.wanted);
  out.to_nodes = std::move(nodes.to);
  out.from_nodes = std::move(nodes.from);
  out.groups = make_depth_groups(skin.fine.V, wanted);
  const RestDepth depth = measure_rest(out, rest, skin.fine);
  out.expected = depth.smooth;
  out.rest_shape = depth.shape;
  out.definition = float(options.definition);
  std::vector<double> thickness = layer_thickness(out, depth.measured);
  thin_layers(options.layer, wanted, thickness);
  set_weights(out, thickness, options.definition);
  if (!options.veins.empty()) {
    out.veins = vein_ridges(options.veins, graph, thickness);
    for (float& height : out.veins) height *= float(options.definition);
  }
  return {std::make_shared<const ReliefTables>(std::move(out))};
}

std::span<const float> vein_heights(const SkinRelief& relief) {
  return relief.data ? std::span<const float>(relief.data->veins) : std::span<const float>();
}

void add_relief(const SkinRelief& relief, const PosedAnatomy& posed,
                std::span<const double> activation, SkinFrame& skin, ReliefWorkspace& w) {
  if (!relief.data || posed.slices.size() != relief.data->slices ||
      Eigen::Index(skin.positions.size()) != 4 * relief.data->vertices)
    throw std::invalid_argument("add_relief: another skin or anatomy than it was made of");
  const ReliefTables& tables = *relief.data;
  pose_samples(tables.samples, posed, activation, w.samples);
  fill_grid(w.samples, w.grid);
  w.depth.assign(tables.expected.begin(), tables.expected.end());
  sample_depths(tables.groups, w.grid, skin.positions, skin.normals, w.depth);
  filter_depth(tables, w);
  add_veins(tables, effort_of(activation), w);
  w.moved.resize(w.relief.size());
  bound_relief(tables, w);
  parallel_for_ranges(
      w.relief.size(), kReliefGrain, Threads::all, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v)
          store4(&skin.positions[4 * v],
                 load4(&skin.positions[4 * v]) + w.relief[v] * load4(&skin.normals[4 * v]));
      });
  vertex_normals(skin.positions, tables.triangles, skin.normals, w.half);
}

}  // namespace ecorche::inline v1
