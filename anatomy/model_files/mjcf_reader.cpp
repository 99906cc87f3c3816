#include "anatomy/model_files/mjcf_reader.h"

// MuJoCo model files (MJCF) as musculoskeletal models: bodies, spatial tendons and the muscles that
// pull on them.
#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/model_files/mjcf_tree.h"

namespace ecorche::inline v1 {
namespace {

using pugi::xml_node;
// Our axes (left, up, forward) from MuJoCo's (forward, left, up).
Mat3 ours_from_mjcf() {
  Mat3 C;
  C << 0, 1, 0, 0, 0, 1, 1, 0, 0;
  return C;
}

struct Hinge {
  double initial = 0, low = 0, high = 0;
  bool limited = false, slide = false;
};

struct Site {
  int body = -1;
  Vec3 place = Vec3::Zero();
};

class MjcfReaderReader {
 public:
  MjcfReaderReader(const ModelFiles& files, const std::string& path) : tree_(files, path) {}

  MusculoskeletalModel read() {
    model_.file = tree_.name();
    model_.format = "MJCF";
    model_.faces_forward = false;
    model_.name = tree_.root().attribute("model").value();
    for (xml_node asset : tree_.sections("asset"))
      for (xml_node mesh : asset.children("mesh")) meshes_[mesh_name(mesh)] = mesh;
    for (xml_node world : tree_.sections("worldbody")) find_joints(world, "", 0);
    couple();
    PerPose<Transform> ground;
    for (Transform& X : ground) {
      X = Transform::Identity();
      X.linear() = ours_from_mjcf();
    }
    for (xml_node world : tree_.sections("worldbody")) children(world, -1, ground, "", 0);
    for (xml_node section : tree_.sections("tendon"))
      for (xml_node tendon : section.children("spatial"))
        tendons_[tendon.attribute("name").value()] = tendon;
    for (xml_node section : tree_.sections("actuator"))
      for (xml_node actuator : section.children()) add_muscle(actuator);
    if (other_actuators_ > 0)
      model_.notes.push_back(fmt::format("{}: {} actuators are no muscles on tendons; left out",
                                         model_.file, other_actuators_));
    if (model_.bodies.empty()) throw UnfitError(fmt::format("{}: no bodies", model_.file));
    if (model_.muscles.empty())
      throw UnfitError(fmt::format("{}: no muscle actuators on spatial tendons", model_.file));
    check_model(model_);
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(xml_node node, const std::string& message) const {
    throw InputError(fmt::format("{}: {}", tree_.where(node), message));
  }

  std::vector<double> numbers(xml_node node, const char* name, const std::string& childclass,
                              size_t most) const {
    return model_xml::numbers(tree_.attribute(node, name, childclass),
                              fmt::format("{}: {}", tree_.where(node), name), most);
  }

  static std::string mesh_name(xml_node mesh) {
    if (mesh.attribute("name")) return mesh.attribute("name").value();
    return std::filesystem::path(mesh.attribute("file").value()).stem().string();
  }

  // Joints may be without a name.
  static std::string joint_key(xml_node joint) {
    return joint.attribute("name") ? joint.attribute("name").value()
                                   : fmt::format("/{}", joint.hash_value());
  }

  std::string class_of(xml_node body, const std::string& outer) const {
    return body.attribute("childclass") ? body.attribute("childclass").value() : outer;
  }

  // --- joints --------------------------------------------------------------------------
  void find_joints(xml_node node, const std::string& childclass, int depth) {
    if (depth > limits::kModelDepth)
      throw LimitError(
          fmt::format("{}: bodies nested deeper than {}", model_.file, limits::kModelDepth));
    for (xml_node child : node.children()) {
      const std::string_view kind = child.name();
      if (kind == "body" || kind == "frame")
        find_joints(child, class_of(child, childclass), depth + 1);
      if (kind != "joint") continue;
      const std::string type = tree_.attribute(child, "type", childclass);
      if (type == "free" || type == "ball") continue;
      Hinge h;
      h.slide = type == "slide";
      const double unit = tree_.degrees() && !h.slide ? kDegree : 1;
      if (const auto ref = numbers(child, "ref", childclass, 1); ref.size() == 1)
        h.initial = unit * ref[0];
      const auto range = numbers(child, "range", childclass, 2);
      if (range.size() == 2 && range[0] < range[1] &&
          tree_.attribute(child, "limited", childclass) != "false") {
        h.limited = true;
        h.low = unit * range[0];
        h.high = unit * range[1];
      }
      joints_[joint_key(child)] = h;
    }
  }

  void couple() {
    for (int pose = 0; pose < kModelPoses; ++pose)
      for (const auto& [name, h] : joints_) {
        values_[pose][name] = h.initial;
        if (pose == kZeroPose && !h.slide)
          values_[pose][name] = h.limited ? std::clamp(0.0, h.low, h.high) : 0;
      }
    for (int round = 0; round < 4; ++round)
      for (xml_node section : tree_.sections("equality"))
        for (xml_node node : section.children("joint")) {
          if (tree_.attribute(node, "active") == "false") continue;
          const std::string a = node.attribute("joint1").value(),
                            b = node.attribute("joint2").value();
          if (!joints_.count(a) || (!b.empty() && !joints_.count(b)))
            fail(node, fmt::format("unknown joint '{}' or '{}'", printable(a), printable(b)));
          auto c = numbers(node, "polycoef", "", 5);
          if (c.empty()) c = {0, 1};
          for (auto& values : values_) {
            const double x = b.empty() ? 0 : values[b] - joints_[b].initial;
            double sum = 0;
            for (size_t i = c.size(); i-- > 0;) sum = sum * x + c[i];
            values[a] = joints_[a].initial + sum;
          }
        }
  }

  // --- bodies --------------------------------------------------------------------------
  void children(xml_node node, int index, const PerPose<Transform>& X_WB,
                const std::string& childclass, int depth) {
    for (xml_node child : node.children()) {
      const std::string_view kind = child.name();
      if (kind == "body")
        body(child, index, X_WB, childclass, depth + 1);
      else if (kind == "frame")
        in_frame(child, index, X_WB, childclass, depth + 1);
      else if (kind == "site")
        site(child, index, Transform::Identity(), childclass);
      else if (kind == "geom")
        geom(child, index, Transform::Identity(), childclass);
      else if (kind == "replicate" || kind == "attach" || kind == "composite" || kind == "flexcomp")
        model_.notes.push_back(fmt::format("{}: not understood; left out", tree_.where(child)));
    }
  }

  void in_frame(xml_node node, int index, const PerPose<Transform>& X_WB, const std::string& outer,
                int depth) {
    if (depth > limits::kModelDepth)
      throw LimitError(
          fmt::format("{}: frames nested deeper than {}", model_.file, limits::kModelDepth));
    const std::string childclass = class_of(node, outer);
    const Transform X_BF = tree_.placement(node);
    for (xml_node child : node.children()) {
      const std::string_view kind = child.name();
      PerPose<Transform> X = X_WB;
      for (Transform& x : X) x = x * X_BF;
      if (kind == "body")
        body(child, index, X, childclass, depth + 1);
      else if (kind == "frame")
        fail(child,
             "frames within frames are not understood; let MuJoCo save the model (mj_saveLastXML)");
      else if (kind == "site")
        site(child, index, X_BF, childclass);
      else if (kind == "geom")
        geom(child, index, X_BF, childclass);
    }
  }

  void body(xml_node node, int parent, const PerPose<Transform>& X_WP, const std::string& outer,
            int depth) {
    if (depth > limits::kModelDepth)
      throw LimitError(
          fmt::format("{}: bodies nested deeper than {}", model_.file, limits::kModelDepth));
    if (model_.bodies.size() >= std::size_t(limits::kModelParts))
      throw LimitError(fmt::format("{}: more than {} bodies", model_.file, limits::kModelParts));
    const std::string childclass = class_of(node, outer);
    const Transform X_PB = tree_.placement(node);
    ModelBody out;
    out.name = node.attribute("name").value();
    out.parent = parent;
    for (int pose = 0; pose < kModelPoses; ++pose) {
      Transform X = X_WP[pose] * X_PB;
      Vec3 center = X.translation();
      for (xml_node joint : node.children("joint")) {
        const auto found = joints_.find(joint_key(joint));
        if (found == joints_.end()) continue;
        const Vec3 at = vector(joint, "pos", childclass, Vec3::Zero()),
                   axis = vector(joint, "axis", childclass, Vec3::UnitZ());
        if (axis.norm() < 1e-12) fail(joint, "axis has no length");
        const double q = values_[pose][found->first] - found->second.initial;
        if (found->second.slide)
          X = X * Eigen::Translation3d(q * axis.normalized());
        else {
          X = X * Eigen::Translation3d(at) * Eigen::AngleAxisd(q, axis.normalized()) *
              Eigen::Translation3d(-at);
          center = X * at;
        }
      }
      out.X_WB[pose] = X;
      out.center[pose] = node.child("joint") ? center : X.translation();
    }
    out.loose = !node.child("joint");
    const int index = model_.bodies.size();
    model_.bodies.push_back(std::move(out));
    const PerPose<Transform> X_WB = model_.bodies[index].X_WB;
    children(node, index, X_WB, childclass, depth);
  }

  Vec3 vector(xml_node node, const char* name, const std::string& childclass,
              const Vec3& otherwise) const {
    const std::string text = tree_.attribute(node, name, childclass);
    return text.empty() ? otherwise
                        : model_xml::vector3(text, fmt::format("{}: {}", tree_.where(node), name));
  }

  void site(xml_node node, int body, const Transform& X_BF, const std::string& childclass) {
    if (sites_.size() >= 4 * std::size_t(limits::kModelParts))
      throw LimitError(fmt::format("{}: too many sites", model_.file));
    sites_[node.attribute("name").value()] = {
        body, (X_BF * tree_.placement(node, childclass)).translation()};
  }

  void geom(xml_node node, int body, const Transform& X_BF, const std::string& childclass) {
    const std::string mesh = tree_.attribute(node, "mesh", childclass),
                      type = tree_.attribute(node, "type", childclass);
    if (!mesh.empty()) {
      if (body >= 0) add_mesh(node, mesh, X_BF * tree_.placement(node, childclass), body);
      return;
    }
    if (type != "cylinder" && type != "sphere" && !type.empty()) return;  // what paths wrap over
    ModelWrap wrap;
    wrap.name = node.attribute("name").value();
    if (wrap.name.empty()) return;
    wrap.body = body;
    wrap.X_BO = X_BF * tree_.placement(node, childclass);
    const auto size = numbers(node, "size", childclass, 3);
    if (size.empty() || !(size[0] > 0)) return;
    wrap.radii.setConstant(size[0]);
    if (type == "cylinder") {
      wrap.kind = ModelWrap::Kind::cylinder;
      double half = size.size() > 1 ? size[1] : 0;
      if (const auto ends = numbers(node, "fromto", childclass, 6); ends.size() == 6) {
        const Vec3 a = X_BF * Vec3(ends[0], ends[1], ends[2]),
                   b = X_BF * Vec3(ends[3], ends[4], ends[5]);
        half = (b - a).norm() / 2;
        if (half < 1e-12) fail(node, "fromto has no length");
        wrap.X_BO.translation() = (a + b) / 2;
        wrap.X_BO.linear() = Quat::FromTwoVectors(Vec3::UnitZ(), b - a).toRotationMatrix();
      }
      wrap.radii.z() = half;
      if (!(half > 0)) return;
    }
    if (wrap_geoms_.size() >= 4 * std::size_t(limits::kModelParts))
      throw LimitError(fmt::format("{}: too many geoms", model_.file));
    wrap_geoms_[wrap.name] = wrap;
  }

  void add_mesh(xml_node node, const std::string& name, const Transform& X_BG, int body) {
    const auto found = meshes_.find(name);
    if (found == meshes_.end()) fail(node, fmt::format("unknown mesh '{}'", printable(name)));
    const std::string file = found->second.attribute("file").value();
    if (file.empty()) return;
    ModelMesh mesh;
    const std::string folder = tree_.mesh_folder();
    mesh.file = model_xml::inside(tree_.name(), folder.empty() ? file : folder + "/" + file,
                                  tree_.where(found->second));
    mesh.scale = vector(found->second, "scale", "", Vec3::Ones());
    mesh.X_BG = X_BG;
    model_.bodies[body].meshes.push_back(std::move(mesh));
  }

  // --- muscles -------------------------------------------------------------------------
  // Objects are taken a side at a time: the same geom may be passed on different sides by different
  // tendons, but it is one object.
  int wrap_index(xml_node use, const std::string& name) {
    const auto geom = wrap_geoms_.find(name);
    if (geom == wrap_geoms_.end())
      fail(use, fmt::format("no sphere or cylinder geom '{}' to wrap over", printable(name)));
    if (geom->second.body < 0) return -1;
    const auto [at, fresh] = wrap_index_.try_emplace(name, int(model_.wraps.size()));
    if (fresh) model_.wraps.push_back(geom->second);
    return at->second;
  }

  const Site& find_site(xml_node use, const std::string& name) const {
    const auto found = sites_.find(name);
    if (found == sites_.end()) fail(use, fmt::format("unknown site '{}'", printable(name)));
    return found->second;
  }

  // The side that a tendon passes on, from a site of whatever body; sites inside the object mean
  // that the path runs through it.
  void wrap_use(xml_node node, ModelMuscle& muscle) {
    ModelWrapUse use;
    use.wrap = wrap_index(node, node.attribute("geom").value());
    if (use.wrap < 0) return;
    use.first = int(muscle.points.size()) - 1;
    use.last = use.first + 1;
    if (node.attribute("sidesite")) {
      const Site& site = find_site(node, node.attribute("sidesite").value());
      const ModelWrap& wrap = model_.wraps[use.wrap];
      if (site.body < 0) return;
      const Transform X_WO = model_.bodies[wrap.body].X_WB[kDefaultPose] * wrap.X_BO;
      use.side = X_WO.inverse() * (model_.bodies[site.body].X_WB[kDefaultPose] * site.place);
      const double reach =
          wrap.kind == ModelWrap::Kind::cylinder ? use.side.head<2>().norm() : use.side.norm();
      if (reach < wrap.radii.x()) use.wrap = through(use.wrap);
    }
    muscle.wraps.push_back(use);
  }

  int through(int wrap) {
    const auto [at, fresh] = through_.try_emplace(wrap, int(model_.wraps.size()));
    if (fresh) {
      ModelWrap hole = model_.wraps[wrap];
      hole.kind = ModelWrap::Kind::torus;
      hole.radii << hole.radii.x(), hole.radii.x(), 0;
      model_.wraps.push_back(hole);
    }
    return at->second;
  }

  void add_muscle(xml_node node) {
    const std::string tendon_name = node.attribute("tendon").value();
    const std::string_view kind = node.name();
    if (tendon_name.empty() ||
        (kind != "muscle" && tree_.attribute(node, "gaintype") != "muscle")) {
      ++other_actuators_;
      return;
    }
    const auto tendon = tendons_.find(tendon_name);
    if (tendon == tendons_.end())
      fail(node, fmt::format("unknown spatial tendon '{}'", printable(tendon_name)));
    ModelMuscle muscle;
    muscle.name = node.attribute("name") ? node.attribute("name").value() : tendon_name;
    forces(node, muscle);
    for (xml_node part : tendon->second.children()) {
      const std::string_view what = part.name();
      if (muscle.points.size() + muscle.wraps.size() > 1000)
        throw LimitError(tree_.where(tendon->second) + ": more than 1000 points and geoms");
      if (what == "site") {
        const std::string name = part.attribute("site").value();
        const Site& site = find_site(part, name);
        if (site.body < 0) continue;
        ModelPoint point;
        point.name = name;
        point.body = site.body;
        point.place.fill(site.place);
        muscle.points.push_back(std::move(point));
      } else if (what == "geom") {
        wrap_use(part, muscle);
      } else if (what == "pulley") {
        model_.notes.push_back(fmt::format("{}: a pulley; its branches are taken as one path",
                                           tree_.where(tendon->second)));
      }
    }
    if (muscle.points.size() < 2)
      fail(tendon->second,
           fmt::format("a path needs two sites on bodies; it has {}", muscle.points.size()));
    model_.muscles.push_back(std::move(muscle));
  }

  // MuJoCo's muscle says at what shares of its fibre length the actuator's length range begins and
  // ends; fibre and tendon follow.
  void forces(xml_node node, ModelMuscle& muscle) const {
    std::vector<double> range{0.75, 1.05};
    double force = -1;
    if (std::string_view(node.name()) == "muscle") {
      if (const auto r = numbers(node, "range", "", 2); r.size() == 2) range = r;
      if (const auto f = numbers(node, "force", "", 1); f.size() == 1) force = f[0];
    } else {
      const auto g = numbers(node, "gainprm", "", 10);
      if (g.size() >= 3) {
        range = {g[0], g[1]};
        force = g[2];
      }
    }
    muscle.max_force = std::max(0.0, force);
    if (const auto user = numbers(node, "user", "", 16);
        user.size() == 1 && user[0] > 0 && user[0] < 1.6)
      muscle.pennation = user[0];  // as we export it
    const auto length = numbers(node, "lengthrange", "", 2);
    if (length.size() != 2 || !(range[1] > range[0]) || !(length[1] > length[0])) return;
    muscle.fibre_length = (length[1] - length[0]) / (range[1] - range[0]);
    muscle.tendon_slack = std::max(0.0, length[0] - range[0] * muscle.fibre_length);
  }

  MjcfTree tree_;
  MusculoskeletalModel model_;
  std::map<std::string, xml_node> meshes_, tendons_;
  std::map<std::string, Hinge> joints_;
  PerPose<std::map<std::string, double>> values_;
  std::map<std::string, Site> sites_;
  std::map<std::string, ModelWrap> wrap_geoms_;
  std::map<std::string, int> wrap_index_;
  std::map<int, int> through_;
  int other_actuators_ = 0;
};

}  // namespace

MusculoskeletalModel parse_mjcf_model(const ModelFiles& files, const std::string& path) {
  return MjcfReaderReader(files, path).read();
}

}  // namespace ecorche::inline v1
