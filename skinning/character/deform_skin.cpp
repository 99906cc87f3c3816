#include "skinning/character/deform_skin.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "anatomy/compute/simd.h"
#include "anatomy/geometry/vertex_normals.h"
#include "skinning/bind/blend_frames.h"
#include "skinning/bind/blend_tables.h"
#include "skinning/bind/muscle_offsets.h"
#include "skinning/dynamics/soft_tissue.h"
#include "skinning/muscle_collision/skin_over_muscles.h"
#include "skinning/settle/elastic_skin.h"

namespace ecorche {
namespace {

constexpr std::size_t kRuns = 32, kBlock = 4096;  // a task

using Eight = Eigen::Array<float, 8, 1>;
using Four = Eigen::Array<float, 4, 1>;

// All vertices of a run blend the same number of carriers, so the inner loop has a constant length.
template <int kCarriers>
void blend_run(const SkinTables& tables, const VertexRun& run, const float* carriers,
               const float* lifts, const Four& root, float* out) {
  const int count = kCarriers > 0 ? kCarriers : run.carriers;
  const std::uint16_t* carrier = &tables.carrier[run.carrier_entry];
  const float* weight = &tables.carrier_weight[run.carrier_entry];
  const std::uint16_t* node = tables.node.data() + run.node_entry;
  const float* share = tables.node_weight.data() + run.node_entry;
  for (int e = run.begin; e < run.end; ++e, carrier += count, weight += count) {
    Eight low = Eight::Zero(), high = Eight::Zero();  // columns 0 and 1; columns 2 and 3
    for (int k = 0; k < count; ++k) {
      const float* map = carriers + 16 * carrier[k];
      low += weight[k] * Eigen::Map<const Eight>(map);
      high += weight[k] * Eigen::Map<const Eight>(map + 8);
    }
    const float* X = &tables.rest[4 * e];
    Four p =
        root + low.head<4>() * X[0] + low.tail<4>() * X[1] + high.head<4>() * X[2] + high.tail<4>();
    for (int k = 0; k < run.nodes; ++k) p += share[k] * Eigen::Map<const Four>(lifts + 4 * node[k]);
    node += run.nodes;
    share += run.nodes;
    Eigen::Map<Four> target(out + 4 * std::size_t(tables.place[e]));
    target = p;
  }
}

void blend_vertices(const SkinTables& tables, const float* carriers, const float* lifts,
                    const Four& root, float* out) {
  const auto blend = [&](const VertexRun& run) {
    switch (run.carriers) {
      case 1:
        return blend_run<1>(tables, run, carriers, lifts, root, out);
      case 2:
        return blend_run<2>(tables, run, carriers, lifts, root, out);
      case 3:
        return blend_run<3>(tables, run, carriers, lifts, root, out);
      case 4:
        return blend_run<4>(tables, run, carriers, lifts, root, out);
      case 5:
        return blend_run<5>(tables, run, carriers, lifts, root, out);
      case 6:
        return blend_run<6>(tables, run, carriers, lifts, root, out);
      default:
        return blend_run<0>(tables, run, carriers, lifts, root, out);
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tables.runs.size(), kRuns),
                    [&](const auto& range) {
                      for (std::size_t r = range.begin(); r < range.end(); ++r)
                        blend(tables.runs[r]);
                    });
}

template <class Do>
void each_vertex(std::size_t count, const Do& act) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlock), [&](const auto& range) {
    for (std::size_t s = range.begin(); s < range.end(); ++s) act(s);
  });
}

void add(std::span<const float> offsets, std::span<float> positions) {
  if (offsets.size() != positions.size()) return;
  for (std::size_t k = 0; k < positions.size(); k += 4)
    store4(&positions[k], load4(&positions[k]) + load4(&offsets[k]));
}

// Muscles that the skin rises over.
struct Beneath {
  const UnderSkin& under;
  UnderSkinMemory& memory;
};

// What else the mesh that settles does.
struct Extras {
  std::span<const float> flesh{};
  const Beneath* beneath = nullptr;
};

// Moves `positions`; `normals` become theirs.
void settle(const SkinTables& tables, const PosedAnatomy& posed, const Extras& extras,
            ElasticScratch& elastic, std::vector<float>& positions, std::vector<float>& normals) {
  add(extras.flesh, positions);
  settle_skin(*tables.elastic, tables.triangles, posed.X_WJ, positions, elastic);
  if (extras.beneath) find_rising(*tables.elastic, positions, elastic);
  const bool risen =
      extras.beneath && rise_over_muscles(extras.beneath->under, posed.slices, elastic.rising,
                                          positions, extras.beneath->memory);
  const std::span<const float> room =
      risen ? room_over_muscles(extras.beneath->memory) : std::span<const float>{};
  part_settled_skin(*tables.elastic, tables.triangles, posed.X_WJ, room, positions, elastic);
  vertex_normals(positions, tables.triangles, normals, elastic.half);
}

// The base mesh's way from where the blend puts it to where it settles, handed down.
void follow(const SkinTables& fine, const PosedAnatomy& posed, const Four& root,
            const Extras& extras, const SkinFrame::Scratch& scratch, ElasticScratch& elastic,
            std::vector<float>& positions) {
  const SkinTables& base = *fine.base;
  elastic.base.resize(4 * std::size_t(base.vertex_count));
  blend_vertices(base, scratch.carriers.data(), scratch.lifts.data(), root, elastic.base.data());
  elastic.offsets.assign(elastic.base.begin(), elastic.base.end());
  settle(base, posed, extras, elastic, elastic.base, elastic.normals);
  for (std::size_t k = 0; k < elastic.base.size(); k += 4)
    store4(&elastic.offsets[k], load4(&elastic.base[k]) - load4(&elastic.offsets[k]));
  each_vertex(std::size_t(fine.vertex_count), [&](std::size_t s) {
    Float4 sum = load4(&positions[4 * s]);
    for (int k = fine.follow_first[s]; k < fine.follow_first[s + 1]; ++k)
      sum += fine.follow_weight[k] * load4(&elastic.offsets[4 * fine.follow[k]]);
    store4(&positions[4 * s], sum);
  });
}

void deform(const Binding& binding, const PosedAnatomy& posed, const Extras& extras, Settle settled,
            SkinFrame& out) {
  if (!binding.tables) throw std::invalid_argument("deform_skin: an empty binding");
  const SkinTables& tables = *binding.tables;
  if (int(posed.X_WJ.size()) != tables.joint_count ||
      int(posed.slices.size()) != tables.slice_count)
    throw std::invalid_argument(fmt::format(
        "deform_skin: the pose has {} joints and {} slices, the binding {} and {}",
        posed.X_WJ.size(), posed.slices.size(), tables.joint_count, tables.slice_count));
  const std::size_t size = 4 * std::size_t(tables.vertex_count);
  out.positions.resize(size);
  out.normals.resize(size);
  SkinFrame::Scratch& scratch = out.scratch;
  pose_carriers(tables, posed.X_WJ, scratch.frames, scratch.turns, scratch.carriers);
  lift_nodes(tables, posed, scratch.carriers, scratch.lifts, scratch.lifts_working);
  const Vec3 root = posed.X_WJ[0].translation();
  const Four root4(float(root.x()), float(root.y()), float(root.z()), 1.0f);
  const bool sorted = tables.order.empty();
  if (!sorted) {
    scratch.positions.resize(size);
    scratch.normals.resize(size);
  }
  std::vector<float>& positions = sorted ? out.positions : scratch.positions;
  std::vector<float>& normals = sorted ? out.normals : scratch.normals;
  blend_vertices(tables, scratch.carriers.data(), scratch.lifts.data(), root4, positions.data());
  if (!scratch.elastic.memory) scratch.elastic.memory = std::make_shared<ElasticScratch>();
  ElasticScratch& elastic = *scratch.elastic.memory;
  if (settled == Settle::yes && tables.elastic && !tables.base) {
    settle(tables, posed, extras, elastic, positions, normals);
  } else {
    if (settled == Settle::yes && tables.base)
      follow(tables, posed, root4, extras, scratch, elastic, positions);
    vertex_normals(positions, tables.triangles, normals, elastic.half);
  }
  if (sorted) return;
  each_vertex(tables.order.size(), [&](std::size_t s) {
    const std::size_t v = 4 * std::size_t(tables.order[s]);
    store4(&out.positions[v], load4(&positions[4 * s]));
    store4(&out.normals[v], load4(&normals[4 * s]));
  });
}

}  // namespace

void deform_skin(const Binding& binding, const PosedAnatomy& posed, SkinFrame& out, Settle settle) {
  deform(binding, posed, {}, settle, out);
}

void deform_skin(const Binding& binding, const PosedAnatomy& posed, std::span<const float> flesh,
                 SkinFrame& out) {
  deform(binding, posed, {flesh, nullptr}, Settle::yes, out);
}

void deform_over_muscles(const Binding& binding, const UnderSkin& under,
                         std::span<const float> flesh, const PosedAnatomy& posed, SkinFrame& out,
                         UnderSkinMemory& memory) {
  const Beneath beneath{under, memory};
  deform(binding, posed, {flesh, &beneath}, Settle::yes, out);
}

void give_way_to_skin(const Binding& binding, const UnderSkin& under, const PosingTable& table,
                      const SkinFrame& skin, PosedAnatomy& posed, UnderSkinMemory& memory) {
  const ElasticScratch* elastic = skin.scratch.elastic.memory.get();
  if (!binding.tables || !elastic || !memory.own)
    throw std::invalid_argument(
        "give_way_to_skin: a skin that was not moved by deform_over_muscles");
  const bool refined = binding.tables->base != nullptr, sorted = binding.tables->order.empty();
  const std::vector<float>& positions = refined  ? elastic->base
                                        : sorted ? skin.positions
                                                 : skin.scratch.positions;
  const std::vector<float>& normals = refined  ? elastic->normals
                                      : sorted ? skin.normals
                                               : skin.scratch.normals;
  give_way_to_skin(under, table, positions, normals, elastic->pressed, posed, memory);
}

void to_points(const SkinFrame& frame, Points& out) {
  const Eigen::Index n = frame.positions.size() / 4;
  out.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k) out(i, k) = frame.positions[4 * i + k];
}

}  // namespace ecorche
