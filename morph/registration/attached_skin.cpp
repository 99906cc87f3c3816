#include "morph/registration/attached_skin.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/geometry/vertex_rings.h"
#include "anatomy/queries/nearest_surface.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kWeld = 1e-5;        // m; vertices nearer than this are one
constexpr double kSkinTight = 0.006;  // m; closer to the body, the nearest triangle alone
constexpr double kLoose = 0.025;      // m; further off, a mean alone
constexpr double kOtherSide = 0.012;  // m; how much further a surface counts that looks square to
                                      // the vertex's; twice that where it looks the other way
constexpr std::size_t kMostEntries = 16;  // of a row
constexpr int kRigidVertices = 24;        // base vertices that carry a rigid piece
constexpr double kSpeck = 0.1;  // share of a part's vertices below which an island on it is
                                // taken for a mistake
using Row = std::vector<std::pair<int, double>>;  // base vertex, weight

constexpr int kSides = 3, kLabels = 9 * kSides;  // parts of the body by sides
using Labels = std::bitset<kLabels>;

int label_of(const VertexPart& part) { return kSides * int(part.part) + int(part.side); }
int side_of(int label) { return label % kSides; }

Points vertex_directions(const TriMesh& mesh) {
  Points out = Points::Zero(mesh.V.rows(), 3);
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)),
               c = mesh.V.row(mesh.F(f, 2));
    const Eigen::RowVector3d n = (b - a).cross(c - a).transpose();
    for (int k = 0; k < 3; ++k) out.row(mesh.F(f, k)) += n;
  }
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    if (const double length = out.row(i).norm(); length > 1e-30) out.row(i) /= length;
  return out;
}

// Points by cells of a grid.
class PointGrid {
 public:
  PointGrid(const Points& points, double cell) : points_(points), cell_(cell) {
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      cells_[key(of(points.row(i)))].push_back(int(i));
  }

  // act(index, distance) for all points within `radius`, in no order.
  template <class Act>
  void within(const Vec3& p, double radius, const Act& act) const {
    const auto look_at = [&](int i) {
      if (const double d = (points_.row(i).transpose() - p).norm(); d <= radius) act(i, d);
    };
    const Eigen::Vector3i low = of(p - Vec3::Constant(radius)),
                          high = of(p + Vec3::Constant(radius));
    if ((high - low).cast<double>().array().prod() > double(points_.rows())) {
      for (int i = 0; i < int(points_.rows()); ++i) look_at(i);
      return;
    }
    for (int x = low.x(); x <= high.x(); ++x)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int z = low.z(); z <= high.z(); ++z) {
          const auto found = cells_.find(key({x, y, z}));
          if (found == cells_.end()) continue;
          for (const int i : found->second) look_at(i);
        }
  }

 private:
  Eigen::Vector3i of(const Vec3& p) const {
    return (p / cell_).array().floor().max(-1e6).min(1e6).cast<int>();
  }
  static std::int64_t key(const Eigen::Vector3i& c) {
    return (std::int64_t(c.x()) * 4194304 + c.y()) * 4194304 + c.z();
  }

  const Points& points_;
  double cell_;
  std::unordered_map<std::int64_t, std::vector<int>> cells_;
};

// The mesh with vertices at one place made one, but not across rigid pieces or sides.
struct Welded {
  TriMesh mesh;
  std::vector<int> of;     // #V of the mesh as it came
  std::vector<int> rigid;  // #V of `mesh`, as the next
  std::vector<int> own;    // label by the mesh's own rig, -1: not told
};

Welded weld(const StandingMesh& in) {
  Welded out;
  out.of.resize(in.mesh.V.rows());
  std::map<std::array<std::int64_t, 5>, int> known;
  std::vector<Vec3> places;
  for (Eigen::Index i = 0; i < in.mesh.V.rows(); ++i) {
    const Vec3 p = in.mesh.V.row(i);
    const int rigid = in.rigid.empty() ? -1 : in.rigid[std::size_t(i)];
    const int own =
        in.parts.empty() || !in.parts[std::size_t(i)] ? -1 : label_of(*in.parts[std::size_t(i)]);
    const std::array<std::int64_t, 5> at{std::llround(p.x() / kWeld), std::llround(p.y() / kWeld),
                                         std::llround(p.z() / kWeld), rigid,
                                         own < 0 ? -1 : side_of(own)};
    const auto [place, is_new] = known.emplace(at, int(places.size()));
    if (is_new) {
      places.push_back(p);
      out.rigid.push_back(rigid);
      out.own.push_back(own);
    }
    out.of[i] = place->second;
  }
  out.mesh.V.resize(places.size(), 3);
  for (std::size_t i = 0; i < places.size(); ++i) out.mesh.V.row(i) = places[i];
  out.mesh.F = in.mesh.F.unaryExpr([&](int v) { return out.of[v]; });
  return out;
}

class Attacher {
 public:
  Attacher(const Registration& registration, const Triangles& F,
           const std::vector<VertexPart>& parts, const Welded& welded)
      : base_{registration.posed, F},
        normals_(vertex_directions(base_)),
        surface_(base_),
        grid_(registration.posed, 0.02),
        rings_(vertex_neighbours(base_)),
        mesh_(welded.mesh),
        directions_(vertex_directions(mesh_)),
        neighbours_(vertex_neighbours(mesh_)),
        rigid_(welded.rigid),
        own_(welded.own) {
    faces_.resize(base_.V.rows());
    area_.assign(base_.V.rows(), 0);
    for (Eigen::Index f = 0; f < F.rows(); ++f) {
      const Vec3 a = base_.V.row(F(f, 0)), b = base_.V.row(F(f, 1)), c = base_.V.row(F(f, 2));
      for (int k = 0; k < 3; ++k) {
        faces_[F(f, k)].push_back(int(f));
        area_[F(f, k)] += (b - a).cross(c - a).norm() / 6;
      }
    }
    for (const VertexPart& part : parts) labels_.push_back(label_of(part));
    for (std::size_t v = 0; v < rings_.size(); ++v)
      for (const int other : rings_[v]) touching_[labels_[v]].set(labels_[other]);
    for (const int label : labels_) touching_[label].set(label);
  }

  void find(std::vector<Row>& rows, std::vector<double>& distance) {
    const std::size_t count = mesh_.V.rows();
    nearest_.assign(count, -1);
    distance.assign(count, 0);
    std::vector<int> sides(count, 0);  // 1: of the side that its rig tells, -1: of the other
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      const auto found = surface_.nearest(mesh_.V.row(i));
      distance[i] = found.distance;
      const int told = own_[i] < 0 ? 0 : side_of(own_[i]),
                side = side_of(labels_[base_.F(found.triangle, 0)]);
      if (told != 0 && side != 0) sides[i] = told == side ? 1 : -1;
    });
    if (std::accumulate(sides.begin(), sides.end(), 0) < 0) std::ranges::fill(own_, -1);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      nearest_[i] = best_vertex(int(i), distance[i], allowed(i));
    });
    for (int round = 0; round < 3 && !mend_islands(distance); ++round) {
    }
    rows.resize(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (rigid_[i] < 0) rows[i] = row_of(int(i), distance[i]);
    });
    smooth(rows, distance);
    find_rigid(rows, distance);
  }

 private:
  // Labels that the vertex may hang on.
  Labels allowed(std::size_t i) const { return own_[i] < 0 ? Labels().set() : touching_[own_[i]]; }

  // Nearest to the vertex of the labels allowed, where surfaces that look elsewhere count as
  // further off.
  int best_vertex(int i, double distance, const Labels& allowed) const {
    constexpr double kMost = 4;
    const auto reach_of = [](double d) { return 1.6 * d + 0.03; };
    const Vec3 p = mesh_.V.row(i), n = directions_.row(i);
    int best = -1;
    for (double reach = reach_of(distance); reach < kMost;) {
      double least = 1e30, near = 1e30;
      grid_.within(p, reach, [&](int b, double d) {
        if (!allowed[labels_[b]]) return;
        near = std::min(near, d);
        const double against = 1 - n.dot(normals_.row(b));  // 0 .. 2
        const double cost = d * (1 + against) + kOtherSide * against;
        if (cost < least || (cost == least && b < best)) least = cost, best = b;
      });
      if (best >= 0 && reach >= reach_of(near)) break;
      reach = best >= 0 ? reach_of(near) : 2 * reach;
    }
    if (best >= 0) return best;
    const int f = surface_.nearest(p).triangle;
    return base_.F(f, 0);
  }

  // Small islands on a part that does not touch the one around them, such as a spot of the trunk on
  // an arm that hangs beside it. Returns whether there was nothing to mend.
  bool mend_islands(const std::vector<double>& distance) {
    const std::size_t count = nearest_.size();
    std::vector<int> island(count, -1);
    std::vector<std::vector<int>> members;
    for (std::size_t seed = 0; seed < count; ++seed) {
      if (island[seed] >= 0 || rigid_[seed] >= 0) continue;
      const int id = int(members.size()), label = labels_[nearest_[seed]];
      members.push_back({int(seed)});
      island[seed] = id;
      for (std::size_t at = 0; at < members[id].size(); ++at)
        for (const int other : neighbours_[members[id][at]])
          if (island[other] < 0 && rigid_[other] < 0 && labels_[nearest_[other]] == label) {
            island[other] = id;
            members[id].push_back(other);
          }
    }
    bool whole = true;
    std::vector<std::pair<int, Labels>> wrong;  // island, labels it may have
    for (std::size_t id = 0; id < members.size(); ++id) {
      const int label = labels_[nearest_[members[id][0]]];
      int host = -1;
      for (const int v : members[id])
        for (const int other : neighbours_[v]) {
          const int at = island[other];
          if (at < 0 || at == int(id) || touching_[label][labels_[nearest_[other]]]) continue;
          if (host < 0 || members[at].size() > members[host].size()) host = at;
        }
      if (host < 0 || double(members[id].size()) > kSpeck * double(members[host].size())) continue;
      wrong.push_back({int(id), touching_[labels_[nearest_[members[host][0]]]]});
      whole = false;
    }
    for (const auto& [id, around] : wrong)
      for (const int v : members[id]) {
        const Labels both = around & allowed(v);
        nearest_[v] = best_vertex(v, distance[v], both.any() ? both : allowed(v));
      }
    return whole;
  }

  // Place on the nearest of the triangles about the vertex chosen.
  Row on_surface(int i, double& distance) const {
    const Vec3 p = mesh_.V.row(i);
    const Labels may = allowed(i);
    std::set<int> near(faces_[nearest_[i]].begin(), faces_[nearest_[i]].end());
    for (const int other : rings_[nearest_[i]])
      near.insert(faces_[other].begin(), faces_[other].end());
    Row out;
    double least = 1e30;
    for (const int f : near) {
      if (!may[labels_[base_.F(f, 0)]] || !may[labels_[base_.F(f, 1)]] ||
          !may[labels_[base_.F(f, 2)]])
        continue;
      const Vec3 a = base_.V.row(base_.F(f, 0)), b = base_.V.row(base_.F(f, 1)),
                 c = base_.V.row(base_.F(f, 2));
      const Vec3 q = nearest_in_triangle(p, a, b, c);
      const double d = (q - p).squaredNorm();
      if (d >= least) continue;
      const Vec3 n = (b - a).cross(c - a);
      const double whole = n.squaredNorm();
      if (whole < 1e-24) continue;
      double u = std::max(0.0, (c - b).cross(q - b).dot(n) / whole),
             v = std::max(0.0, (a - c).cross(q - c).dot(n) / whole),
             w = std::max(0.0, (b - a).cross(q - a).dot(n) / whole);
      const double sum = u + v + w;
      least = d;
      out = {{base_.F(f, 0), u / sum}, {base_.F(f, 1), v / sum}, {base_.F(f, 2), w / sum}};
    }
    if (out.empty()) {
      least = (base_.V.row(nearest_[i]).transpose() - p).squaredNorm();
      out = {{nearest_[i], 1}};
    }
    distance = std::sqrt(least);
    return out;
  }

  // Mean over what is about as near as the nearest place, with normals that agree.
  Row mean_about(int i, double distance) const {
    const Vec3 p = mesh_.V.row(i), n = directions_.row(i);
    const double width = 0.6 * distance, nearest = distance * distance;
    const Labels &beside = touching_[labels_[nearest_[i]]], may = allowed(i);
    Row out;
    grid_.within(p, std::sqrt(nearest + 9 * width * width), [&](int b, double d) {
      if (!may[labels_[b]]) return;
      const double agree = 0.02 + std::max(0.0, n.dot(normals_.row(b)));
      const double part = beside[labels_[b]] ? 1 : distance > 0.1 ? 0.5 : 0;
      const double weight =
          part * area_[b] * agree * std::exp(-(d * d - nearest) / (width * width));
      if (weight > 0) out.push_back({b, weight});
    });
    return out;
  }

  static void tidy(Row& row) {
    std::sort(row.begin(), row.end());
    std::size_t last = 0;
    for (std::size_t k = 1; k < row.size(); ++k)
      if (row[k].first == row[last].first)
        row[last].second += row[k].second;
      else
        row[++last] = row[k];
    if (!row.empty()) row.resize(last + 1);
    if (row.size() > kMostEntries) {
      std::nth_element(row.begin(), row.begin() + kMostEntries, row.end(),
                       [](const auto& a, const auto& b) { return a.second > b.second; });
      const double cut = row[kMostEntries].second;  // taken from all, so that none jumps to zero
      row.resize(kMostEntries);
      for (auto& [b, weight] : row) weight -= cut;
      std::sort(row.begin(), row.end());
    }
    double sum = 0;
    for (const auto& [b, weight] : row) sum += weight;
    if (!(sum > 0)) {
      for (auto& [b, weight] : row) weight = 1;
      sum = double(row.size());
    }
    std::erase_if(row, [&](const auto& entry) { return entry.second < 1e-5 * sum; });
    sum = 0;
    for (const auto& [b, weight] : row) sum += weight;
    for (auto& [b, weight] : row) weight /= sum;
  }

  static double looseness(double distance) {
    const double t = std::clamp((distance - kSkinTight) / (kLoose - kSkinTight), 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }

  // `distance`: becomes that from the place chosen.
  Row row_of(int i, double& distance) const {
    Row out = on_surface(i, distance);
    const double loose = looseness(distance);
    if (loose > 0) {
      Row mean = mean_about(i, distance);
      double sum = 0;
      for (const auto& [b, weight] : mean) sum += weight;
      if (sum > 0) {
        for (auto& [b, weight] : out) weight *= 1 - loose;
        for (const auto& [b, weight] : mean) out.push_back({b, loose * weight / sum});
      }
    }
    tidy(out);
    return out;
  }

  // What is loose takes part of its neighbours' rows.
  void smooth(std::vector<Row>& rows, const std::vector<double>& distance) const {
    constexpr int kRounds = 4;
    std::vector<Row> next(rows.size());
    for (int round = 0; round < kRounds; ++round) {
      tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
        next[i] = rows[i];
        const double share = 0.6 * looseness(distance[i]);
        std::size_t around = 0;
        for (const int other : neighbours_[i]) around += rigid_[other] < 0;
        if (share <= 0 || around == 0 || rigid_[i] >= 0) return;
        for (auto& [b, weight] : next[i]) weight *= 1 - share;
        for (const int other : neighbours_[i])
          if (rigid_[other] < 0)
            for (const auto& [b, weight] : rows[other])
              next[i].push_back({b, share / double(around) * weight});
        tidy(next[i]);
      });
      rows.swap(next);
    }
  }

  // A piece that moves as one goes with what lies about its vertex that is nearest to the body.
  void find_rigid(std::vector<Row>& rows, const std::vector<double>& distance) const {
    std::map<int, int> nearest;  // piece -> vertex
    for (std::size_t i = 0; i < rigid_.size(); ++i) {
      if (rigid_[i] < 0) continue;
      const auto [at, is_new] = nearest.emplace(rigid_[i], int(i));
      if (!is_new && distance[i] < distance[at->second]) at->second = int(i);
    }
    std::map<int, Row> carriers;
    for (const auto& [piece, vertex] : nearest) {
      const Vec3 p = base_.V.row(nearest_[vertex]);
      std::vector<std::pair<double, int>> near;
      for (double reach = 0.03; near.size() < std::size_t(kRigidVertices) && reach < 4;
           reach *= 1.5) {
        near.clear();
        grid_.within(p, reach, [&](int b, double d) {
          if (touching_[labels_[nearest_[vertex]]][labels_[b]]) near.push_back({d, b});
        });
      }
      std::sort(near.begin(), near.end());
      near.resize(std::min(near.size(), std::size_t(kRigidVertices)));
      Row& row = carriers[piece];
      for (const auto& [d, b] : near) row.push_back({b, 1.0 / double(near.size())});
      std::sort(row.begin(), row.end());
    }
    for (std::size_t i = 0; i < rigid_.size(); ++i)
      if (rigid_[i] >= 0) rows[i] = carriers[rigid_[i]];
  }

  TriMesh base_;
  Points normals_;
  NearestSurface surface_;
  PointGrid grid_;
  std::vector<std::vector<int>> rings_;
  const TriMesh& mesh_;
  Points directions_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<std::vector<int>> faces_;
  std::vector<double> area_;
  const std::vector<int>& rigid_;
  std::vector<int> own_;                    // label of each vertex by the mesh's own rig, -1
  std::vector<int> labels_;                 // part and side of base vertices
  std::array<Labels, kLabels> touching_{};  // labels that share an edge of the base mesh
  std::vector<int> nearest_;                // base vertex of each vertex
};

// posed = turn rest + shift, blended over a row.
struct BlendedMap {
  Mat3 turn = Mat3::Zero();
  Vec3 shift = Vec3::Zero();
};

BlendedMap blended_map(const Registration& registration,
                       const Eigen::SparseMatrix<double, Eigen::RowMajor>& map, Eigen::Index i) {
  BlendedMap out;
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(map, i); it; ++it) {
    const Mat3& turn = registration.turn[it.col()];
    const Vec3 rest = registration.body.skin.V.row(it.col()),
               posed = registration.posed.row(it.col());
    out.turn += it.value() * turn;
    out.shift += it.value() * (posed - turn * rest);
  }
  return out;
}

}  // namespace

AttachedSkin attach_skin(const Registration& registration, const Triangles& base_triangles,
                         const std::vector<VertexPart>& parts, const StandingMesh& mesh) {
  const Eigen::Index count = mesh.mesh.V.rows();
  if (count == 0) throw UnfitError("the character's mesh has no vertices");
  const Welded welded = weld(mesh);
  std::vector<Row> rows;
  std::vector<double> distance;
  Attacher(registration, base_triangles, parts, welded).find(rows, distance);
  const auto far = std::count_if(distance.begin(), distance.end(), [](double d) { return d > 1; });
  if (2 * std::size_t(far) > distance.size())
    throw UnfitError(fmt::format(
        "{} of the mesh's {} vertices lie more than a metre from the body that was found in it",
        far, distance.size()));
  AttachedSkin out;
  std::vector<Eigen::Triplet<double>> entries;
  out.distance.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    out.distance[i] = distance[welded.of[i]];
    for (const auto& [b, weight] : rows[welded.of[i]]) entries.emplace_back(int(i), b, weight);
  }
  out.map.resize(count, registration.posed.rows());
  out.map.setFromTriplets(entries.begin(), entries.end());
  out.rest.resize(count, 3);
  tbb::parallel_for(Eigen::Index{0}, count, [&](Eigen::Index i) {
    const BlendedMap map = blended_map(registration, out.map, i);
    const Vec3 posed = mesh.mesh.V.row(i);
    out.rest.row(i) = map.turn.inverse() * (posed - map.shift);
  });
  return out;
}

Points stand_again(const Registration& registration,
                   const Eigen::SparseMatrix<double, Eigen::RowMajor>& map, const Points& rest) {
  Points out(rest.rows(), 3);
  tbb::parallel_for(Eigen::Index{0}, rest.rows(), [&](Eigen::Index i) {
    const BlendedMap blended = blended_map(registration, map, i);
    out.row(i) = blended.turn * rest.row(i).transpose() + blended.shift;
  });
  return out;
}

}  // namespace ecorche::inline v1
