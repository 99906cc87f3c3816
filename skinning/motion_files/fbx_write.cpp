#include "skinning/motion_files/fbx_write.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace ecorche::inline v1 {
namespace {

using namespace std::string_literals;

constexpr std::uint32_t kVersion = 7400;
constexpr double kTicks = 46186158000;     // of FBX's clock a second
constexpr double kCentimetres = 100;       // in a metre
constexpr std::int32_t kTurnsYXZ = 3;      // R = Rz Rx Ry, in FBX's words: first y, then x, then z
constexpr std::int32_t kLinearKeys = 0x4;  // straight between keys

template <class T>
void append(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

// A record: name, properties, records within it.
struct Record {
  std::string name;
  std::string properties;
  std::uint32_t count = 0;  // of properties
  std::vector<Record> inside;

  explicit Record(std::string its_name) : name(std::move(its_name)) {}

  Record&& with(std::int32_t value) && { return std::move(put('I', value)); }
  Record&& with(std::int64_t value) && { return std::move(put('L', value)); }
  Record&& with(double value) && { return std::move(put('D', value)); }
  Record&& with(const std::string& text) && {
    put('S', std::uint32_t(text.size()));
    properties += text;
    return std::move(*this);
  }
  Record&& with_bytes(std::string_view bytes) && {
    put('R', std::uint32_t(bytes.size()));
    properties += bytes;
    return std::move(*this);
  }
  template <class T>
  Record&& with(char kind, const std::vector<T>& values) && {
    put(kind, std::uint32_t(values.size()));
    append(properties, std::uint32_t(0));  // not compressed
    append(properties, std::uint32_t(values.size() * sizeof(T)));
    for (const T& one : values) append(properties, one);
    return std::move(*this);
  }
  Record& add(Record one) {
    inside.push_back(std::move(one));
    return inside.back();
  }

 private:
  template <class T>
  Record& put(char kind, T value) {
    properties += kind;
    append(properties, value);
    ++count;
    return *this;
  }
};

void write_record(const Record& record, std::string& out) {
  const std::size_t begin = out.size();
  append(out, std::uint32_t(0));
  append(out, record.count);
  append(out, std::uint32_t(record.properties.size()));
  append(out, std::uint8_t(record.name.size()));
  out += record.name;
  out += record.properties;
  for (const Record& one : record.inside) write_record(one, out);
  // Readers expect an end of what is inside of these even where nothing is.
  const bool closed = record.count == 0 || record.name == "AnimationLayer";
  if (closed || !record.inside.empty()) out.append(13, '\0');
  const std::uint32_t end = std::uint32_t(out.size());
  std::memcpy(out.data() + begin, &end, sizeof end);
}

Record property(const std::string& name, const std::string& type, const std::string& label,
                const std::string& flags) {
  return Record("P").with(name).with(type).with(label).with(flags);
}

Record whole(const std::string& name, const std::string& type, std::int32_t value) {
  return property(name, type, type == "int" ? "Integer" : "", "").with(value);
}

Record vector(const std::string& name, const std::string& type, const Vec3& value) {
  return property(name, type, "", type.starts_with("Lcl") ? "A" : "")
      .with(value.x())
      .with(value.y())
      .with(value.z());
}

// Identities of objects are numbers of the file's own.
std::int64_t model_of(std::size_t joint) { return 1000000 + std::int64_t(joint); }
std::int64_t attribute_of(std::size_t joint) { return 2000000 + std::int64_t(joint); }
constexpr std::int64_t kStack = 3000000, kLayer = 3000001;
std::int64_t curves_of(std::size_t joint, bool path) {
  return 4000000 + 2 * std::int64_t(joint) + (path ? 1 : 0);
}
std::int64_t curve_of(std::size_t joint, bool path, std::size_t axis) {
  return 5000000 + 6 * std::int64_t(joint) + (path ? 3 : 0) + std::int64_t(axis);
}

std::string object_name(const std::string& name, const char* kind) {
  return name + "\0\x01"s + kind;
}

struct Document {
  Record objects{"Objects"}, connections{"Connections"};
  int models = 0, attributes = 0, nodes = 0, curves = 0;

  void connect(std::int64_t from, std::int64_t to, const std::string& property = {}) {
    Record one = Record("C").with(property.empty() ? "OO"s : "OP"s).with(from).with(to);
    connections.add(property.empty() ? std::move(one) : std::move(one).with(property));
  }
};

void add_joint(const BvhMotion& motion, std::size_t j, Document& out) {
  const BvhJoint& joint = motion.joints[j];
  Record attribute = Record("NodeAttribute")
                         .with(attribute_of(j))
                         .with(object_name(joint.name, "NodeAttribute"))
                         .with("LimbNode"s);
  attribute.add(Record("TypeFlags").with("Skeleton"s));
  out.objects.add(std::move(attribute));
  Record model =
      Record("Model").with(model_of(j)).with(object_name(joint.name, "Model")).with("LimbNode"s);
  model.add(Record("Version").with(std::int32_t(232)));
  Record& properties = model.add(Record("Properties70"));
  properties.add(whole("RotationOrder", "enum", kTurnsYXZ));
  properties.add(whole("RotationActive", "bool", 1));
  properties.add(whole("InheritType", "enum", 1));
  properties.add(vector("Lcl Translation", "Lcl Translation", kCentimetres * joint.offset));
  properties.add(vector("Lcl Rotation", "Lcl Rotation", Vec3::Zero()));
  properties.add(vector("Lcl Scaling", "Lcl Scaling", Vec3::Ones()));
  out.objects.add(std::move(model));
  out.connect(model_of(j), joint.parent < 0 ? 0 : model_of(std::size_t(joint.parent)));
  out.connect(attribute_of(j), model_of(j));
  ++out.models, ++out.attributes;
}

// Curves of a joint's turns, or of a root's path.
void add_curves(const BvhMotion& motion, std::size_t j, bool path,
                const std::vector<std::int64_t>& times, Document& out) {
  const BvhJoint& joint = motion.joints[j];
  const auto first = std::size_t(path ? BvhChannel::x_position : BvhChannel::x_rotation);
  Record node = Record("AnimationCurveNode")
                    .with(curves_of(j, path))
                    .with(object_name(path ? "T" : "R", "AnimCurveNode"))
                    .with(""s);
  Record& defaults = node.add(Record("Properties70"));
  std::array<Record, 3> curves = {Record(""), Record(""), Record("")};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t column = joint.channels.size();
    for (std::size_t c = 0; c < joint.channels.size(); ++c)
      if (std::size_t(joint.channels[c]) == first + axis) column = c;
    if (column == joint.channels.size())
      throw std::invalid_argument("format_fbx: joint '" + joint.name + "' lacks a channel");
    std::vector<float> values;
    double before = 0;
    for (int f = 0; f < motion.frames; ++f) {
      double value = motion.samples[std::size_t(f) * std::size_t(motion.channels) +
                                    std::size_t(joint.first_channel) + column];
      if (!path && f > 0) value = before + std::remainder(value - before, 360.0);
      before = value;
      values.push_back(float(path ? kCentimetres * value : value));
    }
    defaults.add(property("d|"s + "XYZ"[axis], "Number", "", "A").with(double(values[0])));
    Record curve = Record("AnimationCurve")
                       .with(curve_of(j, path, axis))
                       .with(object_name("", "AnimCurve"))
                       .with(""s);
    curve.add(Record("Default").with(double(values[0])));
    curve.add(Record("KeyVer").with(std::int32_t(4008)));
    curve.add(Record("KeyTime").with('l', times));
    curve.add(Record("KeyValueFloat").with('f', values));
    curve.add(Record("KeyAttrFlags").with('i', std::vector<std::int32_t>{kLinearKeys}));
    curve.add(Record("KeyAttrDataFloat").with('f', std::vector<float>(4, 0)));
    curve.add(Record("KeyAttrRefCount").with('i', std::vector<std::int32_t>{motion.frames}));
    curves[axis] = std::move(curve);
  }
  out.objects.add(std::move(node));
  out.connect(curves_of(j, path), kLayer);
  out.connect(curves_of(j, path), model_of(j), path ? "Lcl Translation" : "Lcl Rotation");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    out.objects.add(std::move(curves[axis]));
    out.connect(curve_of(j, path, axis), curves_of(j, path), "d|"s + "XYZ"[axis]);
    ++out.curves;
  }
  ++out.nodes;
}

void add_take(const BvhMotion& motion, const std::string& take, Document& out) {
  std::vector<std::int64_t> times;
  for (int f = 0; f < motion.frames; ++f)
    times.push_back(std::int64_t(std::llround(kTicks * f / motion.fps)));
  Record stack =
      Record("AnimationStack").with(kStack).with(object_name(take, "AnimStack")).with(""s);
  Record& span = stack.add(Record("Properties70"));
  for (const char* name : {"LocalStop", "ReferenceStop"})
    span.add(
        property(name, "KTime", "Time", "").with(times.empty() ? std::int64_t(0) : times.back()));
  out.objects.add(std::move(stack));
  out.objects.add(
      Record("AnimationLayer").with(kLayer).with(object_name(take, "AnimLayer")).with(""s));
  out.connect(kLayer, kStack);
  for (std::size_t j = 0; j < motion.joints.size(); ++j) {
    add_curves(motion, j, false, times, out);
    if (motion.joints[j].parent < 0) add_curves(motion, j, true, times, out);
  }
}

Record settings(double fps) {
  constexpr std::int32_t kOwnRate = 14;
  Record out("GlobalSettings");
  out.add(Record("Version").with(std::int32_t(1000)));
  Record& all = out.add(Record("Properties70"));
  for (const auto& [name, value] :
       std::initializer_list<std::pair<const char*, int>>{{"UpAxis", 1},
                                                          {"UpAxisSign", 1},
                                                          {"FrontAxis", 2},
                                                          {"FrontAxisSign", 1},
                                                          {"CoordAxis", 0},
                                                          {"CoordAxisSign", 1},
                                                          {"OriginalUpAxis", 1},
                                                          {"OriginalUpAxisSign", 1}})
    all.add(whole(name, "int", value));
  all.add(property("UnitScaleFactor", "double", "Number", "").with(1.0));
  all.add(property("OriginalUnitScaleFactor", "double", "Number", "").with(1.0));
  all.add(whole("TimeMode", "enum", kOwnRate));
  all.add(property("CustomFrameRate", "double", "Number", "").with(fps));
  return out;
}

Record definitions(const Document& document) {
  Record out("Definitions");
  out.add(Record("Version").with(std::int32_t(100)));
  const std::array<std::pair<const char*, int>, 7> kinds = {{{"GlobalSettings", 1},
                                                             {"Model", document.models},
                                                             {"NodeAttribute", document.attributes},
                                                             {"AnimationStack", 1},
                                                             {"AnimationLayer", 1},
                                                             {"AnimationCurveNode", document.nodes},
                                                             {"AnimationCurve", document.curves}}};
  std::int32_t total = 0;
  for (const auto& [kind, count] : kinds) total += count;
  out.add(Record("Count").with(total));
  for (const auto& [kind, count] : kinds)
    out.add(Record("ObjectType").with(std::string(kind)))
        .add(Record("Count").with(std::int32_t(count)));
  return out;
}

// Readers of Autodesk's own check these against the time of writing; they are those of a fixed one.
constexpr std::string_view kFileId =
    "\x28\xb3\x2a\xeb\xb6\x24\xcc\xc2\xbf\xc8\xb0\x2a\xa9\x2b\xfc\xf1";
constexpr std::string_view kFootId =
    "\xfa\xbc\xab\x09\xd0\xc8\xd4\x66\xb1\x76\xfb\x83\x1c\xf7\x26\x7e";
constexpr std::string_view kFootEnd =
    "\xf8\x5a\x8c\x6a\xde\xf5\xd9\x7e\xec\xe9\x0c\xe3\x75\x8f\x29\x0b";
constexpr const char* kWritten = "1970-01-01 10:00:00:000";

Record head() {
  Record out("FBXHeaderExtension");
  out.add(Record("FBXHeaderVersion").with(std::int32_t(1003)));
  out.add(Record("FBXVersion").with(std::int32_t(kVersion)));
  out.add(Record("EncryptionType").with(std::int32_t(0)));
  out.add(Record("Creator").with("Ecorche"s));
  return out;
}

Record scene() {
  Record out("Documents");
  out.add(Record("Count").with(std::int32_t(1)));
  out.add(Record("Document").with(std::int64_t(999999)).with("Scene"s).with("Scene"s))
      .add(Record("RootNode").with(std::int64_t(0)));
  return out;
}

}  // namespace

std::string format_fbx(const BvhMotion& motion, const std::string& take) {
  if (motion.samples.size() != std::size_t(motion.frames) * std::size_t(motion.channels) ||
      motion.frames < 1)
    throw std::invalid_argument("format_fbx: samples of other frames");
  Document document;
  for (std::size_t j = 0; j < motion.joints.size(); ++j) add_joint(motion, j, document);
  add_take(motion, take, document);

  std::string out = "Kaydara FBX Binary  \0\x1a\0"s;
  append(out, kVersion);
  write_record(head(), out);
  write_record(Record("FileId").with_bytes(kFileId), out);
  write_record(Record("CreationTime").with(std::string(kWritten)), out);
  write_record(Record("Creator").with("Ecorche"s), out);
  write_record(settings(motion.fps), out);
  write_record(scene(), out);
  write_record(Record("References"), out);
  write_record(definitions(document), out);
  write_record(document.objects, out);
  write_record(document.connections, out);
  out.append(13, '\0');
  out += kFootId;
  append(out, std::uint32_t(0));
  out.append(16 - out.size() % 16, '\0');
  append(out, kVersion);
  out.append(120, '\0');
  out += kFootEnd;
  return out;
}

}  // namespace ecorche::inline v1
