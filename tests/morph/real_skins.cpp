#include "tests/morph/real_skins.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/geometry/self_intersections.h"
#include "anatomy/geometry/vertex_rings.h"
#include "anatomy/queries/ray_caster.h"

namespace ecorche {
namespace {

constexpr double kMirrored = 0.6;      // share of the variance
constexpr int kWaves = 48;             // of a field: fewer, and its values are not normal
constexpr int kBlends = 12;            // rounds in which regions are blended into one another
constexpr int kSmoothNormals = 4;      // rounds: small features move as wholes
constexpr double kOfThickness = 0.25;  // inwards at most, of the thickness there, once scaled
constexpr double kOfGap = 0.35;        // outwards at most, of the gap to other skin
constexpr double kTaken = 1.06;  // given more, for what is taken back where skin would cross itself

using Vector = Eigen::VectorXd;

int region(const char* name) {
  for (std::size_t k = 0; k < kSkinResiduals.size(); ++k)
    if (std::string_view(kSkinResiduals[k].region) == name) return int(k);
  return -1;
}

// By the parts of the body and how near joints are, on the package's undeformed skin.
std::vector<int> regions_of(const BodyPackage& package) {
  std::map<std::string, Vec3> marks;
  for (const Landmark& cube : joint_cubes(package, package.points))
    marks[cube.name] = cube.position;
  const double size = package.points.topRows(package.skin_size).col(1).maxCoeff() -
                      package.points.topRows(package.skin_size).col(1).minCoeff();
  const std::vector<VertexPart> parts = vertex_parts(package);
  std::vector<int> out(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    Vec3 x = package.points.row(Eigen::Index(i));
    x.x() = std::abs(x.x());
    const auto near = [&](const char* mark, double reach) {
      return (x - marks.at(mark)).norm() < reach * size;
    };
    const auto pick = [&]() -> const char* {
      switch (parts[i].part) {
        case BodyPart::head:
        case BodyPart::neck:
          return "head_neck";
        case BodyPart::trunk:
          if (near("joint-l-shoulder", 0.08)) return "shoulder";
          return x.y() < marks.at("joint-l-upper-leg").y() + 0.06 * size ? "hip" : "torso";
        case BodyPart::upper_arm:
          if (near("joint-l-shoulder", 0.08)) return "shoulder";
          return near("joint-l-elbow", 0.04) ? "elbow" : "upper_arm";
        case BodyPart::forearm:
          return near("joint-l-elbow", 0.04) ? "elbow" : "forearm";
        case BodyPart::hand:
          return "hand";
        case BodyPart::thigh:
          if (near("joint-l-upper-leg", 0.08)) return "hip";
          return near("joint-l-knee", 0.05) ? "knee" : "thigh";
        case BodyPart::shank:
          return near("joint-l-knee", 0.05) ? "knee" : "shin";
        case BodyPart::foot:
          return "foot";
      }
      return "torso";
    };
    out[i] = region(pick());
  }
  // what the cavities' quads alone hold lies behind lips and lids
  std::set<int> behind, seen;
  for (const Cavity& cavity : package.cavities) {
    for (const int q : cavity.quads)
      for (int k = 0; k < 4; ++k) behind.insert(package.quads(q, k));
    seen.insert(cavity.loop.begin(), cavity.loop.end());
  }
  for (const int i : behind)
    if (!seen.contains(i)) out[std::size_t(i)] = -1;
  return out;
}

template <typename Rows>
void smooth(const std::vector<std::vector<int>>& rings, int rounds, Rows& values) {
  for (int round = 0; round < rounds; ++round) {
    const Rows before = values;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      if (rings[i].empty()) continue;
      auto sum = before.row(Eigen::Index(i)).eval();
      for (const int n : rings[i]) sum += before.row(n);
      values.row(Eigen::Index(i)) = sum / double(rings[i].size() + 1);
    }
  }
}

// A smooth random field of standard normal values, whose correlation falls as exp(-d^2 / length^2).
Vector waves(const Points& V, double length, std::mt19937& random) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> phase(0, 2 * M_PI);
  Vector sum = Vector::Zero(V.rows());
  for (int k = 0; k < kWaves; ++k) {
    const double x = normal(random), y = normal(random), z = normal(random);
    const Vec3 wave = std::sqrt(2) / length * Vec3(x, y, z);
    sum.array() += ((V * wave).array() + phase(random)).cos();
  }
  return std::sqrt(2.0 / kWaves) * sum;
}

// How far a ray runs to other skin: through the body (-1) or through the air (+1), m.
Vector room(const SkinRays& rays, const Points& V, const Points& normals, double side) {
  constexpr double kFrom = 0.5e-3, kFar = 0.3;  // m
  Vector out(V.rows());
  for (Eigen::Index i = 0; i < V.rows(); ++i) {
    const Vec3 n = side * Vec3(normals.row(i));
    out[i] = kFar;
    if (n.squaredNorm() < 0.5) continue;
    const RayHit hit = rays.first_hit(V.row(i), n, kFar, kFrom);
    if (hit.triangle >= 0) out[i] = double(hit.distance);
  }
  return out;
}

// Vertices of edges that pass through triangles which they have no corner of.
std::vector<bool> crossing_vertices(const TriMesh& skin) {
  std::vector<bool> out(skin.V.rows(), false);
  const SkinRays rays(skin, RayBuild::quick);
  for (Eigen::Index f = 0; f < skin.F.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = skin.F(f, k), b = skin.F(f, (k + 1) % 3);
      if (a > b) continue;
      const Vec3 edge = skin.V.row(b) - skin.V.row(a);
      const double length = edge.norm();
      if (length == 0) continue;
      const RayHit hit =
          rays.first_hit(skin.V.row(a), edge / length, 0.995 * length, 0.005 * length);
      if (hit.triangle < 0) continue;
      const auto corners = skin.F.row(hit.triangle);
      if ((corners.array() == a).any() || (corners.array() == b).any()) continue;
      for (const int i : {a, b, corners[0], corners[1], corners[2]}) out[i] = true;
    }
  return out;
}

BodySpec draw(std::mt19937& random) {
  std::uniform_real_distribution<> unit(0, 1);
  std::normal_distribution<> normal;
  BodySpec spec;
  spec.sex = unit(random) < 0.5 ? Sex::male : Sex::female;
  spec.age = 18 + std::floor(68 * unit(random));
  const double height =
      (spec.sex == Sex::male ? 1.755 : 1.625) + 0.067 * std::clamp(normal(random), -2.2, 2.2);
  spec.height = height;
  // as people are: most between 20 and 32, some from 17 to 42
  const double index = unit(random) < 0.6 ? 20 + 12 * unit(random) : 17 + 25 * unit(random);
  spec.mass = index * height * height;
  return spec;
}

}  // namespace

RealSkins::RealSkins(const BodyModel& model)
    : model_(model), regions_(regions_of(model.package())) {
  const BodyPackage& package = model.package();
  const Eigen::Index n = package.skin_size;
  rings_ = vertex_neighbours(skin_mesh(package, package.points));
  for (const SkinResidual& r : kSkinResiduals) {
    const double length = std::max(r.length, kShortestField);
    if (std::find(lengths_.begin(), lengths_.end(), length) == lengths_.end())
      lengths_.push_back(length);
    const std::size_t k = std::size_t(&r - kSkinResiduals.data());
    mean_of_[k] = r.mean;
    sd_of_[k] = r.sd;
  }
  share_ = Eigen::MatrixXd::Zero(n, Eigen::Index(lengths_.size()));
  for (Eigen::Index i = 0; i < n; ++i) {
    const int r = std::max(regions_[std::size_t(i)], 0);
    const double length = std::max(kSkinResiduals[std::size_t(r)].length, kShortestField);
    share_(i, std::find(lengths_.begin(), lengths_.end(), length) - lengths_.begin()) = 1;
  }
  smooth(rings_, kBlends, share_);
  share_ = share_.cwiseSqrt();
  calibrate();
}

Vector RealSkins::field(const Points& V, unsigned seed) const {
  Vector out = Vector::Zero(V.rows());
  Points other = V;
  other.col(0) = -other.col(0);
  for (std::size_t k = 0; k < lengths_.size(); ++k) {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      if (share_(i, Eigen::Index(k)) > 0) rows.push_back(i);
    const Points here = V(rows, Eigen::all), there = other(rows, Eigen::all);
    const double length = lengths_[k];
    std::mt19937 random(seed + 7919 * unsigned(k)), again = random;
    const Vector even = waves(here, length, random) + waves(there, length, again);
    const Vector own = waves(here, length, random);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      const double apart = 2 * here(Eigen::Index(j), 0) / length;
      const double spread = std::sqrt(2 * (1 + std::exp(-apart * apart)));
      out[rows[j]] += share_(rows[j], Eigen::Index(k)) *
                      (std::sqrt(kMirrored) * even[Eigen::Index(j)] / spread +
                       std::sqrt(1 - kMirrored) * own[Eigen::Index(j)]);
    }
  }
  return out;
}

Vector RealSkins::displacement(const Points& V, double scale, unsigned seed, const Vector& inwards,
                               const Vector& outwards) const {
  Vector d = scale * (mean_ + sd_.cwiseProduct(field(V, seed)));
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    const double most = d[i] < 0 ? kOfThickness * inwards[i] : kOfGap * outwards[i];
    d[i] = most > 0 ? most * std::tanh(d[i] / most) : 0;
  }
  smooth(rings_, 1, d);
  return d;
}

// Blending and limits narrow the spread of some regions: these are given more.
void RealSkins::calibrate() {
  constexpr int kRounds = 4;
  constexpr unsigned kSkins = 12;
  const BodyPackage& package = model_.package();
  ShapeSpec spec;
  const TriMesh skin = shape_body(package, spec).body.skin;
  const SkinRays rays(skin);
  const Points normals = vertex_normals(skin);
  const Vector inwards = room(rays, skin.V, normals, -1), outwards = room(rays, skin.V, normals, 1);
  std::array<double, 12> mean = mean_of_, sd = sd_of_;
  for (int round = 0; round <= kRounds; ++round) {
    mean_.resize(skin.V.rows());
    sd_.resize(skin.V.rows());
    for (Eigen::Index i = 0; i < skin.V.rows(); ++i) {
      const std::size_t r = std::size_t(std::max(regions_[std::size_t(i)], 0));
      mean_[i] = mean[r];
      sd_[i] = sd[r];
    }
    smooth(rings_, kBlends, mean_);
    smooth(rings_, kBlends, sd_);
    if (round == kRounds) break;
    std::array<double, 12> count{}, sum{}, squares{};
    for (unsigned k = 0; k < kSkins; ++k) {
      const double scale = 0.5 + (k + 0.5) / kSkins;
      const Vector d = displacement(skin.V, scale, 1000 + k, inwards, outwards);
      for (Eigen::Index i = 0; i < d.size(); ++i) {
        const int r = regions_[std::size_t(i)];
        if (r < 0) continue;
        count[std::size_t(r)] += 1;
        sum[std::size_t(r)] += d[i];
        squares[std::size_t(r)] += d[i] * d[i];
      }
    }
    for (std::size_t r = 0; r < count.size(); ++r) {
      const double m = sum[r] / count[r], s = std::sqrt(squares[r] / count[r] - m * m);
      mean[r] += kSkinResiduals[r].mean - m;
      sd[r] *= std::clamp(kTaken * kSkinResiduals[r].sd / s, 0.7, 1.4);
    }
  }
}

RealSkin RealSkins::make(unsigned seed) const {
  const BodyPackage& package = model_.package();
  std::mt19937 random(seed);
  RealSkin out;
  Body body;
  for (bool made = false; !made;) {
    out.spec = draw(random);
    try {
      body = make_body(model_, out.spec);
      made = true;
    } catch (const UnfitError&) {  // no such person: another is drawn
    }
  }
  out.scale = std::uniform_real_distribution<>(0.5, 1.5)(random);
  const TriMesh skin{body.skin.V.topRows(package.skin_size), package.triangles};
  const SkinRays rays(skin);
  const Points straight = vertex_normals(skin);
  out.moved = displacement(skin.V, out.scale, unsigned(random()), room(rays, skin.V, straight, -1),
                           room(rays, skin.V, straight, 1));
  Points normals = straight;
  smooth(rings_, kSmoothNormals, normals);
  normals.rowwise().normalize();

  const TriMesh closed = capped_skin(package, skin.V);
  Vector share = Vector::Ones(skin.V.rows());
  const auto moved = [&]() -> Points {
    Points V = skin.V;
    for (Eigen::Index i = 0; i < V.rows(); ++i)
      V.row(i) += share[i] * out.moved[i] * normals.row(i);
    return V;
  };
  // Where skin crosses itself as the body's does not, it is moved less.
  constexpr int kRounds = 16, kNear = 3;
  constexpr double kLess = 0.5;
  const int allowed = count_self_intersections(closed.F, closed.V);
  const std::vector<bool> before = crossing_vertices(closed);
  for (int round = 0; round < kRounds; ++round) {
    const TriMesh now = capped_skin(package, moved());
    if (count_self_intersections(now.F, now.V) <= allowed) break;
    const std::vector<bool> crossing = crossing_vertices(now);
    Vector less = Vector::Ones(share.size());
    bool any = false;
    for (Eigen::Index i = 0; i < less.size(); ++i)
      if (crossing[i] && (!before[i] || round >= kRounds / 2)) less[i] = kLess, any = true;
    if (!any) less.setConstant(0.9);
    for (int k = 0; k < kNear; ++k)
      for (Eigen::Index i = 0; i < less.size(); ++i)
        for (const int n : rings_[i]) less[i] = std::min(less[i], 0.5 * (1 + less[n]));
    share = share.cwiseProduct(less);
  }
  out.moved = out.moved.cwiseProduct(share);
  share.setOnes();
  out.body = body;
  out.body.skin = {moved(), package.triangles};
  out.body.landmarks.clear();
  out.body.mass = 0;
  out.body.name = fmt::format("real{:03}", seed);
  return out;
}

}  // namespace ecorche
