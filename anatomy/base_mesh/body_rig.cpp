#include "anatomy/base_mesh/body_rig.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "anatomy/errors.h"

namespace ecorche::inline v1 {
namespace {

using nlohmann::json;

json read_json(const BodyPackage& package, const std::string& path) {
  const auto bytes = package.reader(path);
  if (!bytes)
    throw InputError(
        fmt::format("{}: missing from the body package; run `make setup` to fetch it again", path));
  try {
    return json::parse(*bytes);
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: {}", path, e.what()));
  }
}

Vec3 mean_point(const Points& points, const std::vector<int>& indices) {
  Vec3 sum = Vec3::Zero();
  for (int i : indices) {
    if (i < 0 || i >= points.rows())
      throw InputError(fmt::format("bone end at point {}: the mesh has {}", i, points.rows()));
    sum += points.row(i).transpose();
  }
  return sum / double(indices.size());
}

// A bone's end: the centre of a joint cube, one point, or the mean of some.
Vec3 bone_end(const BodyPackage& package, const json& end, const Points& points) {
  const std::string strategy = end.at("strategy");
  if (strategy == "VERTEX") return mean_point(points, {end.at("vertex_index").get<int>()});
  if (strategy == "MEAN")
    return mean_point(points, end.at("vertex_indices").get<std::vector<int>>());
  if (strategy != "CUBE")
    throw InputError(fmt::format("bone end by '{}'; expected CUBE, VERTEX or MEAN", strategy));
  const std::string cube = end.at("cube_name");
  const auto group = std::find_if(package.groups.begin(), package.groups.end(),
                                  [&](const auto& g) { return g.first == cube; });
  if (group == package.groups.end())
    throw InputError(fmt::format("bone end at unknown cube '{}'", cube));
  return mean_point(points, group->second);
}

// Bones in an order in which parents precede children: depth first, siblings by name.
void append_bones(const std::string& name, int parent,
                  const std::multimap<std::string, std::string>& children, Rig& rig) {
  rig.names.push_back(name);
  rig.parents.push_back(parent);
  if (rig.names.size() > 4096) throw InputError("more than 4096 bones");
  const int self = int(rig.names.size()) - 1;
  const auto [begin, end] = children.equal_range(name);
  for (auto child = begin; child != end; ++child) append_bones(child->second, self, children, rig);
}

// The authoring tool's rest orientation: the smallest turn of +Y onto the bone, then a roll about
// it; in its frame (x left, y back, z up), then in ours.
Mat3 bone_axes(const Vec3& head, const Vec3& tail, double roll) {
  Mat3 world_from_author;
  world_from_author << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Vec3 along = world_from_author.transpose() * (tail - head).normalized();
  if (!along.allFinite()) return world_from_author;
  const Mat3 turn = Quat::FromTwoVectors(Vec3::UnitY(), along).toRotationMatrix();
  return world_from_author * Eigen::AngleAxisd(roll, along).toRotationMatrix() * turn;
}

VertexWeights parse_weights(const json& table, const std::vector<std::string>& names,
                            int skin_size) {
  std::vector<std::map<int, double>> rows(skin_size);
  for (std::size_t b = 0; b < names.size(); ++b) {
    const auto entries = table.find(names[b]);
    if (entries == table.end()) continue;
    for (const auto& entry : *entries) {
      const auto vertex = entry.at(0).get<long long>();
      const double weight = entry.at(1).get<double>();
      if (vertex < 0 || !std::isfinite(weight) || weight < 0)
        throw InputError(fmt::format("bone '{}': bad weight of vertex {}", names[b], vertex));
      if (vertex < skin_size && weight > 0) rows[vertex][b] += weight;
    }
  }
  VertexWeights out;
  out.start.push_back(0);
  for (const auto& row : rows) {
    std::vector<std::pair<int, double>> sorted(row.begin(), row.end());
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (sorted.empty()) sorted.emplace_back(0, 1.0);  // what no bone holds follows the root
    double sum = 0;
    for (const auto& entry : sorted) sum += entry.second;
    for (const auto& [bone, weight] : sorted) {
      out.bone.push_back(bone);
      out.weight.push_back(weight / sum);
    }
    out.start.push_back(int(out.bone.size()));
  }
  return out;
}

Rig parse_rig(const BodyPackage& package, const json& file, const Points& points) {
  const json& bones = file.contains("bones") ? file.at("bones") : file;
  std::multimap<std::string, std::string> children;
  for (const auto& [name, bone] : bones.items())
    children.emplace(bone.at("parent").get<std::string>(), name);
  Rig rig;
  const auto [begin, end] = children.equal_range("");
  for (auto root = begin; root != end; ++root) append_bones(root->second, -1, children, rig);
  if (rig.names.size() != bones.size()) throw InputError("some bones hang on no root");
  for (const auto& name : rig.names) {
    const json& bone = bones.at(name);
    rig.heads.push_back(bone_end(package, bone.at("head"), points));
    rig.tails.push_back(bone_end(package, bone.at("tail"), points));
    rig.rolls.push_back(bone.at("roll").get<double>());
    rig.axes.push_back(bone_axes(rig.heads.back(), rig.tails.back(), rig.rolls.back()));
  }
  return rig;
}

struct PartPrefix {
  const char* prefix;
  BodyPart part;
};
// Bones of the default rig by the beginning of their names; those of the face are the head's.
constexpr PartPrefix kParts[] = {
    {"spine", BodyPart::trunk},      {"root", BodyPart::trunk},
    {"pelvis", BodyPart::trunk},     {"breast", BodyPart::trunk},
    {"clavicle", BodyPart::trunk},   {"shoulder", BodyPart::trunk},
    {"neck", BodyPart::neck},        {"upperarm", BodyPart::upper_arm},
    {"lowerarm", BodyPart::forearm}, {"wrist", BodyPart::hand},
    {"metacarpal", BodyPart::hand},  {"finger", BodyPart::hand},
    {"upperleg", BodyPart::thigh},   {"lowerleg", BodyPart::shank},
    {"foot", BodyPart::foot},        {"toe", BodyPart::foot},
};

VertexPart part_of_bone(const std::string& name) {
  VertexPart out{BodyPart::head, Side::middle};
  for (const auto& [prefix, part] : kParts) {
    if (name.starts_with(prefix)) out.part = part;
  }
  const bool paired =
      out.part != BodyPart::head && out.part != BodyPart::neck && out.part != BodyPart::trunk;
  if (paired) out.side = name.ends_with(".L") ? Side::left : Side::right;
  return out;
}

}  // namespace

Rig read_rig(const BodyPackage& package, std::string_view name, const Points& points) {
  if (name != "default" && name != "cmu_mb" && name != "mixamo" && name != "game_engine") {
    throw UnfitError(fmt::format(
        "the body package has no rig '{}'; it has default, cmu_mb, mixamo and game_engine", name));
  }
  const std::string rig_path = fmt::format("mpfb2/rigs/standard/rig.{}.json", name);
  const std::string weights_path = fmt::format("mpfb2/rigs/standard/weights.{}.json", name);
  std::string path = rig_path;
  try {
    Rig rig = parse_rig(package, read_json(package, rig_path), points);
    path = weights_path;
    rig.name = name;
    rig.weights =
        parse_weights(read_json(package, weights_path).at("weights"), rig.names, package.skin_size);
    return rig;
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: {}", path, e.what()));
  } catch (const InputError& e) {
    throw std::string_view(e.what()).starts_with("mpfb2/")
        ? e
        : InputError(fmt::format("{}: {}", path, e.what()));
  }
}

std::vector<VertexPart> vertex_parts(const BodyPackage& package) {
  const Rig rig = read_rig(package, "default", package.points);
  std::vector<VertexPart> parts;
  parts.reserve(package.skin_size);
  for (int i = 0; i < package.skin_size; ++i) {
    // Bones of one part share a vertex's weight, so the parts are compared, not the bones.
    std::map<std::pair<int, int>, double> sums;
    for (int k = rig.weights.start[i]; k < rig.weights.start[i + 1]; ++k) {
      const auto part = part_of_bone(rig.names[rig.weights.bone[k]]);
      sums[{int(part.part), int(part.side)}] += rig.weights.weight[k];
    }
    const auto best = std::max_element(
        sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    parts.push_back(
        {static_cast<BodyPart>(best->first.first), static_cast<Side>(best->first.second)});
  }
  return parts;
}

}  // namespace ecorche::inline v1
