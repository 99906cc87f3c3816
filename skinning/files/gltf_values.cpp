#include "skinning/files/gltf_values.h"

#include <fmt/format.h>

#include <array>
#include <initializer_list>
#include <iterator>
#include <vector>

namespace ecorche::inline v1::gltf {
namespace {

using tinygltf::Value;

const char* kind_name(Wrap::Kind kind) {
  return kind == Wrap::Kind::sphere     ? "sphere"
         : kind == Wrap::Kind::cylinder ? "cylinder"
                                        : "ellipsoid";
}

Value numbers(std::initializer_list<double> values) {
  Array array;
  for (double v : values) array.push_back(number(v));
  return Value(std::move(array));
}

void append_row(std::string& out, std::initializer_list<double> values) {
  fmt::format_to(std::back_inserter(out), "[{}]", fmt::join(values, ","));
}

void append_vector(std::string& out, const Vec3& v) { append_row(out, {v.x(), v.y(), v.z()}); }

template <class Items, class Append>
void append_list(std::string& out, const Items& items, const Append& append) {
  out += '[';
  for (const auto& item : items) {
    if (out.back() != '[') out += ',';
    append(item);
  }
  out += ']';
}

void append_strip(std::string& out, const Strip& strip) {
  out += R"({"belly":)";
  append_row(out, {strip.belly_begin, strip.belly_end});
  if (!strip.intersections.empty())
    fmt::format_to(std::back_inserter(out), R"(,"intersections":[{}])",
                   fmt::join(strip.intersections, ","));
  if (strip.raphe > 0) fmt::format_to(std::back_inserter(out), R"(,"raphe":{})", strip.raphe);
  std::vector<std::array<double, 2>> gliding;  // path points, and the joints that place them
  for (std::size_t k = 0; k < strip.path.size(); ++k)
    if (strip.path[k].placing_joint >= 0)
      gliding.push_back({double(k), double(strip.path[k].placing_joint)});
  if (!gliding.empty()) {
    out += R"(,"gliding":)";
    append_list(out, gliding, [&](const auto& row) { append_row(out, {row[0], row[1]}); });
  }
  out += R"(,"path":)";
  append_list(out, strip.path, [&](const PathPoint& p) {
    append_row(out, {p.rest.x(), p.rest.y(), p.rest.z(), double(p.joints[0]), double(p.joints[1]),
                     p.share});
  });
  out += R"(,"reference":)";
  append_vector(out, strip.reference);
  fmt::format_to(std::back_inserter(out), R"(,"rest_length":{},"slices":)", strip.rest_length);
  append_list(out, strip.slices, [&](const Slice& k) {
    append_row(out, {k.s, k.roll, k.offset.x(), k.offset.y(), k.radii.x(), k.radii.y()});
    if (k.outline == kEllipticOutline) return;
    out.back() = ',';
    fmt::format_to(std::back_inserter(out), "{}]", fmt::join(k.outline, ","));
  });
  if (!strip.wraps.empty()) {
    out += R"(,"wraps":)";
    append_list(out, strip.wraps, [&](const Wrap& wrap) {
      const Quat q(wrap.X_WO.linear());
      fmt::format_to(std::back_inserter(out), R"({{"joint":{},"kind":"{}","radii":)", wrap.joint,
                     kind_name(wrap.kind));
      append_vector(out, wrap.radii);
      out += R"(,"rotation":)";
      append_row(out, {q.x(), q.y(), q.z(), q.w()});
      out += R"(,"translation":)";
      append_vector(out, wrap.X_WO.translation());
      out += '}';
    });
  }
  out += '}';
}

const char* side_name(Side side) {
  return side == Side::left ? "left" : side == Side::right ? "right" : "middle";
}

}  // namespace

Value number(double value) { return Value(value); }
Value text(const std::string& value) { return Value(value); }
Value vector3(const Vec3& v) { return numbers({v.x(), v.y(), v.z()}); }

Value joint_extras(const Joint& joint) {
  const Mat3& a = joint.axes;
  return Value(Object{{"axes", numbers({a(0, 0), a(1, 0), a(2, 0), a(0, 1), a(1, 1), a(2, 1),
                                        a(0, 2), a(1, 2), a(2, 2)})},
                      {"min", vector3(joint.min)},
                      {"max", vector3(joint.max)},
                      {"zero", vector3(joint.zero)},
                      {"offset", vector3(joint.X_PJ.translation())}});
}

Value bone_extras(const Bone& bone) {
  return Value(Object{{"joint", Value(bone.joint)}, {"side", text(side_name(bone.side))}});
}

std::string strips_text(const Muscle& muscle) {
  std::string out;
  append_list(out, muscle.strips, [&](const Strip& strip) { append_strip(out, strip); });
  return out;
}

Value muscle_extras(const Muscle& muscle, Value strips) {
  return Value(Object{{"label", text(muscle.label)},
                      {"side", text(side_name(muscle.side))},
                      {"group", text(muscle.group)},
                      {"layer", text(muscle.layer)},
                      {"origin", text(muscle.origin)},
                      {"insertion", text(muscle.insertion)},
                      {"origin_bone", text(muscle.origin_bone)},
                      {"insertion_bone", text(muscle.insertion_bone)},
                      {"volume", number(muscle.volume)},
                      {"fibre_length", number(muscle.fibre_length)},
                      {"pennation", number(muscle.pennation)},
                      {"max_force", number(muscle.max_force)},
                      {"tendon_slack", number(muscle.tendon_slack)},
                      {"tense_thickness", number(muscle.tense_thickness)},
                      {"sheet", Value(muscle.sheet)},
                      {"strips", std::move(strips)}});
}

Value fascia_extras(const FasciaSheet& sheet) {
  Array bones;
  for (const std::string& bone : sheet.bones) bones.push_back(text(bone));
  Object out{{"label", text(sheet.label)},
             {"side", text(side_name(sheet.side))},
             {"group", text(sheet.group)},
             {"rows", Value(sheet.rows)},
             {"columns", Value(sheet.columns)}};
  if (!bones.empty()) out["bones"] = Value(std::move(bones));
  return Value(std::move(out));
}

Value body_extras(const Body& body) {
  Object landmarks;
  for (const Landmark& landmark : body.landmarks)
    landmarks[landmark.name] = vector3(landmark.position);
  return Value(Object{{"name", text(body.name)},
                      {"sex", text(body.sex == Sex::male ? "male" : "female")},
                      {"age", number(body.age)},
                      {"mass", number(body.mass)},
                      {"landmarks", Value(std::move(landmarks))}});
}

}  // namespace ecorche::inline v1::gltf
