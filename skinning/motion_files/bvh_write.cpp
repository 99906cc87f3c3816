#include "skinning/motion_files/bvh_write.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace ecorche::inline v1 {
namespace {

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

BvhMotion to_bvh(const Skeleton& skeleton, const Motion& motion) {
  BvhMotion out;
  out.name = "motion.bvh";
  out.fps = motion.fps;
  out.frame_time = 1 / motion.fps;
  const std::vector<int> order = depth_first(skeleton);
  std::vector<int> index(order.size());  // of our joint in the file
  for (size_t k = 0; k < order.size(); ++k) index[order[k]] = int(k);
  for (int j : order) {
    const Joint& joint = skeleton.joints[j];
    BvhJoint written;
    written.name = joint.name;
    written.parent = joint.parent < 0 ? -1 : index[joint.parent];
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
      out.samples.insert(out.samples.end(),
                         {z * kDegreesPerRadian, x * kDegreesPerRadian, y * kDegreesPerRadian});
    }
    ++out.frames;
  }
  return out;
}

}  // namespace ecorche::inline v1
