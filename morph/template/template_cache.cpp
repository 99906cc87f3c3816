#include "morph/template/template_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "anatomy/errors.h"
#include "anatomy/files/byte_stream.h"
#include "anatomy/files/cache.h"
#include "anatomy/files/package_archive.h"
#include "morph/template/build_template.h"
#include "template_code.h"  // generated: kTemplateCode

// The bytes are the fields in order, numbers as they lie in memory (the cache stays on the machine
// that wrote it), a hash of everything at the end.
namespace ecorche::inline v1 {
namespace {

class Writer {
 public:
  static constexpr bool reading = false;
  template <class T>
  void raw(T* data, size_t count) {
    put_bytes(out, data, count);
  }
  std::string out;
};

class Reader {
 public:
  static constexpr bool reading = true;
  explicit Reader(std::string_view bytes) : in(bytes) {}
  template <class T>
  void raw(T* data, size_t count) {
    take_bytes(in, data, count);
  }
  std::string_view in;
};

template <class A, class T>
requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void field(A& a, T& x) { a.raw(&x, 1); }

template <class A>
uint64_t count(A& a, uint64_t n, size_t least_bytes) {
  a.raw(&n, 1);
  if constexpr (A::reading)
    if (n > a.in.size() / least_bytes)
      throw InputError(
          fmt::format("template cache: {} parts, but only {} bytes left", n, a.in.size()));
  return n;
}

template <class A>
void field(A& a, std::string& x) {
  x.resize(count(a, x.size(), 1));
  a.raw(x.data(), x.size());
}

template <class A, class S, int R, int C, int O>
void field(A& a, Eigen::Matrix<S, R, C, O>& x) {
  int64_t rows = x.rows(), columns = x.cols();
  a.raw(&rows, 1);
  a.raw(&columns, 1);
  if constexpr (A::reading) {
    if (rows < 0 || columns < 0 || (R >= 0 && rows != R) || (C >= 0 && columns != C) ||
        static_cast<uint64_t>(rows) > a.in.size() / sizeof(S) / std::max<int64_t>(columns, 1))
      throw InputError("template cache: impossible matrix size");
    x.resize(rows, columns);
  }
  a.raw(x.data(), std::size_t(rows * columns));
}

template <class A>
void field(A& a, Transform& x) {
  a.raw(x.matrix().data(), 16);
}

template <class A, class T, size_t N>
void field(A& a, std::array<T, N>& x) {
  for (T& e : x) field(a, e);
}

template <class A, class U, class V>
void field(A& a, std::pair<U, V>& x) {
  field(a, x.first);
  field(a, x.second);
}

template <class A, class T>
void field(A& a, std::vector<T>& x) {
  x.resize(count(a, x.size(), 1));
  if constexpr (std::is_arithmetic_v<T>)
    a.raw(x.data(), x.size());
  else
    for (T& e : x) field(a, e);
}

template <class A, class V, class L>
void field(A& a, std::map<std::string, V, L>& x) {
  std::vector<std::pair<std::string, V>> entries(x.begin(), x.end());
  field(a, entries);
  if constexpr (A::reading) x = {entries.begin(), entries.end()};
}

template <class A, class... T>
void fields(A& a, T&... x) {
  (field(a, x), ...);
}

template <class A>
void field(A& a, TriMesh& x) {
  fields(a, x.V, x.F);
}
template <class A>
void field(A& a, Joint& x) {
  fields(a, x.name, x.parent, x.X_PJ, x.axes, x.min, x.max, x.zero);
}
template <class A>
void field(A& a, Bone& x) {
  fields(a, x.name, x.side, x.joint, x.mesh);
}
template <class A>
void field(A& a, PathPoint& x) {
  fields(a, x.rest, x.joints, x.share, x.placing_joint);
}
template <class A>
void field(A& a, Slice& x) {
  fields(a, x.s, x.roll, x.offset, x.radii, x.outline);
}
template <class A>
void field(A& a, Wrap& x) {
  fields(a, x.kind, x.joint, x.X_WO, x.radii);
}
template <class A>
void field(A& a, Strip& x) {
  fields(a, x.path, x.reference, x.slices, x.wraps, x.belly_begin, x.belly_end, x.intersections,
         x.raphe, x.rest_length);
}
template <class A>
void field(A& a, Muscle& x) {
  fields(a, x.name, x.side, x.label, x.group, x.layer, x.origin, x.insertion, x.origin_bone,
         x.insertion_bone, x.strips, x.volume, x.fibre_length, x.pennation, x.max_force,
         x.tendon_slack, x.tense_thickness, x.sheet);
}
template <class A>
void field(A& a, FasciaSheet& x) {
  fields(a, x.name, x.side, x.label, x.group, x.rows, x.columns, x.V, x.belly, x.bones);
}
template <class A>
void field(A& a, FasciaPlan& x) {
  fields(a, x.name, x.side, x.label, x.group, x.thickness, x.fade, x.bones, x.rows, x.columns,
         x.points, x.form, x.near);
}
template <class A>
void field(A& a, Landmark& x) {
  fields(a, x.name, x.position);
}
template <class A>
void field(A& a, Body& x) {
  fields(a, x.skin, x.landmarks, x.name, x.sex, x.age, x.mass);
}
template <class A>
void field(A& a, GroupRule& x) {
  fields(a, x.name, x.paired, x.bones, x.near, x.far, x.across, x.width, x.raised, x.shaft,
         x.freedom);
}
template <class A>
void field(A& a, ContactRule& x) {
  fields(a, x.point, x.a, x.b, x.tolerance, x.along, x.spread, x.loose, x.close);
}
template <class A>
void field(A& a, LandmarkRule& x) {
  fields(a, x.name, x.bone, x.direction, x.from, x.to, x.low, x.high, x.fat_site, x.tolerance,
         x.checked);
}
template <class A>
void field(A& a, CubeRule& x) {
  fields(a, x.joint, x.cube, x.toward, x.vertex, x.male, x.female, x.tolerance);
}
template <class A>
void field(A& a, FitRules& x) {
  fields(a, x.groups, x.contacts, x.landmarks, x.cubes, x.group_of_bone);
}
template <class A>
void field(A& a, Cavity& x) {
  fields(a, x.name, x.loop, x.quads);
}
template <class A>
void field(A& a, BodyPackage& x) {
  fields(a, x.skin_size, x.quads, x.triangles, x.cavities, x.mirror);
}
template <class A>
void field(A& a, HalfBone& x) {
  fields(a, x.name, x.group, x.paired, x.mesh, x.watched);
}
template <class A>
void field(A& a, HalfSkeleton& x) {
  fields(a, x.points, x.hinges, x.bones, x.stature, x.mid_plane);
}
template <class A>
void field(A& a, BonePoint& x) {
  fields(a, x.bone, x.vertex, x.group, x.position);
}
template <class A>
void field(A& a, LandmarkTarget& x) {
  fields(a, x.point, x.wanted, x.slack, x.tolerance, x.deeper, x.shallowest, x.deepest);
}
template <class A>
void field(A& a, SurfaceSample& x) {
  fields(a, x.bone, x.vertex, x.margin);
}
template <class A>
void field(A& a, GapPair& x) {
  fields(a, x.a, x.b, x.x_a, x.x_b, x.normal, x.gap, x.tolerance);
}
template <class A>
void field(A& a, CentreRegressor::Row& x) {
  fields(a, x.name, x.vertices, x.weights);
}
template <class A>
void field(A& a, CentreRegressor& x) {
  fields(a, x.rows);
}
template <class A>
void field(A& a, BuildPrior& x) {
  fields(a, x.own, x.low, x.high, x.weights);
}
template <class A>
void field(A& a, FitTables& x) {
  fields(a, x.rules, x.muscles, x.fascia, x.topology, x.half, x.landmarks, x.margins, x.gaps,
         x.regressor, x.build, x.stature, x.volume);
}

template <class A>
void whole(A& a, Template& x) {
  fields(a, x.anatomy.skeleton.joints, x.anatomy.bones, x.anatomy.muscles, x.anatomy.fascia, x.body,
         x.tables);
}

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

std::string write_template_bytes(const Template& body_template) {
  Writer writer;
  // one description of the format serves both ways, and reading changes what it is handed
  Template copy = body_template;
  whole(writer, copy);
  return sealed(std::move(writer.out));
}

Template read_template_bytes(std::string_view bytes, FatTables fat) {
  Reader reader(unsealed(bytes));
  Template out{{}, {}, FitTables(std::move(fat))};
  whole(reader, out);
  if (!reader.in.empty()) throw InputError("template cache: bytes left over");
  return out;
}

std::string template_key(const std::filesystem::path& tables) {
  std::string all = kTemplateCode;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(tables)) {
    const auto extension = entry.path().extension();
    if (entry.is_regular_file() && (extension == ".csv" || extension == ".txt"))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const std::string bytes = file_bytes(file);
    all += '\n' + file.lexically_relative(tables).generic_string() + ' ' +
           std::to_string(bytes.size()) + '\n' + bytes;
  }
  return sha256(all);
}

Template read_template(const Assets& assets) {
  const std::string name = template_key(assets.tables) + ".template";
  if (const std::optional<std::string> bytes = read_cached(name)) {
    try {
      return read_template_bytes(*bytes, FatTables(assets.tables));
    } catch (const InputError&) {
      // damaged: built anew and overwritten below
    }
  }
  Template out = build_template(assets);
  write_cached(name, write_template_bytes(out));
  return out;
}

}  // namespace ecorche::inline v1
