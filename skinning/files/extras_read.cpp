#include "skinning/files/extras_read.h"

#include <fmt/format.h>

#include <cmath>

#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1::extras {
namespace {

using Json = nlohmann::json;

// Members of one object; every failure says where.
class Fields {
 public:
  Fields(const Json& value, std::string where) : value_(value), where_(std::move(where)) {
    if (!value_.is_object()) fail("extras are missing; is this a character written by ecorche?");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(printable(where_) + ": " + printable(what));
  }
  bool has(const std::string& key) const { return value_.contains(key); }

  const Json& get(const std::string& key) const {
    const auto found = value_.find(key);
    if (found == value_.end()) fail(fmt::format("'{}' is missing", key));
    return *found;
  }

  double number(const std::string& key) const { return as_number(get(key), key); }
  int integer(const std::string& key) const { return as_integer(number(key), key); }

  int as_integer(double v, const std::string& key) const {
    if (v != std::floor(v) || std::abs(v) > 1e9)
      fail(fmt::format("'{}' is {}, not a whole number", key, v));
    return int(v);
  }

  std::string text(const std::string& key) const {
    const Json& v = get(key);
    if (!v.is_string()) fail(fmt::format("'{}' is not text", key));
    return v.get<std::string>();
  }

  const Json& list(const std::string& key) const {
    const Json& v = get(key);
    if (!v.is_array()) fail(fmt::format("'{}' is not a list", key));
    return v;
  }

  std::vector<double> row(const Json& v, const std::string& key, size_t count) const {
    if (!v.is_array() || v.size() != count)
      fail(fmt::format("'{}' is not a list of {} numbers", key, count));
    std::vector<double> out(count);
    for (size_t i = 0; i < count; ++i) out[i] = as_number(v[i], key);
    return out;
  }

  std::vector<double> numbers(const std::string& key, size_t count) const {
    return row(get(key), key, count);
  }

  Vec3 vector3(const std::string& key) const {
    const auto v = numbers(key, 3);
    return {v[0], v[1], v[2]};
  }

 private:
  double as_number(const Json& v, const std::string& key) const {
    if (!v.is_number()) fail(fmt::format("'{}' is not a number", key));
    const double d = v.get<double>();
    if (!std::isfinite(d)) fail(fmt::format("'{}' is not finite", key));
    return d;
  }

  const Json& value_;
  std::string where_;
};

Wrap read_wrap(const Json& value, const std::string& where) {
  const Fields in(value, where);
  Wrap wrap;
  const std::string kind = in.text("kind");
  if (kind == "sphere")
    wrap.kind = Wrap::Kind::sphere;
  else if (kind == "cylinder")
    wrap.kind = Wrap::Kind::cylinder;
  else if (kind == "ellipsoid")
    wrap.kind = Wrap::Kind::ellipsoid;
  else
    in.fail(fmt::format("'kind' is '{}'; expected sphere, cylinder or ellipsoid", kind));
  wrap.joint = in.integer("joint");
  const auto q = in.numbers("rotation", 4);
  const Quat rotation(q[3], q[0], q[1], q[2]);
  if (!(rotation.norm() > 1e-6 && rotation.norm() < 1e6))
    in.fail("'rotation' is no quaternion of length 1");
  wrap.X_WO.linear() = rotation.normalized().toRotationMatrix();
  wrap.X_WO.translation() = in.vector3("translation");
  wrap.radii = in.vector3("radii");
  return wrap;
}

Strip read_strip(const Json& value, const std::string& where) {
  const Fields in(value, where);
  Strip strip;
  for (const Json& v : in.list("path")) {
    const auto p = in.row(v, "path", 6);
    PathPoint point;
    point.rest = Vec3(p[0], p[1], p[2]);
    point.joints = {in.as_integer(p[3], "path"), in.as_integer(p[4], "path")};
    point.share = p[5];
    strip.path.push_back(point);
  }
  if (in.has("gliding"))  // a path point and the joint that places it; few strips have some
    for (const Json& v : in.list("gliding")) {
      const auto row = in.row(v, "gliding", 2);
      const int point = in.as_integer(row[0], "gliding");
      if (point < 0 || point >= int(strip.path.size()))
        in.fail(fmt::format("'gliding' names point {} of {}", point, strip.path.size()));
      strip.path[std::size_t(point)].placing_joint = in.as_integer(row[1], "gliding");
    }
  for (const Json& v : in.list("slices")) {
    const bool outlined = v.is_array() && v.size() != 6;
    const auto k = in.row(v, "slices", outlined ? 6 + kOutlinePoints : 6);
    Slice slice{k[0], k[1], Vec2(k[2], k[3]), Vec2(k[4], k[5])};
    for (std::size_t i = 6; i < k.size(); ++i) slice.outline[i - 6] = float(k[i]);
    strip.slices.push_back(slice);
  }
  strip.reference = in.vector3("reference");
  const auto belly = in.numbers("belly", 2);
  strip.belly_begin = belly[0];
  strip.belly_end = belly[1];
  if (in.has("intersections")) {  // most strips have none
    const Json& places = in.list("intersections");
    strip.intersections = in.row(places, "intersections", places.size());
  }
  if (in.has("raphe")) strip.raphe = in.number("raphe");
  strip.rest_length = in.number("rest_length");
  if (in.has("wraps"))
    for (const Json& v : in.list("wraps")) strip.wraps.push_back(read_wrap(v, where + ": wrap"));
  return strip;
}

Side read_side(const Fields& in) {
  const std::string side = in.text("side");
  if (side == "left") return Side::left;
  if (side == "right") return Side::right;
  if (side != "middle")
    in.fail(fmt::format("'side' is '{}'; expected left, right or middle", side));
  return Side::middle;
}

}  // namespace

void read_joint(const Json& value, const std::string& where, Joint& joint) {
  const Fields in(value, where);
  const auto a = in.numbers("axes", 9);
  joint.axes << a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8];
  joint.min = in.vector3("min");
  joint.max = in.vector3("max");
  joint.zero = in.vector3("zero");
  joint.X_PJ.translation() = in.vector3("offset");
}

void read_bone(const Json& value, const std::string& where, Bone& bone) {
  const Fields in(value, where);
  bone.joint = in.integer("joint");
  bone.side = read_side(in);
}

void read_muscle(const Json& value, const std::string& where, Muscle& muscle) {
  const Fields in(value, where);
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
  if (in.has("max_force"))
    muscle.max_force = in.number("max_force");  // files of earlier versions do not state them
  if (in.has("tendon_slack")) muscle.tendon_slack = in.number("tendon_slack");
  if (in.has("tense_thickness")) muscle.tense_thickness = in.number("tense_thickness");
  const Json& sheet = in.get("sheet");
  if (!sheet.is_boolean()) in.fail("'sheet' is not true or false");
  muscle.sheet = sheet.get<bool>();
  int index = 0;
  for (const Json& v : in.list("strips"))
    muscle.strips.push_back(read_strip(v, fmt::format("{}: strip {}", where, ++index)));
}

void read_fascia(const Json& value, const std::string& where, FasciaSheet& sheet) {
  const Fields in(value, where);
  sheet.label = in.text("label");
  sheet.side = read_side(in);
  sheet.group = in.text("group");
  sheet.rows = in.integer("rows");
  sheet.columns = in.integer("columns");
  if (!in.has("bones")) return;
  for (const Json& bone : in.list("bones")) {
    if (!bone.is_string()) in.fail("'bones' holds something that is no text");
    sheet.bones.push_back(bone.get<std::string>());
  }
}

void read_body(const Json& value, const std::string& where, Body& body) {
  const Fields in(value, where);
  body.name = in.text("name");
  const std::string sex = in.text("sex");
  if (sex != "male" && sex != "female")
    in.fail(fmt::format("'sex' is '{}'; expected male or female", sex));
  body.sex = sex == "male" ? Sex::male : Sex::female;
  body.age = in.number("age");
  body.mass = in.number("mass");
  if (!in.has("landmarks") || in.get("landmarks").is_null())
    return;  // glTF writers drop an empty object, or leave nothing in its place
  const Fields points(in.get("landmarks"), where + ": landmarks");
  for (const auto& [name, place] : in.get("landmarks").items())
    body.landmarks.push_back({name, points.vector3(name)});
}

int read_schema(const Json& value, const std::string& where) {
  return Fields(value, where).integer("schema");
}

}  // namespace ecorche::inline v1::extras
