#include "skinning/gltf_values.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <iterator>

#include "anatomy/errors.h"

namespace ecorche::gltf {
namespace {

using tinygltf::Value;

const char* kind_name(Wrap::Kind kind) {
  return kind == Wrap::Kind::sphere ? "sphere" : kind == Wrap::Kind::cylinder ? "cylinder" : "ellipsoid";
}

Value numbers(std::initializer_list<double> values) {
  Array array;
  for (double v : values) array.push_back(number(v));
  return Value(std::move(array));
}

void append_row(std::string& out, std::initializer_list<double> values) { fmt::format_to(std::back_inserter(out), "[{}]", fmt::join(values, ",")); }

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
  out += R"(,"path":)";
  append_list(out, strip.path, [&](const PathPoint& p) { append_row(out, {p.rest.x(), p.rest.y(), p.rest.z(), double(p.joints[0]), double(p.joints[1]), p.share}); });
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
      fmt::format_to(std::back_inserter(out), R"({{"joint":{},"kind":"{}","radii":)", wrap.joint, kind_name(wrap.kind));
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

// Reads members of one object; every failure says where.
class Reader {
 public:
  Reader(const Value& value, std::string where) : value_(value), where_(std::move(where)) {
    if (!value_.IsObject()) fail("extras are missing; is this a character written by ecorche?");
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(where_ + ": " + what); }
  bool has(const std::string& key) const { return value_.Has(key); }

  const Value& get(const std::string& key) const {
    if (!value_.Has(key)) fail(fmt::format("'{}' is missing", key));
    return value_.Get(key);
  }

  double number(const std::string& key) const { return as_number(get(key), key); }

  int integer(const std::string& key) const { return as_integer(number(key), key); }

  int as_integer(double v, const std::string& key) const {
    if (v != std::floor(v) || std::abs(v) > 1e9) fail(fmt::format("'{}' is {}, not a whole number", key, v));
    return static_cast<int>(v);
  }

  std::string text(const std::string& key) const {
    const Value& v = get(key);
    if (!v.IsString()) fail(fmt::format("'{}' is not text", key));
    return v.Get<std::string>();
  }

  const Array& array(const std::string& key) const {
    const Value& v = get(key);
    if (!v.IsArray()) fail(fmt::format("'{}' is not a list", key));
    return v.Get<Array>();
  }

  std::vector<double> row(const Value& v, const std::string& key, size_t count) const {
    if (!v.IsArray() || v.ArrayLen() != count) fail(fmt::format("'{}' is not a list of {} numbers", key, count));
    std::vector<double> out(count);
    for (size_t i = 0; i < count; ++i) out[i] = as_number(v.Get(static_cast<int>(i)), key);
    return out;
  }

  std::vector<double> numbers(const std::string& key, size_t count) const { return row(get(key), key, count); }

  Vec3 vector3(const std::string& key) const {
    const auto v = numbers(key, 3);
    return {v[0], v[1], v[2]};
  }

  const std::string& where() const { return where_; }

 private:
  double as_number(const Value& v, const std::string& key) const {
    if (!v.IsNumber()) fail(fmt::format("'{}' is not a number", key));
    const double d = v.GetNumberAsDouble();
    if (!std::isfinite(d)) fail(fmt::format("'{}' is not finite", key));
    return d;
  }

  const Value& value_;
  std::string where_;
};

Wrap read_wrap(const Value& value, const std::string& where) {
  const Reader in(value, where);
  Wrap wrap;
  const std::string kind = in.text("kind");
  if (kind == "sphere") wrap.kind = Wrap::Kind::sphere;
  else if (kind == "cylinder") wrap.kind = Wrap::Kind::cylinder;
  else if (kind == "ellipsoid") wrap.kind = Wrap::Kind::ellipsoid;
  else in.fail(fmt::format("'kind' is '{}'; expected sphere, cylinder or ellipsoid", kind));
  wrap.joint = in.integer("joint");
  const auto q = in.numbers("rotation", 4);
  const Quat rotation(q[3], q[0], q[1], q[2]);
  if (rotation.norm() < 1e-6) in.fail("'rotation' has no length");
  wrap.X_WO.linear() = rotation.normalized().toRotationMatrix();
  wrap.X_WO.translation() = in.vector3("translation");
  wrap.radii = in.vector3("radii");
  return wrap;
}

Strip read_strip(const Value& value, const std::string& where) {
  const Reader in(value, where);
  Strip strip;
  for (const Value& v : in.array("path")) {
    const auto p = in.row(v, "path", 6);
    PathPoint point;
    point.rest = Vec3(p[0], p[1], p[2]);
    point.joints = {in.as_integer(p[3], "path"), in.as_integer(p[4], "path")};
    point.share = p[5];
    strip.path.push_back(point);
  }
  for (const Value& v : in.array("slices")) {
    const bool outlined = v.IsArray() && v.ArrayLen() != 6;
    const auto k = in.row(v, "slices", outlined ? 6 + kOutlinePoints : 6);
    Slice slice{k[0], k[1], Vec2(k[2], k[3]), Vec2(k[4], k[5])};
    for (std::size_t i = 6; i < k.size(); ++i) slice.outline[i - 6] = static_cast<float>(k[i]);
    strip.slices.push_back(slice);
  }
  strip.reference = in.vector3("reference");
  const auto belly = in.numbers("belly", 2);
  strip.belly_begin = belly[0];
  strip.belly_end = belly[1];
  strip.rest_length = in.number("rest_length");
  if (in.has("wraps"))
    for (const Value& v : in.array("wraps")) strip.wraps.push_back(read_wrap(v, where + ": wrap"));
  return strip;
}

const char* side_name(Side side) { return side == Side::left ? "left" : side == Side::right ? "right" : "middle"; }

Side read_side(const Reader& in) {
  const std::string side = in.text("side");
  if (side == "left") return Side::left;
  if (side == "right") return Side::right;
  if (side != "middle") in.fail(fmt::format("'side' is '{}'; expected left, right or middle", side));
  return Side::middle;
}

}  // namespace

Value number(double value) { return Value(value); }
Value text(const std::string& value) { return Value(value); }
Value vector3(const Vec3& v) { return numbers({v.x(), v.y(), v.z()}); }

Value joint_extras(const Joint& joint) {
  const Mat3& a = joint.axes;
  return Value(Object{{"axes", numbers({a(0, 0), a(1, 0), a(2, 0), a(0, 1), a(1, 1), a(2, 1), a(0, 2), a(1, 2), a(2, 2)})},
                      {"min", vector3(joint.min)},
                      {"max", vector3(joint.max)},
                      {"zero", vector3(joint.zero)},
                      {"offset", vector3(joint.X_PJ.translation())}});
}

Value bone_extras(const Bone& bone) { return Value(Object{{"joint", Value(bone.joint)}, {"side", text(side_name(bone.side))}}); }

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
                      {"sheet", Value(muscle.sheet)},
                      {"strips", std::move(strips)}});
}

Value body_extras(const Body& body) {
  Object landmarks;
  for (const Landmark& landmark : body.landmarks) landmarks[landmark.name] = vector3(landmark.position);
  return Value(Object{{"name", text(body.name)},
                      {"sex", text(body.sex == Sex::male ? "male" : "female")},
                      {"age", number(body.age)},
                      {"mass", number(body.mass)},
                      {"landmarks", Value(std::move(landmarks))}});
}

void read_joint_extras(const Value& value, const std::string& where, Joint& joint) {
  const Reader in(value, where);
  const auto a = in.numbers("axes", 9);
  joint.axes << a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8];
  joint.min = in.vector3("min");
  joint.max = in.vector3("max");
  joint.zero = in.vector3("zero");
  joint.X_PJ.translation() = in.vector3("offset");
}

void read_bone_extras(const Value& value, const std::string& where, Bone& bone) {
  const Reader in(value, where);
  bone.joint = in.integer("joint");
  bone.side = read_side(in);
}

void read_muscle_extras(const Value& value, const std::string& where, Muscle& muscle) {
  const Reader in(value, where);
  muscle.label = in.text("label");
  muscle.side = read_side(in);
  muscle.group = in.text("group");
  muscle.layer = in.text("layer");
  muscle.origin = in.text("origin");
  muscle.insertion = in.text("insertion");
  muscle.origin_bone = in.text("origin_bone");
  muscle.insertion_bone = in.text("insertion_bone");
  muscle.volume = in.number("volume");
  muscle.fibre_length = in.number("fibre_length");
  muscle.pennation = in.number("pennation");
  if (in.has("max_force")) muscle.max_force = in.number("max_force");  // files of earlier versions do not state them
  if (in.has("tendon_slack")) muscle.tendon_slack = in.number("tendon_slack");
  const Value& sheet = in.get("sheet");
  if (!sheet.IsBool()) in.fail("'sheet' is not true or false");
  muscle.sheet = sheet.Get<bool>();
  int index = 0;
  for (const Value& v : in.array("strips")) muscle.strips.push_back(read_strip(v, fmt::format("{}: strip {}", where, ++index)));
}

void read_body_extras(const Value& value, const std::string& where, Body& body) {
  const Reader in(value, where);
  body.name = in.text("name");
  const std::string sex = in.text("sex");
  if (sex != "male" && sex != "female") in.fail(fmt::format("'sex' is '{}'; expected male or female", sex));
  body.sex = sex == "male" ? Sex::male : Sex::female;
  body.age = in.number("age");
  body.mass = in.number("mass");
  if (!in.has("landmarks")) return;  // glTF writers drop an empty object
  const Value& landmarks = in.get("landmarks");
  if (!landmarks.IsObject()) in.fail("'landmarks' is not an object");
  const Reader points(landmarks, where + ": landmarks");
  for (const std::string& name : landmarks.Keys()) body.landmarks.push_back({name, points.vector3(name)});
}

int read_schema(const Value& value, const std::string& where) { return Reader(value, where).integer("schema"); }

}  // namespace ecorche::gltf
