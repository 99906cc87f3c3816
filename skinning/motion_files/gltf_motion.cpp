#include "skinning/motion_files/gltf_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/gltf_nodes.h"

namespace ecorche::inline v1 {
namespace {

using Json = nlohmann::json;

enum class Interpolation { linear, step, cubic };

// Keys of one property of a node.
struct Track {
  std::vector<double> times;
  GltfFile::Rows values;  // cubic: tangent, value, tangent a key
  Interpolation how = Interpolation::linear;

  Eigen::VectorXd at(double t) const {
    const auto value = [&](std::size_t key, std::size_t part) -> Eigen::VectorXd {
      return values.row(Eigen::Index(how == Interpolation::cubic ? 3 * key + part : key));
    };
    const auto above = std::upper_bound(times.begin(), times.end(), t);
    if (above == times.begin()) return value(0, 1);
    const std::size_t k = std::size_t(above - times.begin()) - 1;
    if (k + 1 >= times.size() || how == Interpolation::step) return value(k, 1);
    const double span = times[k + 1] - times[k], u = (t - times[k]) / span;
    Eigen::VectorXd a = value(k, 1), b = value(k + 1, 1);
    if (how == Interpolation::cubic) {
      const double u2 = u * u, u3 = u2 * u;
      return (2 * u3 - 3 * u2 + 1) * a + span * (u3 - 2 * u2 + u) * value(k, 2) +
             (-2 * u3 + 3 * u2) * b + span * (u3 - u2) * value(k + 1, 0);
    }
    if (a.size() == 4) {
      const Quat q = Quat(a[3], a[0], a[1], a[2])
                         .normalized()
                         .slerp(u, Quat(b[3], b[0], b[1], b[2]).normalized());
      return q.coeffs();
    }
    return (1 - u) * a + u * b;
  }
};

struct NodeTracks {
  std::optional<Track> translation, rotation, scale;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name,
         std::optional<std::filesystem::path> folder)
      : file_(bytes, name, std::move(folder)), tree_(file_) {}

  MotionClip read(const GltfMotionOptions& options) {
    MotionClip out;
    out.name = file_.name();
    read_take(options, out.warnings);
    choose_joints();
    out.fps = fps_;
    out.frame_count = frames_;
    add_joints(out);
    sample(out);
    return out;
  }

  std::optional<NodeMotion> read_nodes(const std::vector<NodeName>& wanted,
                                       const GltfMotionOptions& options) {
    NodeMotion out;
    read_take(options, out.warnings);
    out.fps = fps_;
    const std::vector<std::size_t> nodes = find_nodes(wanted);
    if (nodes.empty() ||
        std::none_of(nodes.begin(), nodes.end(), [&](std::size_t node) { return moves(node); }))
      return std::nullopt;
    for (const std::size_t node : nodes) {
      const int above = tree_.parents()[node];
      out.standing.push_back(tree_.world()[node]);
      out.above.push_back(above < 0 ? Affine::Identity() : tree_.world()[std::size_t(above)]);
    }
    start_sampling();
    for (int f = 0; f < frames_; ++f) {
      place_nodes(double(f) / fps_);
      out.frames.emplace_back();
      for (const std::size_t node : nodes) out.frames.back().push_back(world_[node]);
    }
    return out;
  }

 private:
  void read_take(const GltfMotionOptions& options, std::vector<std::string>& warnings) {
    const Json& take = find_take(options.take);
    read_tracks(take);
    if (options.take.empty() && file_.count("animations") > 1)
      warnings.push_back(fmt::format("{} animations; '{}' is taken, --take NAME takes another",
                                     file_.count("animations"),
                                     printable(take.value("name", "take 1"))));
    fps_ = options.fps ? *options.fps : rate();
    const double frames = std::floor(last_ * fps_ + 1e-3) + 1;
    if (frames > limits::kMotionFrames)
      throw LimitError(fmt::format("{}: {:.0f} frames; the limit is {}", file_.name(), frames,
                                   limits::kMotionFrames));
    frames_ = int(frames);
  }

  std::string node_name(std::size_t node) const {
    return file_.item("nodes", node).value("name", fmt::format("joint {}", node));
  }

  // Empty where one is missing.
  std::vector<std::size_t> find_nodes(const std::vector<NodeName>& wanted) const {
    std::map<std::string, std::size_t> by_name;
    for (std::size_t n = 0; n < tree_.parents().size(); ++n) by_name.emplace(node_name(n), n);
    std::vector<std::size_t> out;
    for (const auto& [name, number] : wanted) {
      const auto found = by_name.find(name);
      if (found == by_name.end()) return {};
      const bool same = number < tree_.parents().size() && node_name(number) == name;
      out.push_back(same ? number : found->second);
    }
    return out;
  }

  bool moves(std::size_t node) const {
    for (int up = int(node); up >= 0; up = tree_.parents()[std::size_t(up)])
      if (tracks_.contains(std::size_t(up))) return true;
    return false;
  }

  const Json& find_take(const std::string& wanted) const {
    const std::size_t count = file_.count("animations");
    if (count == 0)
      throw UnfitError(file_.name() +
                       ": it holds no animation; give a motion, or export it with one");
    if (wanted.empty()) return file_.item("animations", 0);
    std::vector<std::string> names;
    for (std::size_t k = 0; k < count; ++k) {
      names.push_back(file_.item("animations", k).value("name", std::string()));
      if (names.back() == wanted) return file_.item("animations", k);
    }
    if (std::all_of(wanted.begin(), wanted.end(), [](char c) { return c >= '0' && c <= '9'; }) &&
        wanted.size() < 6 && std::stoul(wanted) >= 1 && std::stoul(wanted) <= count)
      return file_.item("animations", std::stoul(wanted) - 1);
    if (names.size() > 20) names.resize(20);
    throw UnfitError(fmt::format("{}: no animation '{}'; there are {}: {}", file_.name(),
                                 printable(wanted), count,
                                 printable(fmt::format("{}", fmt::join(names, ", ")))));
  }

  void read_tracks(const Json& take) {
    const Json& samplers = take.at("samplers");
    for (const Json& channel : take.at("channels")) {
      const Json& target = channel.at("target");
      if (!target.contains("node")) continue;
      const std::size_t node = file_.whole(target, "node");
      if (node >= tree_.parents().size())
        file_.fail(fmt::format("an animation moves node {}", node));
      const std::string path = target.value("path", "");
      const std::size_t columns = path == "rotation" ? 4 : 3;
      if (path != "rotation" && path != "translation" && path != "scale") continue;
      const std::size_t number = file_.whole(channel, "sampler");
      if (!samplers.is_array() || number >= samplers.size())
        file_.fail(fmt::format("an animation names sampler {}, which is not there", number));
      Track track;
      track.times = file_.scalars(file_.whole(samplers[number], "input"));
      track.values = file_.rows(file_.whole(samplers[number], "output"), columns);
      const std::string how = samplers[number].value("interpolation", "LINEAR");
      track.how = how == "STEP"          ? Interpolation::step
                  : how == "CUBICSPLINE" ? Interpolation::cubic
                                         : Interpolation::linear;
      const std::size_t each = track.how == Interpolation::cubic ? 3 : 1;
      if (track.times.empty() || std::size_t(track.values.rows()) != each * track.times.size())
        file_.fail(fmt::format("an animation's sampler {} has {} keys and {} values", number,
                               track.times.size(), track.values.rows()));
      for (std::size_t k = 1; k < track.times.size(); ++k)
        if (!(track.times[k] > track.times[k - 1]))
          file_.fail(
              fmt::format("an animation's sampler {}: times do not rise at key {}", number, k));
      if (track.times[0] < 0 || track.times.back() > 1e6)
        file_.fail(
            fmt::format("an animation's sampler {}: a time of {} s", number, track.times.back()));
      last_ = std::max(last_, track.times.back());
      NodeTracks& tracks = tracks_[node];
      (path == "rotation"      ? tracks.rotation
       : path == "translation" ? tracks.translation
                               : tracks.scale) = std::move(track);
    }
    if (tracks_.empty())
      throw UnfitError(file_.name() + ": its animation moves no node (morph targets alone?)");
  }

  void choose_joints() {
    const std::size_t count = tree_.parents().size();
    std::map<std::size_t, Eigen::Matrix4d> inverse;
    for (std::size_t s = 0; s < file_.count("skins"); ++s) {
      const Json& skin = file_.item("skins", s);
      std::vector<Eigen::Matrix4d> binds;
      if (skin.contains("inverseBindMatrices"))
        binds = file_.matrices(file_.whole(skin, "inverseBindMatrices"));
      std::size_t k = 0;
      for (const Json& joint : skin.at("joints")) {
        const std::size_t node = joint.is_number_unsigned() ? joint.get<std::size_t>() : count;
        if (node >= count) file_.fail(fmt::format("skin {}: no joint {}", s, joint.dump()));
        inverse.emplace(node, k < binds.size() ? binds[k] : Eigen::Matrix4d::Identity());
        ++k;
      }
    }
    std::set<std::size_t> chosen;
    for (const auto& [node, bind] : inverse) chosen.insert(node);
    if (chosen.empty())
      for (const auto& [node, tracks] : tracks_)
        for (int up = int(node); up >= 0; up = tree_.parents()[std::size_t(up)])
          chosen.insert(std::size_t(up));
    if (inverse.empty()) choose_still(chosen);
    if (chosen.size() > limits::kMotionJoints)
      throw LimitError(fmt::format("{}: {} joints; the limit is {}", file_.name(), chosen.size(),
                                   limits::kMotionJoints));
    for (const std::size_t node : tree_.order())
      if (chosen.contains(node)) joints_.push_back(node);
    // As bound: by the map that brings the first joint's binding to where it stands above its rig.
    const std::size_t top = joints_.front();
    const int above = tree_.parents()[top];
    const Affine rig = above < 0 ? Affine::Identity() : tree_.world()[std::size_t(above)];
    for (const std::size_t node : joints_) {
      Affine rest = tree_.world()[node];
      const auto found = inverse.find(node);
      if (found != inverse.end() && std::abs(found->second.determinant()) > 1e-30) {
        Affine bind = Affine::Identity();
        bind.matrix() = found->second.inverse();
        rest = rig * bind;
      }
      rest_.push_back(rest);
    }
    keep_standing_rest();
  }

  // Joints that a take leaves as they are have no tracks in it: nodes below those that move, but
  // for what they carry.
  void choose_still(std::set<std::size_t>& chosen) const {
    for (const std::size_t node : tree_.order()) {
      const int up = tree_.parents()[node];
      const Json& item = file_.item("nodes", node);
      const bool carried =
          item.contains("mesh") || item.contains("camera") || item.contains("extensions");
      if (up >= 0 && !carried && chosen.contains(std::size_t(up)) && below_track(node))
        chosen.insert(node);
    }
  }

  bool below_track(std::size_t node) const {
    for (int up = tree_.parents()[node]; up >= 0; up = tree_.parents()[std::size_t(up)])
      if (tracks_.contains(std::size_t(up))) return true;
    return false;
  }

  // Where the file stands as it was bound, by whatever map, that is the rest pose: bindings may be
  // in units of their own. Bindings that put all joints in one place, as those of a skin that has
  // none, tell nothing.
  void keep_standing_rest() {
    double size = 0, bound_size = 0, miss = 0;
    for (std::size_t j = 1; j < joints_.size(); ++j) {
      const double a = (origin(j) - origin(0)).norm(),
                   b = (rest_[j].translation() - rest_[0].translation()).norm();
      size += a;
      bound_size += b;
    }
    if (!(size > 0)) return;
    const bool bound = bound_size > 1e-6 * size;
    for (std::size_t j = 1; j < joints_.size() && bound; ++j)
      miss += std::abs((origin(j) - origin(0)).norm() / size -
                       (rest_[j].translation() - rest_[0].translation()).norm() / bound_size);
    const bool same_size = std::abs(bound_size / size - 1) < 0.02;
    if (!bound || miss < 1e-3 || !same_size)
      for (std::size_t j = 0; j < joints_.size(); ++j) rest_[j] = tree_.world()[joints_[j]];
  }

  Vec3 origin(std::size_t j) const { return tree_.world()[joints_[j]].translation(); }

  double rate() const {
    std::vector<double> steps;
    for (const auto& [node, tracks] : tracks_)
      for (const auto* track : {&tracks.translation, &tracks.rotation, &tracks.scale})
        if (*track)
          for (std::size_t k = 1; k < (*track)->times.size(); ++k)
            steps.push_back((*track)->times[k] - (*track)->times[k - 1]);
    if (steps.empty()) return 30;
    std::nth_element(steps.begin(), steps.begin() + long(steps.size() / 2), steps.end());
    const double fps = 1 / steps[steps.size() / 2];
    if (!(fps >= 10)) return 30;  // sparse keys: curves between
    return std::min(1000.0, std::abs(fps - std::round(fps)) < 0.02 * fps ? std::round(fps) : fps);
  }

  void add_joints(MotionClip& out) {
    std::map<std::size_t, int> number;
    std::vector<std::string> names;
    for (const std::size_t node : joints_)
      names.push_back(file_.item("nodes", node).value("name", fmt::format("node {}", node)));
    drop_numbers(names);
    std::set<std::string> known;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      ClipJoint joint;
      joint.name = names[j];
      for (int k = 2; !known.insert(joint.name).second; ++k)
        joint.name = fmt::format("{}_{}", names[j], k);
      for (int up = tree_.parents()[joints_[j]]; up >= 0 && joint.parent < 0;
           up = tree_.parents()[std::size_t(up)])
        if (const auto above = number.find(std::size_t(up)); above != number.end())
          joint.parent = above->second;
      joint.offset = rest_[j].translation();
      if (joint.parent >= 0) joint.offset -= rest_[std::size_t(joint.parent)].translation();
      joint.rotation_track = int(j);
      number[joints_[j]] = int(j);
      out.joints.push_back(std::move(joint));
    }
    out.rotation_tracks = int(joints_.size());
  }

  static Mat3 turn_of(const Affine& X) {
    Mat3 axes = X.linear();
    if (axes.determinant() < 0) axes = -axes;
    return nearest_rotation(axes);
  }

  void start_sampling() {
    for (std::size_t n = 0; n < tree_.parents().size(); ++n) {
      places_.push_back(node_place(file_, n));
      maps_.push_back(node_map(file_, n));
    }
    world_.resize(maps_.size());
  }

  // Fills world_ at a time, s.
  void place_nodes(double t) {
    for (const auto& [node, tracks] : tracks_) {
      NodePlace place = places_[node];
      if (tracks.translation) place.translation = tracks.translation->at(t);
      if (tracks.scale) place.scale = tracks.scale->at(t);
      if (tracks.rotation) {
        const Eigen::VectorXd q = tracks.rotation->at(t);
        if (q.norm() > 1e-9) place.rotation = Quat(q[3], q[0], q[1], q[2]).normalized();
      }
      maps_[node] = place.map();
    }
    for (const std::size_t n : tree_.order()) {
      const int above = tree_.parents()[n];
      world_[n] = above < 0 ? maps_[n] : world_[std::size_t(above)] * maps_[n];
    }
  }

  void sample(MotionClip& out) {
    start_sampling();
    std::vector<Mat3> rest;
    for (const Affine& X : rest_) rest.push_back(turn_of(X));
    out.rotations.reserve(std::size_t(out.frame_count) * joints_.size());
    std::vector<Mat3> turns(joints_.size());
    std::vector<Travel> travels = movable_joints(out);
    for (int f = 0; f < out.frame_count; ++f) {
      place_nodes(double(f) / out.fps);
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        turns[j] = turn_of(world_[joints_[j]]) * rest[j].transpose();
        const int parent = out.joints[j].parent;
        out.rotations.push_back(
            parent < 0 ? turns[j] : Mat3(turns[std::size_t(parent)].transpose() * turns[j]));
      }
      for (Travel& travel : travels) {
        const ClipJoint& joint = out.joints[travel.joint];
        const Vec3 place = world_[joints_[travel.joint]].translation();
        travel.places.push_back(
            joint.parent < 0
                ? place
                : Vec3(turns[std::size_t(joint.parent)].transpose() *
                       (place - world_[joints_[std::size_t(joint.parent)]].translation())));
      }
    }
    add_travels(std::move(travels), out);
  }

  // Places of a joint by frame, from its parent in the parent's axes.
  struct Travel {
    std::size_t joint = 0;
    std::vector<Vec3> places;
  };

  // Roots, and joints that keys move, themselves or a node between them and their parent.
  std::vector<Travel> movable_joints(const MotionClip& clip) const {
    std::vector<Travel> out;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const int parent = clip.joints[j].parent;
      bool moved = parent < 0;
      for (int up = int(joints_[j]);
           !moved && up >= 0 && std::size_t(up) != joints_[std::size_t(parent)];
           up = tree_.parents()[std::size_t(up)]) {
        const auto keys = tracks_.find(std::size_t(up));
        moved = keys != tracks_.end() && keys->second.translation.has_value();
      }
      if (moved) out.push_back({j, {}});
    }
    return out;
  }

  // Roots travel, and joints that leave their place by more than a stretched bone does: hips below
  // a node of the whole scene.
  void add_travels(std::vector<Travel> travels, MotionClip& out) const {
    constexpr double kStretch = 0.02;  // of the figure's size
    Eigen::AlignedBox3d figure;
    for (const Affine& rest : rest_) figure.extend(Vec3(rest.translation()));
    std::erase_if(travels, [&](const Travel& travel) {
      const ClipJoint& joint = out.joints[travel.joint];
      return joint.parent >= 0 && std::ranges::none_of(travel.places, [&](const Vec3& place) {
               return (place - joint.offset).norm() > kStretch * figure.diagonal().norm();
             });
    });
    for (const Travel& travel : travels)
      out.joints[travel.joint].translation_track = out.translation_tracks++;
    for (int f = 0; f < out.frame_count; ++f)
      for (const Travel& travel : travels)
        out.translations.push_back(travel.places[std::size_t(f)]);
  }

  GltfFile file_;
  GltfTree tree_;
  std::map<std::size_t, NodeTracks> tracks_;
  double last_ = 0;  // s
  double fps_ = 30;
  int frames_ = 0;
  std::vector<std::size_t> joints_;
  std::vector<Affine> rest_;  // of the joints, in the scene
  // Of all nodes: as they stand, and at the time that is sampled.
  std::vector<NodePlace> places_;
  std::vector<Affine> maps_, world_;
};

}  // namespace

void drop_numbers(std::vector<std::string>& names) {
  std::set<std::string> ends;
  std::vector<std::size_t> cut(names.size(), 0);
  std::size_t numbered = 0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::size_t bar = names[k].rfind('_');
    if (bar == std::string::npos || bar == 0 || bar + 1 == names[k].size()) continue;
    const std::string end = names[k].substr(bar + 1);
    if (end.find_first_not_of("0123456789") != std::string::npos) continue;
    if (!ends.insert(end).second) return;
    cut[k] = bar;
    ++numbered;
  }
  if (names.size() < 8 || 10 * numbered < 9 * names.size()) return;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (cut[k] > 0) names[k].resize(cut[k]);
}

MotionClip gltf_motion(std::string_view bytes, const std::string& name,
                       const GltfMotionOptions& options,
                       std::optional<std::filesystem::path> folder) {
  try {
    return Reader(bytes, name, std::move(folder)).read(options);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: {}", name, printable(e.what())));
  }
}

std::optional<NodeMotion> gltf_node_motion(std::string_view bytes, const std::string& name,
                                           const std::vector<NodeName>& nodes,
                                           const GltfMotionOptions& options,
                                           std::optional<std::filesystem::path> folder) {
  try {
    return Reader(bytes, name, std::move(folder)).read_nodes(nodes, options);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(fmt::format("{}: {}", name, printable(e.what())));
  }
}

}  // namespace ecorche::inline v1
