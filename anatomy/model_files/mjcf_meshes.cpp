#include "anatomy/model_files/mjcf_meshes.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/limits.h"

namespace ecorche::inline v1 {

namespace {

struct Place {  // a body on the way down the tree
  std::string body;
  Transform X_WB = Transform::Identity();
};

class Reader {
 public:
  explicit Reader(const MjcfFiles& files) : files_(files) {}

  Mjcf read(const std::string& path) {
    load(path);
    walk(
        path,
        [this](pugi::xml_node child, const std::string& file, int) { declarations(child, file); },
        0);
    walk(
        path,
        [this](pugi::xml_node child, const std::string& file, int depth) {
          if (std::string_view(child.name()) == "worldbody")
            bodies(child, file, {"world", Transform::Identity()}, depth);
        },
        0);
    return std::move(model_);
  }

 private:
  [[noreturn]] static void fail(const std::string& file, pugi::xml_node node,
                                const std::string& message) {
    throw InputError(printable(fmt::format("{}: <{} name=\"{}\">: {}", file, node.name(),
                                           node.attribute("name").value(), message)));
  }

  const pugi::xml_document& load(const std::string& path) {
    const auto known = documents_.find(path);
    if (known != documents_.end()) return known->second;
    if (documents_.size() >= limits::kModelFiles)
      throw LimitError(
          fmt::format("{}: more than {} included files", printable(path), limits::kModelFiles));
    const std::string text = files_(path);
    pugi::xml_document& document = documents_[path];
    const auto result = document.load_buffer(text.data(), text.size());
    if (!result)
      throw InputError(
          fmt::format("{}: byte {}: {}", printable(path), result.offset, result.description()));
    return document;
  }

  // The path of an included file, relative to the file that includes it. A model never leaves its
  // own folder.
  static std::string included(const std::string& file, pugi::xml_node node) {
    const std::string path =
        (std::filesystem::path(file).parent_path() / node.attribute("file").value())
            .lexically_normal()
            .generic_string();
    if (path.starts_with("..") || path.starts_with("/"))
      fail(file, node, fmt::format("'{}' leaves the model's folder", path));
    return path;
  }

  // Calls `visit` for the children of a file's top element, in order, those of included files in
  // their place.
  template <class Visit>
  void walk(const std::string& file, const Visit& visit, int depth) {
    if (depth > limits::kModelDepth)
      throw LimitError(
          fmt::format("{}: includes nested deeper than {}", printable(file), limits::kModelDepth));
    for (pugi::xml_node child : load(file).document_element().children()) {
      if (std::string_view(child.name()) == "include") {
        walk(included(file, child), visit, depth + 1);
      } else {
        visit(child, file, depth);
      }
    }
  }

  // --- numbers -------------------------------------------------------------------------
  static std::vector<double> numbers(const std::string& file, pugi::xml_node node,
                                     const char* name) {
    const char* at = node.attribute(name).value();
    const char* end = at + std::string_view(at).size();
    std::vector<double> values;
    while (true) {
      while (at < end && (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r' || *at == '+'))
        ++at;
      if (at == end) return values;
      double value = 0;
      const auto [next, error] = std::from_chars(at, end, value);
      if (error != std::errc() || !std::isfinite(value) || values.size() >= 16) {
        fail(file, node,
             fmt::format("{}=\"{}\" is not a list of numbers", name, node.attribute(name).value()));
      }
      values.push_back(value);
      at = next;
    }
  }

  static Vec3 vector(const std::string& file, pugi::xml_node node, const char* name,
                     const Vec3& otherwise) {
    if (!node.attribute(name)) return otherwise;
    const auto v = numbers(file, node, name);
    if (v.size() != 3)
      fail(file, node,
           fmt::format("{}=\"{}\": three numbers expected", name, node.attribute(name).value()));
    return {v[0], v[1], v[2]};
  }

  static Transform placement(const std::string& file, pugi::xml_node node) {
    Transform X = Transform::Identity();
    X.translation() = vector(file, node, "pos", Vec3::Zero());
    for (const char* other : {"axisangle", "xyaxes", "zaxis"}) {
      if (node.attribute(other))
        fail(file, node,
             fmt::format("orientation by {} is not understood; expected quat or euler", other));
    }
    if (node.attribute("quat")) {
      const auto q = numbers(file, node, "quat");
      const double norm =
          q.size() == 4 ? std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) : 0;
      if (norm < 1e-9)
        fail(file, node,
             fmt::format("quat=\"{}\": four numbers, not all zero, expected",
                         node.attribute("quat").value()));
      X.linear() = Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    } else if (node.attribute("euler")) {
      const Vec3 e = vector(file, node, "euler", Vec3::Zero());
      X.linear() =
          (Eigen::AngleAxisd(e.x(), Vec3::UnitX()) * Eigen::AngleAxisd(e.y(), Vec3::UnitY()) *
           Eigen::AngleAxisd(e.z(), Vec3::UnitZ()))
              .toRotationMatrix();
    }
    return X;
  }

  // --- what is declared outside the tree -----------------------------------------------
  void declarations(pugi::xml_node node, const std::string& file) {
    const std::string_view kind = node.name();
    if (kind == "compiler") {
      if (std::string_view(node.attribute("angle").as_string("degree")) != "radian" ||
          node.attribute("eulerseq")) {
        fail(file, node,
             "only angle=\"radian\" and the default order of Euler angles are understood");
      }
    } else if (kind == "asset") {
      for (pugi::xml_node mesh : node.children("mesh")) {
        if (mesh.attribute("refpos") || mesh.attribute("refquat"))
          fail(file, mesh, "refpos and refquat are not understood");
        model_.meshes[mesh.attribute("name").value()] = {mesh.attribute("file").value(),
                                                         vector(file, mesh, "scale", Vec3::Ones())};
      }
    } else if (kind == "equality") {
      for (pugi::xml_node joint : node.children("joint")) coupling(joint, file);
    } else if (kind == "tendon") {
      for (pugi::xml_node tendon : node.children("spatial")) {
        MjcfTendon t{tendon.attribute("name").value(), file, {}};
        for (pugi::xml_node site : tendon.children("site"))
          t.sites.emplace_back(site.attribute("site").value());
        model_.tendons.push_back(std::move(t));
      }
    }
  }

  void coupling(pugi::xml_node node, const std::string& file) {
    MjcfCoupling c{
        node.attribute("joint1").value(), node.attribute("joint2").value(), {0, 1, 0, 0, 0}};
    if (node.attribute("polycoef")) {
      const auto v = numbers(file, node, "polycoef");
      if (v.size() > 5) fail(file, node, "polycoef: at most five numbers expected");
      c.coefficients.fill(0);
      std::copy(v.begin(), v.end(), c.coefficients.begin());
    }
    // The joint it follows stands at zero in the neutral pose, so that only the constant term is
    // left.
    neutral_[c.joint1] = c.coefficients[0];
    model_.couplings.push_back(std::move(c));
  }

  // --- the tree ------------------------------------------------------------------------
  void bodies(pugi::xml_node parent, const std::string& file, const Place& place, int depth) {
    if (depth > limits::kModelDepth)
      throw LimitError(
          fmt::format("{}: bodies nested deeper than {}", printable(file), limits::kModelDepth));
    for (pugi::xml_node child : parent.children()) {
      const std::string_view kind = child.name();
      if (kind == "include") {
        const std::string path = included(file, child);
        bodies(load(path).document_element(), path, place, depth + 1);
      } else if (kind == "body") {
        body(child, file, place, depth);
      } else if (kind == "geom" && child.attribute("mesh")) {
        model_.geoms[child.attribute("name").value()] = {
            place.body, child.attribute("mesh").value(), place.X_WB * placement(file, child)};
      } else if (kind == "site") {
        model_.sites[child.attribute("name").value()] = {
            place.body, place.X_WB * vector(file, child, "pos", Vec3::Zero())};
      }
    }
  }

  // Joints act in order, each in the frame that those before it have left.
  void body(pugi::xml_node node, const std::string& file, const Place& parent, int depth) {
    Place place{node.attribute("name").value(), parent.X_WB * placement(file, node)};
    for (pugi::xml_node joint : node.children("joint")) {
      const std::string name = joint.attribute("name").value();
      MjcfJoint j;
      j.body = place.body;
      j.slide = std::string_view(joint.attribute("type").value()) == "slide";
      const Vec3 local_axis = vector(file, joint, "axis", Vec3::UnitZ());
      if (local_axis.norm() < 1e-9) fail(file, joint, "an axis of length zero");
      const Vec3 local_center = vector(file, joint, "pos", Vec3::Zero());
      j.axis = place.X_WB.linear() * local_axis.normalized();
      j.center = place.X_WB * local_center;
      model_.joints[name] = j;
      const auto q = neutral_.find(name);
      if (q == neutral_.end()) continue;
      if (j.slide) {
        place.X_WB = place.X_WB * Eigen::Translation3d(q->second * local_axis.normalized());
      } else {
        place.X_WB = place.X_WB * Eigen::Translation3d(local_center) *
                     Eigen::AngleAxisd(q->second, local_axis.normalized()) *
                     Eigen::Translation3d(-local_center);
      }
    }
    if (!model_.bodies.emplace(place.body, place.X_WB).second)
      fail(file, node, "a second body of this name");
    bodies(node, file, place, depth + 1);
  }

  const MjcfFiles& files_;
  std::map<std::string, pugi::xml_document> documents_;
  std::map<std::string, double> neutral_;  // joints that do not stand at zero
  Mjcf model_;
};

}  // namespace

Mjcf read_mjcf(const MjcfFiles& files, const std::string& path) { return Reader(files).read(path); }

}  // namespace ecorche::inline v1
