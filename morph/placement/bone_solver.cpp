#include "morph/placement/bone_solver.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include <tbb/parallel_for.h>

namespace ecorche::inline v1 {
namespace {

constexpr double kGroupDamping = 1e-2;  // of steps that single groups take

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct Layout {
  std::vector<std::vector<BoneMap::Way>> ways;  // free ways of each group
  std::vector<int> start;
  int size = 0;
};

Layout lay_out(const BoneProblem& problem) {
  Layout layout;
  for (const BoneGroup& group : problem.groups) {
    layout.start.push_back(layout.size);
    auto& ways = layout.ways.emplace_back();
    for (int w = 0; w < BoneMap::way_count; ++w)
      if (group.freedom[w] > 0) ways.push_back(static_cast<BoneMap::Way>(w));
    layout.size += ways.size();
  }
  return layout;
}

// 3 x #ways of the group
Matrix map_jacobian(const BoneProblem& problem, const Layout& layout, int group, const Vec3& x) {
  const auto& ways = layout.ways[group];
  Matrix out(3, ways.size());
  for (size_t k = 0; k < ways.size(); ++k)
    out.col(k) = derivative(problem.groups[group].map, ways[k], x);
  return out;
}

// The normal equations in blocks of groups, lower triangle: key (row group, column group).
struct NormalEquations {
  explicit NormalEquations(const Layout& l) : layout(l), gradient(Vector::Zero(l.size)) {}

  void add(int group, const Matrix& J, const Vector& r) {
    block(group, group) += J.transpose() * J;
    gradient.segment(layout.start[group], J.cols()) += J.transpose() * r;
  }
  void add(int a, const Matrix& Ja, int b, const Matrix& Jb, const Vector& r) {
    add(a, Ja, r);
    add(b, Jb, r);
    if (a > b)
      block(a, b) += Ja.transpose() * Jb;
    else
      block(b, a) += Jb.transpose() * Ja;
  }
  Matrix& block(int row, int column) {
    Matrix& m = blocks[{row, column}];
    if (m.size() == 0) m = Matrix::Zero(layout.ways[row].size(), layout.ways[column].size());
    return m;
  }
  Vector solve(double damping) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [key, m] : blocks)
      for (int i = 0; i < m.rows(); ++i)
        for (int j = 0; j < m.cols(); ++j) {
          const int row = layout.start[key.first] + i, column = layout.start[key.second] + j;
          if (row >= column)
            entries.emplace_back(row, column, row == column ? m(i, j) * (1 + damping) : m(i, j));
        }
    Eigen::SparseMatrix<double> H(layout.size, layout.size);
    H.setFromTriplets(entries.begin(), entries.end());
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(H);
    return solver.solve(-gradient);
  }

  const Layout& layout;
  std::map<std::pair<int, int>, Matrix> blocks;
  Vector gradient;
};

// Longer steps leave what the linearisation knows about.
double longest_step(BoneMap::Way way) {
  if (way <= BoneMap::shift_z) return 0.03;
  if (way <= BoneMap::turn_z) return 0.12;
  return way >= BoneMap::bow_x && way <= BoneMap::tuck_z ? 0.01 : 0.06;
}

struct Probe {  // answer of the skin field for an inside or depth point
  double residual = 0;
  double slope = 0;  // d residual / d distance
  Vec3 gradient = Vec3::Zero();
};

void probe_skin(BoneProblem& problem, const SkinField& skin, std::vector<Probe>& inside,
                std::vector<Probe>& depths) {
  inside.assign(problem.inside.size(), {});
  depths.assign(problem.depths.size(), {});
  tbb::parallel_for(size_t{0}, problem.inside.size(), [&](size_t i) {
    InsidePoint& p = problem.inside[i];
    const Vec3 x = problem.groups[p.group].map(p.x);
    if (p.answer + (x - p.asked_at).norm() + p.margin < 0) return;
    SkinPoint at = skin.nearest_judged(x, p.seed);
    p.seed = at.triangle;
    if (p.both) {
      const SkinPoint other = problem.mirrored->nearest_judged(x);
      if (other.distance > at.distance) at = other;
    }
    p.asked_at = x;
    p.answer = at.distance;
    if (at.distance + p.margin > 0)
      inside[i] = {(at.distance + p.margin) / p.tolerance, 1 / p.tolerance, at.gradient};
  });
  tbb::parallel_for(size_t{0}, problem.depths.size(), [&](size_t i) {
    DepthPoint& p = problem.depths[i];
    const SkinPoint at = skin.nearest(problem.groups[p.group].map(p.x), p.seed);
    p.seed = at.triangle;
    double off = at.distance + p.wanted;  // positive: too shallow
    off = off > 0 ? std::max(0.0, off - p.slack) : p.deeper * std::min(0.0, off + p.slack);
    if (off != 0)
      depths[i] = {off / p.tolerance, (off > 0 ? 1 : p.deeper) / p.tolerance, at.gradient};
  });
}

double total_cost(BoneProblem& problem, const SkinField& skin, std::vector<Probe>& inside,
                  std::vector<Probe>& depths) {
  probe_skin(problem, skin, inside, depths);
  double cost = 0;
  for (const Probe& p : inside) cost += p.residual * p.residual;
  for (const Probe& p : depths) cost += p.residual * p.residual;
  const auto at = [&](int group, const Vec3& x) { return problem.groups[group].map(x); };
  for (const JointPair& p : problem.joints)
    cost += (at(p.a, p.x_a) - at(p.b, p.x_b)).squaredNorm() / (p.tolerance * p.tolerance);
  for (const GapPair& p : problem.gaps) {
    const double off = (p.normal.dot(at(p.a, p.x_a) - at(p.b, p.x_b)) - p.gap) / p.tolerance;
    cost += off * off;
  }
  for (const AnchorPoint& p : problem.anchors)
    cost += (at(p.group, p.x) - p.target).cwiseQuotient(p.tolerance).squaredNorm();
  for (const WayTie& t : problem.ties) {
    const double off = (deviation(problem.groups[t.a].map, problem.groups[t.a].expected, t.way) -
                        deviation(problem.groups[t.b].map, problem.groups[t.b].expected, t.way)) /
                       t.tolerance;
    cost += off * off;
  }
  for (const BoneGroup& g : problem.groups)
    for (int w = 0; w < BoneMap::way_count; ++w)
      if (g.freedom[w] > 0) {
        const double off =
            deviation(g.map, g.expected, static_cast<BoneMap::Way>(w)) / g.freedom[w];
        cost += off * off;
      }
  return cost;
}

void assemble(const BoneProblem& problem, const Layout& layout, const std::vector<Probe>& inside,
              const std::vector<Probe>& depths, NormalEquations& normal) {
  const auto at = [&](int group, const Vec3& x) { return problem.groups[group].map(x); };
  const auto jacobian = [&](int group, const Vec3& x) {
    return map_jacobian(problem, layout, group, x);
  };
  const auto add_probe = [&](int group, const Vec3& x, const Probe& p) {
    if (p.residual == 0) return;
    normal.add(group, p.slope * p.gradient.transpose() * jacobian(group, x),
               Vector::Constant(1, p.residual));
  };
  for (size_t i = 0; i < inside.size(); ++i)
    add_probe(problem.inside[i].group, problem.inside[i].x, inside[i]);
  for (size_t i = 0; i < depths.size(); ++i)
    add_probe(problem.depths[i].group, problem.depths[i].x, depths[i]);
  for (const JointPair& p : problem.joints) {
    const double s = 1 / p.tolerance;
    normal.add(p.a, s * jacobian(p.a, p.x_a), p.b, -s * jacobian(p.b, p.x_b),
               s * (at(p.a, p.x_a) - at(p.b, p.x_b)));
  }
  for (const GapPair& p : problem.gaps) {
    const double s = 1 / p.tolerance;
    const Vector r =
        Vector::Constant(1, s * (p.normal.dot(at(p.a, p.x_a) - at(p.b, p.x_b)) - p.gap));
    normal.add(p.a, s * p.normal.transpose() * jacobian(p.a, p.x_a), p.b,
               -s * p.normal.transpose() * jacobian(p.b, p.x_b), r);
  }
  for (const AnchorPoint& p : problem.anchors) {
    const Vec3 s = p.tolerance.cwiseInverse();
    normal.add(p.group, s.asDiagonal() * jacobian(p.group, p.x),
               s.asDiagonal() * (at(p.group, p.x) - p.target));
  }
  for (const WayTie& t : problem.ties) {
    const auto row = [&](int g) {
      Matrix J = Matrix::Zero(1, layout.ways[g].size());
      for (size_t k = 0; k < layout.ways[g].size(); ++k)
        if (layout.ways[g][k] == t.way) J(0, k) = 1 / t.tolerance;
      return J;
    };
    const double off = deviation(problem.groups[t.a].map, problem.groups[t.a].expected, t.way) -
                       deviation(problem.groups[t.b].map, problem.groups[t.b].expected, t.way);
    normal.add(t.a, row(t.a), t.b, -row(t.b), Vector::Constant(1, off / t.tolerance));
  }
  for (size_t g = 0; g < problem.groups.size(); ++g) {
    const auto& ways = layout.ways[g];
    if (ways.empty()) continue;
    Matrix J = Matrix::Zero(ways.size(), ways.size());
    Vector r(ways.size());
    for (size_t k = 0; k < ways.size(); ++k) {
      J(k, k) = 1 / problem.groups[g].freedom[ways[k]];
      r[k] = deviation(problem.groups[g].map, problem.groups[g].expected, ways[k]) * J(k, k);
    }
    normal.add(int(g), J, r);
  }
}

}  // namespace

double deviation(const BoneMap& map, const BoneMap& expected, BoneMap::Way way) {
  if (way <= BoneMap::shift_z) return map.target_origin[way] - expected.target_origin[way];
  if (way <= BoneMap::turn_z) {
    const Eigen::AngleAxisd turn(Mat3(map.target_frame * expected.target_frame.transpose()));
    return turn.angle() * turn.axis()[way - BoneMap::turn_x];
  }
  return map.shape[way] - expected.shape[way];
}

SolveSummary solve_bones(BoneProblem& problem, const SkinField& skin, int max_iterations,
                         bool one_by_one) {
  const Layout layout = lay_out(problem);
  std::vector<Probe> inside, depths;
  SolveSummary summary;
  double cost = total_cost(problem, skin, inside, depths);
  summary.initial_cost = summary.cost = cost;
  double damping = 1e-3;
  const auto move = [&](const Vector& step, size_t g) {
    for (size_t k = 0; k < layout.ways[g].size(); ++k) {
      const BoneMap::Way way = layout.ways[g][k];
      const double longest = longest_step(way);
      problem.groups[g].map.move(way, std::clamp(step[layout.start[g] + k], -longest, longest));
    }
  };
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    if (cost < 1e-16) break;
    NormalEquations normal(layout);
    assemble(problem, layout, inside, depths, normal);
    bool better = false;
    double gain = 0;
    for (int attempt = 0; attempt < 6 && !better; ++attempt) {
      const Vector step = normal.solve(damping);
      std::vector<BoneMap> before;
      for (const BoneGroup& g : problem.groups) before.push_back(g.map);
      for (size_t g = 0; g < problem.groups.size(); ++g) move(step, g);
      const double trial = total_cost(problem, skin, inside, depths);
      if (trial < cost) {
        better = true;
        gain = cost - trial;
        cost = trial;
        damping = std::max(1e-6, damping / 4);
      } else {
        for (size_t g = 0; g < problem.groups.size(); ++g) problem.groups[g].map = before[g];
        damping *= 8;
      }
    }
    // one that is at a fold of the skin, where distances jump, must not hold up all others
    if (!better && one_by_one) {
      const Vector step = normal.solve(kGroupDamping);
      for (size_t g = 0; g < problem.groups.size(); ++g) {
        const BoneMap before = problem.groups[g].map;
        move(step, g);
        const double trial = total_cost(problem, skin, inside, depths);
        if (trial < cost)
          gain += cost - trial, cost = trial, better = true;
        else
          problem.groups[g].map = before;
      }
      total_cost(problem, skin, inside, depths);
      damping = kGroupDamping;
    }
    summary.iterations = iteration + 1;
    summary.cost = cost;
    if (!better || gain < 1e-5 * cost) break;
  }
  return summary;
}

}  // namespace ecorche::inline v1
