// Export models as OpenSim 4 and MJCF files. Numbers keep all their digits, so that what is read back is what was written.
#include <cmath>

#include <fmt/format.h>

#include "anatomy/atomic_file.h"
#include "anatomy/errors.h"
#include "anatomy/export_model.h"
#include "anatomy/mesh_io.h"

namespace ecorche {
namespace {

namespace fs = std::filesystem;

// Axes of the file from ours (left, up, forward).
Mat3 osim_axes() {
  Mat3 C;
  C << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // forward, up, right
  return C;
}
Mat3 mjcf_axes() {
  Mat3 C;
  C << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // forward, left, up
  return C;
}

std::string text(double v) { return fmt::format("{}", v); }
std::string text(const Vec3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

std::string escaped(const std::string& raw) {
  std::string out;
  for (char c : raw) {
    if (c == '<') out += "&lt;";
    else if (c == '&') out += "&amp;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

// OpenSim's names hold no blanks and no path characters.
std::string osim_name(const std::string& raw) {
  std::string out = raw;
  for (char& c : out)
    if (c == ' ' || c == '/' || c == '\\' || c == '*' || c == '+' || c == '<' || c == '&' || c == '"' || c == '\t') c = '_';
  return out;
}

// The bones beside the model; returns the folder's name.
std::string write_meshes(const fs::path& file, const ExportModel& model, const Mat3& axes) {
  const std::string folder = file.stem().string() + "_meshes";
  if (model.meshes.empty()) return folder;
  make_output_folder(file.parent_path() / folder);
  for (const ExportMesh& mesh : model.meshes) {
    TriMesh turned = mesh.mesh;
    turned.V = mesh.mesh.V * axes.transpose();
    write_obj(file.parent_path() / folder / mesh.file, turned);
  }
  return folder;
}

// The gap between two path points that a wrap is nearest to, and the point of it that is nearest.
std::pair<size_t, Vec3> nearest_gap(const ExportStrip& strip, const Wrap& wrap, const std::vector<Vec3>& origins) {
  std::pair<size_t, Vec3> best{1, Vec3::Zero()};
  double least = 1e300;
  for (size_t k = 1; k < strip.points.size(); ++k) {
    const Vec3 a = origins[strip.bodies[k - 1]] + strip.points[k - 1], b = origins[strip.bodies[k]] + strip.points[k];
    const Vec3 o = wrap.X_WO.translation();
    const double t = std::clamp((o - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-12), 0.0, 1.0);
    const Vec3 p = a + t * (b - a);
    if ((p - o).norm() >= least) continue;
    least = (p - o).norm();
    best = {k, p};
  }
  return best;
}

std::vector<Vec3> origins_of(const ExportModel& model) {
  std::vector<Vec3> out;
  for (const ExportBody& body : model.bodies) out.push_back(body.parent < 0 ? body.place : Vec3(out[body.parent] + body.place));
  return out;
}

// --- OpenSim ---------------------------------------------------------------------------------------------------------------------------
class OsimWriter {
 public:
  OsimWriter(const ExportModel& model, std::string meshes) : model_(model), meshes_(std::move(meshes)), origins_(origins_of(model)) {}

  std::string write() {
    line("<?xml version=\"1.0\" encoding=\"UTF-8\" ?>");
    line("<OpenSimDocument Version=\"40000\">");
    line("<Model name=\"{}\">", escaped(osim_name(model_.name)));
    line("<credits>Written by ecorche</credits><length_units>meters</length_units><force_units>N</force_units><gravity>0 -9.80665 0</gravity>");
    line("<BodySet name=\"bodyset\"><objects>");
    for (size_t b = 0; b < model_.bodies.size(); ++b) body(static_cast<int>(b));
    line("</objects></BodySet>\n<JointSet name=\"jointset\"><objects>");
    for (size_t b = 0; b < model_.bodies.size(); ++b) joint(static_cast<int>(b));
    line("</objects></JointSet>\n<ConstraintSet name=\"constraintset\"><objects>");
    for (const auto& [patella, knee] : model_.patellae) coupling(model_.angles[patella], model_.angles[knee]);
    line("</objects></ConstraintSet>\n<ForceSet name=\"forceset\"><objects>");
    for (const ExportStrip& strip : model_.strips) muscle(strip);
    line("</objects></ForceSet>\n</Model>\n</OpenSimDocument>");
    return std::move(out_);
  }

 private:
  template <class... A>
  void line(fmt::format_string<A...> format, A&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<A>(values)...);
    out_ += '\n';
  }
  static Vec3 turned(const Vec3& v) { return osim_axes() * v; }

  void body(int index) {
    const ExportBody& b = model_.bodies[index];
    const Mat3 I = osim_axes() * b.inertia * osim_axes().transpose();
    line("<Body name=\"{}\"><mass>{}</mass><mass_center>{}</mass_center><inertia>{} {} {} {} {} {}</inertia>", b.name, b.mass, text(turned(b.center)), I(0, 0),
         I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    out_ += "<attached_geometry>";
    int number = 0;
    for (const ExportMesh& mesh : model_.meshes)
      if (mesh.body == index)
        line("<Mesh name=\"{}_geom_{}\"><socket_frame>..</socket_frame><mesh_file>{}/{}</mesh_file></Mesh>", b.name, ++number, escaped(meshes_), mesh.file);
    line("</attached_geometry><WrapObjectSet name=\"wrapobjectset\"><objects>");
    for (const ExportStrip& strip : model_.strips)
      for (size_t w = 0; w < strip.wraps.size(); ++w)
        if (strip.wraps[w].joint == index) wrap(strip, w);
    line("</objects></WrapObjectSet></Body>");
  }

  void wrap(const ExportStrip& strip, size_t index) {
    const Wrap& w = strip.wraps[index];
    const Mat3 R = osim_axes() * w.X_WO.linear();
    const Vec3 angles(std::atan2(-R(1, 2), R(2, 2)), std::asin(std::clamp(R(0, 2), -1.0, 1.0)), std::atan2(-R(0, 1), R(0, 0)));
    const char* kind = w.kind == Wrap::Kind::sphere ? "WrapSphere" : w.kind == Wrap::Kind::cylinder ? "WrapCylinder" : "WrapEllipsoid";
    out_ += fmt::format("<{} name=\"{}_w{}\"><active>true</active><xyz_body_rotation>{}</xyz_body_rotation><translation>{}</translation><quadrant>all</quadrant>", kind,
                        escaped(osim_name(strip.name)), index + 1, text(angles), text(turned(w.X_WO.translation() - origins_[w.joint])));
    if (w.kind == Wrap::Kind::sphere) out_ += fmt::format("<radius>{}</radius>", w.radii.x());
    else if (w.kind == Wrap::Kind::cylinder) out_ += fmt::format("<radius>{}</radius><length>{}</length>", w.radii.x(), 2 * w.radii.z());
    else out_ += fmt::format("<dimensions>{}</dimensions>", text(w.radii));
    line("</{}>", kind);
  }

  std::vector<const ExportAngle*> angles_of(int index) const {
    std::vector<const ExportAngle*> out;
    for (const ExportAngle& angle : model_.angles)
      if (angle.body == index) out.push_back(&angle);
    return out;
  }

  void joint(int index) {
    const ExportBody& b = model_.bodies[index];
    const auto angles = angles_of(index);
    const char* kind = b.parent < 0 ? "FreeJoint" : angles.empty() ? "WeldJoint" : "CustomJoint";
    line("<{} name=\"{}_joint\"><socket_parent_frame>{}_parent</socket_parent_frame><socket_child_frame>{}_child</socket_child_frame>", kind, b.name, b.name, b.name);
    if (b.parent < 0) {
      out_ += "<coordinates>";
      for (const char* c : {"tilt", "turn", "list", "tx", "ty", "tz"}) line("<Coordinate name=\"{}_{}\"><default_value>0</default_value></Coordinate>", b.name, c);
      out_ += "</coordinates>";
    } else if (!angles.empty()) {
      out_ += "<coordinates>";
      for (const ExportAngle* a : angles)
        line("<Coordinate name=\"{}\"><default_value>{}</default_value><range>{} {}</range><clamped>true</clamped></Coordinate>", a->name, a->rest, a->low, a->high);
      out_ += "</coordinates>";
    }
    line("<frames><PhysicalOffsetFrame name=\"{}_parent\"><socket_parent>{}</socket_parent><translation>{}</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>",
         b.name, b.parent < 0 ? "/ground" : "/bodyset/" + model_.bodies[b.parent].name, text(turned(b.place)));
    line("<PhysicalOffsetFrame name=\"{}_child\"><socket_parent>/bodyset/{}</socket_parent><translation>0 0 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame></frames>",
         b.name, b.name);
    if (std::string_view(kind) == "CustomJoint") spatial_transform(angles);
    line("</{}>", kind);
  }

  void spatial_transform(const std::vector<const ExportAngle*>& angles) {
    out_ += "<SpatialTransform>";
    std::vector<Vec3> axes;
    for (const ExportAngle* a : angles) axes.push_back(turned(a->axis));
    while (axes.size() < 3) {  // the axes of turns that do not happen must still be independent
      Vec3 other = axes.size() == 1 ? Vec3(axes[0].unitOrthogonal()) : Vec3(axes[0].cross(axes[1]).normalized());
      axes.push_back(other);
    }
    for (size_t i = 0; i < 3; ++i) {
      out_ += fmt::format("<TransformAxis name=\"rotation{}\">", i + 1);
      if (i < angles.size()) out_ += fmt::format("<coordinates>{}</coordinates>", angles[i]->name);
      out_ += fmt::format("<axis>{}</axis>", text(axes[i]));
      if (i < angles.size()) out_ += fmt::format("<LinearFunction name=\"function\"><coefficients>1 {}</coefficients></LinearFunction>", -angles[i]->rest);
      else out_ += "<Constant name=\"function\"><value>0</value></Constant>";
      line("</TransformAxis>");
    }
    for (int i = 0; i < 3; ++i)
      line("<TransformAxis name=\"translation{}\"><axis>{}</axis><Constant name=\"function\"><value>0</value></Constant></TransformAxis>", i + 1, text(Vec3(Vec3::Unit(i))));
    line("</SpatialTransform>");
  }

  void coupling(const ExportAngle& patella, const ExportAngle& knee) {
    line("<CoordinateCouplerConstraint name=\"{}_follows\"><isEnforced>true</isEnforced><coupled_coordinates_function><LinearFunction><coefficients>{} {}</coefficients></LinearFunction>"
         "</coupled_coordinates_function><independent_coordinate_names>{}</independent_coordinate_names><dependent_coordinate_name>{}</dependent_coordinate_name>"
         "<scale_factor>1</scale_factor></CoordinateCouplerConstraint>",
         patella.name, kPatellaShare, patella.rest - kPatellaShare * knee.rest, knee.name, patella.name);
  }

  void muscle(const ExportStrip& s) {
    const std::string name = escaped(osim_name(s.name));
    line("<Millard2012EquilibriumMuscle name=\"{}\"><GeometryPath name=\"geometrypath\"><PathPointSet><objects>", name);
    for (size_t k = 0; k < s.points.size(); ++k)
      line("<PathPoint name=\"{}-P{}\"><socket_parent_frame>/bodyset/{}</socket_parent_frame><location>{}</location></PathPoint>", name, k + 1, model_.bodies[s.bodies[k]].name,
           text(turned(s.points[k])));
    line("</objects></PathPointSet><PathWrapSet><objects>");
    for (size_t w = 0; w < s.wraps.size(); ++w) {
      const size_t gap = nearest_gap(s, s.wraps[w], origins_).first;
      line("<PathWrap name=\"pathwrap_{}\"><wrap_object>{}_w{}</wrap_object><method>hybrid</method><range>{} {}</range></PathWrap>", w + 1, name, w + 1, gap, gap + 1);
    }
    line("</objects></PathWrapSet></GeometryPath><max_isometric_force>{}</max_isometric_force><optimal_fiber_length>{}</optimal_fiber_length><tendon_slack_length>{}"
         "</tendon_slack_length><pennation_angle_at_optimal>{}</pennation_angle_at_optimal><max_contraction_velocity>10</max_contraction_velocity>"
         "<ignore_tendon_compliance>true</ignore_tendon_compliance><fiber_damping>0.1</fiber_damping></Millard2012EquilibriumMuscle>",
         s.max_force, s.fibre_length, s.tendon_slack, s.pennation);
  }

  const ExportModel& model_;
  std::string meshes_;
  std::vector<Vec3> origins_;
  std::string out_;
};

// --- MJCF ------------------------------------------------------------------------------------------------------------------------------
class MjcfWriter {
 public:
  MjcfWriter(const ExportModel& model, std::string meshes) : model_(model), meshes_(std::move(meshes)), origins_(origins_of(model)) {}

  std::string write() {
    line("<mujoco model=\"{}\">", escaped(model_.name));
    line("<!-- Written by ecorche. Joint coordinates are anatomical angles; the default pose is the rest pose. -->");
    line("<compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\" balanceinertia=\"true\" meshdir=\"{}\"/>", escaped(meshes_));
    line("<option timestep=\"0.001\" integrator=\"implicitfast\"/>\n<size nuser_actuator=\"1\"/>");
    line("<default><joint damping=\"0.5\" armature=\"0.01\"/><geom contype=\"0\" conaffinity=\"0\" mass=\"0\" rgba=\"0.89 0.85 0.76 1\"/><site size=\"0.001\"/></default>");
    if (!model_.meshes.empty()) {
      line("<asset>");
      for (const ExportMesh& mesh : model_.meshes) line("<mesh name=\"{}\" file=\"{}\" inertia=\"shell\"/>", stem(mesh.file), mesh.file);
      line("</asset>");
    }
    line("<worldbody>");
    for (size_t b = 0; b < model_.bodies.size(); ++b)
      if (model_.bodies[b].parent < 0) body(static_cast<int>(b));
    line("</worldbody>\n<equality>");
    for (const auto& [patella, knee] : model_.patellae)
      line("<joint joint1=\"{}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\"/>", model_.angles[patella].name, model_.angles[knee].name, kPatellaShare);
    line("</equality>\n<tendon>");
    for (const ExportStrip& strip : model_.strips) tendon(strip);
    line("</tendon>\n<actuator>");
    for (const ExportStrip& s : model_.strips)
      line("<muscle name=\"{}\" tendon=\"{}_tendon\" ctrllimited=\"true\" ctrlrange=\"0 1\" range=\"0.5 1.5\" force=\"{}\" lengthrange=\"{} {}\" user=\"{}\"/>", escaped(s.name), escaped(s.name),
           s.max_force, s.tendon_slack + 0.5 * s.fibre_length, s.tendon_slack + 1.5 * s.fibre_length, s.pennation);
    line("</actuator>\n</mujoco>");
    return std::move(out_);
  }

  int left_out() const { return left_out_; }

 private:
  template <class... A>
  void line(fmt::format_string<A...> format, A&&... values) {
    fmt::format_to(std::back_inserter(out_), format, std::forward<A>(values)...);
    out_ += '\n';
  }
  static Vec3 turned(const Vec3& v) { return mjcf_axes() * v; }
  static std::string stem(const std::string& file) { return file.substr(0, file.size() - 4); }

  void body(int index) {
    const ExportBody& b = model_.bodies[index];
    const Mat3 I = mjcf_axes() * b.inertia * mjcf_axes().transpose();
    line("<body name=\"{}\" pos=\"{}\">", b.name, text(turned(b.place)));
    if (b.parent < 0) line("<freejoint name=\"{}_free\"/>", b.name);
    line("<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>", text(turned(b.center)), b.mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    for (const ExportAngle& a : model_.angles)
      if (a.body == index) line("<joint name=\"{}\" axis=\"{}\" ref=\"{}\" range=\"{} {}\"/>", a.name, text(turned(a.axis)), a.rest, a.low, a.high);
    for (const ExportMesh& mesh : model_.meshes)
      if (mesh.body == index) line("<geom name=\"{}\" type=\"mesh\" mesh=\"{}\"/>", stem(mesh.file), stem(mesh.file));
    for (const ExportStrip& strip : model_.strips) {
      for (size_t k = 0; k < strip.points.size(); ++k)
        if (strip.bodies[k] == index) line("<site name=\"{}-P{}\" pos=\"{}\"/>", escaped(strip.name), k + 1, text(turned(strip.points[k])));
      for (size_t w = 0; w < strip.wraps.size(); ++w)
        if (strip.wraps[w].joint == index) wrap(strip, w);
    }
    for (size_t child = static_cast<size_t>(index) + 1; child < model_.bodies.size(); ++child)
      if (model_.bodies[child].parent == index) body(static_cast<int>(child));
    line("</body>");
  }

  void wrap(const ExportStrip& strip, size_t index) {
    const Wrap& w = strip.wraps[index];
    if (w.kind == Wrap::Kind::ellipsoid) return;
    const Quat q(Mat3(mjcf_axes() * w.X_WO.linear()));
    const std::string size = w.kind == Wrap::Kind::sphere ? text(w.radii.x()) : fmt::format("{} {}", w.radii.x(), w.radii.z());
    line("<geom name=\"{}_w{}\" type=\"{}\" size=\"{}\" pos=\"{}\" quat=\"{} {} {} {}\" rgba=\"0.5 0.5 0.9 0.3\"/>", escaped(strip.name), index + 1,
         w.kind == Wrap::Kind::sphere ? "sphere" : "cylinder", size, text(turned(w.X_WO.translation() - origins_[w.joint])), q.w(), q.x(), q.y(), q.z());
    // The side that the line passes on at rest, a way off the surface.
    const Vec3 o = w.X_WO.translation(), near = nearest_gap(strip, w, origins_).second;
    Vec3 out = near - o;
    if (w.kind == Wrap::Kind::cylinder) out -= w.X_WO.linear().col(2) * w.X_WO.linear().col(2).dot(out);
    if (out.norm() < 1e-6) out = w.X_WO.linear().col(0);
    line("<site name=\"{}_s{}\" pos=\"{}\"/>", escaped(strip.name), index + 1, text(turned(o + 1.5 * w.radii.x() * out.normalized() - origins_[w.joint])));
  }

  void tendon(const ExportStrip& s) {
    line("<spatial name=\"{}_tendon\">", escaped(s.name));
    std::vector<int> in_gap(s.points.size(), -1);  // MuJoCo takes one object between two sites
    for (size_t w = 0; w < s.wraps.size(); ++w) {
      const size_t gap = nearest_gap(s, s.wraps[w], origins_).first;
      if (s.wraps[w].kind == Wrap::Kind::ellipsoid || in_gap[gap] >= 0) ++left_out_;
      else in_gap[gap] = static_cast<int>(w);
    }
    for (size_t k = 0; k < s.points.size(); ++k) {
      if (in_gap[k] >= 0) line("<geom geom=\"{}_w{}\" sidesite=\"{}_s{}\"/>", escaped(s.name), in_gap[k] + 1, escaped(s.name), in_gap[k] + 1);
      line("<site site=\"{}-P{}\"/>", escaped(s.name), k + 1);
    }
    line("</spatial>");
  }

  const ExportModel& model_;
  std::string meshes_;
  std::vector<Vec3> origins_;
  std::string out_;
  int left_out_ = 0;
};

}  // namespace

int write_osim(const fs::path& file, const ExportModel& model) {
  const std::string text = OsimWriter(model, file.stem().string() + "_meshes").write();
  write_meshes(file, model, osim_axes());
  write_file_atomically(file, text);
  return 0;
}

int write_mjcf(const fs::path& file, const ExportModel& model) {
  MjcfWriter writer(model, file.stem().string() + "_meshes");
  const std::string text = writer.write();
  write_meshes(file, model, mjcf_axes());
  write_file_atomically(file, text);
  return writer.left_out();
}

}  // namespace ecorche
