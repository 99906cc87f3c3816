// ecorche-import fbx|dae < scene > scene.glb: the Open Asset Import Library in a program of its
// own, because files from strangers may crash it, hang it, or worse.
//
// It gives up its rights (import_sandbox.h) before it looks at the file. Exit status: 0, 2 usage, 3
// malformed, 4 cannot be read, 5 over its limits, 127 where it cannot give up its rights; the
// reason as a line on standard error.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "anatomy/mesh_files/import_sandbox.h"
#include "anatomy/mesh_files/scene_glb.h"

namespace {

using ecorche::SceneFrame;

constexpr int kUsage = 2, kMalformed = 3, kCannot = 4, kOverLimit = 5, kNoSandbox = 127;
constexpr const char* kFile = "/scene";  // what the library calls the one file that there is

bool write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(std::size_t(n));
  }
  return true;
}

int refuse(int status, std::string words) {
  std::replace(words.begin(), words.end(), '\n', ' ');
  write_all(2, words.substr(0, 300));
  return status;
}

// The file, and none beside it, whatever the library asks for.
class OneStream : public Assimp::IOStream {
 public:
  explicit OneStream(std::string_view bytes) : bytes_(bytes) {}

  std::size_t Read(void* out, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t items = std::min(count, (bytes_.size() - at_) / size);
    std::memcpy(out, bytes_.data() + at_, items * size);
    at_ += items * size;
    return items;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t to = origin == aiOrigin_END ? from - offset : from + offset;
    if (to > bytes_.size()) return aiReturn_FAILURE;
    at_ = to;
    return aiReturn_SUCCESS;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

class OneFile : public Assimp::IOSystem {
 public:
  OneFile(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  bool Exists(const char* file) const override { return name_ == file; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char*) override {
    return name_ == file ? new OneStream(bytes_) : nullptr;
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string_view bytes_;
  std::string name_;
};

// Standard input, mapped.
std::string_view mapped_input() {
  struct stat info {};
  if (::fstat(0, &info) != 0 || !S_ISREG(info.st_mode) || info.st_size <= 0) return {};
  void* const at = ::mmap(nullptr, std::size_t(info.st_size), PROT_READ, MAP_PRIVATE, 0, 0);
  if (at == MAP_FAILED) return {};
  return {static_cast<const char*>(at), std::size_t(info.st_size)};
}

void keep_importer(Assimp::Importer& importer, const std::string& ending) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const std::string endings =
        std::string(" ") + importer.GetImporterInfo(k)->mFileExtensions + " ";
    if (endings.find(" " + ending + " ") == std::string::npos)
      importer.UnregisterLoader(importer.GetImporter(k));
  }
}

template <class T>
T fact(const aiScene& scene, const char* key, T otherwise) {
  T value{};
  return scene.mMetaData && scene.mMetaData->Get(key, value) ? value : otherwise;
}

// What the FBX file says of unit and axes. The library leaves coordinates and root as they are.
SceneFrame fbx_frame(const aiScene& scene) {
  SceneFrame frame;
  double scale = fact<double>(scene, "UnitScaleFactor", 0);
  if (scale == 0) scale = double(fact<float>(scene, "UnitScaleFactor", 1));
  if (!(scale > 1e-6 && scale < 1e6)) scale = 1;
  frame.unit = frame.source_unit = scale / 100;  // of centimetres
  const int axes[] = {fact<int>(scene, "CoordAxis", 0), fact<int>(scene, "UpAxis", 1),
                      fact<int>(scene, "FrontAxis", 2)};
  const int signs[] = {fact<int>(scene, "CoordAxisSign", 1), fact<int>(scene, "UpAxisSign", 1),
                       fact<int>(scene, "FrontAxisSign", 1)};
  const bool right = std::all_of(axes, axes + 3, [](int a) { return a >= 0 && a < 3; }) &&
                     axes[0] != axes[1] && axes[1] != axes[2] && axes[0] != axes[2];
  if (!right) return frame;
  double turn[3][3] = {};
  for (int row = 0; row < 3; ++row) turn[row][axes[row]] = signs[row] < 0 ? -1 : 1;
  const auto minor = [&](int a, int b) {
    return turn[1][a] * turn[2][b] - turn[1][b] * turn[2][a];
  };
  const double det = turn[0][0] * minor(1, 2) - turn[0][1] * minor(0, 2) + turn[0][2] * minor(0, 1);
  for (double& x : turn[2]) x *= det;  // the way to the front follows from the others
  std::memcpy(frame.turn, turn, sizeof turn);
  frame.up = std::string(signs[1] < 0 ? "-" : "+") + "XYZ"[axes[1]];
  return frame;
}

int import(const std::string& ending, std::string_view bytes) {
  Assimp::Importer importer;
  keep_importer(importer, ending);
  const std::string file = kFile + ("." + ending);
  importer.SetIOHandler(new OneFile(bytes, file));
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_REMOVE_EMPTY_BONES, false);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* const scene = importer.ReadFile(
      file, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_JoinIdenticalVertices);
  if (!scene || !scene->mRootNode)
    return refuse(kMalformed, std::string("malformed: ") + importer.GetErrorString());
  SceneFrame frame = ending == "fbx" ? fbx_frame(*scene) : SceneFrame();
  frame.format = ending;
  const std::string glb = ecorche::scene_glb(*scene, frame);
  return write_all(1, glb) ? 0 : refuse(kOverLimit, "the scene is too large");
}

}  // namespace

int main(int count, char** words) {
  const std::string ending = count == 2 ? words[1] : "";
  if (ending != "fbx" && ending != "dae")
    return refuse(kUsage, "usage: ecorche-import fbx|dae < scene > scene.glb\n");
  const std::string_view bytes = mapped_input();
  if (bytes.empty()) return refuse(kMalformed, "standard input is no file, or an empty one");
  if (!ecorche::give_up_rights()) return refuse(kNoSandbox, "it cannot give up its rights");
  int status = kCannot;
  try {
    status = import(ending, bytes);
  } catch (const std::bad_alloc&) {
    status = refuse(kOverLimit, "reading it takes more memory than is allowed");
  } catch (const std::exception& e) {
    status = refuse(kCannot, e.what());
  } catch (...) {
    status = refuse(kMalformed, "malformed");
  }
  ::_exit(status);  // nothing of it need be taken apart
}
