#include "app/files/vertex_caches.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <memory>

#include "anatomy/errors.h"
#include "anatomy/files/atomic_file.h"
#include "skinning/files/mdd_io.h"
#include "skinning/files/obj_sequence.h"
#include "skinning/files/pc2_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

const std::map<std::string, CacheMesh> kMeshes{{"obj", CacheMesh::obj}, {"glb", CacheMesh::glb}};

std::vector<std::string> layer_names(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string name = text.substr(at, comma - at);
    if (name != "skin" && name != "muscles" && name != "bones")
      throw UsageError(
          fmt::format("--layers: '{}' is no layer; there are skin, muscles and bones", name));
    if (std::find(out.begin(), out.end(), name) != out.end())
      throw UsageError(fmt::format("--layers: '{}' is named twice", name));
    out.push_back(name);
    at = comma + 1;
  }
  return out;
}

fs::path of_layer(const fs::path& output, const std::string& layer, const char* ending) {
  return output.parent_path() / (output.stem().string() + "-" + layer + ending);
}

// What OBJ files of a sequence share: DIR/%04d.obj has DIR/materials.mtl.
fs::path sequence_materials(const fs::path& pattern) {
  return pattern.parent_path() / "materials.mtl";
}

LayerMesh make_layer(const Assets& assets, const std::string& name, const Actor& actor,
                     const SkinTexture& texture) {
  const Anatomy& anatomy = actor.character.anatomy;
  return name == "skin"    ? skin_layer(actor.character.body.skin, texture)
         : name == "bones" ? bone_layer(anatomy, read_cartilage_rules(assets.tables))
                           : muscle_layer(anatomy);
}

// The skin's vertex of each vertex that the .glb's skin has.
std::vector<int> glb_rows(const Assets& assets, const Actor& actor, Detail detail) {
  const TriMesh& skin = actor.character.body.skin;
  const std::optional<BaseSkin> base =
      detail != Detail::full ? find_base(assets, skin) : std::nullopt;
  std::vector<int> rows =
      find_look(assets, base ? base->mesh : skin, actor.character.anatomy.skeleton).texture.vertex;
  if (rows.empty())
    throw UnfitError(
        "--cache-for glb: the skin is not the body package's, so that its .glb has the skin's own "
        "vertices; leave the option away");
  if (base)
    for (int& row : rows) row = base->refinement.base_rows[row];
  return rows;
}

// The mesh that a layer's cache goes on, and its materials.
void write_layer_mesh(const fs::path& cache, const std::string& name, const LayerMesh& layer) {
  const fs::path mesh = of_layer(cache, name, ".obj"), materials = of_layer(cache, name, ".mtl");
  std::string text =
      fmt::format("# metres, +Y up; vertex by vertex the points of {}\nmtllib {}\n",
                  of_layer(cache, name, cache.extension().c_str()).filename().string(),
                  materials.filename().string());
  append_vertices({layer.rest.data(), std::size_t(layer.rest.size())}, 3, text);
  text += layer_faces({&layer, 1});
  write_file_atomically(materials, layer_materials({&layer, 1}));
  write_file_atomically(mesh, text);
}

}  // namespace

void add_cache_options(CLI::App& verb, CacheOptions& options) {
  verb.add_option(
      "--layers", options.layers,
      "Vertex caches of these layers: skin, muscles, bones. OUT.pc2 becomes OUT-skin.pc2, "
      "OUT-muscles.pc2, ... with the mesh that each goes on, "
      "OUT-skin.obj, ...; an OBJ sequence has all of them in each file, a group a part");
  verb.add_option("--cache-for", options.mesh,
                  "What a skin's vertex cache goes on: obj (an OBJ of the skin; +Y up), or glb "
                  "(the skin of our .glb as Blender imports it: split along the "
                  "texture's seams, +Z up)")
      ->transform(CLI::CheckedTransformer(kMeshes))
      ->default_str("obj");
}

bool is_cache(const fs::path& file) {
  const fs::path kind = file.extension();
  return kind == ".pc2" || kind == ".mdd" || kind == ".obj";
}

std::vector<fs::path> cache_files(const fs::path& output, const CacheOptions& options) {
  const std::vector<std::string> layers = layer_names(options.layers);
  if (layers.empty()) return {output};
  if (options.mesh == CacheMesh::glb)
    throw UsageError(
        "--cache-for glb: for the skin alone; caches of --layers go on the OBJ files that are "
        "written beside them");
  if (output.extension() == ".obj") return {output};
  std::vector<fs::path> out;
  for (const std::string& layer : layers)
    for (const char* ending : {output.extension().c_str(), ".obj", ".mtl"})
      out.push_back(of_layer(output, layer, ending));
  return out;
}

VertexCaches::VertexCaches(const Assets& assets, const std::vector<fs::path>& outputs,
                           const Actor& actor, const Motion& motion, const CacheOptions& options) {
  if (outputs.empty()) return;
  const std::vector<std::string> names = layer_names(options.layers);
  if (options.mesh == CacheMesh::glb) rows_ = glb_rows(assets, actor, options.detail);
  SkinTexture texture;
  if (std::find(names.begin(), names.end(), "skin") != names.end())
    texture =
        find_look(assets, actor.character.body.skin, actor.character.anatomy.skeleton).texture;
  if (names.empty()) layers_.push_back(make_layer(assets, "skin", actor, {}));
  for (const std::string& name : names) layers_.push_back(make_layer(assets, name, actor, texture));
  posed_.resize(layers_.size());
  for (const fs::path& file : outputs) {
    if (file.extension() == ".obj" && !names.empty()) {
      open_layers(file);
    } else if (names.empty()) {
      open(file, motion, {0},
           int(rows_.empty() ? layers_[0].rest.rows() : Eigen::Index(rows_.size())));
    } else {
      for (std::size_t i = 0; i < names.size(); ++i) {
        write_layer_mesh(file, names[i], layers_[i]);
        open(of_layer(file, names[i], file.extension().c_str()), motion, {i},
             int(layers_[i].rest.rows()));
      }
    }
  }
}

void VertexCaches::open(const fs::path& file, const Motion& motion, std::vector<std::size_t> layers,
                        int vertices) {
  if (file.extension() == ".pc2") {
    auto writer = std::make_shared<Pc2Writer>(file, vertices);
    sinks_.push_back({std::move(layers), !rows_.empty(),
                      [writer](std::span<const float> p) { writer->add_frame(p, 3); },
                      [writer] { writer->finish(); }});
  } else if (file.extension() == ".mdd") {
    auto writer =
        std::make_shared<MddWriter>(file, vertices, int(motion.frames.size()), motion.fps);
    sinks_.push_back({std::move(layers), !rows_.empty(),
                      [writer](std::span<const float> p) { writer->add_frame(p, 3); },
                      [writer] { writer->finish(); }});
  } else {
    auto writer = std::make_shared<ObjSequenceWriter>(file, layers_[0].groups[0].F);
    sinks_.push_back({std::move(layers), false,
                      [writer](std::span<const float> p) { writer->add_frame(p, 3); }, [] {}});
  }
}

void VertexCaches::open_layers(const fs::path& pattern) {
  const fs::path materials = sequence_materials(pattern);
  int vertices = 0;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    vertices += layers_[i].rest.rows();
    all.push_back(i);
  }
  const std::string head = fmt::format("mtllib {}\n", materials.filename().string());
  auto writer = std::make_shared<ObjSequenceWriter>(pattern, vertices, head, layer_faces(layers_));
  write_file_atomically(materials, layer_materials(layers_));
  sinks_.push_back({std::move(all), false,
                    [writer](std::span<const float> p) { writer->add_frame(p, 3); }, [] {}});
}

void VertexCaches::add(const CharacterState& frame) {
  for (std::size_t i = 0; i < layers_.size(); ++i)
    pose_layer(layers_[i], frame.posed, frame.skin, posed_[i]);
  for (const Sink& sink : sinks_) {
    joined_.clear();
    for (const std::size_t i : sink.layers)
      joined_.insert(joined_.end(), posed_[i].data(), posed_[i].data() + posed_[i].size());
    if (sink.for_glb) {
      joined_.clear();
      for (const int row : rows_)
        joined_.insert(joined_.end(), {posed_[0](row, 0), -posed_[0](row, 2), posed_[0](row, 1)});
    }
    sink.add(joined_);
  }
}

void VertexCaches::finish() {
  for (const Sink& sink : sinks_) sink.finish();
}

}  // namespace ecorche
