#include "morph/template/import_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include <fmt/format.h>

#include "anatomy/bones/bone_package.h"
#include "anatomy/errors.h"
#include "anatomy/files/input_file.h"
#include "anatomy/geometry/mesh_measures.h"
#include "anatomy/model_files/model_reader.h"
#include "anatomy/muscles/action_line.h"
#include "anatomy/muscles/taut_path.h"
#include "anatomy/muscles/transform_muscles.h"
#include "anatomy/posing/pose_anatomy.h"
#include "anatomy/queries/signed_distance.h"
#include "morph/placement/fitted_skeleton.h"
#include "morph/template/build_template.h"
#include "morph/template/default_sections.h"

namespace ecorche::inline v1 {
namespace {

constexpr double kThroughHole = 0.8;  // of a torus's hole: how far from its middle a line may pass
// radii: a line that passes further away has nothing to do with it
constexpr double kHoleReach = 4;
constexpr double kShortest = 1e-4;  // m between path points
// places along a line that are asked for their direction: those of its sections
constexpr int kDirections = 16;
constexpr double kUnderSkin = 15e-3;      // m: a belly this near to the skin grows to it
constexpr double kUnknownSection = 1e-4;  // m^2, of muscles whose forces are not stated

std::string region(const std::string& joint) {
  const std::string stem = split_side(joint).first;
  static const std::map<std::string, std::string> regions{
      {"pelvis", "hip"},          {"hip", "thigh"},
      {"patella", "thigh"},       {"knee", "leg"},
      {"ankle", "foot"},          {"subtalar", "foot"},
      {"clavicle", "shoulder"},   {"scapula", "shoulder"},
      {"shoulder", "arm"},        {"elbow", "forearm"},
      {"forearm", "forearm"},     {"wrist", "hand"},
      {"thorax", "trunk_thorax"}, {"head", "neck"},
      {"jaw", "face_jaw"}};
  if (const auto found = regions.find(stem); found != regions.end()) return found->second;
  if (stem.starts_with("toe") || stem.starts_with("mtp")) return "foot";
  if (stem.starts_with("mcp") || stem.starts_with("pip") || stem.starts_with("dip") ||
      stem.starts_with("cmc") || stem.starts_with("ip"))
    return "hand";
  return stem.starts_with("c") ? "neck" : "trunk_back";
}

// "deltoid_l.2" -> {"deltoid_l", 2}: strips of one muscle, as this program exports them; 0 for
// other names.
std::pair<std::string, int> strip_number(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0 || name.size() - dot > 4 || name.size() == dot + 1)
    return {name, 0};
  int number = 0;
  for (size_t i = dot + 1; i < name.size(); ++i) {
    if (name[i] < '0' || name[i] > '9') return {name, 0};
    number = 10 * number + (name[i] - '0');
  }
  return {name.substr(0, dot), number};
}

class Importer {
 public:
  Importer(const MusculoskeletalModel& model, const Template& base, const ImportOptions& options)
      : model_(model), base_(base), options_(options) {}

  Imported import(const Assets& assets) {
    const FitRules& rules = base_.tables.rules;
    const std::vector<BodyRule> bodies = read_body_rules(assets.tables / "model_bodies.csv");
    ImportReport& report = out_.report;
    report.notes = model_.notes;
    report.match = match_model(model_, base_.anatomy.skeleton, bodies);
    report.upright = false;
    const Anatomy source = read_source_skeleton(assets);
    ModelMatch upright = match_model(model_, source.skeleton, bodies);
    target_ = &base_.anatomy;
    const CarryMap stay = [](const Vec3& x, int) { return x; };
    if (!report.match.same &&
        (upright.same || upright.direction_error <= report.match.direction_error)) {
      report.match = std::move(upright);
      report.upright = true;
      target_ = &source;
      const SkeletonWarp warp(source, rules, place_source(assets, source, rules));
      build([&](const Vec3& x, int joint) { return warp.by_joint(joint, x); });
    } else {
      build(stay);
    }
    return std::move(out_);
  }

 private:
  const BodyMatch& body(int index) const { return out_.report.match.bodies[index]; }
  Vec3 place(const ModelPoint& point) const {
    return body(point.body).X_TB * point.place[out_.report.match.pose];
  }

  void build(const CarryMap& to_template) {
    out_.anatomy.skeleton = base_.anatomy.skeleton;
    take_bones(to_template);
    const TriMesh closed = capped_skin(base_.tables.topology, base_.body.skin.V);
    const SkinField skin(closed);
    std::map<std::string, int> index;
    for (const ModelMuscle& muscle : model_.muscles) {
      Strip strip;
      if (!take_path(muscle, to_template, strip)) continue;
      const double volume = dress(muscle, strip);
      add(muscle, std::move(strip), volume, skin, index);
    }
    if (out_.anatomy.muscles.empty())
      throw UnfitError(fmt::format("{}: no muscle spans two points of known bodies", model_.file));
    if (options_.mirror) mirror();
    count();
    validate(out_.anatomy);
  }

  // --- bones ---------------------------------------------------------------------------
  void take_bones(const CarryMap& to_template) {
    std::set<int> replaced;
    std::vector<Bone> own;
    if (!options_.folder.empty())
      for (size_t b = 0; b < model_.bodies.size(); ++b) {
        int number = 0;
        for (const ModelMesh& part : model_.bodies[b].meshes) {
          TriMesh mesh = read_model_mesh(options_.folder, part);
          if (mesh.F.rows() == 0) {
            ++out_.report.meshes_missing;
            continue;
          }
          ++out_.report.meshes;
          Bone bone;
          bone.joint = body(int(b)).joints[0];
          for (Eigen::Index i = 0; i < mesh.V.rows(); ++i)
            mesh.V.row(i) = to_template(body(int(b)).X_TB * Vec3(mesh.V.row(i)), bone.joint);
          bone.mesh = std::move(mesh);
          bone.side = side_of(bone.joint);
          bone.name =
              printable(model_.bodies[b].name) + (++number > 1 ? fmt::format(".{}", number) : "");
          if (body(int(b)).named)
            replaced.insert(body(int(b)).joints.begin(), body(int(b)).joints.end());
          own.push_back(std::move(bone));
        }
      }
    for (const Bone& bone : base_.anatomy.bones)
      if (!replaced.count(bone.joint)) out_.anatomy.bones.push_back(bone);
    for (Bone& bone : own) out_.anatomy.bones.push_back(std::move(bone));
  }

  Side side_of(int joint) const {
    return split_side(base_.anatomy.skeleton.joints[joint].name).second;
  }

  // The joint of a point: of the body's joints, the one whose bone is nearest.
  int nearest_joint(const BodyMatch& match, const Vec3& x) const {
    if (match.joints.size() == 1) return match.joints[0];
    int best = match.joints[0];
    double least = std::numeric_limits<double>::infinity();
    for (const Bone& bone : target_->bones) {
      if (std::find(match.joints.begin(), match.joints.end(), bone.joint) == match.joints.end())
        continue;
      const double d = (bone.mesh.V.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff();
      if (d < least) {
        least = d;
        best = bone.joint;
      }
    }
    return best;
  }

  // --- paths ---------------------------------------------------------------------------
  struct Station {
    PathPoint point;
    int number = 0;  // in the model's path; points that are put in between take the one before
  };

  bool take_path(const ModelMuscle& muscle, const CarryMap& to_template, Strip& strip) {
    std::vector<Station> stations;
    for (size_t k = 0; k < muscle.points.size(); ++k) {
      const ModelPoint& from = muscle.points[k];
      if (!from.active[out_.report.match.pose]) continue;
      Station s;
      s.number = int(k);
      s.point.rest = place(from);
      s.point.joints[0] = nearest_joint(body(from.body), s.point.rest);
      if (body(from.body).with >= 0) {
        s.point.joints[1] = body(from.body).with;
        s.point.share = 0.5;
      }
      if (!stations.empty() && (stations.back().point.rest - s.point.rest).norm() < kShortest)
        continue;
      stations.push_back(s);
    }
    if (stations.size() < 2) {
      out_.report.notes.push_back(
          fmt::format("{}: muscle '{}': its points lie in one place; left out", model_.file,
                      printable(muscle.name)));
      return false;
    }
    for (const ModelWrapUse& use : muscle.wraps)
      if (model_.wraps[use.wrap].kind == ModelWrap::Kind::torus) through_hole(use, stations);
    strip.path.clear();
    for (const Station& s : stations) strip.path.push_back(s.point);
    std::vector<Vec3> sides;
    std::vector<ModelWrapUse> uses;
    for (const ModelWrapUse& use : muscle.wraps) {
      const ModelWrap& from = model_.wraps[use.wrap];
      if (from.kind == ModelWrap::Kind::torus) continue;
      strip.wraps.push_back(to_wrap(from));
      sides.push_back(use.side.isZero() ? from.side : use.side);
      uses.push_back(use);
    }
    strip = carry_strip(strip, to_template);
    for (size_t k = 0; k < stations.size(); ++k) stations[k].point.rest = strip.path[k].rest;
    for (size_t w = 0; w < strip.wraps.size(); ++w)
      over(strip.wraps[w], sides[w], uses[w], stations);
    while (stations.size() > std::size_t(kMaxPathPoints)) thin(stations);
    strip.path.clear();
    for (const Station& s : stations) strip.path.push_back(s.point);
    if (has_directions(strip)) return true;
    out_.report.notes.push_back(
        fmt::format("{}: muscle '{}': its path turns back on itself; left out", model_.file,
                    printable(muscle.name)));
    return false;
  }

  // Whether sections can be laid across the line wherever they come to lie.
  static bool has_directions(const Strip& strip) {
    if (!(line_length(strip.path) > kShortest)) return false;
    std::vector<double> s;
    for (int k = 0; k <= kDirections; ++k) s.push_back(double(k) / kDirections);
    const std::vector<Vec3> tangents = line_tangents(line_points(strip.path, s));
    return std::all_of(tangents.begin(), tangents.end(), [](const Vec3& t) {
      return t.allFinite() && std::abs(t.norm() - 1) < 1e-6;
    });
  }

  Wrap to_wrap(const ModelWrap& from) const {
    const BodyMatch& match = body(from.body);
    Wrap wrap;
    wrap.kind = from.kind == ModelWrap::Kind::sphere     ? Wrap::Kind::sphere
                : from.kind == ModelWrap::Kind::cylinder ? Wrap::Kind::cylinder
                                                         : Wrap::Kind::ellipsoid;
    wrap.joint = match.joints[0];
    wrap.X_WO.linear() = match.X_TB.linear() / match.scale * from.X_BO.linear();
    wrap.X_WO.translation() = match.X_TB * from.X_BO.translation();
    wrap.radii = match.scale * from.radii;
    return wrap;
  }

  // A line that would miss the hole gets a via point in it.
  void through_hole(const ModelWrapUse& use, std::vector<Station>& stations) {
    const ModelWrap& ring = model_.wraps[use.wrap];
    const BodyMatch& match = body(ring.body);
    const Affine X_TO = match.X_TB * Affine(ring.X_BO.matrix()), X_OT = X_TO.inverse();
    const double hole = ring.radii.x();
    size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    Vec3 at = Vec3::Zero();
    for (size_t k = 1; k < stations.size(); ++k) {
      if (stations[k - 1].number < use.first || (use.last >= 0 && stations[k].number > use.last))
        continue;
      const Vec3 a = X_OT * stations[k - 1].point.rest, b = X_OT * stations[k].point.rest;
      const double t = std::clamp(-a.dot(b - a) / std::max((b - a).squaredNorm(), 1e-12), 0.0, 1.0);
      const Vec3 p = a + t * (b - a);
      if (p.norm() < least && t > 0.02 && t < 0.98) {
        least = p.norm();
        best = k;
        at = p;
      }
    }
    if (best == 0 || least < kThroughHole * hole || least > kHoleReach * (hole + ring.radii.z()))
      return;
    at.z() = 0;
    if (at.norm() > kThroughHole * hole) at *= kThroughHole * hole / at.norm();
    insert(stations, best, {X_TO * at}, nearest_joint(match, X_TO * at));
  }

  // Via points where a wrap holds the line at rest: between the two points where it reaches in
  // deepest.
  void over(const Wrap& wrap, const Vec3& side, const ModelWrapUse& use,
            std::vector<Station>& stations) {
    for (size_t k = 1; k < stations.size(); ++k) {
      if (stations[k - 1].number < use.first ||
          (use.last >= 0 && stations[k].number > use.last && stations[k - 1].number >= use.last))
        continue;
      const auto points =
          taut_points(stations[k - 1].point.rest, stations[k].point.rest, wrap, side);
      if (points.empty()) continue;
      insert(stations, k, points, wrap.joint);
      k += points.size();
    }
  }

  void insert(std::vector<Station>& stations, size_t before, const std::vector<Vec3>& points,
              int joint) {
    std::vector<Station> added;
    for (const Vec3& p : points) {
      Station s;
      s.number = stations[before - 1].number;
      s.point.rest = p;
      s.point.joints[0] = joint;
      added.push_back(s);
    }
    out_.report.via_points += added.size();
    stations.insert(stations.begin() + long(before), added.begin(), added.end());
  }

  // Drops the inner point that bends the line least.
  static void thin(std::vector<Station>& stations) {
    size_t least = 1;
    double best = std::numeric_limits<double>::infinity();
    for (size_t k = 1; k + 1 < stations.size(); ++k) {
      const Vec3 &a = stations[k - 1].point.rest, &b = stations[k].point.rest,
                 &c = stations[k + 1].point.rest;
      const double detour = (b - a).norm() + (c - b).norm() - (c - a).norm();
      if (detour < best) {
        best = detour;
        least = k;
      }
    }
    stations.erase(stations.begin() + long(least));
  }

  // --- muscles -------------------------------------------------------------------------
  double dress(const ModelMuscle& muscle, Strip& strip) {
    const double length = line_length(strip.path);
    StripForces f{0, muscle.fibre_length, muscle.tendon_slack, muscle.pennation, muscle.max_force};
    if (muscle.max_force > 0 && muscle.fibre_length > 0) {
      f.volume = muscle.max_force / options_.stress * muscle.fibre_length;
    } else {
      f.volume = kUnknownSection * length;
      ++out_.report.forces_unknown;
    }
    const std::vector<Vec3> middle = line_points(strip.path, std::array{0.5});
    add_default_sections(strip, f, toward_bone(strip, middle[0]));
    return f.volume;
  }

  Vec3 toward_bone(const Strip& strip, const Vec3& x) const {
    std::set<int> joints;
    for (const PathPoint& p : strip.path) joints.insert(p.joints[0]);
    double least = std::numeric_limits<double>::infinity();
    Vec3 deep = Vec3::Zero();
    for (const Bone& bone : base_.anatomy.bones) {
      if (!joints.count(bone.joint)) continue;
      Eigen::Index at = 0;
      const double d =
          (bone.mesh.V.rowwise() - x.transpose()).rowwise().squaredNorm().minCoeff(&at);
      if (d < least) {
        least = d;
        deep = bone.mesh.V.row(at).transpose() - x;
      }
    }
    return deep.norm() > 1e-6 ? Vec3(deep.normalized()) : Vec3::Zero();
  }

  struct NearBone {
    std::string name;
    double distance = 0;
  };
  NearBone near_bone(const PathPoint& p) const {
    NearBone near{"", std::numeric_limits<double>::infinity()};
    for (const Bone& bone : out_.anatomy.bones) {
      if (bone.joint != p.joints[0]) continue;
      const double d = distance_to_mesh(p.rest, bone.mesh);
      if (d < near.distance) near = {bone.name, d};
    }
    return near;
  }

  void add(const ModelMuscle& from, Strip strip, double volume, const SkinField& skin,
           std::map<std::string, int>& index) {
    const auto [stem, number] = strip_number(printable(from.name));
    const bool further = number > 1 && index.count(stem) > 0;
    const std::string name =
        number > 0 && (further || (number == 1 && has_second(stem))) ? stem : printable(from.name);
    if (further) {
      Muscle& muscle = out_.anatomy.muscles[index.at(name)];
      muscle.volume += volume;
      muscle.max_force += from.max_force;
      muscle.strips.push_back(std::move(strip));
      return;
    }
    if (index.count(name))
      throw InputError(fmt::format("{}: two muscles are named '{}'", model_.file, name));
    Muscle muscle;
    muscle.name = muscle.label = name;
    const Vec3 middle = line_points(strip.path, std::array{0.5})[0];
    size_t nearest = 0;
    for (size_t k = 0; k < strip.path.size(); ++k) {
      if ((strip.path[k].rest - middle).norm() < (strip.path[nearest].rest - middle).norm())
        nearest = k;
      if (muscle.side == Side::middle) muscle.side = side_of(strip.path[k].joints[0]);
    }
    if (muscle.side == Side::middle) muscle.side = split_model_side(name).second;
    muscle.group = region(base_.anatomy.skeleton.joints[strip.path[nearest].joints[0]].name);
    double thickest = 0;
    for (const Slice& slice : strip.slices) thickest = std::max(thickest, slice.radii.y());
    muscle.layer = skin.distance(middle) + thickest > -kUnderSkin ? "superficial" : "deep";
    muscle.origin_bone = near_bone(strip.path.front()).name;
    muscle.insertion_bone = near_bone(strip.path.back()).name;
    muscle.origin = muscle.origin_bone;
    muscle.insertion = muscle.insertion_bone;
    muscle.volume = volume;
    muscle.max_force = from.max_force;
    muscle.fibre_length = from.fibre_length;
    muscle.tendon_slack = from.tendon_slack;
    muscle.pennation = from.pennation;
    muscle.strips.push_back(std::move(strip));
    index[name] = out_.anatomy.muscles.size();
    out_.anatomy.muscles.push_back(std::move(muscle));
  }

  bool has_second(const std::string& stem) const {
    return std::any_of(model_.muscles.begin(), model_.muscles.end(),
                       [&](const ModelMuscle& m) { return m.name == stem + ".2"; });
  }

  // The other side of a model of one side. Names get the side that they lack.
  void mirror() {
    std::set<std::pair<std::string, Side>> there;
    for (const Muscle& muscle : out_.anatomy.muscles)
      there.emplace(split_model_side(muscle.name).first, muscle.side);
    const size_t count = out_.anatomy.muscles.size();
    for (size_t m = 0; m < count; ++m) {
      Muscle& muscle = out_.anatomy.muscles[m];
      const Side opposite = muscle.side == Side::left ? Side::right : Side::left;
      if (muscle.side == Side::middle ||
          there.count({split_model_side(muscle.name).first, opposite}))
        continue;
      if (mirror_name(muscle.name) == muscle.name) muscle.name += side_suffix(muscle.side);
      Muscle other = muscle;
      other.name = mirror_name(muscle.name);
      other.side = opposite;
      other.origin_bone = mirror_name(other.origin_bone);
      other.insertion_bone = mirror_name(other.insertion_bone);
      const CarryMap reflect = [](const Vec3& x, int) { return Vec3(-x.x(), x.y(), x.z()); };
      for (Strip& strip : other.strips) {
        strip = carry_strip(strip, reflect);
        for (PathPoint& p : strip.path)
          for (int& j : p.joints) j = mirror_joint(j);
        for (Wrap& w : strip.wraps) w.joint = mirror_joint(w.joint);
      }
      out_.anatomy.muscles.push_back(std::move(other));
    }
  }

  int mirror_joint(int joint) const {
    if (joint < 0) return joint;
    const int other =
        find_joint(base_.anatomy.skeleton, mirror_name(base_.anatomy.skeleton.joints[joint].name));
    return other >= 0 ? other : joint;
  }

  void count() {
    ImportReport& r = out_.report;
    std::vector<double> distances;
    for (Muscle& muscle : out_.anatomy.muscles) {
      ++r.muscles;
      const double now = rest_volume(muscle);
      if (now < 0.99 * muscle.volume)
        r.notes.push_back(
            fmt::format("muscle '{}': too short for its {:.0f} ml; drawn with {:.0f} ml",
                        muscle.name, 1e6 * muscle.volume, 1e6 * now));
      muscle.volume = now;
      r.volume += now;
      for (const Strip& strip : muscle.strips) {
        ++r.strips;
        r.points += strip.path.size();
        r.wraps += strip.wraps.size();
        for (const PathPoint* end : {&strip.path.front(), &strip.path.back()}) {
          if (end->joints[1] >= 0) continue;
          const NearBone near = near_bone(*end);
          if (!std::isfinite(near.distance)) continue;
          distances.push_back(near.distance);
          if (near.distance <= r.attachment_max) continue;
          r.attachment_max = near.distance;
          r.attachment_worst = muscle.name;
        }
      }
    }
    if (distances.empty()) return;
    std::nth_element(distances.begin(), distances.begin() + long(distances.size() / 2),
                     distances.end());
    r.attachment_median = distances[distances.size() / 2];
  }

  const MusculoskeletalModel& model_;
  const Template& base_;
  const ImportOptions& options_;
  const Anatomy* target_ = nullptr;
  Imported out_;
};

}  // namespace

Imported import_model(const MusculoskeletalModel& model, const Template& base, const Assets& assets,
                      const ImportOptions& options) {
  if (!(options.stress > 0))
    throw std::invalid_argument("import_model: the stress must be positive");
  return Importer(model, base, options).import(assets);
}

}  // namespace ecorche::inline v1
