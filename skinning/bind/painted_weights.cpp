#include "skinning/bind/painted_weights.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kSumSlack = 0.01;
constexpr std::size_t kMostPaintedJoints = 8;

int find_part(const Anatomy& anatomy, const std::string& name) {
  if (const int joint = find_joint(anatomy.skeleton, name); joint >= 0) return joint;
  for (const Bone& bone : anatomy.bones)
    if (bone.name == name) return bone.joint;
  return -1;
}

struct Painted {
  std::map<int, double> weights;  // by joint
  std::vector<std::string> names;
  double sum = 0;
  int row = 0;  // the last one that names the vertex
};

void add_row(const Table& table, int row, const Anatomy& anatomy, int vertex_count,
             std::map<int, Painted>& out) {
  const double number = table.number(row, "vertex");
  if (number != std::floor(number) || number < 0 || number >= vertex_count)
    throw InputError(fmt::format("{}: there is no vertex {}; the skin has the vertices 0 to {}",
                                 table.where(row), table.text(row, "vertex"), vertex_count - 1));
  const std::string& name = table.text(row, "joint");
  const int joint = find_part(anatomy, name);
  if (joint < 0)
    throw InputError(
        fmt::format("{}: '{}' is no joint and no bone of this character; `ecorche weights` writes "
                    "a table with its joints",
                    table.where(row), name));
  const double weight = table.number(row, "weight");
  if (weight < 0 || weight > 1)
    throw InputError(fmt::format("{}: the weight {} is not between 0 and 1", table.where(row),
                                 table.text(row, "weight")));
  Painted& painted = out[number];
  if (std::find(painted.names.begin(), painted.names.end(), name) != painted.names.end())
    throw InputError(fmt::format("{}: vertex {} has '{}' twice; leave one of them",
                                 table.where(row), int(number), name));
  painted.names.push_back(name);
  painted.sum += weight;
  painted.row = row;
  if (weight > 0) painted.weights[joint] += weight;
}

}  // namespace

PaintedWeights read_painted_weights(const std::filesystem::path& file, const Anatomy& anatomy,
                                    int vertex_count) {
  return painted_weights(Table(file), printable(file.string()), anatomy, vertex_count);
}

PaintedWeights painted_weights(const Table& table, const std::string& name, const Anatomy& anatomy,
                               int vertex_count) {
  std::map<int, Painted> found;
  for (int row = 0; row < table.rows(); ++row) add_row(table, row, anatomy, vertex_count, found);
  if (found.empty())
    throw InputError(
        fmt::format("{}: holds no weights; columns are vertex, joint and weight", name));
  PaintedWeights out;
  for (const auto& [vertex, painted] : found) {
    if (std::abs(painted.sum - 1) > kSumSlack)
      throw InputError(
          fmt::format("{}: the weights of vertex {} add up to {:.4g}; give it all of its joints, "
                      "so that they make 1",
                      table.where(painted.row), vertex, painted.sum));
    if (painted.weights.size() > kMostPaintedJoints)
      throw InputError(fmt::format("{}: vertex {} has {} joints; {} is the most",
                                   table.where(painted.row), vertex, painted.weights.size(),
                                   kMostPaintedJoints));
    out.vertices.push_back(vertex);
    out.weights.emplace_back();
    for (const auto& [joint, weight] : painted.weights)
      out.weights.back().push_back({joint, weight / painted.sum});
  }
  return out;
}

std::vector<std::vector<Influence>> joint_weights_of(const BlendTables& tables) {
  const BlendMesh& mesh = tables.mesh;
  const FrameTables& frames = tables.frames;
  std::vector<std::vector<Influence>> out(mesh.vertex_count);
  for (const VertexRun& run : mesh.runs)
    for (int e = run.begin; e < run.end; ++e) {
      const int sorted = mesh.sorted_index[e];
      std::map<int, double> weights;
      for (int k = 0; k < run.frames; ++k) {
        const std::size_t entry = run.frame_entry + std::size_t((e - run.begin) * run.frames + k);
        const int frame = mesh.frame[entry];
        if (frame >= frames.first_pair()) continue;
        weights[frames.joint_of(frame)] += double(mesh.frame_weight[entry]);
      }
      std::vector<Influence>& row = out[mesh.order.empty() ? sorted : mesh.order[sorted]];
      for (const auto& [joint, weight] : weights) row.push_back({joint, weight});
      std::stable_sort(row.begin(), row.end(),
                       [](const Influence& a, const Influence& b) { return a.weight > b.weight; });
    }
  return out;
}

void write_weights(const std::filesystem::path& file, const Skeleton& skeleton,
                   const BlendTables& tables) {
  std::string out = "vertex,joint,weight\n";
  const std::vector<std::vector<Influence>> rows = joint_weights_of(tables);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const Influence& w : rows[i])
      fmt::format_to(std::back_inserter(out), "{},{},{:.7f}\n", i, skeleton.joints[w.joint].name,
                     w.weight);
  write_file_atomically(file, out);
}

}  // namespace ecorche::inline v1
