// Measuring code of its own for the tests: every triangle is cut, segments are joined by the edges
// they end on, hulls are wrapped like a gift, searches look at every millimetre, ways over the skin
// are shortest paths along the segments of a cut. It shares only the table of definitions with what
// it checks.
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include <Eigen/Geometry>

#include "anatomy/base_mesh/body_rig.h"
#include "morph/measures/tape_measure.h"
#include "morph/shapes/body.h"

namespace ecorche {

class TapeCheck {
 public:
  TapeCheck(const BodyPackage& package, const MeasureTable& table)
      : package_(package), table_(table), parts_(vertex_parts(package)) {
    for (const Measure& m : table.measures)
      if (m.kind == MeasureKind::path && !m.hull && m.clip_vertex < 0)
        for (std::size_t i = 0; i + 1 < m.vertices.size(); ++i)
          ways_.try_emplace({m.vertices[i], m.vertices[i + 1]},
                            way(m.vertices[i], m.vertices[i + 1]));
  }

  double take(const Measure& m, const Points& V) const {
    switch (m.kind) {
      case MeasureKind::height:
        return V(m.vertices[0], 1) - V.col(1).head(package_.skin_size).minCoeff();
      case MeasureKind::ahead:
        return V(m.vertices[0], 2) - V(m.vertices[1], 2);
      case MeasureKind::distance:
        return (V.row(m.vertices[0]) - V.row(m.vertices[1])).norm();
      case MeasureKind::girth:
      case MeasureKind::breadth:
      case MeasureKind::depth:
        return searched(m, V);
      case MeasureKind::sum: {
        double sum = 0;
        for (const Term& t : m.terms) sum += t.factor * take(table_.measures[t.measure], V);
        return sum;
      }
      case MeasureKind::mass:
        return kBodyDensity * skin_volume(package_, V);
      case MeasureKind::path: {
        double sum = 0;
        for (std::size_t i = 0; i + 1 < m.vertices.size(); ++i) {
          const auto found = ways_.find({m.vertices[i], m.vertices[i + 1]});
          if (found == ways_.end()) return std::numeric_limits<double>::quiet_NaN();
          const auto place = [&V](const WayPoint& p) -> Vec3 {
            return V.row(p.a) + p.t * (V.row(p.b) - V.row(p.a));
          };
          for (std::size_t k = 0; k + 1 < found->second.size(); ++k)
            sum += (place(found->second[k + 1]) - place(found->second[k])).norm();
        }
        return sum;
      }
      default:
        return std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  struct Segment {
    std::pair<int, int> from, to;  // edges, smaller vertex first
    Vec3 a, b;
  };

  struct WayPoint {
    int a, b;
    double t;
  };

  // On the base mesh, the shortest way between two vertices in any of the planes turned about the
  // line between them by 7.5 degrees; in the mid-plane where both lie on it.
  std::vector<WayPoint> way(int from, int to) const {
    const Points base = package_.points.topRows(package_.skin_size);
    const Vec3 p = base.row(from), q = base.row(to), along = (q - p).normalized();
    const bool middle = std::abs(p.x()) < 1e-9 && std::abs(q.x()) < 1e-9;
    std::vector<WayPoint> best;
    double best_length = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < (middle ? 1 : 24); ++turn) {
      const Vec3 normal =
          middle ? Vec3(Vec3::UnitX())
                 : Vec3(Eigen::AngleAxisd(M_PI * turn / 24, along) * along.unitOrthogonal());
      const double length = shortest(cut(base, p, normal), base, from, to, best_length, best);
      best_length = std::min(best_length, length);
    }
    return best;
  }

  using Crossing = std::pair<int, int>;

  // Dijkstra's way from crossing to crossing; written to `best` when shorter than `limit`.
  static double shortest(const std::vector<Segment>& segments, const Points& V, int from, int to,
                         double limit, std::vector<WayPoint>& best) {
    std::map<Crossing, Vec3> place;
    std::map<Crossing, std::vector<Crossing>> next;
    for (const Segment& s : segments) {
      place[s.from] = s.a, place[s.to] = s.b;
      next[s.from].push_back(s.to), next[s.to].push_back(s.from);
    }
    const auto nearest = [&](int v) {
      Crossing found;
      double least = std::numeric_limits<double>::infinity();
      for (const auto& [edge, point] : place)
        if (const double d = (point - V.row(v).transpose()).norm(); d < least)
          least = d, found = edge;
      return std::pair{found, least};
    };
    const auto [first, first_gap] = nearest(from);
    const auto [last, last_gap] = nearest(to);
    if (first_gap > 0.005 || last_gap > 0.005) return std::numeric_limits<double>::infinity();
    std::map<Crossing, double> length{{first, first_gap}};
    std::map<Crossing, Crossing> before;
    std::set<std::pair<double, Crossing>> open{{first_gap, first}};
    while (!open.empty()) {
      const auto [so_far, at] = *open.begin();
      open.erase(open.begin());
      if (at == last) break;
      for (const Crossing& other : next[at]) {
        const double reached = so_far + (place[other] - place[at]).norm();
        const auto known = length.find(other);
        if (known != length.end() && known->second <= reached) continue;
        length[other] = reached, before[other] = at;
        open.insert({reached, other});
      }
    }
    if (!length.contains(last) || length[last] + last_gap >= limit)
      return std::numeric_limits<double>::infinity();
    std::vector<WayPoint> back{{to, to, 0}};
    for (Crossing at = last; at != first; at = before[at]) {
      const Vec3 a = V.row(at.first), b = V.row(at.second);
      back.push_back({at.first, at.second, (place[at] - a).norm() / (b - a).norm()});
    }
    back.push_back({from, from, 0});
    best.assign(back.rbegin(), back.rend());
    return length[last] + last_gap;
  }

  double searched(const Measure& m, const Points& V) const {
    const auto p = [&](std::size_t k) -> Vec3 { return V.row(m.vertices[k]); };
    Vec3 normal = Vec3::UnitY();
    if (m.plane == PlaneKind::across) normal = (p(2) - p(1)).normalized();
    if (m.plane == PlaneKind::midline) normal = (p(1) - p(0)).cross(Vec3::UnitX()).normalized();
    if (m.plane == PlaneKind::foot) normal = (p(1) - p(0)).cross(Vec3::UnitY()).normalized();
    if (m.plane == PlaneKind::hand) {
      const Vec3 e = (p(1) - p(0)).normalized(), d = p(2) - (p(0) + p(1)) / 2;
      normal = (d - e * e.dot(d)).normalized();
    }
    double best = std::numeric_limits<double>::quiet_NaN();
    for (double offset = m.search == Search::none ? 0 : -m.reach;
         offset <= (m.search == Search::none ? 0 : m.reach) + 1e-9; offset += 0.001) {
      const double value = at_plane(m, V, p(0) + offset * normal, normal);
      if (std::isnan(best) || (m.search == Search::largest ? value > best : value < best))
        best = value;
    }
    return best;
  }

  double at_plane(const Measure& m, const Points& V, const Vec3& origin, const Vec3& normal) const {
    const std::vector<Segment> segments = cut(V, origin, normal);
    std::map<std::pair<int, int>, std::vector<std::size_t>> at_edge;
    for (std::size_t s = 0; s < segments.size(); ++s)
      at_edge[segments[s].from].push_back(s), at_edge[segments[s].to].push_back(s);
    std::size_t nearest = 0;
    for (std::size_t s = 0; s < segments.size(); ++s)
      if (std::min((segments[s].a - origin).norm(), (segments[s].b - origin).norm()) <
          std::min((segments[nearest].a - origin).norm(), (segments[nearest].b - origin).norm()))
        nearest = s;
    std::set<std::size_t> piece;
    std::vector<std::size_t> open{nearest};
    while (!open.empty()) {
      const std::size_t s = open.back();
      open.pop_back();
      if (!piece.insert(s).second) continue;
      for (const auto& edge : {segments[s].from, segments[s].to})
        for (std::size_t next : at_edge[edge]) open.push_back(next);
    }
    std::vector<Vec3> points;
    double length = 0;
    for (std::size_t s : piece) {
      if (m.arms_off && (on_arm(segments[s].from) || on_arm(segments[s].to))) {
        if (!on_arm(segments[s].from)) points.push_back(segments[s].a);
        if (!on_arm(segments[s].to)) points.push_back(segments[s].b);
        continue;
      }
      points.push_back(segments[s].a);
      points.push_back(segments[s].b);
      length += (segments[s].b - segments[s].a).norm();
    }
    if (m.kind == MeasureKind::breadth) return extent(points, Vec3::UnitX());
    if (m.kind == MeasureKind::depth) return extent(points, Vec3::UnitZ());
    return m.hull ? wrapped(points, normal) : length;
  }

  bool on_arm(const std::pair<int, int>& edge) const {
    const auto arm = [&](int v) {
      const BodyPart part = parts_[v].part;
      return part == BodyPart::upper_arm || part == BodyPart::forearm || part == BodyPart::hand;
    };
    return arm(edge.first) || arm(edge.second);
  }

  std::vector<Segment> cut(const Points& V, const Vec3& origin, const Vec3& normal) const {
    std::vector<Segment> out;
    const Eigen::VectorXd height =
        (V.topRows(package_.skin_size).rowwise() - origin.transpose()) * normal;
    for (Eigen::Index f = 0; f < package_.triangles.rows(); ++f) {
      Segment s;
      int found = 0;
      for (int e = 0; e < 3; ++e) {
        int a = package_.triangles(f, e), b = package_.triangles(f, (e + 1) % 3);
        if ((height[a] < 0) == (height[b] < 0)) continue;
        if (a > b) std::swap(a, b);
        const Vec3 at =
            (V.row(a) * height[b] - V.row(b) * height[a]).transpose() / (height[b] - height[a]);
        (found == 0 ? s.from : s.to) = {a, b};
        (found == 0 ? s.a : s.b) = at;
        ++found;
      }
      if (found == 2) out.push_back(s);
    }
    return out;
  }

  static double extent(const std::vector<Vec3>& points, const Vec3& axis) {
    double low = 1e9, high = -1e9;
    for (const Vec3& p : points)
      low = std::min(low, p.dot(axis)), high = std::max(high, p.dot(axis));
    return high - low;
  }

  // From the lowest point, always to the point with the least turn.
  static double wrapped(const std::vector<Vec3>& points, const Vec3& normal) {
    const Vec3 u = normal.cross(std::abs(normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitZ())
                       .normalized(),
               v = normal.cross(u);
    std::vector<Vec2> p;
    for (const Vec3& x : points) p.emplace_back(x.dot(u), x.dot(v));
    std::size_t first = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p[i].y() < p[first].y()) first = i;
    double length = 0, heading = 0;
    std::size_t at = first;
    for (std::size_t step = 0; step <= p.size(); ++step) {
      double least = 1e9, far = 0, next_heading = 0;
      std::size_t next = at;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec2 d = p[i] - p[at];
        if (d.norm() < 1e-9) continue;
        double turn = std::atan2(d.y(), d.x()) - heading;
        while (turn < -1e-9) turn += 2 * M_PI;
        if (turn < least - 1e-9 || (turn < least + 1e-9 && d.norm() > far))
          least = turn, far = d.norm(), next = i, next_heading = heading + turn;
      }
      length += far;
      heading = std::fmod(next_heading, 2 * M_PI);
      at = next;
      if ((p[at] - p[first]).norm() < 1e-9) break;
    }
    return length;
  }

  const BodyPackage& package_;
  const MeasureTable& table_;
  std::vector<VertexPart> parts_;
  std::map<std::pair<int, int>, std::vector<WayPoint>> ways_;
};

}  // namespace ecorche
