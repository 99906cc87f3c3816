#include "app/files/open_plates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "skinning/motion_files/opensim_read.h"

namespace ecorche {
namespace {

constexpr double kStands = 20;  // N: below, a plate's noise

// Columns of x, y, z; -1: none.
struct PlateColumns {
  std::array<int, 3> force{-1, -1, -1}, place{-1, -1, -1}, torque{-1, -1, -1};
};

int column_of(const CoordinateTable& table, const std::string& name) {
  const auto found = std::ranges::find(table.columns, name);
  return found == table.columns.end() ? -1 : int(found - table.columns.begin());
}

// "R_ground_force_vx" and "ground_force_r_vx" have "R_ground_torque_x", "ground_torque_r_x".
std::vector<PlateColumns> plates_of(const CoordinateTable& table) {
  std::vector<PlateColumns> out;
  for (const std::string& column : table.columns) {
    if (!column.ends_with("_vy")) continue;
    const std::string stem = column.substr(0, column.size() - 2);
    std::string twist = stem;
    if (const std::size_t at = twist.find("force"); at != std::string::npos)
      twist.replace(at, 5, "torque");
    PlateColumns plate;
    for (std::size_t k = 0; k < 3; ++k) {
      const char axis = char('x' + k);
      plate.force[k] = column_of(table, stem + "v" + axis);
      plate.place[k] = column_of(table, stem + "p" + axis);
      plate.torque[k] = column_of(table, twist + axis);
    }
    if (std::ranges::min(plate.force) >= 0 && std::ranges::min(plate.place) >= 0)
      out.push_back(plate);
  }
  return out;
}

// Mean of the rows within half a frame of a moment: plates are faster than cameras. Places are
// weighted by force.
FootForce force_at(const CoordinateTable& table, const PlateColumns& plate, double time,
                   double half) {
  const auto row = [&](double t) {
    return std::size_t(std::ranges::lower_bound(table.times, t) - table.times.begin());
  };
  std::size_t first = row(time - half), end = std::max(row(time + half), first + 1);
  end = std::min(end, table.rows.size());
  FootForce out;
  if (first >= end) return out;
  const auto three = [&](std::size_t r, const std::array<int, 3>& columns) {
    Vec3 v = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      if (columns[std::size_t(k)] >= 0) v[k] = table.rows[r][std::size_t(columns[std::size_t(k)])];
    return v;
  };
  double pressed = 0;
  for (std::size_t r = first; r < end; ++r) {
    const Vec3 force = three(r, plate.force);
    out.force += force / double(end - first);
    out.free_moment += three(r, plate.torque).y() / double(end - first);
    const double weight = std::max(force.y(), 1e-6);
    out.place += weight * three(r, plate.place);
    pressed += weight;
  }
  out.place /= pressed;
  return out;
}

}  // namespace

std::vector<std::array<FootForce, 2>> open_plates(const std::filesystem::path& file,
                                                  const Skeleton& skeleton, const Motion& motion,
                                                  const PlateFrame& frame) {
  const std::string name = printable(file.filename().string());
  const CoordinateTable table = parse_coordinates(read_input_file(file, limits::kTableBytes), name);
  const std::vector<PlateColumns> plates = plates_of(table);
  if (plates.empty())
    throw UnfitError(fmt::format(
        "{}: no force of a plate; columns NAME_vx, _vy, _vz, _px, _py, _pz are needed", name));
  const int n = int(motion.frames.size());
  const double end = frame.start + (n - 1) / motion.fps;
  if (table.times.back() < frame.start || table.times.front() > end)
    throw UnfitError(
        fmt::format("{}: it lasts from {:.3f} to {:.3f} s, the motion from {:.3f} to "
                    "{:.3f} s",
                    name, table.times.front(), table.times.back(), frame.start, end));
  const std::array<int, 2> feet{find_joint(skeleton, "subtalar_l"),
                                find_joint(skeleton, "subtalar_r")};
  std::vector<std::array<Vec3, 2>> at;
  std::vector<Transform> X;
  for (const Pose& pose : motion.frames) {
    forward_kinematics(skeleton, pose, X);
    at.push_back({X[std::size_t(feet[0])].translation(), X[std::size_t(feet[1])].translation()});
  }
  std::vector<std::array<FootForce, 2>> out(at.size());
  for (const PlateColumns& plate : plates) {
    std::vector<FootForce> forces;
    for (int f = 0; f < n; ++f) {
      forces.push_back(force_at(table, plate, frame.start + f / motion.fps, 0.5 / motion.fps));
      forces.back().force = frame.turn * forces.back().force;
      forces.back().place = frame.scale * (frame.turn * forces.back().place);
      forces.back().place.y() += frame.floor;
    }
    for (int f = 0; f < n; ++f) {
      if (forces[std::size_t(f)].force.y() < kStands) continue;
      std::array<double, 2> away{0, 0};
      int last = f;
      for (; last < n && forces[std::size_t(last)].force.y() >= kStands; ++last)
        for (std::size_t s = 0; s < 2; ++s) {
          const Vec3 way = forces[std::size_t(last)].place - at[std::size_t(last)][s];
          away[s] += forces[std::size_t(last)].force.y() * std::hypot(way.x(), way.z());
        }
      const std::size_t foot = away[1] < away[0] ? 1 : 0;
      for (; f < last; ++f) {
        FootForce& whole = out[std::size_t(f)][foot];
        const FootForce& part = forces[std::size_t(f)];
        const double sum = whole.force.y() + part.force.y();
        whole.place = (whole.force.y() * whole.place + part.force.y() * part.place) / sum;
        whole.force += part.force;
        whole.free_moment += part.free_moment;
      }
    }
  }
  return out;
}

}  // namespace ecorche
