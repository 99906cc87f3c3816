#include "anatomy/model_files/mjcf_writer.h"

// Export models as MuJoCo's MJCF files.
#include <fmt/format.h>

#include <optional>

#include "anatomy/files/atomic_file.h"
#include "anatomy/model_files/export_wraps.h"
#include "anatomy/model_files/model_text.h"

namespace ecorche::inline v1 {
namespace {

// Axes of the file from ours (left, up, forward).
Mat3 mjcf_axes() {
  Mat3 C;
  C << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // forward, left, up
  return C;
}

class MjcfWriter {
 public:
  MjcfWriter(const ExportModel& model, std::string meshes)
      : model_(model), meshes_(std::move(meshes)), origins_(origins_of(model)) {}

  std::string write() {
    line("<mujoco model=\"{}\">", escaped(model_.name));
    line(
        "<!-- Written by ecorche. Joint coordinates are anatomical angles; the default pose is the "
        "rest pose. -->");
    line(
        "<compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\" "
        "balanceinertia=\"true\" meshdir=\"{}\"/>",
        escaped(meshes_));
    line("<option timestep=\"0.001\" integrator=\"implicitfast\"/>\n<size nuser_actuator=\"1\"/>");
    line(
        "<default><joint damping=\"0.5\" armature=\"0.01\"/><geom contype=\"0\" conaffinity=\"0\" "
        "mass=\"0\" rgba=\"0.89 0.85 0.76 1\"/><site size=\"0.001\"/></default>");
    if (!model_.meshes.empty()) {
      line("<asset>");
      for (const ExportMesh& mesh : model_.meshes)
        line("<mesh name=\"{}\" file=\"{}\" inertia=\"shell\"/>", stem(mesh.file), mesh.file);
      line("</asset>");
    }
    line("<worldbody>");
    if (model_.ground)
      line(
          "<geom name=\"floor\" type=\"plane\" size=\"0 0 0.1\" pos=\"0 0 {}\" contype=\"1\" "
          "conaffinity=\"1\" rgba=\"0.8 0.8 0.78 1\"/>",
          *model_.ground);
    for (size_t b = 0; b < model_.bodies.size(); ++b)
      if (model_.bodies[b].parent < 0) body(int(b));
    line("</worldbody>\n<equality>");
    for (const auto& [patella, knee] : model_.patellae)
      line("<joint joint1=\"{}\" joint2=\"{}\" polycoef=\"0 {} 0 0 0\"/>",
           model_.angles[patella].name, model_.angles[knee].name, kPatellaShare);
    line("</equality>\n<tendon>");
    for (const ExportStrip& strip : model_.strips) tendon(strip);
    line("</tendon>\n<actuator>");
    for (const ExportStrip& s : model_.strips)
      line(
          "<muscle name=\"{}\" tendon=\"{}_tendon\" ctrllimited=\"true\" ctrlrange=\"0 1\" "
          "range=\"0.5 1.5\" force=\"{}\" lengthrange=\"{} {}\" user=\"{}\"/>",
          escaped(s.name), escaped(s.name), s.max_force, s.tendon_slack + 0.5 * s.fibre_length,
          s.tendon_slack + 1.5 * s.fibre_length, s.pennation);
    line("</actuator>\n</mujoco>");
    return std::move(out_);
  }

  const ExportLosses& losses() const { return losses_; }

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
    line("<inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{} {} {} {} {} {}\"/>",
         text(turned(b.center)), b.mass, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    for (const ExportAngle& a : model_.angles)
      if (a.body == index)
        line("<joint name=\"{}\" axis=\"{}\" ref=\"{}\" range=\"{} {}\"/>", a.name,
             text(turned(a.axis)), a.rest, a.low, a.high);
    for (const ExportMesh& mesh : model_.meshes)
      if (mesh.body == index)
        line("<geom name=\"{}\" type=\"mesh\" mesh=\"{}\"/>", stem(mesh.file), stem(mesh.file));
    for (const ExportContact& c : model_.contacts)
      if (c.body == index)
        line(
            "<geom name=\"contact_{}\" type=\"sphere\" size=\"{}\" pos=\"{}\" contype=\"1\" "
            "rgba=\"0.4 0.7 0.4 0.4\" group=\"3\"/>",
            c.name, c.radius, text(turned(c.center)));
    for (const ExportMarker& m : model_.markers)
      if (m.body == index)
        line("<site name=\"marker_{}\" pos=\"{}\" rgba=\"0.9 0.3 0.6 1\"/>", m.name,
             text(turned(m.place)));
    for (const ExportStrip& strip : model_.strips) {
      for (size_t k = 0; k < strip.points.size(); ++k)
        if (strip.bodies[k] == index)
          line("<site name=\"{}-P{}\" pos=\"{}\"/>", escaped(strip.name), k + 1,
               text(turned(strip.points[k])));
      for (size_t w = 0; w < strip.wraps.size(); ++w)
        if (strip.wraps[w].joint == index) wrap(strip, w);
    }
    for (size_t child = std::size_t(index) + 1; child < model_.bodies.size(); ++child)
      if (model_.bodies[child].parent == index) body(int(child));
    line("</body>");
  }

  // What MuJoCo can wrap over, or nothing.
  std::optional<Wrap> shown(const ExportStrip& strip, const Wrap& wrap) const {
    return wrap.kind == Wrap::Kind::ellipsoid
               ? osculating_sphere(wrap, place_wrap(strip, wrap, origins_))
               : wrap;
  }

  void wrap(const ExportStrip& strip, size_t index) {
    const auto found = shown(strip, strip.wraps[index]);
    if (!found) return;
    const Wrap& w = *found;
    const Quat q(Mat3(mjcf_axes() * w.X_WO.linear()));
    const std::string size = w.kind == Wrap::Kind::sphere
                                 ? text(w.radii.x())
                                 : fmt::format("{} {}", w.radii.x(), w.radii.z());
    line(
        "<geom name=\"{}_w{}\" type=\"{}\" size=\"{}\" pos=\"{}\" quat=\"{} {} {} {}\" rgba=\"0.5 "
        "0.5 0.9 0.3\" group=\"3\"/>",
        escaped(strip.name), index + 1, w.kind == Wrap::Kind::sphere ? "sphere" : "cylinder", size,
        text(turned(w.X_WO.translation() - origins_[w.joint])), q.w(), q.x(), q.y(), q.z());
    // The side that the line passes on at rest, a way off the surface.
    const Vec3 o = w.X_WO.translation(),
               near = place_wrap(strip, strip.wraps[index], origins_).near;
    Vec3 out = near - o;
    if (w.kind == Wrap::Kind::cylinder)
      out -= w.X_WO.linear().col(2) * w.X_WO.linear().col(2).dot(out);
    if (out.norm() < 1e-6) out = w.X_WO.linear().col(0);
    line("<site name=\"{}_s{}\" pos=\"{}\"/>", escaped(strip.name), index + 1,
         text(turned(o + 1.5 * w.radii.x() * out.normalized() - origins_[w.joint])));
  }

  void tendon(const ExportStrip& s) {
    line("<spatial name=\"{}_tendon\">", escaped(s.name));
    std::vector<int> in_gap(s.points.size(), -1);  // MuJoCo takes one object between two sites
    for (size_t w = 0; w < s.wraps.size(); ++w) {
      const size_t gap = place_wrap(s, s.wraps[w], origins_).gap;
      const bool fits = in_gap[gap] < 0 && shown(s, s.wraps[w]);
      if (fits)
        in_gap[gap] = int(w);
      else
        ++losses_.wraps_left_out;
      losses_.wraps_as_spheres += fits && s.wraps[w].kind == Wrap::Kind::ellipsoid;
    }
    for (size_t k = 0; k < s.points.size(); ++k) {
      if (in_gap[k] >= 0)
        line("<geom geom=\"{}_w{}\" sidesite=\"{}_s{}\"/>", escaped(s.name), in_gap[k] + 1,
             escaped(s.name), in_gap[k] + 1);
      line("<site site=\"{}-P{}\"/>", escaped(s.name), k + 1);
    }
    line("</spatial>");
  }

  const ExportModel& model_;
  std::string meshes_;
  std::vector<Vec3> origins_;
  std::string out_;
  ExportLosses losses_;
};

}  // namespace

ExportLosses write_mjcf(const std::filesystem::path& file, const ExportModel& model) {
  MjcfWriter writer(model, file.stem().string() + "_meshes");
  const std::string text = writer.write();
  write_model_meshes(file, model, mjcf_axes());
  write_file_atomically(file, text);
  return writer.losses();
}

}  // namespace ecorche::inline v1
