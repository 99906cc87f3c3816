#include "viewer/organ_rooms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>

#include "anatomy/geometry/join_meshes.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/queries/ray_caster.h"
#include "viewer/scene.h"

namespace ecorche {
namespace {

constexpr int kAround = 60, kRings = 12;  // directions, rings of a cap
constexpr double kStep = 0.008;           // m, between heights
constexpr double kWall = 0.002;           // m, kept from what a ray meets
constexpr double kVault = 0.0065;         // m, of the skull's roof
constexpr double kBase = 0.009;           // m, of its floor
constexpr int kBridgedRows = 2, kBridgedColumns = 1;
// Unlike any tissue: what is there is not modelled.
const Vec3f kRoomColors[] = {{0.42f, 0.45f, 0.54f}, {0.42f, 0.45f, 0.54f}, {0.50f, 0.46f, 0.45f}};

bool is_of_spine(std::string_view name) {
  return name == "sacrum" || ((name[0] == 't' || name[0] == 'l') && name.size() <= 3 &&
                              name.size() > 1 && std::isdigit(static_cast<unsigned char>(name[1])));
}

bool is_of_wall(std::string_view name) {
  return is_of_spine(name) || name.starts_with("rib") || name.starts_with("sternum") ||
         name.starts_with("hip_bone");
}

// What a room can grow against: bones of the trunk's wall and the muscles around.
TriMesh wall_of(const Anatomy& anatomy, const MuscleSurface& surface) {
  TriMesh muscles;
  std::vector<const TriMesh*> wall{&muscles};
  Eigen::AlignedBox3d box;
  for (const Bone& bone : anatomy.bones) {
    if (!is_of_wall(bone.name)) continue;
    wall.push_back(&bone.mesh);
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v)
      box.extend(Vec3(bone.mesh.V.row(v).transpose()));
  }
  if (surface.vertices() > 0) update_muscle_surface(surface, rest_slices(anatomy), muscles.V);
  muscles.F.resize(surface.F.rows(), 3);
  Eigen::Index near = 0;
  for (Eigen::Index f = 0; f < surface.F.rows(); ++f)
    if (box.contains(Vec3(muscles.V.row(surface.F(f, 0)).transpose())))
      muscles.F.row(near++) = surface.F.row(f);
  muscles.F.conservativeResize(near, 3);
  return join_meshes(wall);
}

// Distances from an axis to a wall, by height and direction; a gap in the wall is not a number.
struct Shaft {
  double low = 0;                                    // m, of the first row
  std::vector<Vec3> axis;                            // #rows
  std::vector<std::array<double, kAround>> reach{};  // #rows, m

  static Vec3 direction(int column) {
    const double angle = 2 * std::numbers::pi * column / kAround;
    return {std::sin(angle), 0, std::cos(angle)};  // 0: to the front
  }
  // The row below a height, and the share of the way to the next one.
  std::pair<std::size_t, double> row_at(double height) const {
    const double row = std::clamp((height - low) / kStep, 0.0, double(axis.size()) - 1);
    const std::size_t k = std::min(std::size_t(row), axis.size() - 2);
    return {k, row - double(k)};
  }
  // On the wall at a height between rows.
  Vec3 at(double height, int column) const {
    const auto [k, u] = row_at(height);
    const std::size_t c = std::size_t(column % kAround);
    return middle(height) + ((1 - u) * reach[k][c] + u * reach[k + 1][c]) * direction(column);
  }
  Vec3 middle(double height) const {
    const auto [k, u] = row_at(height);
    return axis[k] + u * (axis[k + 1] - axis[k]);
  }
};

// The least or the most within a window, which goes round in the columns.
std::vector<std::array<double, kAround>> extreme(
    const std::vector<std::array<double, kAround>>& reach, bool least, int rows_beside,
    int columns_beside) {
  auto out = reach;
  const int rows = int(reach.size());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < kAround; ++c)
      for (int i = std::max(r - rows_beside, 0); i <= std::min(r + rows_beside, rows - 1); ++i)
        for (int j = c - columns_beside; j <= c + columns_beside; ++j) {
          const double value = reach[std::size_t(i)][std::size_t((j + kAround) % kAround)];
          double& own = out[std::size_t(r)][std::size_t(c)];
          own = least ? std::min(own, value) : std::max(own, value);
        }
  return out;
}

// Gaps take the mean of what is beside them, round by round.
void close_gaps(Shaft& shaft) {
  const int rows = int(shaft.reach.size());
  for (bool open = true; open;) {
    open = false;
    bool closed = false;
    const auto before = shaft.reach;
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < kAround; ++c) {
        if (!std::isnan(before[std::size_t(r)][std::size_t(c)])) continue;
        double sum = 0;
        int count = 0;
        for (const auto& [i, j] : {std::pair{r - 1, c}, {r + 1, c}, {r, c - 1}, {r, c + 1}}) {
          if (i < 0 || i >= rows) continue;
          const double value = before[std::size_t(i)][std::size_t((j + kAround) % kAround)];
          if (!std::isnan(value)) sum += value, ++count;
        }
        if (count > 0)
          shaft.reach[std::size_t(r)][std::size_t(c)] = sum / count, closed = true;
        else
          open = true;
      }
    if (!closed) break;
  }
}

// The spine's front by rows; not a number where there is no spine.
std::vector<double> spine_fronts(const Anatomy& anatomy, double low, std::size_t rows) {
  constexpr double beside = 0.02;  // m
  std::vector<double> out(rows, std::nan(""));
  for (const Bone& bone : anatomy.bones) {
    if (!is_of_spine(bone.name)) continue;
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
      const Vec3 p = bone.mesh.V.row(v).transpose();
      const auto row = std::lround((p.y() - low) / kStep);
      if (std::abs(p.x()) > beside || row < 0 || row >= long(rows)) continue;
      for (long k = std::max(row - 2, 0l); k <= std::min(row + 2, long(rows) - 1); ++k)
        if (!(out[std::size_t(k)] >= p.z())) out[std::size_t(k)] = p.z();
    }
  }
  return out;
}

std::optional<Shaft> shaft_of(const Anatomy& anatomy, const SkinRays& wall, double low,
                              double high) {
  const auto rows = std::size_t((high - low) / kStep) + 1;
  Shaft out{low, {}, {}};
  double behind = std::nan(""), depth = 0.12;
  for (const double front : spine_fronts(anatomy, low, rows)) {
    if (!std::isnan(front)) behind = std::isnan(behind) ? front : 0.7 * behind + 0.3 * front;
    if (std::isnan(behind)) return std::nullopt;
    const double height = low + kStep * double(out.axis.size());
    const RayHit hit = wall.first_hit({0, height, behind + 0.03}, Vec3::UnitZ(), 0.4);
    if (hit.triangle >= 0) depth += 0.3 * (std::max(hit.distance + 0.03, 0.05) - depth);
    out.axis.emplace_back(0, height, behind + 0.5 * depth);
  }
  for (const Vec3& from : out.axis) {
    auto& row = out.reach.emplace_back();
    for (int c = 0; c < kAround; ++c) {
      const RayHit hit = wall.first_hit(from, Shaft::direction(c), 0.3);
      row[std::size_t(c)] = hit.triangle < 0 ? std::nan("") : std::max(hit.distance - kWall, 0.005);
    }
  }
  close_gaps(out);
  for (const auto& row : out.reach)
    for (const double value : row)
      if (std::isnan(value)) return std::nullopt;
  out.reach = extreme(extreme(out.reach, true, kBridgedRows, kBridgedColumns), false, kBridgedRows,
                      kBridgedColumns);
  out.reach = extreme(out.reach, true, 1, 0);  // what lies between rays is not pierced
  return out;
}

// Two sheets over the same rim, and the wall between: from below, ring by ring.
struct Ring {
  std::vector<Vec3> points;  // #around; counter-clockwise seen from above
};

OrganRoom closed(int which, const std::vector<Ring>& rings) {
  OrganRoom out;
  out.which = which;
  for (const Ring& ring : rings)
    for (const Vec3& p : ring.points) out.rest.push_back(p.cast<float>());
  const auto index = [](std::size_t ring, int column) {
    return std::uint32_t(ring * kAround + std::size_t(column % kAround));
  };
  for (std::size_t r = 0; r + 1 < rings.size(); ++r)
    for (int c = 0; c < kAround; ++c) {
      out.triangles.emplace_back(index(r, c), index(r, c + 1), index(r + 1, c + 1));
      out.triangles.emplace_back(index(r, c), index(r + 1, c + 1), index(r + 1, c));
    }
  for (const std::size_t end : {std::size_t(0), rings.size() - 1}) {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : rings[end].points) middle += p / double(kAround);
    const auto tip = std::uint32_t(out.rest.size());
    out.rest.push_back(middle.cast<float>());
    for (int c = 0; c < kAround; ++c) {
      const std::uint32_t a = index(end, c), b = index(end, c + 1);
      out.triangles.push_back(end == 0 ? Triangle32(tip, b, a) : Triangle32(tip, a, b));
    }
  }
  return out;
}

double extreme_height(const Anatomy& anatomy, std::string_view begin, bool low, double beside) {
  double out = std::nan("");
  for (const Bone& bone : anatomy.bones) {
    if (bone.name != begin && bone.name != std::string(begin) + "_l") continue;
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) {
      if (std::abs(bone.mesh.V(v, 0)) > beside) continue;
      const double y = bone.mesh.V(v, 1);
      if (std::isnan(out) || (low ? y < out : y > out)) out = y;
    }
  }
  return out;
}

// Joints of the trunk from below, and how a height hangs between them.
OrganRoom::Hold hold_at(const std::vector<std::pair<double, int>>& joints, double height) {
  std::size_t k = 0;
  while (k + 1 < joints.size() && joints[k + 1].first < height) ++k;
  if (k + 1 == joints.size()) return {joints[k].second, joints[k].second, 0};
  const double share = (height - joints[k].first) / (joints[k + 1].first - joints[k].first);
  return {joints[k].second, joints[k + 1].second, float(std::clamp(share, 0.0, 1.0))};
}

void add_trunk(const Anatomy& anatomy, const MuscleSurface& surface, std::vector<OrganRoom>& out) {
  const double floor = extreme_height(anatomy, "sacrum", true, 1),
               inlet = extreme_height(anatomy, "rib1", false, 1),
               tip = extreme_height(anatomy, "sternum", true, 0.02),
               side = extreme_height(anatomy, "rib10", true, 1),
               back = extreme_height(anatomy, "t12", true, 1),
               dome = extreme_height(anatomy, "t10", false, 1);
  for (const double height : {floor, inlet, tip, side, back, dome})
    if (std::isnan(height)) return;
  const TriMesh mesh = wall_of(anatomy, surface);
  if (mesh.F.rows() == 0) return;
  const SkinRays wall(mesh, RayBuild::quick);
  const std::optional<Shaft> shaft = shaft_of(anatomy, wall, floor, inlet);
  if (!shaft) return;
  // Where the midriff's edge lies: at the tip of the breast bone, at the sides on the tenth ribs,
  // behind on the last vertebra of the chest.
  const auto rim = [&](int column) {
    const double front = Shaft::direction(column).z();
    const double end = front > 0 ? tip : back;
    return side + front * front * (end - side);
  };
  const auto level = [&](double from, double to, double share) {
    Ring ring;
    for (int c = 0; c < kAround; ++c) {
      const double a = from >= 0 ? from : rim(c), b = to >= 0 ? to : rim(c);
      ring.points.push_back(shaft->at(a + share * (b - a), c));
    }
    return ring;
  };
  const auto cap = [&](double share) {  // 0: the rim, 1: the dome's top
    Ring ring;
    for (int c = 0; c < kAround; ++c) {
      const Vec3 edge = shaft->at(rim(c), c);
      const double inwards = 1 - share;
      Vec3 top = shaft->middle(dome);
      Vec3 p = top + inwards * (edge - top);
      p.y() = edge.y() + (dome - edge.y()) * (1 - inwards * inwards);
      ring.points.push_back(p);
    }
    return ring;
  };
  constexpr double kRim = -1;
  const int chest_rows = int((inlet - tip) / kStep) + 4,
            belly_rows = int((tip - floor) / kStep) + 4;
  std::vector<Ring> chest, belly;
  for (int k = kRings - 1; k > 0; --k) chest.push_back(cap(double(k) / kRings));
  for (int k = 0; k <= chest_rows; ++k) chest.push_back(level(kRim, inlet, double(k) / chest_rows));
  for (int k = 0; k <= belly_rows; ++k) belly.push_back(level(floor, kRim, double(k) / belly_rows));
  for (int k = 1; k < kRings; ++k) belly.push_back(cap(double(k) / kRings));
  const std::vector<Vec3> rest = rest_positions(anatomy.skeleton);
  std::vector<std::pair<double, int>> joints;
  for (const char* name : {"pelvis", "l5", "l4", "l3", "l2", "l1", "t12", "t11", "thorax"})
    if (const int j = find_joint(anatomy.skeleton, name); j >= 0)
      if (joints.empty() || rest[std::size_t(j)].y() > joints.back().first)
        joints.emplace_back(rest[std::size_t(j)].y(), j);
  for (OrganRoom& room : std::array{closed(1, chest), closed(2, belly)}) {
    for (const Vec3f& p : room.rest) room.holds.push_back(hold_at(joints, double(p.y())));
    out.push_back(std::move(room));
  }
}

void add_skull(const Anatomy& anatomy, std::vector<OrganRoom>& out) {
  const int found = find_bone(anatomy, "skull");
  if (found < 0 || anatomy.bones[std::size_t(found)].mesh.F.rows() == 0) return;
  const Bone& skull = anatomy.bones[std::size_t(found)];
  const Vec3 low = skull.mesh.V.colwise().minCoeff(), high = skull.mesh.V.colwise().maxCoeff();
  const double up = 0.37 * (high.y() - low.y());
  const Vec3 middle(0.5 * (low.x() + high.x()), high.y() - up, 0.5 * (low.z() + high.z()));
  const SkinRays rays(skull.mesh, RayBuild::quick);
  const auto reach = [&](const Vec3& to) {
    const RayHit hit = rays.first_hit(middle, to, 0.2);
    return hit.triangle < 0 ? 0.2 : double(hit.distance);
  };
  // Below, where face and neck are open, it ends as an ellipsoid would.
  const Vec3 half(reach(Vec3::UnitX()), 1.05 * up, 0.92 * reach(Vec3::UnitZ()));
  std::vector<Ring> rings;
  constexpr int rows = 30;
  for (int r = 1; r < rows; ++r) {
    Ring ring;
    const double tilt = std::numbers::pi * (double(r) / rows - 0.5);
    for (int c = 0; c < kAround; ++c) {
      const Vec3 to = std::cos(tilt) * Shaft::direction(c) + std::sin(tilt) * Vec3::UnitY();
      double far = reach(to) - (to.y() < -0.2 ? kBase : kVault);
      if (to.y() < 0) far = std::min(far, 1 / to.cwiseQuotient(half).norm());
      ring.points.push_back(middle + std::max(far, 0.01) * to);
    }
    rings.push_back(std::move(ring));
  }
  OrganRoom room = closed(0, rings);
  room.holds.assign(room.rest.size(), {skull.joint, skull.joint, 0});
  out.push_back(std::move(room));
}

}  // namespace

std::vector<OrganRoom> find_organ_rooms(const Anatomy& anatomy, const MuscleSurface& surface) {
  std::vector<OrganRoom> out;
  add_skull(anatomy, out);
  add_trunk(anatomy, surface, out);
  return out;
}

DrawMesh posed_room(const OrganRoom& room, const std::vector<Vec3>& joint_rest,
                    const PosedAnatomy& posed) {
  DrawMesh out;
  out.triangles = room.triangles;
  out.parts.assign(room.rest.size(), kFirstRoomPart + std::uint32_t(room.which));
  out.colors.assign(room.rest.size(), kRoomColors[room.which]);
  const auto carried = [&](const Vec3& place, int joint) {
    return Vec3(posed.X_WJ[std::size_t(joint)] * (place - joint_rest[std::size_t(joint)]));
  };
  for (std::size_t v = 0; v < room.rest.size(); ++v) {
    const Vec3 place = room.rest[v].cast<double>();
    const OrganRoom::Hold& hold = room.holds[v];
    Vec3 now = (1 - hold.share) * carried(place, hold.lower);
    if (hold.share > 0) now += hold.share * carried(place, hold.upper);
    out.positions.push_back(now.cast<float>());
  }
  out.normals.assign(out.positions.size(), Vec3f::UnitY());
  return out;
}

std::vector<DrawMesh> posed_rooms(const std::vector<OrganRoom>& rooms,
                                  const std::vector<Vec3>& joint_rest, const PosedAnatomy& posed) {
  std::vector<DrawMesh> out;
  for (const OrganRoom& room : rooms) out.push_back(posed_room(room, joint_rest, posed));
  return out;
}

double volume_of(const OrganRoom& room) {
  double six = 0;
  for (const Triangle32& t : room.triangles) {
    const Vec3 a = room.rest[t[0]].cast<double>(), b = room.rest[t[1]].cast<double>(),
               c = room.rest[t[2]].cast<double>();
    six += a.dot(b.cross(c));
  }
  return six / 6;
}

}  // namespace ecorche
