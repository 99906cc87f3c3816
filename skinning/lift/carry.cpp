#include "skinning/lift/carry.h"

#include <algorithm>
#include <cmath>

#include "anatomy/compute/cross_matrix.h"
#include "anatomy/geometry/mesh_measures.h"

namespace ecorche::inline v1 {
namespace {

// Of two proxies that overlap, N/m and s. Stiffer: limbs that meet jerk; softer: they sink into
// each other.
constexpr double kLimbStiffness = 2e4, kLimbDamping = 0.05;

// A contact of skin with its terms of the system.
struct ContactTerms {
  Mat3 B = Mat3::Zero();
  Vec3 r = Vec3::Zero();
  Vec3 arm = Vec3::Zero();
  int joint = 0;
};

Vec3 node_at(const Points& points, int i) { return points.row(i).transpose(); }

// Force and stiffness of a spring that pulls `from` towards `to`.
struct Pull {
  Vec3 force = Vec3::Zero();
  Mat3 stiffness = Mat3::Zero();
};

Pull spring_pull(const Vec3& from, const Vec3& to, double rest, double stiffness, double slack) {
  Pull out;
  const Vec3 way = to - from;
  const double length = std::max(way.norm(), 1e-9);
  const Vec3 u = way / length;
  const Mat3 along = u * u.transpose();
  if (length > rest) {
    out.force = stiffness * (length - rest) * u;
    out.stiffness = stiffness * (along + (1 - rest / length) * (Mat3::Identity() - along));
  } else if (slack > 0) {
    out.force = slack * stiffness * (length - rest) * u;
    out.stiffness = slack * stiffness * along;
  }
  return out;
}

// Regularised Coulomb friction as a viscosity, N s/m.
double friction_viscosity(const CarryOptions& options, double normal_force, const Vec3& sliding) {
  return options.friction * std::max(normal_force, 0.0) / std::max(sliding.norm(), options.creep);
}

// Normal and tangential terms of a contact over one step.
void contact_terms(const CarryOptions& options, const Vec3& normal, double area, double pressure,
                   double slope, const Vec3& velocity, Mat3& B, Vec3& r) {
  const double h = options.step;
  const Mat3 across = Mat3::Identity() - normal * normal.transpose();
  const double c = h * area * slope * (h + options.stiffness_damping),
               t = h * friction_viscosity(options, area * pressure, across * velocity);
  B = c * normal * normal.transpose() + t * across;
  r = h * area * pressure * normal;
}

void add_sheet(const CarryModel& model, const CarryState& state, ContactSystem& system) {
  const Sheet& sheet = *model.sheet;
  const CarryOptions& options = model.options;
  const double h = options.step, implicit = h * (h + options.stiffness_damping);
  for (Eigen::Index i = 0; i < state.nodes.rows(); ++i) {
    const double mass = sheet.mass[std::size_t(i)];
    system.add_node(
        int(i), mass * (1 + h * options.drag) * Mat3::Identity(),
        mass * (node_at(state.node_velocities, int(i)) - h * options.gravity * Vec3::UnitY()));
  }
  for (std::size_t e = 0; e < sheet.springs.size(); ++e) {
    const SheetSpring& spring = sheet.springs[e];
    const Pull pull = spring_pull(node_at(state.nodes, spring.a), node_at(state.nodes, spring.b),
                                  spring.rest, spring.stiffness, sheet.material.slack);
    system.add_spring(int(e), implicit * pull.stiffness, h * pull.force);
  }
}

// Of node k of a strap's loop.
Pull strap_pull(const Strap& strap, double length, std::size_t k, const Points& nodes,
                const Vec3& bar) {
  return spring_pull(node_at(nodes, strap.nodes[k]), bar + strap.hook, length,
                     strap.stiffness * strap.shares[k], 0);
}

void add_straps(const CarryModel& model, const CarryState& state, const Vec3& bar_velocity,
                ContactSystem& system) {
  const double h = model.options.step, implicit = h * (h + model.options.stiffness_damping);
  for (std::size_t s = 0; s < model.sheet->straps.size(); ++s) {
    const Strap& strap = model.sheet->straps[s];
    for (std::size_t k = 0; k < strap.nodes.size(); ++k) {
      const Pull pull = strap_pull(strap, state.strap_lengths[s], k, state.nodes, state.bar);
      system.add_node(strap.nodes[k], implicit * pull.stiffness,
                      h * pull.force + implicit * pull.stiffness * bar_velocity);
    }
  }
}

// Nodes of the sheet in the mattress, with their terms.
struct NodeContact {
  int node = 0;
  Mat3 B = Mat3::Zero();
  Vec3 r = Vec3::Zero();
};

std::vector<NodeContact> nodes_in_mattress(const CarryModel& model, const CarryState& state) {
  std::vector<NodeContact> out;
  const Mattress& mattress = model.mattress;
  if (!mattress.present) return out;
  for (Eigen::Index i = 0; i < state.nodes.rows(); ++i) {
    const double depth = mattress.height - state.nodes(i, 1);
    if (depth <= 0) continue;
    double pressure = 0, slope = 0;
    foundation(mattress.stiffness, 3 * mattress.bottom, depth, pressure, slope);
    NodeContact contact{int(i), Mat3::Zero(), Vec3::Zero()};
    contact_terms(model.options, Vec3::UnitY(), model.sheet->area[std::size_t(i)], pressure, slope,
                  node_at(state.node_velocities, int(i)), contact.B, contact.r);
    out.push_back(contact);
  }
  return out;
}

Vec3 point_velocity(const BodyFrames& frames, const Eigen::VectorXd& velocity, int joint,
                    const Vec3& arm) {
  const Eigen::Matrix<double, 6, 1> v = frames.jacobian[std::size_t(joint)] * velocity;
  return v.tail<3>() + v.head<3>().cross(arm);
}

Vec3 sheet_velocity(const CarryModel& model, const Points& velocities, const SkinContact& contact) {
  Vec3 out = Vec3::Zero();
  if (contact.triangle < 0) return out;
  for (int k = 0; k < 3; ++k)
    out += contact.corners[k] * node_at(velocities, model.sheet->mesh.F(contact.triangle, k));
  return out;
}

std::vector<ContactTerms> skin_terms(const CarryModel& model, const CarryState& state,
                                     const BodyFrames& frames,
                                     const std::vector<SkinContact>& contacts) {
  std::vector<ContactTerms> out;
  out.reserve(contacts.size());
  for (const SkinContact& contact : contacts) {
    ContactTerms terms;
    terms.joint = model.patient.carrier[std::size_t(contact.vertex)];
    terms.arm =
        node_at(state.skin, contact.vertex) - frames.X_WJ[std::size_t(terms.joint)].translation();
    const Vec3 sliding = point_velocity(frames, state.body.velocity, terms.joint, terms.arm) -
                         sheet_velocity(model, state.node_velocities, contact);
    contact_terms(model.options, contact.normal, contact.area, contact.pressure, contact.slope,
                  sliding, terms.B, terms.r);
    out.push_back(terms);
  }
  return out;
}

// Forces as they acted, from the velocities at the end of the step.
void measure_skin(const CarryModel& model, const BodyFrames& frames,
                  const std::vector<SkinContact>& contacts, const std::vector<ContactTerms>& terms,
                  CarryState& state) {
  CarryForces& forces = state.forces;
  const double h = model.options.step;
  forces.pressure.assign(std::size_t(state.skin.rows()), 0);
  forces.contact_area.assign(std::size_t(state.skin.rows()), 0);
  forces.pad.assign(std::size_t(state.skin.rows()), -1);
  forces.region.assign(model.patient.regions.size(), Vec3::Zero());
  forces.pads.assign(model.pads.size(), Vec3::Zero());
  state.pressed = state.skin;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const SkinContact& contact = contacts[c];
    const Vec3 relative =
        point_velocity(frames, state.body.velocity, terms[c].joint, terms[c].arm) -
        sheet_velocity(model, state.node_velocities, contact);
    const Vec3 force = (terms[c].r - terms[c].B * relative) / h;
    const std::size_t i = std::size_t(contact.vertex);
    // A vertex in a corner of two pads has the mean of both.
    const double before = forces.pressure[i] * forces.contact_area[i];
    forces.contact_area[i] += contact.area;
    forces.pressure[i] =
        (before + std::max(0.0, force.dot(contact.normal))) / forces.contact_area[i];
    forces.region[std::size_t(model.patient.region[i])] += force;
    forces.pad[i] = contact.pad;
    if (contact.pad >= 0)
      forces.pads[std::size_t(contact.pad)] += force;
    else if (contact.triangle < 0)
      forces.mattress += force;
    state.pressed.row(contact.vertex) += contact.depth * contact.normal.transpose();
  }
}

void measure_sheet(const CarryModel& model, const Points& before, const Vec3& bar_velocity,
                   const std::vector<NodeContact>& below, CarryState& state) {
  const double h = model.options.step;
  for (const NodeContact& each : below)
    state.forces.mattress += (each.r - each.B * node_at(state.node_velocities, each.node)) / h;
  for (std::size_t s = 0; s < model.sheet->straps.size(); ++s) {
    const Strap& strap = model.sheet->straps[s];
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < strap.nodes.size(); ++k) {
      const Pull pull = strap_pull(strap, state.strap_lengths[s], k, before, state.bar);
      sum += pull.force - (h + model.options.stiffness_damping) * pull.stiffness *
                              (node_at(state.node_velocities, strap.nodes[k]) - bar_velocity);
    }
    state.forces.straps.push_back(sum.norm());
    state.forces.strap_sum += sum;
  }
}

// Limbs that press on each other and on the trunk.
void add_limbs(const CarryModel& model, const BodyFrames& frames, ContactSystem& system) {
  const double h = model.options.step;
  std::vector<ProxyContact> contacts;
  find_proxy_contacts(model.patient.limbs, frames.X_WJ, contacts);
  const auto jacobian = [&](int joint, const Vec3& point) {
    const Eigen::MatrixXd& J = frames.jacobian[std::size_t(joint)];
    const Vec3 arm = point - frames.X_WJ[std::size_t(joint)].translation();
    return Eigen::MatrixXd(J.bottomRows<3>() - cross_matrix(arm) * J.topRows<3>());
  };
  for (const ProxyContact& contact : contacts) {
    const Eigen::RowVectorXd J =
        contact.out.transpose() *
        (jacobian(contact.joint, contact.point) - jacobian(contact.other_joint, contact.point));
    const double c = h * kLimbStiffness * (h + kLimbDamping);
    system.add_body(c * J.transpose() * J, h * kLimbStiffness * contact.depth * J.transpose());
  }
}

void shape_skin(const CarryModel& model, const BodyFrames& frames, CarryState& state) {
  const int every = std::max(1, int(std::lround(model.options.shape_time / model.options.step)));
  if (model.shaper && state.steps % every == 0) {
    Points shaped;
    model.shaper(state.body.pose, shaped);
    fit_shape(model.patient, frames.X_WJ, shaped, state.wanted_shape);
    if (state.steps == 0) state.shape = state.wanted_shape;
  }
  if (model.shaper) state.shape += (state.wanted_shape - state.shape) / every;
  carried_skin(model.patient, frames.X_WJ, state.shape, state.skin);
}

}  // namespace

CarryState start_carrying(const CarryModel& model, const Pose& pose, const Vec3& sheet_offset,
                          const Vec3& bar) {
  CarryState state;
  state.body.pose = pose;
  state.body.velocity.setZero(model.patient.freedoms());
  if (model.sheet) {
    state.nodes = model.sheet->mesh.V.rowwise() + sheet_offset.transpose();
    state.node_velocities.setZero(state.nodes.rows(), 3);
    for (const Strap& strap : model.sheet->straps) state.strap_lengths.push_back(strap.length);
  }
  state.bar = bar;
  state.rest = passive_rest(model.patient, pose);
  state.system = std::make_shared<ContactSystem>(model.sheet.get(), model.patient.freedoms());
  return state;
}

void carry(const CarryModel& model, const Vec3& bar_velocity, CarryState& state) {
  const double h = model.options.step;
  BodyFrames frames;
  body_frames(model.patient, state.body.pose, frames);
  BodyForces body;
  body_forces(model.patient, state.rest, state.body, frames, model.options.gravity, body);
  shape_skin(model, frames, state);
  const Points normals = vertex_normals({state.skin, model.patient.skin.F});
  std::vector<SkinContact> contacts;
  find_contacts(model.patient, state.skin, normals, model.sheet.get(), state.nodes, model.mattress,
                model.pads, h, state.memory, contacts);

  ContactSystem& system = *state.system;
  system.clear();
  system.add_body(
      body.inertia * (1 + h * model.options.drag) + h * body.damping + h * h * body.stiffness,
      body.inertia * state.body.velocity + h * body.force);
  add_limbs(model, frames, system);
  std::vector<NodeContact> below;
  if (model.sheet) {
    add_sheet(model, state, system);
    add_straps(model, state, bar_velocity, system);
    below = nodes_in_mattress(model, state);
    for (const NodeContact& each : below) system.add_node(each.node, each.B, each.r);
  }
  const std::vector<ContactTerms> terms = skin_terms(model, state, frames, contacts);
  for (std::size_t c = 0; c < contacts.size(); ++c)
    system.add_contact(terms[c].joint, terms[c].arm, contacts[c].triangle, contacts[c].corners,
                       terms[c].B, terms[c].r);
  system.solve(frames, state.node_velocities, state.body.velocity);

  state.forces = {};
  measure_skin(model, frames, contacts, terms, state);
  const Points before = state.nodes;
  if (model.sheet) {
    state.nodes += h * state.node_velocities;
    measure_sheet(model, before, bar_velocity, below, state);
  }
  state.bar += h * bar_velocity;
  advance_body(model.patient, h, state.body);
  state.time += h;
  ++state.steps;
}

double carried_energy(const CarryModel& model, const CarryState& state) {
  BodyFrames frames;
  body_frames(model.patient, state.body.pose, frames);
  double sum = body_energy(model.patient, state.body, frames, model.options.gravity);
  for (Eigen::Index i = 0; i < state.nodes.rows(); ++i)
    sum += model.sheet->mass[std::size_t(i)] * (0.5 * state.node_velocities.row(i).squaredNorm() +
                                                model.options.gravity * state.nodes(i, 1));
  return sum;
}

}  // namespace ecorche::inline v1
