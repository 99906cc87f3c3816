#include "anatomy/model_files/mjcf_tree.h"

#include <filesystem>
#include <string_view>

#include <fmt/format.h>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {
Vec3 axis_of(char c) {
  const int i = (c | 0x20) - 'x';
  return i >= 0 && i < 3 ? Vec3(Vec3::Unit(i)) : Vec3::Zero();
}

}  // namespace

MjcfTree::MjcfTree(const ModelFiles& files, const std::string& path) : files_(files), path_(path) {
  model_xml::load(document_, files.read(path), path);
  if (std::string_view(root().name()) != "mujoco")
    throw InputError(fmt::format("{}: no <mujoco> element; is it a MuJoCo model (MJCF)?", path));
  expand(root(), path, 0);
  classes_["main"];
  for (pugi::xml_node node : root().children()) {
    const std::string_view kind = node.name();
    if (kind == "default") defaults(node, "", 0);
    if (kind != "compiler") continue;
    if (node.attribute("angle"))
      degrees_ = std::string_view(node.attribute("angle").value()) != "radian";
    if (node.attribute("eulerseq")) euler_order_ = node.attribute("eulerseq").value();
    if (node.attribute("meshdir")) mesh_folder_ = node.attribute("meshdir").value();
    if (std::string_view(node.attribute("coordinate").value()) == "global")
      throw InputError(where(node) + ": global coordinates are not understood");
  }
  if (euler_order_.size() != 3 || euler_order_.find_first_not_of("xyzXYZ") != std::string::npos)
    throw InputError(
        fmt::format("{}: eulerseq '{}'; three of x, y, z expected", path, printable(euler_order_)));
}

// Included files are named from the main file's folder; many models name them from the folder of
// the file that includes.
void MjcfTree::expand(pugi::xml_node node, const std::string& file, int depth) {
  if (depth > 4 * limits::kModelDepth)
    throw LimitError(fmt::format("{}: includes or elements nested too deep", file));
  for (pugi::xml_node child = node.first_child(); child;) {
    const pugi::xml_node next = child.next_sibling();
    if (std::string_view(child.name()) == "include") {
      if (++included_ > limits::kModelFiles)
        throw LimitError(fmt::format("{}: more than {} included files; does one include itself?",
                                     file, limits::kModelFiles));
      const std::string name = child.attribute("file").value();
      std::string path, text;
      try {
        path = model_xml::inside(path_, name, where(child));
        text = files_.read(path);
      } catch (const InputError&) {
        path = model_xml::inside(file, name, where(child));
        text = files_.read(path);
      }
      pugi::xml_document inner;
      model_xml::load(inner, text, path);
      expand(inner.document_element(), path, depth + limits::kModelDepth / 16);
      for (pugi::xml_node part : inner.document_element().children())
        node.insert_copy_before(part, child);
      node.remove_child(child);
    } else {
      expand(child, file, depth + 1);
    }
    child = next;
  }
}

void MjcfTree::defaults(pugi::xml_node node, const std::string& parent, int depth) {
  if (depth > limits::kModelDepth)
    throw LimitError(fmt::format("{}: default classes nested too deep", path_));
  const std::string name = node.attribute("class") ? node.attribute("class").value()
                           : parent.empty()        ? "main"
                                                   : "";
  if (name.empty()) throw InputError(where(node) + ": a class inside a class needs a name");
  auto& own = classes_[name];
  const auto inherited = classes_[parent.empty() ? "main" : parent];
  for (const auto& [element, attributes] : inherited)
    for (const auto& [key, value] : attributes) own[element].emplace(key, value);
  for (pugi::xml_node child : node.children()) {
    if (std::string_view(child.name()) == "default") continue;
    for (pugi::xml_attribute a : child.attributes()) own[child.name()][a.name()] = a.value();
  }
  for (pugi::xml_node child : node.children("default")) defaults(child, name, depth + 1);
}

std::string MjcfTree::attribute(pugi::xml_node node, const char* name,
                                const std::string& childclass) const {
  if (node.attribute(name)) return node.attribute(name).value();
  const std::string own = node.attribute("class").value();
  auto found = classes_.find(own.empty() ? childclass.empty() ? "main" : childclass : own);
  if (found == classes_.end())
    throw InputError(fmt::format("{}: unknown class '{}'", where(node),
                                 printable(own.empty() ? childclass : own)));
  const auto element = found->second.find(node.name());
  if (element == found->second.end()) return "";
  const auto value = element->second.find(name);
  return value == element->second.end() ? "" : value->second;
}

std::vector<pugi::xml_node> MjcfTree::sections(const char* name) const {
  std::vector<pugi::xml_node> out;
  for (pugi::xml_node node : root().children(name)) out.push_back(node);
  return out;
}

std::string MjcfTree::where(pugi::xml_node node) const {
  return fmt::format("{}: <{} name=\"{}\">", path_, node.name(),
                     printable(node.attribute("name").value()));
}

Transform MjcfTree::placement(pugi::xml_node node, const std::string& childclass) const {
  Transform X = Transform::Identity();
  const std::string at = where(node);
  if (const std::string pos = attribute(node, "pos", childclass); !pos.empty())
    X.translation() = model_xml::vector3(pos, at + ": pos");
  const auto unit = [&](const Vec3& v, const char* what) -> Vec3 {
    if (v.norm() < 1e-12) throw InputError(fmt::format("{}: {} has no length", at, what));
    return v.normalized();
  };
  const double angle = degrees_ ? kDegree : 1;
  if (const std::string quat = attribute(node, "quat", childclass); !quat.empty()) {
    const auto q = model_xml::numbers(quat, at + ": quat", 4);
    if (q.size() != 4 || std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) < 1e-9)
      throw InputError(at + ": quat: four numbers, not all zero, expected");
    X.linear() = Quat(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
  } else if (const std::string euler = attribute(node, "euler", childclass); !euler.empty()) {
    const Vec3 e = angle * model_xml::vector3(euler, at + ": euler");
    for (int i = 0; i < 3; ++i) {
      const Mat3 turn = Eigen::AngleAxisd(e[i], axis_of(euler_order_[i])).toRotationMatrix();
      X.linear() = euler_order_[i] >= 'a'
                       ? Mat3(X.linear() * turn)
                       : Mat3(turn * X.linear());  // small letters turn with the body
    }
  } else if (const std::string turn = attribute(node, "axisangle", childclass); !turn.empty()) {
    const auto v = model_xml::numbers(turn, at + ": axisangle", 4);
    if (v.size() != 4) throw InputError(at + ": axisangle: four numbers expected");
    X.linear() =
        Eigen::AngleAxisd(angle * v[3], unit({v[0], v[1], v[2]}, "axisangle")).toRotationMatrix();
  } else if (const std::string axes = attribute(node, "xyaxes", childclass); !axes.empty()) {
    const auto v = model_xml::numbers(axes, at + ": xyaxes", 6);
    if (v.size() != 6) throw InputError(at + ": xyaxes: six numbers expected");
    const Vec3 x = unit({v[0], v[1], v[2]}, "xyaxes"),
               z = unit(x.cross(Vec3(v[3], v[4], v[5])), "xyaxes");
    X.linear() << x, z.cross(x), z;
  } else if (const std::string z = attribute(node, "zaxis", childclass); !z.empty()) {
    X.linear() =
        Quat::FromTwoVectors(Vec3::UnitZ(), unit(model_xml::vector3(z, at + ": zaxis"), "zaxis"))
            .toRotationMatrix();
  }
  return X;
}

}  // namespace ecorche::inline v1
