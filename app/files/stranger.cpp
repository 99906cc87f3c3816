#include "app/files/stranger.h"

#include <algorithm>
#include <map>
#include <utility>

#include "morph/registration/attached_skin.h"
#include "morph/registration/still_hands.h"

namespace ecorche {
namespace {

constexpr double kTorn = 3, kShortest = 1e-3;  // times as long; m, of edges that count

// Edges that bringing the mesh to rest made longer.
void measure_tears(const HungSkin& hung, FitOutcome& out) {
  const Triangles& F = hung.rest.F;
  double torn = 0, all = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = F(f, k), j = F(f, (k + 1) % 3);
      const double before = (hung.standing.row(i) - hung.standing.row(j)).norm();
      const double after = (hung.rest.V.row(i) - hung.rest.V.row(j)).norm();
      all += 1;
      if (after > kTorn * std::max(before, kShortest)) torn += 1;
      out.longest_tear = std::max(out.longest_tear, after - before);
    }
  }
  out.torn_share = torn / std::max(all, 1.0);
}

// By the stems of joints' names (joint_parts); fingers and toes by what is left.
std::optional<VertexPart> part_of_joint(const NamedPart& joint) {
  static const std::map<std::string, BodyPart> kParts{
      {"head", BodyPart::head},     {"jaw", BodyPart::head},
      {"neck", BodyPart::neck},     {"trunk", BodyPart::trunk},
      {"pelvis", BodyPart::trunk},  {"clavicle", BodyPart::trunk},
      {"scapula", BodyPart::trunk}, {"shoulder", BodyPart::upper_arm},
      {"elbow", BodyPart::forearm}, {"hip", BodyPart::thigh},
      {"knee", BodyPart::shank},    {"ankle", BodyPart::foot}};
  if (joint.part.empty()) return std::nullopt;
  const auto known = kParts.find(joint.part);
  const bool foot = joint.part.starts_with("toe") || joint.part.starts_with("mtp");
  const BodyPart part = known != kParts.end() ? known->second
                        : foot                ? BodyPart::foot
                                              : BodyPart::hand;
  const bool paired = part != BodyPart::head && part != BodyPart::neck && part != BodyPart::trunk;
  return VertexPart{part, paired ? joint.side : Side::middle};
}

}  // namespace

Stranger make_stranger(std::string glb, const std::string& name) {
  Stranger out;
  out.name = name;
  out.source = std::make_shared<const std::string>(std::move(glb));
  out.rig = read_source_rig(*out.source, name);
  out.joints = joint_hints(out.rig);
  return out;
}

std::vector<std::optional<VertexPart>> told_parts(const SourceRig& rig) {
  std::vector<std::optional<VertexPart>> of_joint;
  for (const NamedPart& joint : joint_parts(rig)) of_joint.push_back(part_of_joint(joint));
  std::vector<std::optional<VertexPart>> out(rig.weights.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    std::map<std::pair<BodyPart, Side>, double> weights;
    double told = 0;
    const auto add = [&](int joint, double weight) {
      if (!of_joint[std::size_t(joint)]) return;
      weights[{of_joint[std::size_t(joint)]->part, of_joint[std::size_t(joint)]->side}] += weight;
      told += weight;
    };
    const SourcePiece& piece = rig.pieces[std::size_t(rig.piece_of[v])];
    for (const Influence& w : rig.weights[v]) add(w.joint, w.weight);
    if (piece.joint >= 0) add(piece.joint, 1);
    if (told < 0.5) continue;
    const auto most = std::ranges::max_element(
        weights, {}, [](const auto& part_and_weight) { return part_and_weight.second; });
    const auto [part, side] = most->first;
    if (part == BodyPart::trunk && is_covering(rig.kinds[v])) continue;
    out[v] = VertexPart{part, side};
  }
  return out;
}

HungSkin hang_skin(const Stranger& stranger, const Registration& registration,
                   const BodyPackage& package, Report& report) {
  const StageTimer timer(report, "attach");
  StandingMesh standing;
  standing.mesh.F = stranger.rig.mesh.F;
  standing.mesh.V =
      (registration.scale * stranger.rig.mesh.V * registration.axes.transpose()).rowwise() +
      registration.shift.transpose();
  standing.rigid = rigid_pieces(stranger.rig);
  standing.parts = told_parts(stranger.rig);
  const std::vector<VertexPart> parts = vertex_parts(package);
  AttachedSkin attached =
      attach_skin(with_still_hands(registration, parts), package.triangles, parts, standing);
  HungSkin out;
  out.own.base = {registration.body.skin.V, package.triangles};
  out.own.map = std::move(attached.map);
  out.own.scale = registration.scale;
  out.own.axes = registration.axes;
  out.own.shift = registration.shift;
  out.own.source = stranger.source;
  out.rest = {std::move(attached.rest), standing.mesh.F};
  out.standing = std::move(standing.mesh.V);
  std::vector<double>& distance = attached.distance;
  report.set("own_skin.vertices", int(distance.size()));
  report.set("own_skin.triangles", int(out.rest.F.rows()));
  report.set("own_skin.pieces", int(stranger.rig.pieces.size()));
  report.set("own_skin.joints", int(stranger.rig.joints.size()));
  const auto p95 = distance.begin() + long(0.95 * double(distance.size() - 1));
  std::nth_element(distance.begin(), p95, distance.end());
  report.set("own_skin.distance_p95", *p95);
  return out;
}

FittedForFile fit_stranger(const Assets& assets, const Template& body_template,
                           const Stranger& stranger, const Registration& registration,
                           const BodyPackage& package, const FittedActorOptions& options,
                           Report& report) {
  const HungSkin hung = hang_skin(stranger, registration, package, report);
  FittedActorOptions with = options;
  with.hung = &hung;
  FittedForFile out = fit_for_file(assets, body_template, registration.body, package, with, report);
  measure_tears(hung, out);
  report.set("own_skin.torn_share", out.torn_share);
  report.set("own_skin.longest_tear", out.longest_tear);
  return out;
}

}  // namespace ecorche
