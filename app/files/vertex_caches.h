// Vertex caches and OBJ sequences of a motion, written frame by frame: of the skin, or of several
// layers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/files/assets.h"
#include "app/files/actor.h"
#include "app/files/character_file.h"
#include "skinning/files/layer_mesh.h"

namespace CLI {
class App;
}

namespace ecorche {

// What a skin's cache goes on.
enum class CacheMesh {
  obj,  // the skin's own vertices, +Y up: an OBJ file of the skin
  glb   // the vertices of the skin in our .glb, and +Z up, as Blender has them from there
};

struct CacheOptions {
  std::string layers;  // "skin,muscles,bones"; empty: the skin alone, in the file that was named
  CacheMesh mesh = CacheMesh::obj;
  Detail detail = Detail::full;  // of the .glb that CacheMesh::glb means
};

// --layers and --cache-for
void add_cache_options(CLI::App& verb, CacheOptions& options);

// Whether files of this kind are written here: .pc2, .mdd, .obj.
bool is_cache(const std::filesystem::path& file);

// What an output will be written as: itself, or with layers a cache and a mesh a layer,
// OUT-muscles.pc2 and OUT-muscles.obj. Throws UsageError for a layer that there is not.
std::vector<std::filesystem::path> cache_files(const std::filesystem::path& output,
                                               const CacheOptions& options);

class VertexCaches {
 public:
  // Throws UsageError, OutputError; UnfitError for CacheMesh::glb on a skin whose .glb has no
  // texture to split it.
  VertexCaches(const Assets& assets, const std::vector<std::filesystem::path>& outputs,
               const Actor& actor, const Motion& motion, const CacheOptions& options);

  void add(const CharacterState& frame);
  void finish();

 private:
  struct Sink {
    std::vector<std::size_t> layers;  // whose vertices go in, one after the other
    bool for_glb = false;
    std::function<void(std::span<const float>)> add;  // three floats a vertex
    std::function<void()> finish;
  };
  void open(const std::filesystem::path& file, const Motion& motion,
            std::vector<std::size_t> layers, int vertices);
  void open_layers(const std::filesystem::path& pattern);

  std::vector<LayerMesh> layers_;
  std::vector<PointsF> posed_;
  std::vector<int> rows_;  // CacheMesh::glb: the skin's vertex of each in the file; else empty
  std::vector<Sink> sinks_;
  std::vector<float> joined_;
};

}  // namespace ecorche
