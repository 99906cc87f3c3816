#include "anatomy/model_files/osim_reader.h"

// OpenSim model files: 4.x (sockets, joint set) and 3.x (joints inside bodies).
#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/model_files/model_xml.h"
#include "anatomy/model_files/osim_functions.h"
#include "anatomy/model_files/osim_joints.h"

namespace ecorche::inline v1 {
namespace {

using pugi::xml_node;

constexpr double kMostTurn = 100;  // rad

// Our axes (left, up, forward) from OpenSim's (forward, up, right).
Mat3 ours_from_osim() {
  Mat3 C;
  C << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  return C;
}

std::string last_part(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

std::string trimmed(const char* text) {
  std::string s = text;
  s.erase(0, s.find_first_not_of(" \t\r\n"));
  s.erase(s.find_last_not_of(" \t\r\n") + 1);
  return s;
}

bool says(xml_node node, const char* child, std::string_view word) {
  return trimmed(node.child_value(child)) == word;
}

struct Frame {  // fixed in a body
  std::string body;
  Transform X_BF = Transform::Identity();
};

class OsimReaderReader {
 public:
  explicit OsimReaderReader(std::string name) { model_.file = std::move(name); }

  MusculoskeletalModel read(const std::string& text) {
    model_xml::load(document_, text, model_.file);
    const xml_node root = document_.child("OpenSimDocument");
    const xml_node model = root.child("Model");
    if (!model)
      throw InputError(fmt::format(
          "{}: no <Model> in an <OpenSimDocument>; is it an OpenSim model (.osim)?", model_.file));
    model_.format = fmt::format("OpenSim {}", root.attribute("Version").value());
    model_.name = model.attribute("name").value();
    find_joints(model);
    for (xml_node constraint :
         model.child("ConstraintSet").child("objects").children("CoordinateCouplerConstraint"))
      coordinates_.couple(constraint, where("constraint", constraint));
    coordinates_.settle();
    place_bodies();
    for (xml_node body : model.child("BodySet").child("objects").children("Body"))
      parts_of_body(body);
    if (xml_node ground = model.child("Ground")) ground_wraps(ground);
    for (xml_node force : model.child("ForceSet").child("objects").children()) add_force(force);
    leave_out();
    check_model(model_);
    return std::move(model_);
  }

 private:
  std::string where(const char* kind, xml_node node) const {
    return fmt::format("{}: {} '{}'", model_.file, kind, printable(node.attribute("name").value()));
  }

  Transform placement(xml_node node, const char* position, const char* orientation,
                      const std::string& at) const {
    Transform X = Transform::Identity();
    if (node.child(position))
      X.translation() =
          model_xml::vector3(node.child_value(position), fmt::format("{}: {}", at, position));
    if (node.child(orientation)) {
      const Vec3 turn =
          model_xml::vector3(node.child_value(orientation), fmt::format("{}: {}", at, orientation));
      if (turn.cwiseAbs().maxCoeff() > kMostTurn)
        throw InputError(fmt::format("{}: {}: {:.3g} rad; expected radians up to {}", at,
                                     orientation, turn.cwiseAbs().maxCoeff(), kMostTurn));
      X.linear() = model_xml::body_xyz(turn);
    }
    return X;
  }

  // --- joints and frames ---------------------------------------------------------------
  void find_joints(xml_node model) {
    frames_["ground"] = {"ground", Transform::Identity()};
    std::vector<std::pair<xml_node, std::string>> joints;  // with the child's name in 3.x files
    for (xml_node body : model.child("BodySet").child("objects").children("Body")) {
      const std::string name = body.attribute("name").value();
      if (name == "ground") continue;
      if (frames_.size() > std::size_t(limits::kModelParts))
        throw LimitError(fmt::format("{}: more than {} bodies", model_.file, limits::kModelParts));
      if (name.empty() || !frames_.emplace(name, Frame{name, Transform::Identity()}).second)
        throw InputError(fmt::format("{}: a body without a name of its own", where("body", body)));
      for (xml_node frame : body.child("components").children("PhysicalOffsetFrame"))
        offset_frame(frame, name);
      for (xml_node joint : body.child("Joint").children())
        joints.emplace_back(joint, name);  // 3.x
    }
    for (xml_node joint : model.child("JointSet").child("objects").children())
      joints.emplace_back(joint, "");
    for (const auto& [node, child] : joints) {
      OsimJoint joint = child.empty() ? socket_joint(node) : nested_joint(node, child);
      for (xml_node c : node.child("coordinates").children("Coordinate"))
        joint.coordinates.emplace_back(c.attribute("name").value());
      for (xml_node c : node.child("CoordinateSet").child("objects").children("Coordinate"))
        joint.coordinates.emplace_back(c.attribute("name").value());
      coordinates_.add(joint);
      const std::string key = joint.child;
      if (!joints_.emplace(key, std::move(joint)).second)
        throw InputError(
            fmt::format("{}: body '{}' is moved by two joints", where("joint", node), key));
    }
  }

  void offset_frame(xml_node node, const std::string& body) {
    frames_[node.attribute("name").value()] = {
        body, placement(node, "translation", "orientation", where("frame", node))};
  }

  OsimJoint nested_joint(xml_node node, const std::string& child) const {
    OsimJoint joint;
    joint.name = node.attribute("name").value();
    joint.kind = node.name();
    joint.node = node;
    joint.where = where("joint", node);
    joint.child = child;
    joint.parent = trimmed(node.child_value("parent_body"));
    joint.X_PF = placement(node, "location_in_parent", "orientation_in_parent", joint.where);
    joint.X_BM = placement(node, "location", "orientation", joint.where);
    if (is_reverse(node))
      throw InputError(joint.where +
                       ": reversed joints are not understood; save the model with OpenSim 4");
    return joint;
  }
  static bool is_reverse(xml_node node) { return says(node, "reverse", "true"); }

  OsimJoint socket_joint(xml_node node) {
    OsimJoint joint;
    joint.name = node.attribute("name").value();
    joint.kind = node.name();
    joint.node = node;
    joint.where = where("joint", node);
    std::map<std::string, Frame> own;
    for (xml_node frame : node.child("frames").children("PhysicalOffsetFrame")) {
      const std::string body = last_part(trimmed(frame.child_value("socket_parent")));
      const Frame f{body, placement(frame, "translation", "orientation", where("frame", frame))};
      own[frame.attribute("name").value()] = f;
      frames_.emplace(frame.attribute("name").value(), f);
    }
    const auto resolve = [&](const char* socket) {
      const std::string name = last_part(trimmed(node.child_value(socket)));
      if (const auto found = own.find(name); found != own.end()) return found->second;
      return frame(name, fmt::format("{}: {}", joint.where, socket));
    };
    const Frame parent = resolve("socket_parent_frame"), child = resolve("socket_child_frame");
    joint.parent = parent.body;
    joint.child = child.body;
    joint.X_PF = parent.X_BF;
    joint.X_BM = child.X_BF;
    return joint;
  }

  const Frame& frame(const std::string& name, const std::string& at) const {
    const auto found = frames_.find(last_part(name));
    if (found == frames_.end())
      throw InputError(fmt::format("{}: unknown body or frame '{}'", at, printable(name)));
    return found->second;
  }

  // Bodies in an order in which parents precede children.
  void place_bodies() {
    std::map<std::string, std::vector<std::string>> children;
    for (const auto& [child, joint] : joints_) children[joint.parent].push_back(child);
    std::vector<std::string> queue{"ground"};
    for (size_t at = 0; at < queue.size(); ++at) {
      for (const std::string& name : children[queue[at]]) {
        const OsimJoint& joint = joints_.at(name);
        ModelBody body;
        body.name = name;
        body.loose = joint.kind == "ScapulothoracicJoint" || joint.kind == "EllipsoidJoint";
        body.parent = body_index_.count(joint.parent) ? body_index_.at(joint.parent) : -1;
        for (int pose = 0; pose < kModelPoses; ++pose) {
          const Transform X_WP = body.parent < 0 ? ground() : model_.bodies[body.parent].X_WB[pose];
          const Transform X_WM =
              X_WP * joint.X_PF * osim_joint_transform(joint, coordinates_, pose, model_.notes);
          body.X_WB[pose] = X_WM * joint.X_BM.inverse();
          body.center[pose] = X_WM.translation();
        }
        body_index_[name] = model_.bodies.size();
        model_.bodies.push_back(std::move(body));
        queue.push_back(name);
      }
    }
    for (const auto& [child, joint] : joints_)
      if (!body_index_.count(child))
        throw InputError(
            fmt::format("{}: body '{}' does not hang on the ground: its parent '{}' is unknown or "
                        "a child of its own",
                        joint.where, child, joint.parent));
    if (model_.bodies.empty())
      throw UnfitError(fmt::format("{}: no body hangs on the ground by a joint", model_.file));
  }

  static Transform ground() {
    Transform X = Transform::Identity();
    X.linear() = ours_from_osim();
    return X;
  }

  int body_index(const Frame& f, const std::string& at) const {
    const auto found = body_index_.find(f.body);
    if (found == body_index_.end())
      throw InputError(fmt::format("{}: '{}' is not a body that a joint moves", at, f.body));
    return found->second;
  }

  // --- what hangs on bodies ------------------------------------------------------------
  void parts_of_body(xml_node node) {
    const auto found = body_index_.find(node.attribute("name").value());
    if (found == body_index_.end()) {
      if (std::string_view(node.attribute("name").value()) != "ground")
        throw InputError(fmt::format("{}: no joint moves it", where("body", node)));
      return;
    }
    ModelBody& body = model_.bodies[found->second];
    const std::string at = where("body", node);
    for (xml_node mesh : node.child("attached_geometry").children("Mesh"))
      add_mesh(mesh, "mesh_file", "scale_factors", at, body);
    for (xml_node mesh : node.child("VisibleObject")
                             .child("GeometrySet")
                             .child("objects")
                             .children("DisplayGeometry"))
      add_mesh(mesh, "geometry_file", "scale_factors", at, body);
    for (const xml_node wrap : node.child("WrapObjectSet").child("objects").children())
      add_wrap(wrap, found->second);
  }

  void add_mesh(xml_node node, const char* file, const char* scale, const std::string& at,
                ModelBody& body) {
    ModelMesh mesh;
    mesh.file = model_xml::inside("", trimmed(node.child_value(file)), at + ": " + file);
    if (node.child(scale))
      mesh.scale = model_xml::vector3(node.child_value(scale), at + ": " + scale);
    if (node.child("transform")) {
      const auto v = model_xml::numbers(node.child_value("transform"), at + ": transform", 6);
      if (v.size() != 6) throw InputError(at + ": transform: six numbers expected");
      mesh.X_BG.linear() = model_xml::body_xyz({v[0], v[1], v[2]});
      mesh.X_BG.translation() << v[3], v[4], v[5];
    }
    body.meshes.push_back(std::move(mesh));
  }

  // Objects on the ground ride on no bone and are left out like those that are switched off.
  void ground_wraps(xml_node ground) {
    for (xml_node wrap : ground.child("WrapObjectSet").child("objects").children())
      switched_off_.insert(wrap.attribute("name").value());
  }

  void add_wrap(xml_node node, int body) {
    const std::string at = where("wrap object", node), kind = node.name();
    if (model_.wraps.size() >= std::size_t(limits::kModelParts))
      throw LimitError(
          fmt::format("{}: more than {} wrap objects", model_.file, limits::kModelParts));
    ModelWrap wrap;
    wrap.name = node.attribute("name").value();
    wrap.body = body;
    wrap.X_BO = placement(node, "translation", "xyz_body_rotation", at);
    const auto length = [&](const char* name) {
      const double v = model_xml::number(node.child_value(name), fmt::format("{}: {}", at, name));
      if (!(v > 0) || v > 100)
        throw InputError(fmt::format("{}: {} is {}; a length in metres expected", at, name, v));
      return v;
    };
    if (kind == "WrapSphere") {
      wrap.radii.setConstant(length("radius"));
    } else if (kind == "WrapCylinder") {
      wrap.kind = ModelWrap::Kind::cylinder;
      wrap.radii << length("radius"), length("radius"), length("length") / 2;
    } else if (kind == "WrapEllipsoid") {
      wrap.kind = ModelWrap::Kind::ellipsoid;
      wrap.radii = model_xml::vector3(node.child_value("dimensions"), at + ": dimensions");
      if (!(wrap.radii.minCoeff() > 0))
        throw InputError(at + ": dimensions: three positive lengths expected");
    } else if (kind == "WrapTorus") {
      wrap.kind = ModelWrap::Kind::torus;
      const double tube = length("inner_radius"),
                   hole = std::max(0.0, length("outer_radius") - tube);
      wrap.radii << hole, hole, tube;
    } else {
      model_.notes.push_back(fmt::format("{}: kind '{}' is not understood; left out", at, kind));
      switched_off_.insert(wrap.name);
      return;
    }
    if (says(node, "active", "false")) {
      switched_off_.insert(wrap.name);
      return;
    }
    const std::string quadrant = trimmed(node.child_value("quadrant"));
    if (quadrant.size() <= 2 && !quadrant.empty()) {
      const int axis = quadrant.back() - 'x';
      if (axis >= 0 && axis < 3) wrap.side[axis] = quadrant[0] == '-' ? -1 : 1;
    }
    wrap_index_.emplace(wrap.name, int(model_.wraps.size()));
    model_.wraps.push_back(std::move(wrap));
  }

  // --- muscles -------------------------------------------------------------------------
  static xml_node path_of(xml_node force) {
    for (xml_node child : force.children()) {
      if (std::string_view(child.name()) == "GeometryPath") return child;
      if (xml_node inner = child.child("GeometryPath")) return inner;
    }
    return {};
  }

  void add_force(xml_node node) {
    const xml_node path = path_of(node);
    if (!path) return;
    if (!node.child("max_isometric_force")) {
      model_.notes.push_back(
          fmt::format("{}: a {} is no muscle; left out", where("force", node), node.name()));
      return;
    }
    const std::string at = where("muscle", node);
    if (says(node, "isDisabled", "true") || says(node, "appliesForce", "false")) {
      model_.notes.push_back(at + ": switched off in the model; left out");
      return;
    }
    ModelMuscle muscle;
    muscle.name = node.attribute("name").value();
    const auto value = [&](const char* name) {
      if (!node.child(name)) return 0.0;
      const double v = model_xml::number(node.child_value(name), fmt::format("{}: {}", at, name));
      if (v < 0) throw InputError(fmt::format("{}: {} is {}; it cannot be negative", at, name, v));
      return v;
    };
    muscle.max_force = value("max_isometric_force");
    muscle.fibre_length = value("optimal_fiber_length");
    muscle.tendon_slack = value("tendon_slack_length");
    muscle.pennation = value(node.child("pennation_angle_at_optimal") ? "pennation_angle_at_optimal"
                                                                      : "pennation_angle");
    for (xml_node point : path.child("PathPointSet").child("objects").children())
      add_point(point, at, muscle);
    int active = 0;
    for (const ModelPoint& p : muscle.points) active += p.active[kZeroPose];
    if (active < 2)
      throw InputError(fmt::format("{}: a path needs two points; it has {}", at, active));
    const xml_node uses = path.child("PathWrapSet").child("objects");
    for (xml_node use : uses.children("PathWrap")) add_use(use, at, muscle);
    model_.muscles.push_back(std::move(muscle));
  }

  void add_point(xml_node node, const std::string& muscle_at, ModelMuscle& muscle) {
    const std::string at = fmt::format("{}: path point '{}'", muscle_at,
                                       printable(node.attribute("name").value())),
                      kind = node.name();
    if (++points_ > limits::kModelParts)
      throw LimitError(
          fmt::format("{}: more than {} path points", model_.file, limits::kModelParts));
    const char* socket = node.child("socket_parent_frame") ? "socket_parent_frame"
                         : node.child("socket_parent")     ? "socket_parent"
                                                           : "body";
    const Frame& f = frame(trimmed(node.child_value(socket)), at);
    ModelPoint point;
    point.name = node.attribute("name").value();
    point.body = body_index(f, at);
    const auto coordinate = [&](const char* name, const char* older) {
      return last_part(trimmed(node.child_value(node.child(name) ? name : older)));
    };
    if (kind == "MovingPathPoint") {
      point.kind = ModelPoint::Kind::moving;
      for (int pose = 0; pose < kModelPoses; ++pose) {
        Vec3 place = Vec3::Zero();
        for (int i = 0; i < 3; ++i) {
          const std::string axis(1, char('x' + i));
          const xml_node function = find_osim_function(node.child((axis + "_location").c_str()));
          const std::string c = coordinate(("socket_" + axis + "_coordinate").c_str(),
                                           (axis + "_coordinate").c_str());
          if (!function) throw InputError(fmt::format("{}: {}_location has no function", at, axis));
          place[i] = osim_function(function, c.empty() ? 0 : coordinates_.value(c, pose, at),
                                   fmt::format("{}: {}_location", at, axis));
        }
        point.place[pose] = f.X_BF * place;
      }
    } else {
      const Vec3 place = model_xml::vector3(node.child_value("location"), at + ": location");
      point.place.fill(f.X_BF * place);
    }
    if (kind == "ConditionalPathPoint") {
      point.kind = ModelPoint::Kind::conditional;
      const auto range = model_xml::numbers(node.child_value("range"), at + ": range", 2);
      if (range.size() != 2) throw InputError(at + ": range: two numbers expected");
      for (int pose = 0; pose < kModelPoses; ++pose) {
        const double v =
            coordinates_.value(coordinate("socket_coordinate", "coordinate"), pose, at);
        point.active[pose] = v >= range[0] - 1e-9 && v <= range[1] + 1e-9;
      }
    }
    muscle.points.push_back(std::move(point));
  }

  void add_use(xml_node node, const std::string& at, ModelMuscle& muscle) {
    const std::string name = trimmed(node.child_value("wrap_object"));
    const auto found = wrap_index_.find(name);
    if (found == wrap_index_.end()) {
      if (!switched_off_.count(name))
        throw InputError(fmt::format("{}: unknown wrap object '{}'", at, printable(name)));
      return;
    }
    ModelWrapUse use;
    use.wrap = found->second;
    if (node.child("range")) {
      const auto range = model_xml::numbers(node.child_value("range"), at + ": wrap range", 2);
      if (range.size() == 2 && range[0] > 0)
        use.first = int(range[0]) - 1;  // counted from 1; -1 is the path's end
      if (range.size() == 2 && range[1] > 0) use.last = int(range[1]) - 1;
    }
    muscle.wraps.push_back(use);
  }

  void leave_out() {
    int conditional = 0, moving = 0;
    for (const ModelMuscle& muscle : model_.muscles)
      for (const ModelPoint& point : muscle.points) {
        conditional += point.kind == ModelPoint::Kind::conditional;
        moving += point.kind == ModelPoint::Kind::moving;
      }
    if (conditional > 0)
      model_.notes.push_back(fmt::format(
          "{} conditional path points: kept where they are active at rest, left out elsewhere",
          conditional));
    if (moving > 0)
      model_.notes.push_back(
          fmt::format("{} moving path points: fixed where they are at rest", moving));
    if (!switched_off_.empty())
      model_.notes.push_back(fmt::format(
          "{} wrap objects that are switched off, on the ground or of unknown kind: left out",
          switched_off_.size()));
    if (model_.muscles.empty())
      throw UnfitError(fmt::format("{}: no muscle in its force set", model_.file));
  }

  pugi::xml_document document_;
  MusculoskeletalModel model_;
  OsimCoordinates coordinates_;
  std::map<std::string, Frame> frames_;      // bodies and offset frames by name
  std::map<std::string, OsimJoint> joints_;  // by the body that they move
  std::map<std::string, int> body_index_, wrap_index_;
  std::set<std::string> switched_off_;  // wrap objects that paths may name
  int points_ = 0;
};

}  // namespace

MusculoskeletalModel parse_osim(const std::string& text, const std::string& name) {
  return OsimReaderReader(name).read(text);
}

}  // namespace ecorche::inline v1
