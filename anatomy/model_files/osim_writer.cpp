#include "anatomy/model_files/osim_writer.h"

// Export models as OpenSim 4 files.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "anatomy/files/atomic_file.h"
#include "anatomy/model_files/coordinates.h"
#include "anatomy/model_files/export_wraps.h"
#include "anatomy/model_files/model_text.h"

namespace ecorche::inline v1 {
namespace {

// Axes of the file from ours (left, up, forward).
Mat3 osim_axes() {
  Mat3 C;
  C << 0, 0, 1, 0, 1, 0, -1, 0, 0;  // forward, up, right
  return C;
}

// OpenSim's names hold no blanks and no path characters.
std::string osim_name(const std::string& raw) {
  std::string out = raw;
  for (char& c : out)
    if (c == ' ' || c == '/' || c == '\\' || c == '*' || c == '+' || c == '<' || c == '&' ||
        c == '"' || c == '\t')
      c = '_';
  return out;
}

class OsimWriter {
 public:
  OsimWriter(const ExportModel& model, std::string meshes)
      : model_(model), meshes_(std::move(meshes)), origins_(origins_of(model)) {}

  std::string write() {
    line("<?xml version=\"1.0\" encoding=\"UTF-8\" ?>");
    line("<OpenSimDocument Version=\"40000\">");
    line("<Model name=\"{}\">", escaped(osim_name(model_.name)));
    line(
        "<credits>Written by "
        "ecorche</credits><length_units>meters</length_units><force_units>N</"
        "force_units><gravity>0 -9.80665 0</gravity>");
    line("<BodySet name=\"bodyset\"><objects>");
    for (size_t b = 0; b < model_.bodies.size(); ++b) body(int(b));
    line("</objects></BodySet>\n<JointSet name=\"jointset\"><objects>");
    for (size_t b = 0; b < model_.bodies.size(); ++b) joint(int(b));
    line("</objects></JointSet>\n<ConstraintSet name=\"constraintset\"><objects>");
    for (const auto& [patella, knee] : model_.patellae)
      coupling(model_.angles[patella], model_.angles[knee]);
    line("</objects></ConstraintSet>\n<ForceSet name=\"forceset\"><objects>");
    for (const ExportStrip& strip : model_.strips) muscle(strip);
    for (const ExportContact& contact : model_.contacts) contact_force(contact);
    line("</objects></ForceSet>");
    if (model_.ground) contact_geometry();
    markers();
    line("</Model>\n</OpenSimDocument>");
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
    line(
        "<Body name=\"{}\"><mass>{}</mass><mass_center>{}</mass_center><inertia>{} {} {} {} {} "
        "{}</inertia>",
        b.name, b.mass, text(turned(b.center)), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
        I(1, 2));
    out_ += "<attached_geometry>";
    int number = 0;
    for (const ExportMesh& mesh : model_.meshes)
      if (mesh.body == index)
        line(
            "<Mesh "
            "name=\"{}_geom_{}\"><socket_frame>..</socket_frame><mesh_file>{}/{}</mesh_file></"
            "Mesh>",
            b.name, ++number, escaped(meshes_), mesh.file);
    line("</attached_geometry><WrapObjectSet name=\"wrapobjectset\"><objects>");
    for (const ExportStrip& strip : model_.strips)
      for (size_t w = 0; w < strip.wraps.size(); ++w)
        if (strip.wraps[w].joint == index) wrap(strip, w);
    line("</objects></WrapObjectSet></Body>");
  }

  void wrap(const ExportStrip& strip, size_t index) {
    const Wrap& w = strip.wraps[index];
    const Mat3 R = osim_axes() * w.X_WO.linear();
    const Vec3 angles(std::atan2(-R(1, 2), R(2, 2)), std::asin(std::clamp(R(0, 2), -1.0, 1.0)),
                      std::atan2(-R(0, 1), R(0, 0)));
    const char* kind = w.kind == Wrap::Kind::sphere     ? "WrapSphere"
                       : w.kind == Wrap::Kind::cylinder ? "WrapCylinder"
                                                        : "WrapEllipsoid";
    out_ += fmt::format(
        "<{} "
        "name=\"{}_w{}\"><active>true</active><xyz_body_rotation>{}</"
        "xyz_body_rotation><translation>{}</translation><quadrant>all</quadrant>",
        kind, escaped(osim_name(strip.name)), index + 1, text(angles),
        text(turned(w.X_WO.translation() - origins_[w.joint])));
    if (w.kind == Wrap::Kind::sphere)
      out_ += fmt::format("<radius>{}</radius>", w.radii.x());
    else if (w.kind == Wrap::Kind::cylinder)
      out_ += fmt::format("<radius>{}</radius><length>{}</length>", w.radii.x(), 2 * w.radii.z());
    else
      out_ += fmt::format("<dimensions>{}</dimensions>", text(w.radii));
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
    line(
        "<{} "
        "name=\"{}_joint\"><socket_parent_frame>{}_parent</"
        "socket_parent_frame><socket_child_frame>{}_child</socket_child_frame>",
        kind, b.name, b.name, b.name);
    if (b.parent < 0) {
      out_ += "<coordinates>";
      for (const char* c : kRootCoordinates)
        line("<Coordinate name=\"{}_{}\"><default_value>0</default_value></Coordinate>", b.name, c);
      out_ += "</coordinates>";
    } else if (!angles.empty()) {
      out_ += "<coordinates>";
      for (const ExportAngle* a : angles)
        line(
            "<Coordinate name=\"{}\"><default_value>{}</default_value><range>{} "
            "{}</range><clamped>true</clamped></Coordinate>",
            a->name, a->rest, a->low, a->high);
      out_ += "</coordinates>";
    }
    line(
        "<frames><PhysicalOffsetFrame "
        "name=\"{}_parent\"><socket_parent>{}</socket_parent><translation>{}</"
        "translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>",
        b.name, b.parent < 0 ? "/ground" : "/bodyset/" + model_.bodies[b.parent].name,
        text(turned(b.place)));
    line(
        "<PhysicalOffsetFrame "
        "name=\"{}_child\"><socket_parent>/bodyset/{}</socket_parent><translation>0 0 "
        "0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame></frames>",
        b.name, b.name);
    if (std::string_view(kind) == "CustomJoint") spatial_transform(angles);
    line("</{}>", kind);
  }

  void spatial_transform(const std::vector<const ExportAngle*>& angles) {
    out_ += "<SpatialTransform>";
    std::vector<Vec3> axes;
    for (const ExportAngle* a : angles) axes.push_back(turned(a->axis));
    while (axes.size() < 3) {  // the axes of turns that do not happen must still be independent
      Vec3 other = axes.size() == 1 ? Vec3(axes[0].unitOrthogonal())
                                    : Vec3(axes[0].cross(axes[1]).normalized());
      axes.push_back(other);
    }
    for (size_t i = 0; i < 3; ++i) {
      out_ += fmt::format("<TransformAxis name=\"rotation{}\">", i + 1);
      if (i < angles.size()) out_ += fmt::format("<coordinates>{}</coordinates>", angles[i]->name);
      out_ += fmt::format("<axis>{}</axis>", text(axes[i]));
      if (i < angles.size())
        out_ += fmt::format(
            "<LinearFunction name=\"function\"><coefficients>1 {}</coefficients></LinearFunction>",
            -angles[i]->rest);
      else
        out_ += "<Constant name=\"function\"><value>0</value></Constant>";
      line("</TransformAxis>");
    }
    for (int i = 0; i < 3; ++i)
      line(
          "<TransformAxis name=\"translation{}\"><axis>{}</axis><Constant "
          "name=\"function\"><value>0</value></Constant></TransformAxis>",
          i + 1, text(Vec3(Vec3::Unit(i))));
    line("</SpatialTransform>");
  }

  void coupling(const ExportAngle& patella, const ExportAngle& knee) {
    line(
        "<CoordinateCouplerConstraint "
        "name=\"{}_follows\"><isEnforced>true</"
        "isEnforced><coupled_coordinates_function><LinearFunction><coefficients>{} "
        "{}</coefficients></LinearFunction>"
        "</coupled_coordinates_function><independent_coordinate_names>{}</"
        "independent_coordinate_names><dependent_coordinate_name>{}</dependent_coordinate_name>"
        "<scale_factor>1</scale_factor></CoordinateCouplerConstraint>",
        patella.name, kPatellaShare, patella.rest - kPatellaShare * knee.rest, knee.name,
        patella.name);
  }

  void muscle(const ExportStrip& s) {
    const std::string name = escaped(osim_name(s.name));
    line(
        "<Millard2012EquilibriumMuscle name=\"{}\"><GeometryPath "
        "name=\"geometrypath\"><PathPointSet><objects>",
        name);
    for (size_t k = 0; k < s.points.size(); ++k)
      line(
          "<PathPoint "
          "name=\"{}-P{}\"><socket_parent_frame>/bodyset/{}</socket_parent_frame><location>{}</"
          "location></PathPoint>",
          name, k + 1, model_.bodies[s.bodies[k]].name, text(turned(s.points[k])));
    line("</objects></PathPointSet><PathWrapSet><objects>");
    for (size_t w = 0; w < s.wraps.size(); ++w) {
      const size_t gap = place_wrap(s, s.wraps[w], origins_).gap;
      line(
          "<PathWrap "
          "name=\"pathwrap_{}\"><wrap_object>{}_w{}</wrap_object><method>hybrid</method><range>{} "
          "{}</range></PathWrap>",
          w + 1, name, w + 1, gap, gap + 1);
    }
    line(
        "</objects></PathWrapSet></GeometryPath><max_isometric_force>{}</"
        "max_isometric_force><optimal_fiber_length>{}</optimal_fiber_length><tendon_slack_length>{}"
        "</tendon_slack_length><pennation_angle_at_optimal>{}</"
        "pennation_angle_at_optimal><max_contraction_velocity>10</max_contraction_velocity>"
        "<ignore_tendon_compliance>true</ignore_tendon_compliance><fiber_damping>0.1</"
        "fiber_damping></Millard2012EquilibriumMuscle>",
        s.max_force, s.fibre_length, s.tendon_slack, s.pennation);
  }

  void contact_geometry() {
    line("<ContactGeometrySet name=\"contactgeometryset\"><objects>");
    line(
        "<ContactHalfSpace name=\"floor\"><socket_frame>/ground</socket_frame><location>0 {} "
        "0</location><orientation>0 0 {}</orientation></ContactHalfSpace>",
        *model_.ground, -std::numbers::pi / 2);
    for (const ExportContact& c : model_.contacts)
      line(
          "<ContactSphere "
          "name=\"{}\"><socket_frame>/bodyset/{}</socket_frame><location>{}</location><radius>{}</"
          "radius></ContactSphere>",
          c.name, model_.bodies[c.body].name, text(turned(c.center)), c.radius);
    line("</objects></ContactGeometrySet>");
  }

  // Constants as in the examples that come with OpenSim's optimal control (Falisse et al.
  // 2019, 10.1098/rsif.2019.0402).
  void contact_force(const ExportContact& c) {
    line(
        "<SmoothSphereHalfSpaceForce "
        "name=\"contact_{}\"><socket_sphere>/contactgeometryset/{}</"
        "socket_sphere><socket_half_space>/contactgeometryset/floor</socket_half_space>"
        "<stiffness>3067776</stiffness><dissipation>2</dissipation><static_friction>0.8</"
        "static_friction><dynamic_friction>0.8</dynamic_friction>"
        "<viscous_friction>0.5</viscous_friction><transition_velocity>0.2</transition_velocity></"
        "SmoothSphereHalfSpaceForce>",
        c.name, c.name);
  }

  void markers() {
    if (model_.markers.empty()) return;
    line("<MarkerSet name=\"markerset\"><objects>");
    for (const ExportMarker& m : model_.markers)
      line(
          "<Marker "
          "name=\"{}\"><socket_parent_frame>/bodyset/{}</socket_parent_frame><location>{}</"
          "location></Marker>",
          m.name, model_.bodies[m.body].name, text(turned(m.place)));
    line("</objects></MarkerSet>");
  }

  const ExportModel& model_;
  std::string meshes_;
  std::vector<Vec3> origins_;
  std::string out_;
};

}  // namespace

ExportLosses write_osim(const std::filesystem::path& file, const ExportModel& model) {
  const std::string text = OsimWriter(model, file.stem().string() + "_meshes").write();
  write_model_meshes(file, model, osim_axes());
  write_file_atomically(file, text);
  return {};
}

}  // namespace ecorche::inline v1
