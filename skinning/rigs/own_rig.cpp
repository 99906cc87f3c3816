#include "skinning/rigs/own_rig.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/mesh_files/glb_bytes.h"
#include "anatomy/mesh_files/gltf_file.h"
#include "anatomy/mesh_files/gltf_nodes.h"

namespace ecorche::inline v1 {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr int kRounds = 3;

// Bytes of floats behind a file's own, and the accessors that name them.
class KeyWriter {
 public:
  KeyWriter(OrderedJson& root, std::string& binary) : root_(root), binary_(binary) {
    for (const char* list : {"bufferViews", "accessors"})
      if (!root_.contains(list)) root_[list] = OrderedJson::array();
  }

  std::size_t add(const std::vector<float>& values, const char* type, std::size_t columns,
                  bool bounds) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    const std::size_t begin = binary_.size();
    binary_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    root_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", values.size() * sizeof(float)}});
    OrderedJson accessor{{"bufferView", root_["bufferViews"].size() - 1},
                         {"componentType", 5126},
                         {"count", values.size() / columns},
                         {"type", type}};
    if (bounds) {
      accessor["min"] = {*std::min_element(values.begin(), values.end())};
      accessor["max"] = {*std::max_element(values.begin(), values.end())};
    }
    root_["accessors"].push_back(std::move(accessor));
    return root_["accessors"].size() - 1;
  }

 private:
  OrderedJson& root_;
  std::string& binary_;
};

}  // namespace

struct OwnRig::Sums {
  std::vector<Vec3> blended;  // #V: sum of the movers' shares
};

OwnRig::OwnRig(const OwnSkin& own, const std::string& name)
    : own_(own), rig_(read_source_rig(*own.source, name)) {
  if (rig_.joints.empty())
    throw UnfitError(name + ": its own file has no rig; leave --rig own out");
  for (const SourceJoint& joint : rig_.joints) movers_.push_back({joint.node, joint.parent, {}});
  const GltfFile file(*own.source, name);
  const std::vector<int> parents = file.parents();
  std::map<std::size_t, int> loose;  // node -> mover
  for (const SourcePiece& piece : rig_.pieces) {
    if (piece.skin >= 0) continue;
    bool held = false;
    for (int up = int(piece.node); up >= 0; up = parents[std::size_t(up)])
      for (const SourceJoint& joint : rig_.joints) held |= joint.node == std::size_t(up);
    if (held) continue;
    const auto [at, is_new] = loose.emplace(piece.node, int(movers_.size()));
    if (is_new) movers_.push_back({piece.node, -1, {}});
    for (int i = 0; i < piece.vertex_count; ++i)
      movers_[std::size_t(at->second)].vertices.push_back({piece.first_vertex + i, 1.0});
  }
  for (std::size_t i = 0; i < rig_.weights.size(); ++i)
    for (const Influence& w : rig_.weights[i])
      movers_[std::size_t(w.joint)].vertices.push_back({int(i), w.weight});
  size_ = (rig_.mesh.V.colwise().maxCoeff() - rig_.mesh.V.colwise().minCoeff()).norm();
}

// The rigid motion that brings the mover's vertices nearest to what the others leave to it;
// `alone`: to the targets themselves.
void OwnRig::turn_about(const Mover& mover, const std::vector<Vec3>& targets, bool alone,
                        Sums& sums, Transform& motion) const {
  double weight = 0;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  Mat3 product = Mat3::Zero();
  for (const auto& [i, w] : mover.vertices) {
    const Vec3 p = rig_.mesh.V.row(i);
    const double share = alone ? w : w * w;
    Vec3 aim = targets[std::size_t(i)];
    // w (motion p) + what the others do = target
    if (!alone) aim = motion * p + (aim - sums.blended[std::size_t(i)]) / std::max(w, 0.05);
    weight += share;
    from += share * p;
    to += share * aim;
    product += share * aim * p.transpose();
  }
  if (!(weight > 0)) return;
  from /= weight;
  to /= weight;
  const Transform before = motion;
  const double firm = 1e-6 * size_ * size_;  // few vertices keep the turn that they had
  motion.linear() =
      nearest_rotation(product / weight - to * from.transpose() + firm * before.linear());
  motion.translation() = to - motion.linear() * from;
  if (alone) return;
  for (const auto& [i, w] : mover.vertices) {
    const Vec3 p = rig_.mesh.V.row(i);
    sums.blended[std::size_t(i)] += w * (motion * p - before * p);
  }
}

void OwnRig::add_frame(std::span<const float> positions, OwnRigMotion& motion) const {
  const std::size_t count = rig_.mesh.V.rows();
  std::vector<Vec3> targets(count);
  const Mat3 back = own_.axes.inverse() / own_.scale;
  for (std::size_t i = 0; i < count; ++i)
    targets[i] = back * (Vec3(double(positions[4 * i]), double(positions[4 * i + 1]),
                              double(positions[4 * i + 2])) -
                         own_.shift);
  std::vector<Transform> moves(movers_.size(), Transform::Identity());
  Sums sums;
  for (std::size_t m = 0; m < movers_.size(); ++m) {
    if (movers_[m].above >= 0) moves[m] = moves[std::size_t(movers_[m].above)];
    turn_about(movers_[m], targets, true, sums, moves[m]);
  }
  sums.blended.assign(count, Vec3::Zero());
  for (std::size_t m = 0; m < movers_.size(); ++m)
    for (const auto& [i, w] : movers_[m].vertices)
      sums.blended[std::size_t(i)] += w * (moves[m] * Vec3(rig_.mesh.V.row(i)));
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t m = 0; m < movers_.size(); ++m)
      if (!movers_[m].vertices.empty()) turn_about(movers_[m], targets, false, sums, moves[m]);
  for (std::size_t m = 0; m < movers_.size(); ++m)
    if (movers_[m].vertices.empty() && movers_[m].above >= 0)
      moves[m] = moves[std::size_t(movers_[m].above)];
  double sum = 0, most = 0;
  std::vector<char> moved(count, 0);
  for (const Mover& mover : movers_)
    for (const auto& [i, w] : mover.vertices) moved[std::size_t(i)] = 1;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!moved[i]) continue;
    const double miss = own_.scale * (targets[i] - sums.blended[i]).norm();
    sum += miss * miss;
    most = std::max(most, miss);
    ++counted;
  }
  const double frames = double(motion.frames.size());
  const double mean = counted > 0 ? sum / double(counted) : 0;
  motion.rms = std::sqrt((motion.rms * motion.rms * frames + mean) / (frames + 1));
  motion.max = std::max(motion.max, most);
  motion.frames.push_back(std::move(moves));
}

std::string OwnRig::with_motions(const std::vector<OwnRigMotion>& motions) const {
  const GlbParts parts = split_glb(*own_.source, "the character's own file");
  auto root =
      parse_gltf_json<OrderedJson>(parts.json, "the character's own file", limits::kJsonBytes);
  std::string binary(parts.binary);
  KeyWriter keys(root, binary);
  const GltfFile file(*own_.source, "the character's own file");
  const GltfTree tree(file);
  OrderedJson animations = OrderedJson::array();
  for (const OwnRigMotion& motion : motions) {
    std::vector<float> times;
    for (std::size_t f = 0; f < motion.frames.size(); ++f)
      times.push_back(float(double(f) / motion.fps));
    const std::size_t input = keys.add(times, "SCALAR", 1, true);
    OrderedJson samplers = OrderedJson::array(), channels = OrderedJson::array();
    const auto channel = [&](std::size_t node, const char* path, std::size_t output) {
      samplers.push_back({{"input", input}, {"output", output}, {"interpolation", "LINEAR"}});
      channels.push_back(
          {{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
    };
    // How far nodes have gone: those that are not moved go with what is above them.
    std::vector<std::vector<float>> turns(movers_.size()), places(movers_.size());
    std::vector<Quat> last(movers_.size(), Quat::Identity());
    std::vector<int> mover_of(tree.parents().size(), -1);
    for (std::size_t m = 0; m < movers_.size(); ++m) mover_of[movers_[m].node] = int(m);
    std::vector<Affine> world(tree.parents().size());
    for (const std::vector<Transform>& frame : motion.frames)
      for (const std::size_t node : tree.order()) {
        const int above = tree.parents()[node], m = mover_of[node];
        const Affine over = above < 0 ? Affine::Identity() : world[std::size_t(above)];
        if (m < 0) {
          world[node] = over * node_map(file, node);
          continue;
        }
        const NodePlace standing = node_place(file, node);
        const Affine wanted = Affine(frame[std::size_t(m)]) * tree.world()[node];
        const Affine local = over.inverse() * wanted;
        Mat3 axes = local.linear();
        for (int k = 0; k < 3; ++k)
          if (standing.scale[k] != 0) axes.col(k) /= standing.scale[k];
        NodePlace place = standing;
        place.translation = local.translation();
        place.rotation = Quat(nearest_rotation(axes)).normalized();
        if (place.rotation.dot(last[std::size_t(m)]) < 0) place.rotation.coeffs() *= -1;
        last[std::size_t(m)] = place.rotation;
        world[node] = over * place.map();
        for (const double v : place.rotation.coeffs()) turns[std::size_t(m)].push_back(float(v));
        for (const double v : place.translation) places[std::size_t(m)].push_back(float(v));
      }
    for (std::size_t m = 0; m < movers_.size(); ++m) {
      OrderedJson& node = root["nodes"][movers_[m].node];
      if (node.contains("matrix")) {  // what is animated is given in parts
        const NodePlace standing = node_place(file, movers_[m].node);
        node.erase("matrix");
        const Vec3 t = standing.translation, s = standing.scale;
        const Eigen::Vector4d q = standing.rotation.coeffs();
        node["translation"] = {t.x(), t.y(), t.z()};
        node["rotation"] = {q[0], q[1], q[2], q[3]};
        node["scale"] = {s.x(), s.y(), s.z()};
      }
      channel(movers_[m].node, "rotation", keys.add(turns[m], "VEC4", 4, false));
      channel(movers_[m].node, "translation", keys.add(places[m], "VEC3", 3, false));
    }
    animations.push_back({{"name", motion.name},
                          {"samplers", std::move(samplers)},
                          {"channels", std::move(channels)}});
  }
  if (root.contains("animations"))
    for (OrderedJson& each : root["animations"]) animations.push_back(std::move(each));
  if (!animations.empty()) root["animations"] = std::move(animations);
  binary.resize((binary.size() + 3) / 4 * 4);
  root["buffers"] = OrderedJson::array({OrderedJson{{"byteLength", binary.size()}}});
  return glb_bytes(root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace), binary);
}

}  // namespace ecorche::inline v1
