#include "skinning/constraints/self_collision.h"

#include <algorithm>
#include <cmath>

#include "skinning/constraints/temporal_smoothing.h"

namespace ecorche {
namespace {

constexpr double kGive = 0.08;       // of both radii: how deep flesh that meets is pressed in
constexpr double kTrunkGive = 0.15;  // likewise of an arm in the trunk, whose ellipsoids are rough
constexpr double kBell = 0.05;       // s
constexpr int kRounds = 12;

struct Place {
  Vec3 centre = Vec3::Zero();
  Mat3 axes = Mat3::Identity();
  Vec3 half = Vec3::Zero();
};

Vec3 ball_centre(const LimbBall& ball, const std::vector<Transform>& X, const LimbShift& shift) {
  return X[ball.joint] * ball.centre + ball.middle * shift.middle + ball.end * shift.end;
}

// How deep a ball lies in another or in an ellipsoid, and which way is out.
double depth_of(const Vec3& centre, double radius, const Place& other, Vec3& out) {
  const Vec3 half = other.half.array() + radius,
             p = other.axes.transpose() * (centre - other.centre);
  const Vec3 q = p.cwiseQuotient(half);
  const double inside = q.norm();
  if (inside >= 1) return 0;
  const Vec3 slope = q.cwiseQuotient(half);  // of inside^2 / 2
  const double steep = slope.norm();
  if (inside < 1e-6 || steep < 1e-9) return 0;  // on the centre: no way is out
  out = other.axes * (slope / steep);
  return std::min((1 - inside) * inside / steep, half.minCoeff());
}

struct Parter {
  const ApartTables& tables;
  const std::vector<Transform>& X;

  const LimbBall& ball(int limb, int b) const { return tables.rounds.limbs[limb][b]; }

  double depth(const RoundPair& pair, const LimbShifts& shifts, Vec3& out) const {
    const LimbBall& mine = ball(pair.limb, pair.ball);
    const Vec3 centre = ball_centre(mine, X, shifts[pair.limb]);
    Place other;
    if (pair.other_limb >= 0) {
      const LimbBall& theirs = ball(pair.other_limb, pair.other);
      other.centre = ball_centre(theirs, X, shifts[pair.other_limb]);
      other.half.setConstant(theirs.radius);
    } else {
      const TrunkRound& round = tables.rounds.trunk[pair.other];
      const Transform& frame = X[round.joint];
      other = {frame * round.centre, frame.linear(), round.half};
    }
    return depth_of(centre, mine.radius, other, out);
  }
};

void add(const LimbBall& ball, const Vec3& move, double squares, LimbShift& shift) {
  shift.middle += ball.middle / squares * move;
  shift.end += ball.end / squares * move;
}

}  // namespace

ApartTables make_apart_tables(const Skeleton& skeleton, BodyRounds rounds) {
  ApartTables tables{std::move(rounds), {}};
  const auto& limbs = tables.rounds.limbs;
  const auto& trunk = tables.rounds.trunk;
  std::vector<Transform> X;
  forward_kinematics(skeleton, rest_pose(skeleton), X);
  const auto pair = [&](int limb, int other_limb, Meeting kind) {
    for (int b = 0; b < int(limbs[limb].size()); ++b) {
      const std::size_t others = other_limb >= 0 ? limbs[other_limb].size() : trunk.size();
      for (int o = 0; o < int(others); ++o)
        tables.pairs.push_back({limb, b, other_limb, o, 0, kind});
    }
  };
  pair(0, 1, Meeting::leg_leg);
  pair(2, 3, Meeting::arm_arm);
  for (const int arm : {2, 3}) {
    pair(arm, 0, Meeting::arm_leg), pair(arm, 1, Meeting::arm_leg);
    pair(arm, -1, Meeting::arm_trunk);
  }
  const int head = find_joint(skeleton, "head");
  const Parter parter{tables, X};
  for (RoundPair& one : tables.pairs) {
    double give = kGive, size = parter.ball(one.limb, one.ball).radius;
    if (one.other_limb >= 0) {
      size += parter.ball(one.other_limb, one.other).radius;
    } else {
      const TrunkRound& round = trunk[one.other];
      if (round.joint == head) one.kind = Meeting::arm_head;
      if (round.joint != head) give = kTrunkGive;
      size += round.half.minCoeff();
    }
    Vec3 out;
    one.allowed = std::max(give * size, parter.depth(one, {}, out));
  }
  return tables;
}

MeetingDepths meeting_depths(const ApartTables& tables, const std::vector<Transform>& X) {
  const Parter parter{tables, X};
  MeetingDepths depths{};
  Vec3 out;
  for (const RoundPair& pair : tables.pairs) {
    double& deepest = depths[int(pair.kind)];
    deepest = std::max(deepest, parter.depth(pair, {}, out) - pair.allowed);
  }
  return depths;
}

LimbShifts part_limbs(const ApartTables& tables, const std::vector<Transform>& X) {
  const Parter parter{tables, X};
  LimbShifts own;
  for (int round = 0; round < kRounds; ++round) {
    // All pairs at once, so that left and right are treated alike.
    LimbShifts step;
    std::array<int, 4> counts{};
    for (const RoundPair& pair : tables.pairs) {
      Vec3 out;
      const double deep = parter.depth(pair, own, out) - pair.allowed;
      if (deep <= 0) continue;
      const LimbBall& mine = parter.ball(pair.limb, pair.ball);
      double squares = mine.middle * mine.middle + mine.end * mine.end;
      const LimbBall* theirs =
          pair.other_limb >= 0 ? &parter.ball(pair.other_limb, pair.other) : nullptr;
      if (theirs) squares += theirs->middle * theirs->middle + theirs->end * theirs->end;
      add(mine, deep * out, squares, step[pair.limb]);
      ++counts[pair.limb];
      if (!theirs) continue;
      add(*theirs, -deep * out, squares, step[pair.other_limb]);
      ++counts[pair.other_limb];
    }
    if (counts == std::array<int, 4>{}) break;
    for (std::size_t l = 0; l < 4; ++l) {
      if (counts[l] == 0) continue;
      constexpr double kMore = 1.5;  // a mean over all pairs falls short of what the deepest needs
      own[l].middle += kMore / counts[l] * step[l].middle;
      own[l].end += kMore / counts[l] * step[l].end;
    }
  }
  return own;
}

void smooth_shifts(double fps, std::vector<LimbShifts>& shifts) {
  using Both = Eigen::Vector<double, 6>;  // of a limb: middle, end
  std::vector<Both> limb(shifts.size());
  for (std::size_t l = 0; l < 4; ++l) {
    for (std::size_t f = 0; f < shifts.size(); ++f)
      limb[f] << shifts[f][l].middle, shifts[f][l].end;
    widened_bell(int(std::lround(kBell * fps)), limb,
                 [](const Both& a, const Both& b) { return a.squaredNorm() > b.squaredNorm(); });
    for (std::size_t f = 0; f < shifts.size(); ++f)
      shifts[f][l] = {limb[f].head<3>(), limb[f].tail<3>()};
  }
}

}  // namespace ecorche
