#include "viewer/gl/gpu_mesh.h"

#include <fmt/format.h>

#include <stdexcept>

namespace ecorche {
namespace {

constexpr int frames_kept = 4;
// Meshes without a key get one of these: they take the place that the same index had before.
constexpr std::uint64_t unnamed = std::uint64_t{1} << 63;

void check(const DrawMesh& mesh, int index) {
  const std::size_t n = mesh.positions.size();
  auto fits = [&](std::size_t size, const char* what, bool needed) {
    if (size == n || (!needed && size == 0)) return;
    throw std::invalid_argument(
        fmt::format("draw list: mesh {}: {} {} for {} positions", index, size, what, n));
  };
  fits(mesh.normals.size(), "normals", true);
  fits(mesh.colors.size(), "colours", false);
  fits(mesh.occlusion.size(), "occlusion values", false);
  fits(mesh.dissolve.size(), "dissolve values", false);
  fits(mesh.fibres.size(), "fibre values", false);
  fits(mesh.parts.size(), "parts", false);
}

void check_triangles(const DrawMesh& mesh, int index) {
  for (const Triangle32& t : mesh.triangles)
    if (t.maxCoeff() >= mesh.positions.size())
      throw std::invalid_argument(fmt::format("draw list: mesh {}: vertex {} of {}", index,
                                              t.maxCoeff(), mesh.positions.size()));
}

}  // namespace

GpuMeshes::~GpuMeshes() {
  for (auto& [key, slot] : slots_) free(slot);
}

void GpuMeshes::free(Slot& slot) const {
  gl_.DeleteVertexArrays(1, &slot.vertex_array);
  gl_.DeleteBuffers(1, &slot.indices);
  gl_.DeleteBuffers(attribute_count, slot.buffers.data());
}

void GpuMeshes::begin(const DrawList& list) {
  ++frame_;
  keys_.clear();
  for (std::size_t i = 0; i < list.meshes.size(); ++i) {
    const DrawMesh& mesh = list.meshes[i];
    const std::uint64_t key = mesh.key ? mesh.key : unnamed + i;
    keys_.push_back(key);
    const auto [it, fresh] = slots_.try_emplace(key);
    Slot& slot = it->second;
    const bool whole =
        fresh || !mesh.key || slot.shape != mesh.shape || slot.vertices != mesh.positions.size();
    const bool faced = whole || slot.faces != mesh.faces || slot.triangles != mesh.triangles.size();
    if (whole || slot.revision != mesh.revision) {
      check(mesh, int(i));
      upload(slot, mesh, whole);
    }
    if (faced) {
      check_triangles(mesh, int(i));
      upload_triangles(slot, mesh);
    }
    slot.faces = mesh.faces;
    slot.revision = mesh.revision;
    slot.shape = mesh.shape;
    slot.last_frame = frame_;
  }
  for (auto it = slots_.begin(); it != slots_.end();) {
    if (frame_ - it->second.last_frame > frames_kept) {
      free(it->second);
      it = slots_.erase(it);
    } else {
      ++it;
    }
  }
}

void GpuMeshes::upload(Slot& slot, const DrawMesh& mesh, bool fresh) const {
  if (!slot.vertex_array) {
    gl_.GenVertexArrays(1, &slot.vertex_array);
    gl_.GenBuffers(1, &slot.indices);
    gl_.GenBuffers(attribute_count, slot.buffers.data());
  }
  slot.box.setEmpty();
  for (const Vec3f& p : mesh.positions) slot.box.extend(p);
  slot.vertices = mesh.positions.size();
  gl_.BindVertexArray(slot.vertex_array);
  auto floats = [&](GLuint place, int width, const auto& values) {
    if (values.empty()) {
      gl_.DisableVertexAttribArray(place);
      return;
    }
    gl_.BindBuffer(GL_ARRAY_BUFFER, slot.buffers[place]);
    gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])),
                   values.data(), GL_STREAM_DRAW);
    gl_.VertexAttribPointer(place, width, GL_FLOAT, GL_FALSE, 0, nullptr);
    gl_.EnableVertexAttribArray(place);
  };
  floats(0, 3, mesh.positions);
  floats(1, 3, mesh.normals);
  floats(2, 3, mesh.colors);
  if (!fresh) return;
  floats(3, 1, mesh.occlusion);
  floats(4, 1, mesh.dissolve);
  floats(5, 4, mesh.fibres);
  if (mesh.parts.empty()) {
    gl_.DisableVertexAttribArray(6);
  } else {
    gl_.BindBuffer(GL_ARRAY_BUFFER, slot.buffers[6]);
    gl_.BufferData(GL_ARRAY_BUFFER,
                   static_cast<GLsizeiptr>(mesh.parts.size() * sizeof(std::uint32_t)),
                   mesh.parts.data(), GL_STREAM_DRAW);
    gl_.VertexAttribIPointer(6, 1, GL_UNSIGNED_INT, 0, nullptr);
    gl_.EnableVertexAttribArray(6);
  }
}

void GpuMeshes::upload_triangles(Slot& slot, const DrawMesh& mesh) const {
  slot.triangles = mesh.triangles.size();
  gl_.BindVertexArray(slot.vertex_array);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, slot.indices);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(slot.triangles * sizeof(Triangle32)),
                 mesh.triangles.data(), GL_STATIC_DRAW);
}

void GpuMeshes::draw(const DrawList& list, const DrawItem& item) const {
  const DrawMesh& mesh = list.meshes[item.mesh];
  const Slot& slot = slots_.at(keys_[item.mesh]);
  if (slot.triangles == 0) return;
  gl_.BindVertexArray(slot.vertex_array);
  const Vec3f& c = item.surface.color;
  if (mesh.colors.empty()) gl_.VertexAttrib3f(2, c.x(), c.y(), c.z());
  if (mesh.occlusion.empty()) gl_.VertexAttrib1f(3, 1);
  if (mesh.dissolve.empty()) gl_.VertexAttrib1f(4, 1);
  if (mesh.fibres.empty()) gl_.VertexAttrib4f(5, 1, 0, 0, 0);
  if (mesh.parts.empty()) gl_.VertexAttribI1ui(6, item.part);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * slot.triangles), GL_UNSIGNED_INT,
                   nullptr);
}

}  // namespace ecorche
