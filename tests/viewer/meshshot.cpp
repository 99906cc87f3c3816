// Looks at meshes: OBJ and PLY files -> one picture, several views side by side. See usage() below.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>

#include "anatomy/errors.h"
#include "viewer/camera.h"
#include "viewer/gl/renderer.h"

namespace ecorche {
namespace {

const char* const usage =
    "meshshot OUT.png [--view V]... [--size WxH] [--zoom X,Y,Z,RADIUS] [--ortho] [--flat] [--bg "
    "R,G,B] FILE[:R,G,B[,A]]...\n"
    "  V: front back left right top bottom oblique or AZIMUTH,ELEVATION in degrees (0 front, 90 "
    "the body's left); repeat for\n"
    "     views side by side (--size is of each). Colours 0..1; A < 1 is glass. OBJ (v with "
    "optional r g b, f) and PLY (ascii or\n"
    "     binary little endian; red green blue of vertices are used). --flat: facets instead of "
    "smooth normals.\n";

std::vector<float> numbers(std::string_view text) {
  std::vector<float> values;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    float value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + comma, value);
    if (code != std::errc() || end != text.data() + comma) return {};
    values.push_back(value);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return values;
}

void add_fan(DrawMesh& mesh, const std::vector<long>& corners, const std::string& file) {
  const long n = mesh.positions.size();
  for (const long c : corners)
    if (c < 0 || c >= n) throw InputError(fmt::format("{}: vertex {} of {}", file, c, n));
  for (std::size_t k = 2; k < corners.size(); ++k)
    mesh.triangles.emplace_back(std::uint32_t(corners[0]), std::uint32_t(corners[k - 1]),
                                std::uint32_t(corners[k]));
}

DrawMesh read_obj(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file));
  DrawMesh mesh;
  std::vector<std::vector<long>> faces;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3f p, c;
      words >> p.x() >> p.y() >> p.z();
      mesh.positions.push_back(p);
      if (words >> c.x() >> c.y() >> c.z()) mesh.colors.push_back(c);
    } else if (word == "f") {
      std::vector<long>& face = faces.emplace_back();
      while (words >> word) {
        const long i = std::strtol(word.c_str(), nullptr, 10);
        face.push_back(i < 0 ? long(mesh.positions.size()) + i : i - 1);
      }
    }
  }
  if (mesh.colors.size() != mesh.positions.size()) mesh.colors.clear();
  for (const auto& face : faces) add_fan(mesh, face, file);
  return mesh;
}

struct PlyProperty {
  std::string name, type, count_type;
};
struct PlyElement {
  std::string name;
  long count = 0;
  std::vector<PlyProperty> properties;
};

double read_ply_value(std::istream& in, bool ascii, const std::string& type) {
  if (ascii) {
    double value = 0;
    in >> value;
    return value;
  }
  auto raw = [&]<typename T>(T value) {
    in.read(reinterpret_cast<char*>(&value), sizeof value);
    return double(value);
  };
  if (type == "float" || type == "float32") return raw(0.0f);
  if (type == "double" || type == "float64") return raw(0.0);
  if (type == "uchar" || type == "uint8") return raw(std::uint8_t{0});
  if (type == "char" || type == "int8") return raw(std::int8_t{0});
  if (type == "ushort" || type == "uint16") return raw(std::uint16_t{0});
  if (type == "short" || type == "int16") return raw(std::int16_t{0});
  if (type == "uint" || type == "uint32") return raw(std::uint32_t{0});
  return raw(std::int32_t{0});
}

std::vector<PlyElement> read_ply_header(std::istream& in, bool& ascii) {
  std::vector<PlyElement> elements;
  for (std::string line; std::getline(in, line) && line.rfind("end_header", 0) != 0;) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") words >> word, ascii = word == "ascii";
    if (word == "element") {
      PlyElement& e = elements.emplace_back();
      words >> e.name >> e.count;
    }
    if (word == "property" && !elements.empty()) {
      PlyProperty p;
      words >> p.type;
      if (p.type == "list") words >> p.count_type >> p.type;
      words >> p.name;
      elements.back().properties.push_back(p);
    }
  }
  return elements;
}

DrawMesh read_ply(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(fmt::format("{}: cannot be read", file));
  bool ascii = true;
  const std::vector<PlyElement> elements = read_ply_header(in, ascii);
  DrawMesh mesh;
  for (const PlyElement& e : elements) {
    for (long i = 0; i < e.count && in; ++i) {
      Vec3f p = Vec3f::Zero(), c = Vec3f::Constant(-1);
      for (const PlyProperty& q : e.properties) {
        if (q.count_type.empty()) {
          const float v = read_ply_value(in, ascii, q.type);
          const float scale = q.type == "uchar" || q.type == "uint8" ? 1 / 255.0f : 1;
          for (int k = 0; k < 3; ++k) {
            if (q.name == std::string(1, "xyz"[k])) p[k] = v;
            if (q.name == std::string((const char*[]){"red", "green", "blue"}[k])) c[k] = v * scale;
          }
        } else {
          const long n = read_ply_value(in, ascii, q.count_type);
          std::vector<long> face;
          for (long k = 0; k < n && in; ++k)
            face.push_back(long(read_ply_value(in, ascii, q.type)));
          if (e.name == "face") add_fan(mesh, face, file);
        }
      }
      if (e.name == "vertex") {
        mesh.positions.push_back(p);
        if (c.x() >= 0) mesh.colors.push_back(c);
      }
    }
  }
  if (mesh.colors.size() != mesh.positions.size()) mesh.colors.clear();
  return mesh;
}

void make_flat(DrawMesh& mesh) {
  DrawMesh flat;
  for (const Triangle32& t : mesh.triangles) {
    const std::uint32_t n = flat.positions.size();
    for (int k = 0; k < 3; ++k) {
      flat.positions.push_back(mesh.positions[t[k]]);
      if (!mesh.colors.empty()) flat.colors.push_back(mesh.colors[t[k]]);
    }
    flat.triangles.emplace_back(n, n + 1, n + 2);
  }
  mesh = std::move(flat);
}

void add_normals(DrawMesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3f::Zero());
  for (const Triangle32& t : mesh.triangles) {
    const Vec3f n = (mesh.positions[t[1]] - mesh.positions[t[0]])
                        .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
    for (int k = 0; k < 3; ++k) mesh.normals[t[k]] += n;
  }
  for (Vec3f& n : mesh.normals) n = n.squaredNorm() > 0 ? n.normalized() : Vec3f(0, 1, 0);
}

struct Request {
  std::string out;
  std::vector<ViewAngles> views;
  int width = 900, height = 1200;
  std::vector<float> zoom;
  bool ortho = false, flat = false;
  std::vector<std::string> files;
  std::vector<float> background;
};

Request parse(int argc, char** argv) {
  Request r;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    auto value = [&] {
      return i + 1 < argc ? std::string(argv[++i])
                          : throw UsageError(word + " needs a value\n" + usage);
    };
    if (word == "--view")
      r.views.push_back(view_angles(value()));
    else if (word == "--size") {
      if (std::sscanf(value().c_str(), "%dx%d", &r.width, &r.height) != 2) throw UsageError(usage);
    } else if (word == "--zoom")
      r.zoom = numbers(value());
    else if (word == "--bg")
      r.background = numbers(value());
    else if (word == "--ortho")
      r.ortho = true;
    else if (word == "--flat")
      r.flat = true;
    else if (r.out.empty())
      r.out = word;
    else
      r.files.push_back(word);
  }
  if (r.files.empty() || (!r.zoom.empty() && r.zoom.size() != 4)) throw UsageError(usage);
  if (r.views.empty()) r.views.push_back({});
  return r;
}

void add_file(DrawList& list, const std::string& word, bool flat) {
  const std::size_t colon = word.rfind(':');
  std::vector<float> c = colon == std::string::npos
                             ? std::vector<float>{}
                             : numbers(std::string_view(word).substr(colon + 1));
  const std::string file = c.size() >= 3 ? word.substr(0, colon) : word;
  DrawMesh mesh =
      file.size() > 4 && file.substr(file.size() - 4) == ".ply" ? read_ply(file) : read_obj(file);
  if (flat) make_flat(mesh);
  add_normals(mesh);
  DrawItem item;
  item.mesh = list.meshes.size();
  item.part = std::uint32_t(list.items.size() + 1);
  if (c.size() >= 3) {
    item.surface.color = {c[0], c[1], c[2]};
    mesh.colors.clear();
  }
  if (c.size() == 4 && c[3] < 1)
    item.surface.opacity = c[3], item.surface.edge_opacity = 0.5f * (1 - c[3]);
  list.meshes.push_back(std::move(mesh));
  list.items.push_back(item);
}

int run(int argc, char** argv) {
  const Request request = parse(argc, argv);
  DrawList list;
  for (const std::string& file : request.files) add_file(list, file, request.flat);
  list.lighting.follows_camera = true;
  if (request.background.size() == 3)
    list.background_top = list.background_bottom = {request.background[0], request.background[1],
                                                    request.background[2]};
  Vec3f low = Vec3f::Constant(1e30f), high = -low;
  for (const DrawMesh& mesh : list.meshes)
    for (const Vec3f& p : mesh.positions) low = low.cwiseMin(p), high = high.cwiseMax(p);
  if (!(low.x() <= high.x())) throw InputError("no vertices");
  const Vec3f center = request.zoom.empty()
                           ? Vec3f(0.5f * (low + high))
                           : Vec3f(request.zoom[0], request.zoom[1], request.zoom[2]);
  const float aspect = float(request.width) / float(request.height);
  Renderer renderer;
  Image sheet = make_image(request.width * int(request.views.size()), request.height);
  for (std::size_t k = 0; k < request.views.size(); ++k) {
    const ViewAngles view = request.views[k];
    float radius = request.zoom.empty() ? 0.5f * (high - low).norm() : request.zoom[3];
    list.camera = orbit_camera(center, radius, view.azimuth, view.elevation, 0.35f, aspect);
    if (request.zoom.empty()) {
      // Move in until the box touches the picture's edges.
      const Mat4f m = projection_matrix(list.camera, aspect) * view_matrix(list.camera);
      float reach = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Vec4f p = m * Vec4f(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                  corner & 4 ? high.z() : low.z(), 1);
        reach = std::max({reach, std::abs(p.x() / p.w()), std::abs(p.y() / p.w())});
      }
      radius *= reach * 1.03f;
      list.camera = orbit_camera(center, radius, view.azimuth, view.elevation, 0.35f, aspect);
    }
    if (request.ortho) list.camera.ortho_height = 2 * radius / std::min(aspect, 1.0f);
    list.camera.near_plane =
        std::max(0.01f * radius, (list.camera.eye - center).norm() - (high - low).norm());
    list.camera.far_plane = (list.camera.eye - center).norm() + 2 * (high - low).norm();
    const Image image = renderer.render(list, request.width, request.height);
    for (int y = 0; y < image.height; ++y)
      std::memcpy(sheet.pixel(int(k) * request.width, y), image.pixel(0, y),
                  4 * std::size_t(image.width));
  }
  write_png(request.out, sheet);
  std::cerr << fmt::format("{}: {} x {} ({})\n", request.out, sheet.width, sheet.height,
                           renderer.driver());
  return 0;
}

}  // namespace
}  // namespace ecorche

int main(int argc, char** argv) {
  try {
    return ecorche::run(argc, argv);
  } catch (const ecorche::Error& error) {
    std::cerr << "meshshot: " << error.what() << "\n";
    return 3;
  }
}
