#include "morph/fit/shown_through.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>

#include "anatomy/base_mesh/chest_wall.h"
#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/muscle_surface.h"
#include "anatomy/queries/ray_caster.h"
#include "anatomy/queries/ray_crossings.h"
#include "morph/fat/underside_samples.h"
#include "morph/fit/layer_gaps.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kBetweenRays = 0.004;  // m; smaller: the same to a few percent, slower
constexpr double kBorders = 0.020;      // m, about a triangle; smaller: what lies aslant counts
constexpr double kAbove = 0.5;          // share of the layer above its underside where rays begin
constexpr double kBeneath = 0.080;      // m below it, to where rays go
constexpr float kFaded = 0.5f;          // into a belly, from where on fascia covers nothing
constexpr int kNone = -1;

// Borders of superficial muscles shift from body to body, and nobody sees it.
bool lies_deep(const Muscle& muscle) {
  return muscle.layer == "intermediate" || muscle.layer == "deep";
}

// Muscles in order, then bones, as solids; and fascia.
class LayeredFlesh {
 public:
  explicit LayeredFlesh(const Anatomy& anatomy)
      : count_(int(anatomy.muscles.size() + anatomy.bones.size())) {
    const MuscleSurface surface = make_muscle_surface(anatomy);
    TriMesh drawn;
    update_muscle_surface(surface, rest_slices(anatomy), drawn.V);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
      if (!lies_in_fat(anatomy.muscles[std::size_t(muscle_of(surface, f))])) kept.push_back(f);
    drawn.F.resize(Eigen::Index(kept.size()), 3);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      drawn.F.row(Eigen::Index(k)) = surface.F.row(kept[k]);
      solids_.push_back(muscle_of(surface, kept[k]));
    }
    std::vector<const TriMesh*> all{&drawn};
    for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
      all.push_back(&anatomy.bones[b].mesh);
      solids_.insert(solids_.end(), std::size_t(anatomy.bones[b].mesh.F.rows()),
                     int(anatomy.muscles.size() + b));
    }
    const TriMesh mesh = join_meshes(all);
    rays_.emplace(mesh.V, mesh.F, solids_, drawn.V.rows());
    std::vector<TriMesh> sheets;
    for (const FasciaSheet& sheet : anatomy.fascia)
      if (TriMesh inner = unfaded(sheet); inner.F.rows() > 0) sheets.push_back(std::move(inner));
    if (sheets.empty()) return;
    std::vector<const TriMesh*> joined;
    for (const TriMesh& sheet : sheets) joined.push_back(&sheet);
    fascia_.emplace(join_meshes(joined), RayBuild::quick);
  }

  struct Buffer {
    std::vector<Crossing> crossings;
    std::vector<RayInterval> intervals;
    std::vector<std::pair<double, int>> met;  // distance and solid; #solids: fascia
  };

  // What a ray meets on its way inwards, nearest first.
  void look(const UndersideSample& sample, Buffer& out) const {
    const Vec3 from = sample.point - kAbove * sample.layer * sample.inwards;
    const double far = kAbove * sample.layer + kBeneath;
    rays_->cross(from, sample.inwards, far, far, kNone, out.crossings);
    find_intervals(out.crossings, solids_, far, out.intervals);
    out.met.clear();
    for (const RayInterval& interval : out.intervals)
      out.met.emplace_back(interval.from, interval.solid);
    if (fascia_) {
      const RayHit hit = fascia_->first_hit(from, sample.inwards, far);
      if (hit.triangle >= 0) out.met.emplace_back(double(hit.distance), count_);
    }
    std::ranges::sort(out.met);
  }

 private:
  // Without the margin that passes into bellies below.
  static TriMesh unfaded(const FasciaSheet& sheet) {
    TriMesh out{sheet.V, grid_triangles(sheet.rows, sheet.columns)};
    Eigen::Index kept = 0;
    for (Eigen::Index f = 0; f < out.F.rows(); ++f) {
      float most = 0;
      for (int i = 0; i < 3; ++i) most = std::max(most, sheet.belly[std::size_t(out.F(f, i))]);
      if (most < kFaded) out.F.row(kept++) = out.F.row(f).eval();
    }
    out.F.conservativeResize(kept, 3);
    return out;
  }

  static int muscle_of(const MuscleSurface& surface, Eigen::Index f) {
    return surface.muscle[std::size_t(surface.F(f, 0))];
  }

  int count_ = 0;  // of solids
  std::vector<int> solids_;
  std::optional<CrossingRays> rays_;
  std::optional<SkinRays> fascia_;
};

std::vector<UndersideSample> samples_of(const LayeredBody& body) {
  std::vector<char> looked_at(std::size_t(body.wall.V.rows()), 0);
  for (const int i : vertices_over_flesh(body.wall, body.parts)) looked_at[std::size_t(i)] = 1;
  return underside_samples(body.wall, body.fat.thickness, looked_at, kBetweenRays);
}

// Names of all solids, and where each is in a list in alphabetical order; -1: not there.
std::vector<std::string> names_of(const Anatomy& anatomy) {
  std::vector<std::string> out;
  for (const Muscle& muscle : anatomy.muscles) out.push_back(muscle.name);
  for (const Bone& bone : anatomy.bones) out.push_back(bone.name);
  return out;
}
// And of fascia, after them.
std::vector<int> places_in(const std::vector<std::string>& sorted, const Anatomy& anatomy) {
  std::vector<int> out;
  for (const std::string& name : names_of(anatomy)) {
    const auto at = std::ranges::lower_bound(sorted, name);
    out.push_back(at != sorted.end() && *at == name ? int(at - sorted.begin()) : kNone);
  }
  out.push_back(int(sorted.size()));
  return out;
}

using Pairs = std::vector<OrderedPair>;

void sort_uniquely(Pairs& pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

// Each triangle with rays gets what those within 2 cm of its middle have.
std::vector<Pairs> gathered(const std::vector<UndersideSample>& samples,
                            const std::vector<Pairs>& own) {
  std::vector<Vec3> middles(own.size(), Vec3::Zero());
  std::vector<double> counts(own.size(), 0.0);
  std::vector<std::size_t> triangles;
  for (const UndersideSample& sample : samples) {
    const std::size_t f = std::size_t(sample.triangle);
    if (counts[f] == 0) triangles.push_back(f);
    middles[f] += sample.point;
    ++counts[f];
  }
  for (const std::size_t f : triangles) middles[f] /= counts[f];
  std::vector<Pairs> out(own.size());
  tbb::parallel_for(std::size_t{0}, triangles.size(), [&](std::size_t k) {
    const std::size_t f = triangles[k];
    for (const std::size_t other : triangles)
      if ((middles[other] - middles[f]).squaredNorm() < kBorders * kBorders)
        out[f].insert(out[f].end(), own[other].begin(), own[other].end());
    sort_uniquely(out[f]);
  });
  return out;
}

}  // namespace

LayerOrder order_of_layers(const LayeredBody& body) {
  LayerOrder out;
  out.names = names_of(body.anatomy);
  std::ranges::sort(out.names);
  const std::vector<int> places = places_in(out.names, body.anatomy);
  const LayeredFlesh flesh(body.anatomy);
  const std::vector<UndersideSample> samples = samples_of(body);
  std::vector<Pairs> on_ray(samples.size());
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
    thread_local LayeredFlesh::Buffer buffer;
    flesh.look(samples[k], buffer);
    for (std::size_t i = 0; i < buffer.met.size(); ++i)
      for (std::size_t j = i + 1; j < buffer.met.size(); ++j)
        on_ray[k].push_back(
            {places[std::size_t(buffer.met[i].second)], places[std::size_t(buffer.met[j].second)]});
  });
  std::vector<Pairs> own(std::size_t(body.wall.F.rows()));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Pairs& all = own[std::size_t(samples[k].triangle)];
    all.insert(all.end(), on_ray[k].begin(), on_ray[k].end());
  }
  for (Pairs& pairs : own) sort_uniquely(pairs);
  out.pairs = gathered(samples, own);
  return out;
}

LayerOrder template_layers(const Template& body_template, const BodyPackage& package) {
  const Body& body = body_template.body;
  const SkinRays wall(chest_wall_skin(package, body.sex, body.skin.V));
  const FatLayer fat = make_fat_layer(body_template.tables.fat, wall, body_template.anatomy, body);
  const std::vector<VertexPart> parts = vertex_parts(package);
  return order_of_layers({body_template.anatomy, wall.mesh(), fat, parts});
}

ShownThrough measure_shown_through(const LayerOrder& reference, const LayeredBody& body) {
  if (reference.pairs.size() != std::size_t(body.wall.F.rows()))
    throw std::invalid_argument("measure_shown_through: the reference has another skin");
  const std::vector<int> places = places_in(reference.names, body.anatomy);
  const LayeredFlesh flesh(body.anatomy);
  const std::vector<UndersideSample> samples = samples_of(body);
  std::vector<int> shown(samples.size(), kNone);
  tbb::parallel_for(std::size_t{0}, samples.size(), [&](std::size_t k) {
    thread_local LayeredFlesh::Buffer buffer;
    flesh.look(samples[k], buffer);
    const Pairs& pairs = reference.pairs[std::size_t(samples[k].triangle)];
    for (std::size_t i = 1; i < buffer.met.size(); ++i) {
      const int outer = places[std::size_t(buffer.met[0].second)],
                inner = places[std::size_t(buffer.met[i].second)];
      if (std::ranges::binary_search(pairs, OrderedPair{inner, outer}) &&
          !std::ranges::binary_search(pairs, OrderedPair{outer, inner}))
        shown[k] = buffer.met[0].second;
    }
  });
  ShownThrough out;
  const std::size_t muscles = body.anatomy.muscles.size();
  out.muscles.assign(muscles, 0.0);
  out.bones.assign(body.anatomy.bones.size(), 0.0);
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (shown[k] == kNone || shown[k] >= int(muscles + out.bones.size())) continue;
    const std::size_t solid = std::size_t(shown[k]);
    out.area += samples[k].area;
    (solid < muscles ? out.muscles[solid] : out.bones[solid - muscles]) += samples[k].area;
  }
  const auto note = [&](double area, const std::string& name) {
    if (area > out.by_one) out.by_one = area, out.most = name;
  };
  for (std::size_t m = 0; m < muscles; ++m)
    if (lies_deep(body.anatomy.muscles[m])) note(out.muscles[m], body.anatomy.muscles[m].name);
  for (std::size_t b = 0; b < out.bones.size(); ++b) note(out.bones[b], body.anatomy.bones[b].name);
  return out;
}

}  // namespace ecorche::inline v1
