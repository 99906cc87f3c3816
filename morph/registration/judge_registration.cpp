#include "morph/registration/judge_registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "anatomy/compute/parallel_ranges.h"
#include "anatomy/errors.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/queries/nearest_surface.h"
#include "anatomy/queries/solid_angle.h"

namespace ecorche::inline v1 {
namespace {

// What is written as doubtful, and what is refused. m, but for shares.
constexpr double kDoubtfulMedian = 0.004, kDoubtfulP95 = 0.015;
constexpr double kRefusedMedian = 0.012, kFarOff = 0.05, kRefusedFar = 0.2;
constexpr double kDoubtfulFar = 0.012, kDoubtfulUnseen = 0.2, kDoubtfulOther = 0.97,
                 kDoubtfulShape = 2.0, kDoubtfulStretch = 0.05;
// Mass over the cube of stature, kg/m^3: people from lean to very heavy lie between the doubtful
// ones, infants and skeletons between the refused ones.
constexpr double kDoubtfulThin = 8, kDoubtfulStout = 22, kRefusedThin = 6, kRefusedStout = 32;
// Much of the scan elsewhere and much of the body unseen, or far elsewhere: another kind of thing.
constexpr double kElsewhere = 0.1, kElsewhereUnseen = 0.25, kRefusedP95 = 0.15, kOthersP95 = 0.03;
// Root mean square of joints' turns over usual ones: people who stand come to 0.9, on one
// leg to 1.1.
constexpr double kDoubtfulTurn = 1.1, kRefusedTurn = 1.35;
// A joint that the file names lies so far from ours, or nearer to that of the other side. m
constexpr double kDoubtfulJoint = 0.15, kDoubtfulTwin = 0.06;
constexpr double kDoubtfulHead = 60 * kDegree;  // turned against the chest
constexpr double kHalfSeen = 0.55;              // of a hand or foot
// A part of the body of which less is seen is missing; so many missing parts are too many.
constexpr double kSeenLimb = 0.15, kMostMissing = 9, kRefusedMissing = 1;
// Of the places along a limb's part that many lie inside the rest of the body: it is not there.
constexpr int kAlongLimb = 9;
constexpr double kBuried = 0.5, kInsideAngle = 2 * std::numbers::pi;
constexpr std::size_t kJudged = 6000;  // points of the scan
constexpr double kStandsOff = -1;      // instead of a distance

DistanceFigures figures_of(std::vector<double> distances) {
  DistanceFigures out;
  if (distances.empty()) return out;
  std::sort(distances.begin(), distances.end());
  for (const double d : distances) out.mean += d / double(distances.size());
  out.median = distances[distances.size() / 2];
  out.p95 = distances[std::size_t(0.95 * double(distances.size() - 1))];
  out.max = distances.back();
  return out;
}

// Part of a limb, from a joint to the next one.
struct LimbPart {
  std::string name, end;
  std::vector<BodyPart> beyond;  // it and what hangs on it
};

// How much of a limb's part lies inside the rest of the body: a limb that is not there is folded
// into what is.
double buried_share(const ArticulatedBody& body, const LimbPart& part, Side side,
                    const Registration& out) {
  const auto place = [&](const std::string& name) {
    return out.pose.posed[std::size_t(find_segment(body, name + side_suffix(side)))];
  };
  const auto hangs = [&](int v) {
    const VertexPart& at = body.parts[std::size_t(v)];
    return at.side == side &&
           std::find(part.beyond.begin(), part.beyond.end(), at.part) != part.beyond.end();
  };
  const Vec3 from = place(part.name), to = place(part.end);
  std::array<double, kAlongLimb> angles{};
  for (Eigen::Index f = 0; f < body.F.rows(); ++f) {
    const auto F = body.F.row(f);
    if (hangs(F[0]) || hangs(F[1]) || hangs(F[2])) continue;
    for (std::size_t i = 0; i < angles.size(); ++i)
      angles[i] += solid_angle(from + (double(i) + 0.5) / kAlongLimb * (to - from),
                               out.posed.row(F[0]), out.posed.row(F[1]), out.posed.row(F[2]));
  }
  const auto inside =
      std::count_if(angles.begin(), angles.end(), [](double a) { return a > kInsideAngle; });
  return double(inside) / kAlongLimb;
}

// Limbs' parts that are nowhere but inside the body, and all beyond them.
std::set<std::pair<BodyPart, Side>> buried_parts(const ArticulatedBody& body,
                                                 const Registration& out) {
  const LimbPart parts[] = {
      {"arm", "forearm", {BodyPart::upper_arm, BodyPart::forearm, BodyPart::hand}},
      {"forearm", "hand", {BodyPart::forearm, BodyPart::hand}},
      {"thigh", "shank", {BodyPart::thigh, BodyPart::shank, BodyPart::foot}},
      {"shank", "foot", {BodyPart::shank, BodyPart::foot}}};
  std::set<std::pair<BodyPart, Side>> buried;
  for (const LimbPart& part : parts)
    for (const Side side : {Side::left, Side::right})
      if (buried_share(body, part, side, out) > kBuried)
        for (const BodyPart beyond : part.beyond) buried.insert({beyond, side});
  return buried;
}

void look_for_limbs(const ArticulatedBody& body, const Scan& scan, Registration& out) {
  constexpr const char* kNames[] = {"head", "neck",  "trunk", "upper arm", "forearm",
                                    "hand", "thigh", "shank", "foot"};
  const std::set<std::pair<BodyPart, Side>> buried = buried_parts(body, out);
  std::map<std::pair<BodyPart, Side>, Vec2> areas;  // seen, all
  for (std::size_t i = 0; i < body.area.size(); ++i) {
    Vec2& one =
        areas.try_emplace({body.parts[i].part, body.parts[i].side}, Vec2::Zero()).first->second;
    one += body.area[i] * Vec2(out.seen[i] ? 1 : 0, 1);
  }
  std::string missing;
  double gone = 0;
  for (const auto& [key, area] : areas) {
    if (area[0] > kSeenLimb * area[1] && !buried.contains(key)) continue;
    const BodyPart part = key.first;
    gone += part == BodyPart::hand || part == BodyPart::foot || part == BodyPart::neck ? 0.4 : 1;
    missing += fmt::format("{}{}{}", missing.empty() ? "" : ", ",
                           key.second == Side::left    ? "left "
                           : key.second == Side::right ? "right "
                                                       : "",
                           kNames[int(key.first)]);
  }
  std::string half;
  for (const auto& [key, area] : areas)
    if ((key.first == BodyPart::hand || key.first == BodyPart::foot) &&
        area[0] > kSeenLimb * area[1] && area[0] < kHalfSeen * area[1] && !buried.contains(key))
      half += fmt::format("{}{} {}", half.empty() ? "" : ", ",
                          key.second == Side::left ? "left" : "right", kNames[int(key.first)]);
  if (!half.empty())
    out.report.doubts.push_back("less than half of it was seen, its turn is a guess: " + half);
  if (missing.empty()) return;
  if (gone > kMostMissing || (!scan.one_view && gone >= kRefusedMissing))
    throw UnfitError(
        fmt::format("too little of a person: nothing of the scan lies where {} would be", missing));
  out.report.doubts.push_back("nothing of the scan shows " + missing);
}

double height_of(const Body& body) {
  return body.skin.V.col(1).maxCoeff() - body.skin.V.col(1).minCoeff();
}

double build_of(const Body& body) { return body.mass / std::pow(height_of(body), 3); }

// Joints that the file names and that lie elsewhere. Those of the middle sit anywhere in rigs.
void compare_joints(const RegistrationEvidence& evidence, Registration& out) {
  const ArticulatedBody& body = evidence.body;
  std::string off;
  for (const PlaceHint& hint : evidence.hints) {
    if (hint.joint < 0) continue;
    const SegmentJoint& joint = body.joints[std::size_t(hint.joint)];
    if (joint.side == Side::middle) continue;
    const Side across = joint.side == Side::left ? Side::right : Side::left;
    const int twin =
        find_segment(body, joint.name.substr(0, joint.name.size() - 2) + side_suffix(across));
    const Vec3 place = out.axes * (out.scale / evidence.scan.unit * hint.place) + out.shift;
    const double own = (out.pose.posed[std::size_t(hint.joint)] - place).norm(),
                 other = (out.pose.posed[std::size_t(twin)] - place).norm();
    if (own > kDoubtfulJoint || (own > kDoubtfulTwin && other < 0.8 * own))
      off += fmt::format("{}{} ({:.0f} cm)", off.empty() ? "" : ", ", joint.name, 100 * own);
  }
  if (!off.empty())
    out.report.doubts.push_back("joints that the file names lie elsewhere than ours: " + off);
}

// How far the head looks aside, against the chest.
double head_turn(const ArticulatedBody& body, const Registration& out) {
  const int neck = find_segment(body, "neck"), head = find_segment(body, "head");
  const Quat whole = out.pose.rotations[std::size_t(neck)] * out.pose.rotations[std::size_t(head)];
  const Vec3 front = whole * Vec3::UnitZ();
  return std::abs(std::atan2(front.x(), front.z()));
}

// What is as near as a person can be laid to it, and is none.
void refuse_others(const Registration& out, double far) {
  const RegistrationReport& report = out.report;
  const double stature = height_of(out.body), build = build_of(out.body);
  const auto refuse = [](const std::string& why) {
    throw UnfitError("this does not look like a person who stands: " + why);
  };
  if (build < kRefusedThin || build > kRefusedStout)
    refuse(fmt::format("a body in it would weigh {:.0f} kg at {:.2f} m", out.body.mass, stature));
  const bool unusual = build < kDoubtfulThin || build > kDoubtfulStout;
  if (report.doubt > kDoubtfulOther && (report.scan_to_body.p95 > kOthersP95 || unusual))
    refuse(
        "a body fits into it in several ways, well in none; --landmarks or --pose help where it is "
        "a "
        "person after all");
  if (report.turn_deviation > kRefusedTurn)
    refuse(
        fmt::format("joints would have to turn to {:.1f} times what is usual; no head, trunk, "
                    "arms and legs of a person who stands were found",
                    report.turn_deviation));
  if (report.scan_to_body.p95 > kRefusedP95)
    refuse(fmt::format("5 % of it lie more than {:.0f} mm from the nearest body",
                       1e3 * report.scan_to_body.p95));
  if (far > kElsewhere && report.unseen > kElsewhereUnseen)
    refuse(fmt::format(
        "{:.0f} % of it lies more than {:.0f} mm from the nearest body, of which {:.0f} % have "
        "nothing beside them",
        100 * far, 1e3 * kFarOff, 100 * report.unseen));
}

// Share of edges that the surface fit made less than half or more than twice as long.
double stretched_share(const ArticulatedBody& body, const Points& before, const Points& after) {
  double off = 0, all = 0;
  for (Eigen::Index f = 0; f < body.F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = body.F(f, k), j = body.F(f, (k + 1) % 3);
      if (!body.outer[std::size_t(i)] || body.parts[std::size_t(i)].part == BodyPart::hand)
        continue;
      const double ratio = (after.row(i) - after.row(j)).norm() /
                           std::max((before.row(i) - before.row(j)).norm(), 1e-9);
      const double area = body.area[std::size_t(i)];
      all += area;
      if (ratio < 0.5 || ratio > 2) off += area;
    }
  }
  return off / std::max(all, 1e-12);
}

}  // namespace

void judge_registration(const RegistrationEvidence& evidence, Registration& out) {
  const ArticulatedBody& body = evidence.body;
  const Scan& scan = evidence.scan;
  const SurfacePoints& points = evidence.target.surface;
  const std::vector<char>& covering = evidence.target.covering;
  RegistrationReport& report = out.report;
  // Scan to body: exact distances of even points. Clothes may stand off.
  const TriMesh skin{out.posed, body.F};
  const NearestSurface surface(skin);
  const Points normals = vertex_normals(skin);
  std::vector<double> distances(std::min(kJudged, std::size_t(points.points.rows())));
  parallel_for_ranges(distances.size(), 64, Threads::all, [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      const Vec3 p =
          out.axes * (out.scale / scan.unit * points.points.row(Eigen::Index(k)).transpose()) +
          out.shift;
      const SurfacePoint hit = surface.nearest(p);
      distances[k] = hit.distance;
      const Vec3 outwards = normals.row(body.F(hit.triangle, 0));
      if (!covering.empty() && covering[k] && outwards.dot(p - hit.point) > 0)
        distances[k] = kStandsOff;
    }
  });
  std::erase(distances, kStandsOff);
  report.scan_to_body = figures_of(distances);
  std::vector<double> back;
  double unseen = 0, all = 0;
  for (std::size_t i = 0; i < body.outer.size(); ++i) {
    all += body.area[i];
    if (!body.outer[i]) continue;
    if (!out.seen[i]) {
      unseen += body.area[i];
      continue;
    }
    const Vec3 p = out.axes.transpose() * (out.posed.row(Eigen::Index(i)).transpose() - out.shift) *
                   (scan.unit / out.scale);
    const Vec3 n = out.axes.transpose() * normals.row(Eigen::Index(i)).transpose();
    const NearPoint near = evidence.tree.nearest(p, n);
    const Vec3 m = points.normals.row(near.index);
    const Vec3 gap = p - points.points.row(near.index).transpose();
    back.push_back((m.squaredNorm() > 0.5 ? std::abs(m.dot(gap)) : gap.norm()) * out.scale /
                   scan.unit);
  }
  report.body_to_scan = figures_of(back);
  report.unseen = unseen / std::max(all, 1e-12);
  look_for_limbs(body, scan, out);
  const DistanceFigures& off = report.scan_to_body;
  const double far = double(std::count_if(distances.begin(), distances.end(),
                                          [](double d) { return d > kFarOff; })) /
                     double(std::max<std::size_t>(distances.size(), 1));
  if (off.median > kRefusedMedian || far > kRefusedFar)
    throw UnfitError(fmt::format(
        "this does not look like a person who stands: half of it lies more than {:.0f} mm from the "
        "nearest body, and {:.0f} % more than {:.0f} mm; --landmarks or --pose help where the pose "
        "was not found",
        1e3 * off.median, 100 * far, 1e3 * kFarOff));
  refuse_others(out, far);
  const double stretched = stretched_share(body, evidence.start, evidence.fitted);
  const auto doubt = [&](bool is, const std::string& why) {
    if (is) report.doubts.push_back(why);
  };
  doubt(off.median > kDoubtfulMedian || off.p95 > kDoubtfulP95,
        fmt::format("the body lies off the scan: median {:.1f} mm, 95 % below {:.1f} mm",
                    1e3 * off.median, 1e3 * off.p95));
  doubt(
      far > kDoubtfulFar,
      fmt::format("{:.1f} % of the scan lies more than {:.0f} mm from the body: a limb may be lost",
                  100 * far, 1e3 * kFarOff));
  doubt(report.unseen > kDoubtfulUnseen,
        fmt::format("{:.0f} % of the skin was never seen; it comes from what bodies are like",
                    100 * report.unseen));
  doubt(report.doubt > kDoubtfulOther,
        "another pose fits nearly as well (--landmarks or --pose decide)");
  doubt(report.shape_distance > kDoubtfulShape,
        fmt::format("no usual body: {:.1f} standard deviations a component from the mean",
                    report.shape_distance));
  doubt(report.turn_deviation > kDoubtfulTurn,
        fmt::format("joints turn to {:.1f} times what is usual", report.turn_deviation));
  if (const double turned = head_turn(body, out); turned > kDoubtfulHead)
    doubt(true, fmt::format("the head would look {:.0f} degrees aside; a plain head does not tell",
                            turned * kDegreesPerRadian));
  compare_joints(evidence, out);
  const double build = build_of(out.body);
  doubt(build < kDoubtfulThin || build > kDoubtfulStout,
        fmt::format("{:.0f} kg at {:.2f} m is an unusual build: clothes, hair or doubled surfaces "
                    "count as body where names do not tell them",
                    out.body.mass, height_of(out.body)));
  doubt(stretched > kDoubtfulStretch,
        fmt::format("{:.0f} % of the skin had to be stretched to half or double", 100 * stretched));
}

}  // namespace ecorche::inline v1
