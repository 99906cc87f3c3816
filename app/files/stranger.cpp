#include "app/files/stranger.h"

#include <algorithm>
#include <utility>

#include "anatomy/base_mesh/body_rig.h"
#include "morph/registration/attached_skin.h"
#include "morph/registration/still_hands.h"

namespace ecorche {
namespace {

constexpr double kTorn = 3, kShortest = 1e-3;  // times as long; m, of edges that count

double torn_share(const HungSkin& hung) {
  const Triangles& F = hung.rest.F;
  double torn = 0, all = 0;
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = F(f, k), j = F(f, (k + 1) % 3);
      const double before = (hung.standing.row(i) - hung.standing.row(j)).norm();
      const double after = (hung.rest.V.row(i) - hung.rest.V.row(j)).norm();
      all += 1;
      if (after > kTorn * std::max(before, kShortest)) torn += 1;
    }
  }
  return torn / std::max(all, 1.0);
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

HungSkin hang_skin(const Stranger& stranger, const Registration& registration,
                   const BodyPackage& package, Report& report) {
  const StageTimer timer(report, "attach");
  StandingMesh standing;
  standing.mesh.F = stranger.rig.mesh.F;
  standing.mesh.V =
      (registration.scale * stranger.rig.mesh.V * registration.axes.transpose()).rowwise() +
      registration.shift.transpose();
  standing.rigid = rigid_pieces(stranger.rig);
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
  out.torn_share = torn_share(hung);
  report.set("own_skin.torn_share", out.torn_share);
  return out;
}

}  // namespace ecorche
