#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "anatomy/files/atomic_file.h"
#include "skinning/motion_files/bvh_io.h"

namespace ecorche {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

const char* channel_name(BvhChannel channel) {
  static constexpr const char* kNames[] = {"Xposition", "Yposition", "Zposition",
                                           "Xrotation", "Yrotation", "Zrotation"};
  return kNames[std::size_t(channel)];
}

// Twelve digits: 1e-9 of the value comes back, and no noise of the last bits is spelled out.
std::string number(double value) { return fmt::format("{:.12g}", value + 0.0); }

void append_offset(std::string& out, int depth, const Vec3& offset) {
  out += fmt::format("{:{}}OFFSET {} {} {}\n", "", 2 * depth, number(offset.x()),
                     number(offset.y()), number(offset.z()));
}

void open_joint(std::string& out, const BvhJoint& joint, int depth) {
  out += fmt::format("{:{}}{} {}\n{:{}}{{\n", "", 2 * depth, joint.parent < 0 ? "ROOT" : "JOINT",
                     joint.name, "", 2 * depth);
  append_offset(out, depth + 1, joint.offset);
  out += fmt::format("{:{}}CHANNELS {}", "", 2 * depth + 2, joint.channels.size());
  for (BvhChannel channel : joint.channels) out += std::string(" ") + channel_name(channel);
  out += '\n';
  for (const Vec3& site : joint.end_sites) {
    out += fmt::format("{:{}}End Site\n{:{}}{{\n", "", 2 * depth + 2, "", 2 * depth + 2);
    append_offset(out, depth + 2, site);
    out += fmt::format("{:{}}}}\n", "", 2 * depth + 2);
  }
}

// Joints in the order they are stored must be a walk through the tree; anything else cannot be
// written as nested braces.
void append_hierarchy(std::string& out, const BvhMotion& motion) {
  std::vector<int> open;
  auto close = [&] {
    out += fmt::format("{:{}}}}\n", "", 2 * (open.size() - 1));
    open.pop_back();
  };
  for (size_t j = 0; j < motion.joints.size(); ++j) {
    const int parent = motion.joints[j].parent;
    while (!open.empty() && open.back() != parent) close();
    if (parent >= 0 && open.empty())
      throw std::invalid_argument(fmt::format(
          "format_bvh: joint '{}' does not follow its parent's branch", motion.joints[j].name));
    open_joint(out, motion.joints[j], int(open.size()));
    open.push_back(int(j));
  }
  while (!open.empty()) close();
}

Mat3 axis_rotation(BvhChannel channel, double degrees) {
  const int axis = int(channel) - int(BvhChannel::x_rotation);
  return Eigen::AngleAxisd(degrees / kDegrees, Vec3::Unit(axis)).toRotationMatrix();
}

// Children of every joint in depth-first order, as BVH files need them.
std::vector<int> depth_first(const Skeleton& skeleton) {
  std::vector<std::vector<int>> children(skeleton.joints.size() + 1);
  for (size_t j = 0; j < skeleton.joints.size(); ++j)
    children[skeleton.joints[j].parent + 1].push_back(int(j));
  std::vector<int> order, stack(children[0].rbegin(), children[0].rend());
  while (!stack.empty()) {
    const int j = stack.back();
    stack.pop_back();
    order.push_back(j);
    stack.insert(stack.end(), children[j + 1].rbegin(), children[j + 1].rend());
  }
  return order;
}

}  // namespace

std::string format_bvh(const BvhMotion& motion) {
  if (motion.samples.size() != std::size_t(motion.frames) * motion.channels)
    throw std::invalid_argument(fmt::format("format_bvh: {} samples for {} frames of {} channels",
                                            motion.samples.size(), motion.frames, motion.channels));
  std::string out = "HIERARCHY\n";
  append_hierarchy(out, motion);
  out += fmt::format("MOTION\nFrames: {}\nFrame Time: {:.10f}\n", motion.frames, 1 / motion.fps);
  for (int f = 0; f < motion.frames; ++f) {
    for (int c = 0; c < motion.channels; ++c) {
      const double value = motion.samples[f * motion.channels + c];
      if (!std::isfinite(value))
        throw std::invalid_argument(
            fmt::format("format_bvh: frame {} channel {} is not finite", f, c));
      if (c > 0) out += ' ';
      out += number(value);
    }
    out += '\n';
  }
  return out;
}

void write_bvh(const std::filesystem::path& file, const BvhMotion& motion) {
  write_file_atomically(file, format_bvh(motion));
}

void bvh_kinematics(const BvhMotion& motion, int frame, std::vector<Transform>& out) {
  if (frame < -1 || frame >= motion.frames)
    throw std::invalid_argument(
        fmt::format("bvh_kinematics: frame {} of {}", frame, motion.frames));
  out.resize(motion.joints.size());
  for (size_t j = 0; j < out.size(); ++j) {
    const BvhJoint& joint = motion.joints[j];
    Vec3 position = joint.offset;
    Mat3 rotation = Mat3::Identity();
    if (frame >= 0) {
      const double* row =
          motion.samples.data() + std::size_t(frame) * motion.channels + joint.first_channel;
      for (size_t k = 0; k < joint.channels.size(); ++k) {
        if (joint.channels[k] < BvhChannel::x_rotation)
          position[int(joint.channels[k])] = row[k];
        else
          rotation = rotation * axis_rotation(joint.channels[k], row[k]);
      }
    }
    Transform local = Transform::Identity();
    local.linear() = rotation;
    local.translation() = position;
    out[j] = joint.parent < 0 ? local : out[joint.parent] * local;
  }
}

BvhMotion to_bvh(const Skeleton& skeleton, const Motion& motion) {
  BvhMotion out;
  out.name = "motion.bvh";
  out.fps = motion.fps;
  out.frame_time = 1 / motion.fps;
  const std::vector<int> order = depth_first(skeleton);
  std::vector<int> place(order.size());
  for (size_t k = 0; k < order.size(); ++k) place[order[k]] = int(k);
  for (int j : order) {
    const Joint& joint = skeleton.joints[j];
    BvhJoint written;
    written.name = joint.name;
    written.parent = joint.parent < 0 ? -1 : place[joint.parent];
    written.offset = joint.X_PJ.translation();
    if (joint.parent < 0)
      written.channels = {BvhChannel::x_position, BvhChannel::y_position, BvhChannel::z_position};
    written.channels.insert(written.channels.end(), {BvhChannel::z_rotation, BvhChannel::x_rotation,
                                                     BvhChannel::y_rotation});
    written.first_channel = out.channels;
    out.channels += written.channels.size();
    out.joints.push_back(written);
  }
  for (const Pose& pose : motion.frames) {
    for (int j : order) {
      if (skeleton.joints[j].parent < 0)
        out.samples.insert(out.samples.end(), {pose.root.x(), pose.root.y(), pose.root.z()});
      // R = Rz Rx Ry: the sine of the middle angle is R(2,1).
      const Mat3 R = pose.rotations[j].toRotationMatrix();
      const double x = std::atan2(R(2, 1), std::hypot(R(2, 0), R(2, 2)));
      const double z = std::atan2(-R(0, 1), R(1, 1)), y = std::atan2(-R(2, 0), R(2, 2));
      out.samples.insert(out.samples.end(), {z * kDegrees, x * kDegrees, y * kDegrees});
    }
    ++out.frames;
  }
  return out;
}

}  // namespace ecorche
