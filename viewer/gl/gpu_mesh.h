// Meshes on the GPU, uploaded again only when they have changed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "viewer/draw_list.h"
#include "viewer/gl/gl_api.h"

namespace ecorche {

class GpuMeshes {
 public:
  explicit GpuMeshes(const GlApi& gl) : gl_(gl) {}
  ~GpuMeshes();
  GpuMeshes(const GpuMeshes&) = delete;
  GpuMeshes& operator=(const GpuMeshes&) = delete;

  // Uploads new and changed meshes; frees buffers that the lists of the last frames did not use.
  // Throws std::invalid_argument naming the mesh: arrays of unequal length, indices out of range.
  void begin(const DrawList& list);
  // Draws the item's mesh of that list; missing arrays take the item's values.
  void draw(const DrawList& list, const DrawItem& item) const;
  // Box around mesh `index` of that list, in its own frame; empty for a mesh without vertices.
  const Eigen::AlignedBox3f& box(int index) const { return slots_.at(keys_[index]).box; }

 private:
  static constexpr int attribute_count = 7;
  struct Slot {
    GLuint vertex_array = 0, indices = 0;
    std::array<GLuint, attribute_count> buffers{};
    Eigen::AlignedBox3f box;
    std::uint64_t revision = 0, shape = 0, faces = 0;
    std::size_t vertices = 0, triangles = 0;
    int last_frame = 0;
  };
  void upload(Slot& slot, const DrawMesh& mesh, bool fresh) const;
  void upload_triangles(Slot& slot, const DrawMesh& mesh) const;
  void free(Slot& slot) const;

  const GlApi& gl_;
  int frame_ = 0;
  std::map<std::uint64_t, Slot> slots_;
  std::vector<std::uint64_t> keys_;  // of the current list's meshes
};

}  // namespace ecorche
