#include "morph/measures/tape_measure.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "anatomy/base_mesh/body_rig.h"
#include "anatomy/errors.h"
#include "anatomy/files/quantity.h"
#include "morph/measures/body_volume.h"
#include "morph/measures/measure_plane.h"

namespace ecorche::inline v1 {
namespace {

bool is_section(const Measure& m) {
  return m.kind == MeasureKind::girth || m.kind == MeasureKind::breadth ||
         m.kind == MeasureKind::depth;
}

}  // namespace

TapeMeasure::TapeMeasure(const BodyPackage& package, MeasureTable table)
    : table_(std::move(table)), mesh_(make_section_mesh(package.triangles)) {
  base_ = package.points.topRows(package.skin_size);
  build_parts(package);
  build_chains(package.points);
  capped_ = capped_skin(package, package.points).F;
  for (const auto& cavity : package.cavities) caps_.push_back(cavity.loop);
}

double TapeMeasure::parse(int k, std::string_view text, const std::string& what) const {
  const Measure& m = measure(k);
  if (m.kind == MeasureKind::mass) return parse_mass(text, what, 2, 400);
  if (m.kind == MeasureKind::ahead) return parse_length(text, what, {-0.5, 0.5}, {-0.5, 0.5});
  const double usual = take(k, base_);
  const bool round = m.kind == MeasureKind::girth || m.kind == MeasureKind::breadth ||
                     m.kind == MeasureKind::depth;
  return parse_length(text, what, {usual / 4, (round ? 3 : 1.6) * usual},
                      {usual / 2, (round ? 2 : 1.35) * usual});
}

// A loop is looked for on the part of the body that carries its first landmark, the joint next to
// it included.
void TapeMeasure::build_parts(const BodyPackage& package) {
  const std::vector<VertexPart> parts = vertex_parts(package);
  const auto part = [&parts](int vertex) { return parts[vertex]; };
  for (int v = 0; v < package.skin_size; ++v) {
    mesh_.arm.push_back(part(v).part == BodyPart::upper_arm || part(v).part == BodyPart::forearm ||
                        part(v).part == BodyPart::hand);
    if (part(v).part == BodyPart::foot) soles_.push_back(v);
  }
  starts_.resize(table_.measures.size());
  for (std::size_t k = 0; k < starts_.size(); ++k) {
    const Measure& m = table_.measures[k];
    if (!is_section(m)) continue;
    const Vec3 origin = package.points.row(m.vertices[0]);
    for (int f = 0; f < mesh_.triangles.rows(); ++f) {
      bool close = false;
      for (int e = 0; e < 3; ++e)
        close = close || (package.points.row(mesh_.triangles(f, e)).transpose() - origin).norm() <
                             0.03 + m.reach;
      if (close) starts_[k].push_back(f);
    }
  }
}

// Points where a plane through both vertices cuts edges on the shorter way between them: of planes
// turned about the line between them, the one with the shortest way, as a tape would slip. On the
// mid-line that is the plane of symmetry.
std::vector<TapeMeasure::EdgePoint> TapeMeasure::chain(const Points& V, int from, int to) const {
  const auto point = [&V](int v) -> Vec3 { return V.row(v); };
  const Vec3 along = (point(to) - point(from)).normalized();
  const bool middle = std::abs(point(from).x()) < 1e-9 && std::abs(point(to).x()) < 1e-9;
  std::vector<int> around;
  for (int f = 0; f < mesh_.triangles.rows(); ++f)
    if ((mesh_.triangles.row(f).array() == from).any()) around.push_back(f);
  std::vector<EdgePoint> best;
  double best_length = 1e9;
  std::vector<SkinCrossing> loop;
  constexpr int kTurns = 24;
  for (int turn = 0; turn < (middle ? 1 : kTurns); ++turn) {
    const Vec3 normal =
        middle ? Vec3(Vec3::UnitX())
               : Eigen::AngleAxisd(M_PI * turn / kTurns, along) * along.unitOrthogonal();
    cut_loop(mesh_, around, V, point(from), normal, point(from), loop);
    shorter_way(loop, V, from, to, best, best_length);
  }
  if (best.empty())
    throw UnfitError(
        fmt::format("no way over the skin from vertex {} to vertex {}; choose landmarks of one "
                    "part of the body",
                    from, to));
  return best;
}

void TapeMeasure::shorter_way(const std::vector<SkinCrossing>& loop, const Points& V, int from,
                              int to, std::vector<EdgePoint>& best, double& best_length) {
  const auto nearest = [&loop, &V](int v) {
    const auto farther = [p = Vec3(V.row(v))](const SkinCrossing& a, const SkinCrossing& b) {
      return (a.point - p).squaredNorm() < (b.point - p).squaredNorm();
    };
    return std::size_t(std::min_element(loop.begin(), loop.end(), farther) - loop.begin());
  };
  if (loop.size() < 3) return;
  const std::size_t n = loop.size(), i = nearest(from), j = nearest(to);
  if ((loop[j].point - V.row(to).transpose()).norm() > 0.005) return;
  for (const std::size_t step : {std::size_t{1}, n - 1}) {
    std::vector<EdgePoint> way{{from, from, 0}};
    double length = 0;
    for (std::size_t before = i, at = (i + step) % n; before != j;
         before = at, at = (at + step) % n) {
      length += (loop[at].point - loop[before].point).norm();
      if (at != j) way.push_back({loop[at].a, loop[at].b, loop[at].t});
    }
    way.push_back({to, to, 0});
    if (length < best_length) best_length = length, best = way;
  }
}

void TapeMeasure::build_chains(const Points& base) {
  chains_.resize(table_.measures.size());
  for (std::size_t k = 0; k < chains_.size(); ++k) {
    const Measure& m = table_.measures[k];
    if (m.kind != MeasureKind::path) continue;
    for (std::size_t i = 0; i + 1 < m.vertices.size(); ++i) {
      const auto piece = chain(base, m.vertices[i], m.vertices[i + 1]);
      chains_[k].insert(chains_[k].end(), piece.begin() + (i > 0 ? 1 : 0), piece.end());
    }
  }
}

double TapeMeasure::take(int k, const Points& V, MeasureGradient* gradient,
                         TapeTrace* trace) const {
  if (gradient != nullptr) gradient->clear();
  if (trace != nullptr) trace->clear();
  const Measure& m = measure(k);
  switch (m.kind) {
    case MeasureKind::height:
      return take_height(m, V, gradient, trace);
    case MeasureKind::mass:
      return take_mass(V, gradient);
    case MeasureKind::path:
      return take_path(k, V, gradient, trace);
    case MeasureKind::girth:
    case MeasureKind::breadth:
    case MeasureKind::depth:
      return take_section(mesh_, m, starts_[k], V, gradient, trace);
    case MeasureKind::distance: {
      const Vec3 a = V.row(m.vertices[0]), b = V.row(m.vertices[1]);
      const double length = (b - a).norm();
      if (gradient != nullptr)
        *gradient = {{m.vertices[1], (b - a) / length}, {m.vertices[0], (a - b) / length}};
      if (trace != nullptr) trace->push_back({a, b});
      return length;
    }
    case MeasureKind::ahead: {
      const Vec3 a = V.row(m.vertices[0]), b = V.row(m.vertices[1]);
      if (gradient != nullptr)
        *gradient = {{m.vertices[0], Vec3::UnitZ()}, {m.vertices[1], -Vec3::UnitZ()}};
      if (trace != nullptr) trace->push_back({b, Vec3(b.x(), b.y(), a.z())});
      return a.z() - b.z();
    }
    case MeasureKind::sum: {
      double sum = 0;
      MeasureGradient part;
      TapeTrace lines;
      for (const Term& term : m.terms) {
        sum += term.factor * take(term.measure, V, gradient != nullptr ? &part : nullptr,
                                  trace != nullptr ? &lines : nullptr);
        for (const auto& [vertex, g] : part) gradient->emplace_back(vertex, term.factor * g);
        if (trace != nullptr) trace->insert(trace->end(), lines.begin(), lines.end());
      }
      return sum;
    }
  }
  return 0;
}

std::vector<double> TapeMeasure::take_all(const Points& V) const {
  std::vector<double> out;
  for (int k = 0; k < count(); ++k) out.push_back(take(k, V));
  return out;
}

double TapeMeasure::take_height(const Measure& m, const Points& V, MeasureGradient* gradient,
                                TapeTrace* trace) const {
  const int sole = *std::min_element(soles_.begin(), soles_.end(),
                                     [&V](int a, int b) { return V(a, 1) < V(b, 1); });
  const int top = m.vertices[0];
  if (gradient != nullptr) *gradient = {{top, Vec3::UnitY()}, {sole, -Vec3::UnitY()}};
  if (trace != nullptr) trace->push_back({V.row(top), Vec3(V(top, 0), V(sole, 1), V(top, 2))});
  return V(top, 1) - V(sole, 1);
}

double TapeMeasure::take_mass(const Points& V, MeasureGradient* gradient) const {
  const int skin = int(capped_.maxCoeff()) + 1 - int(caps_.size());
  std::vector<Vec3> centres;
  for (const auto& rim : caps_) {
    Vec3 centre = Vec3::Zero();
    for (int v : rim) centre += V.row(v).transpose() / double(rim.size());
    centres.push_back(centre);
  }
  const auto point = [&](int v) -> Vec3 { return v < skin ? Vec3(V.row(v)) : centres[v - skin]; };
  double volume = 0;
  std::vector<Vec3> by_vertex(gradient != nullptr ? std::size_t(skin) + caps_.size() : 0,
                              Vec3::Zero());
  for (Eigen::Index f = 0; f < capped_.rows(); ++f) {
    const int i = capped_(f, 0), j = capped_(f, 1), l = capped_(f, 2);
    const Vec3 a = point(i), b = point(j), c = point(l), ab = a.cross(b);
    volume += ab.dot(c) / 6;
    if (gradient == nullptr) continue;
    by_vertex[i] += b.cross(c) / 6;
    by_vertex[j] += c.cross(a) / 6;
    by_vertex[l] += ab / 6;
  }
  if (gradient != nullptr) {
    for (std::size_t c = 0; c < caps_.size(); ++c)
      for (int v : caps_[c]) by_vertex[v] += by_vertex[skin + c] / double(caps_[c].size());
    for (int v = 0; v < skin; ++v)
      if (!by_vertex[v].isZero(0)) gradient->emplace_back(v, kBodyDensity * by_vertex[v]);
  }
  return kBodyDensity * volume;
}

// A chain of points with their derivative; cut off at the level of the clip landmark; bridged by
// the hull where the table says so.
double TapeMeasure::take_path(int k, const Points& V, MeasureGradient* gradient,
                              TapeTrace* trace) const {
  const Measure& m = measure(k);
  struct Node {
    int a, b;
    double t;
    Vec3 point;
    bool on_level;  // where the chain crosses the level: an end that slides along its edge
  };
  const auto& chain = chains_[k];
  const auto place = [&V](const EdgePoint& e) -> Vec3 {
    return (1 - e.t) * V.row(e.a).transpose() + e.t * V.row(e.b).transpose();
  };
  std::vector<Node> nodes;
  // Of a chain that is cut, the part kept lies between the first and the last node on the wanted
  // side.
  const double level = m.clip_vertex >= 0 ? V(m.clip_vertex, 1) : 0;
  const auto kept = [&](const Vec3& p) {
    return m.clip_vertex < 0 || (m.clip_above ? p.y() >= level : p.y() <= level);
  };
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const Vec3 p = place(chain[i]);
    if (kept(p)) nodes.push_back({chain[i].a, chain[i].b, chain[i].t, p, false});
    if (i + 1 == chain.size()) break;
    const Vec3 q = place(chain[i + 1]);
    if (kept(p) == kept(q)) continue;
    // Between two chain points; its derivative is carried by whichever of them is nearer, which is
    // exact for a straight chain.
    const double s = (level - p.y()) / (q.y() - p.y());
    const EdgePoint& e = s < 0.5 ? chain[i] : chain[i + 1];
    nodes.push_back({e.a, e.b, e.t, p + s * (q - p), true});
  }
  std::vector<int> used(nodes.size());
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = int(i);
  if (m.hull && nodes.size() > 2)
    used = bridged_chain([&] {
      std::vector<Vec3> points;
      for (const Node& node : nodes) points.push_back(node.point);
      return points;
    }());
  double length = 0;
  std::vector<Vec3> line;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const Node& p = nodes[used[i]];
    line.push_back(p.point);
    if (i + 1 == used.size()) break;
    const Node& q = nodes[used[i + 1]];
    const Vec3 d = q.point - p.point;
    const double step = d.norm();
    length += step;
    if (gradient == nullptr || step < 1e-12) continue;
    for (const auto& [node, g] :
         {std::make_pair(&p, Vec3(-d / step)), std::make_pair(&q, Vec3(d / step))}) {
      Vec3 by_point = g;
      if (node->on_level && std::abs(d.y()) > 1e-9) {
        // The end stays on the level: what moves it along the chain is the level, what moves it
        // sideways is the skin.
        const double along = g.dot(d) / d.y();
        gradient->emplace_back(m.clip_vertex, along * Vec3::UnitY());
        by_point -= along * Vec3::UnitY();
      }
      gradient->emplace_back(node->a, (1 - node->t) * by_point);
      gradient->emplace_back(node->b, node->t * by_point);
    }
  }
  if (trace != nullptr) trace->push_back(line);
  return length;
}

}  // namespace ecorche::inline v1
