#include "skinning/character/live_character.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/muscles/action_line.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kStep = 0.005;  // m, for directions

// Rows of points that are carried, in the order in which they are read again.
struct Rows {
  std::vector<Vec3> points;

  void add(const Vec3& p) { points.push_back(p); }
  // A place with three directions from it.
  void add_frame(const Vec3& p, const Mat3& directions) {
    add(p);
    for (int axis = 0; axis < 3; ++axis) add(p + directions.col(axis));
  }
};

Mat3 directions_at(const Points& moved, Eigen::Index row) {
  Mat3 out;
  for (int axis = 0; axis < 3; ++axis)
    out.col(axis) = (moved.row(row + 1 + axis) - moved.row(row)).transpose();
  return out;
}

// The nearest right-handed frame.
Mat3 nearest_frame(const Mat3& directions) {
  const Svd3 parts = svd(directions);
  Mat3 out = parts.U * parts.V.transpose();
  if (out.determinant() < 0) out.col(2) *= -1;
  return out;
}

Ellipse carried_section(const Ellipse& rest, const Points& moved, Eigen::Index row) {
  Ellipse out = rest;
  out.center = moved.row(row);
  const Vec3 u = moved.row(row + 1).transpose() - out.center,
             v = moved.row(row + 2).transpose() - out.center;
  out.radii = Vec2(u.norm(), v.norm());
  if (out.radii.minCoeff() < 1e-9) return out;
  out.axes.col(0) = u.normalized();
  out.axes.col(2) = u.cross(v).normalized();
  out.axes.col(1) = out.axes.col(2).cross(out.axes.col(0));
  return out;
}

void carry_wrap(const Points& moved, Eigen::Index row, Wrap& wrap) {
  const Mat3 axes = directions_at(moved, row);
  wrap.X_WO.translation() = moved.row(row);
  wrap.X_WO.linear() = nearest_frame(axes * wrap.radii.cwiseInverse().asDiagonal());
  wrap.radii = axes.colwise().norm();
  // Round things stay round.
  if (wrap.kind == Wrap::Kind::sphere) wrap.radii.setConstant(std::cbrt(wrap.radii.prod()));
  if (wrap.kind == Wrap::Kind::cylinder)
    wrap.radii.head<2>().setConstant(std::sqrt(wrap.radii[0] * wrap.radii[1]));
}

// Rows of a strip's path, zero direction and wraps.
Eigen::Index path_rows(const Strip& strip) {
  return Eigen::Index(strip.path.size() + 1 + 4 * strip.wraps.size());
}

// `sections`: carried; then as the strip says them, which knows no shift along its line.
void carry_path(const Strip& rest, const Points& moved, Eigen::Index row,
                std::span<Ellipse> sections, Strip& out) {
  for (PathPoint& point : out.path) point.rest = moved.row(row++);
  out.reference = (moved.row(row++).transpose() - out.path[0].rest).normalized();
  for (std::size_t w = 0; w < out.wraps.size(); ++w, row += 4) {
    out.wraps[w].radii = rest.wraps[w].radii;
    carry_wrap(moved, row, out.wraps[w]);
  }
  out.rest_length = line_length(out.path);
  if (sections.size() < 2) return;
  set_slices(out, sections);
  std::ranges::copy(rest_slices(out), sections.begin());
}

}  // namespace

LiveAnatomy::LiveAnatomy(const Character& character) : start_(character), character_(character) {
  const Anatomy& anatomy = character.anatomy;
  slices_ = rest_slices(anatomy);
  Rows rows;
  for (const Bone& bone : anatomy.bones)
    for (Eigen::Index v = 0; v < bone.mesh.V.rows(); ++v) rows.add(bone.mesh.V.row(v));
  slice_row_ = rows.points.size();
  for (const Ellipse& e : slices_) {
    rows.add(e.center);
    rows.add(e.center + e.radii.x() * e.axes.col(0));
    rows.add(e.center + e.radii.y() * e.axes.col(1));
  }
  path_row_ = rows.points.size();
  for (const Muscle& muscle : anatomy.muscles)
    for (const Strip& strip : muscle.strips) {
      for (const PathPoint& point : strip.path) rows.add(point.rest);
      rows.add(strip.path[0].rest + kStep * strip.reference);
      for (const Wrap& wrap : strip.wraps)
        rows.add_frame(wrap.X_WO.translation(), wrap.X_WO.linear() * wrap.radii.asDiagonal());
    }
  fascia_row_ = rows.points.size();
  for (const FasciaSheet& sheet : anatomy.fascia)
    for (Eigen::Index v = 0; v < sheet.V.rows(); ++v) rows.add(sheet.V.row(v));
  joint_row_ = rows.points.size();
  const std::vector<Vec3> joints = rest_positions(anatomy.skeleton);
  for (std::size_t j = 0; j < joints.size(); ++j)
    rows.add_frame(joints[j], kStep * anatomy.skeleton.joints[j].axes);
  Points inside(rows.points.size(), 3);
  for (std::size_t i = 0; i < rows.points.size(); ++i) inside.row(i) = rows.points[i];
  carrier_ = make_skin_interpolation(character.body.skin.V, inside);
}

void LiveAnatomy::follow(const Points& skin) {
  carry(carrier_, skin, moved_);
  character_.body.skin.V = skin;
  Eigen::Index row = 0;
  for (Bone& bone : character_.anatomy.bones) {
    bone.mesh.V = moved_.middleRows(row, bone.mesh.V.rows());
    row += bone.mesh.V.rows();
  }
  follow_muscles(slice_row_, path_row_);
  row = fascia_row_;
  for (FasciaSheet& sheet : character_.anatomy.fascia) {
    sheet.V = moved_.middleRows(row, sheet.V.rows());
    row += sheet.V.rows();
  }
  follow_skeleton(joint_row_);
}

void LiveAnatomy::follow_muscles(Eigen::Index slice_row, Eigen::Index path_row) {
  const std::vector<Muscle>& rest = start_.anatomy.muscles;
  std::vector<Muscle>& muscles = character_.anatomy.muscles;
  struct Begin {
    Eigen::Index path = 0;
    std::size_t slice = 0;
  };
  std::vector<Begin> begins;
  Begin next{path_row, 0};
  for (const Muscle& muscle : rest) {
    begins.push_back(next);
    for (const Strip& strip : muscle.strips)
      next.path += path_rows(strip), next.slice += strip.slices.size();
  }
  const std::vector<Ellipse> old = rest_slices(start_.anatomy);
  tbb::parallel_for(std::size_t{0}, muscles.size(), [&](std::size_t m) {
    Begin at = begins[m];
    double before = 0, now = 0;
    for (std::size_t s = 0; s < muscles[m].strips.size(); ++s) {
      const Strip& from = rest[m].strips[s];
      const std::size_t count = from.slices.size();
      for (std::size_t k = at.slice; k < at.slice + count; ++k)
        slices_[k] = carried_section(old[k], moved_, slice_row + 3 * Eigen::Index(k));
      const std::span<Ellipse> sections = std::span(slices_).subspan(at.slice, count);
      carry_path(from, moved_, at.path, sections, muscles[m].strips[s]);
      if (count >= 2)
        before += tube_volume(std::span<const Ellipse>(old).subspan(at.slice, count)),
            now += tube_volume(sections);
      at.path += path_rows(from), at.slice += count;
    }
    if (before > 0) muscles[m].volume = rest[m].volume * now / before;
  });
}

void LiveAnatomy::follow_skeleton(Eigen::Index row) {
  Skeleton& skeleton = character_.anatomy.skeleton;
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    const Eigen::Index at = row + 4 * Eigen::Index(j);
    const Eigen::RowVector3d from = joint.parent < 0
                                        ? Eigen::RowVector3d(0, 0, 0)
                                        : Eigen::RowVector3d(moved_.row(row + 4 * joint.parent));
    joint.X_PJ.translation() = (moved_.row(at) - from).transpose();
    joint.axes = nearest_frame(directions_at(moved_, at));
  }
}

}  // namespace ecorche::inline v1
