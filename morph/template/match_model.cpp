#include "morph/template/match_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "anatomy/compute/eigenvectors.h"
#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "anatomy/files/input_file.h"

namespace ecorche::inline v1 {
namespace {

// weight of leaving a body as it stands, of one direction between joint centres
constexpr double kAsItStands = 0.15;
constexpr double kSameSkeleton = 5e-3;  // m, median over joint centres
// m: centres closer together say little about direction and nothing about scale
constexpr double kSpread = 0.08;
constexpr double kLeastScale = 0.4, kMostScale = 2.5;

struct Named {  // what a body's name says
  const BodyRule* rule = nullptr;
  int exact = -1;  // a joint of ours
  std::string stem;
  Side side = Side::middle;
};

int sided_joint(const Skeleton& skeleton, const std::string& name, Side side) {
  const int own = find_joint(skeleton, name + side_suffix(side));
  return own >= 0 ? own : find_joint(skeleton, name);
}

bool is_paired(const Skeleton& skeleton, const std::string& name) {
  return find_joint(skeleton, name) < 0;
}

struct Anchor {    // a joint centre of the model and where it belongs
  int body = 0;    // whose joint to its parent it is
  int above = -1;  // body at the other side
  Vec3 model = Vec3::Zero(), target = Vec3::Zero();
};

struct Candidate {
  int pose = 0, facing = 0;
  Mat3 turn = Mat3::Identity();
  std::vector<std::vector<int>> joints;
  std::vector<int> above;  // nearest named ancestor that rides on another joint; -1
  std::vector<Anchor> anchors;
  double error = std::numeric_limits<double>::infinity();
};

class Matcher {
 public:
  Matcher(const MusculoskeletalModel& model, const Skeleton& skeleton,
          const std::vector<BodyRule>& rules)
      : model_(model), skeleton_(skeleton), rest_(rest_positions(skeleton)) {
    int known = 0;
    for (const ModelBody& body : model.bodies) {
      Named n;
      n.exact = find_joint(skeleton, body.name);
      std::tie(n.stem, n.side) = split_model_side(body.name);
      if (n.exact < 0)
        for (const BodyRule& rule : rules)
          if (rule.body == n.stem) n.rule = &rule;
      known += n.rule || n.exact >= 0;
      names_.push_back(n);
    }
    if (known < 2) {
      std::string list;
      for (size_t b = 0; b < model.bodies.size() && b < 12; ++b)
        list += (b ? ", " : "") + printable(model.bodies[b].name);
      throw UnfitError(
          fmt::format("{}: of its bodies ({}) {} known; add the others to data/model_bodies.csv",
                      model.file, list, known == 1 ? "one is" : "none is"));
    }
  }

  ModelMatch match() const {
    Candidate best;
    for (int facing = 0; facing < (model_.faces_forward ? 1 : 4); ++facing)
      for (int pose = 0; pose < kModelPoses; ++pose) {
        Candidate c = try_candidate(pose, facing);
        if (c.error < best.error - 1e-12) best = std::move(c);
      }
    return finish(best);
  }

 private:
  Candidate try_candidate(int pose, int facing) const {
    Candidate c;
    c.pose = pose;
    c.facing = facing;
    c.turn = Eigen::AngleAxisd(facing * 1.57079632679489662, Vec3::UnitY()).toRotationMatrix();
    for (size_t b = 0; b < model_.bodies.size(); ++b) place(int(b), c);
    c.error = 0;
    double weight = 0;
    const auto compare = [&](const Anchor& a, const Anchor& b) {
      const Vec3 m = b.model - a.model, t = b.target - a.target;
      if (m.norm() < kSpread || t.norm() < kSpread) return;
      c.error += std::pow(std::atan2(m.cross(t).norm(), m.dot(t)), 2);
      weight += 1;
    };
    for (size_t i = 0; i < c.anchors.size(); ++i)
      for (size_t k = 0; k < c.anchors.size(); ++k) {
        if (c.anchors[k].above == c.anchors[i].body)
          compare(c.anchors[i], c.anchors[k]);
        else if (k > i && c.anchors[k].above == c.anchors[i].above)
          compare(c.anchors[i], c.anchors[k]);
      }
    c.error = weight > 0 ? std::sqrt(c.error / weight) : 1e3;
    return c;
  }

  Vec3 center(const Candidate& c, int body) const {
    return c.turn * model_.bodies[body].center[c.pose];
  }

  // A limb without side in its name lies on the side where it is.
  Side side_of(const Candidate& c, int body) const {
    if (names_[body].side != Side::middle) return names_[body].side;
    if (body >= 0 && model_.bodies[body].parent >= 0) {
      const int parent = model_.bodies[body].parent;
      if (const int up = c.above[body]; up >= 0 && !c.joints[up].empty()) {
        const std::string& name = skeleton_.joints[c.joints[up][0]].name;
        if (name.ends_with("_l")) return Side::left;
        if (name.ends_with("_r")) return Side::right;
      }
      int root = parent;
      while (model_.bodies[root].parent >= 0 && names_[root].rule == nullptr)
        root = model_.bodies[root].parent;
      return center(c, body).x() >= (c.turn * model_.bodies[root].X_WB[c.pose].translation()).x()
                 ? Side::left
                 : Side::right;
    }
    return Side::right;
  }

  void place(int b, Candidate& c) const {
    const int parent = model_.bodies[b].parent;
    int up = parent;  // the nearest ancestor that is carried by a joint of its own
    while (up >= 0 && c.joints[up].empty()) up = model_.bodies[up].parent;
    c.joints.emplace_back();
    c.above.push_back(up);
    const Named& n = names_[b];
    if (n.exact >= 0) {
      c.joints[b] = {n.exact};
    } else if (n.rule) {
      const Side side = is_paired(skeleton_, n.rule->joints[0]) ? side_of(c, b) : n.side;
      for (const std::string& name : n.rule->joints)
        if (const int j = sided_joint(skeleton_, name, side); j >= 0) c.joints[b].push_back(j);
    }
    if (c.joints[b].empty()) return;
    // Bodies on one joint (wrist bones) are one body.
    while (up >= 0 && c.joints[up][0] == c.joints[b][0]) up = c.above[up];
    c.above[b] = up;
    if (up < 0 || is_with(b) || (n.rule && n.rule->none) || model_.bodies[b].loose) return;
    if (parent_rides_along(b, c)) return;
    c.anchors.push_back({b, up, center(c, b), rest_[target_joint(b, c)]});
  }

  bool is_with(int b) const { return names_[b].rule && !names_[b].rule->with.empty(); }

  // The joint between two bodies that ride on one joint of ours is none of ours.
  bool parent_rides_along(int b, const Candidate& c) const {
    int up = model_.bodies[b].parent;
    while (up >= 0 && c.joints[up].empty()) up = model_.bodies[up].parent;
    return up >= 0 && c.joints[up][0] == c.joints[b][0];
  }

  int target_joint(int b, const Candidate& c) const {
    const int own = c.joints[b][0], from = c.joints[c.above[b]][0];
    if (!names_[b].rule || !names_[b].rule->first) return own;
    for (int j = own; j >= 0; j = skeleton_.joints[j].parent)
      if (skeleton_.joints[j].parent == from) return j;
    return own;
  }

  // The first body of those that ride on one joint, from the root.
  int leader(int b, const Candidate& c) const {
    int lead = b;
    for (int up = model_.bodies[b].parent; up >= 0; up = model_.bodies[up].parent)
      if (!c.joints[up].empty()) {
        if (c.joints[up][0] != c.joints[b][0]) break;
        lead = up;
      }
    return lead;
  }

  struct Similarity {
    Mat3 turn = Mat3::Identity();
    double scale = 1;
    Vec3 shift = Vec3::Zero();
  };

  // Of a body, from the joint centres around it. `stands`: how it is turned where nothing tells.
  static Similarity solve(const std::vector<const Anchor*>& around, const Mat3& stands,
                          double scale, const Vec3& point, const Vec3& where) {
    Similarity s{stands, scale, Vec3::Zero()};
    Vec3 a0 = point, b0 = where;
    if (!around.empty()) {
      a0 = b0 = Vec3::Zero();
      for (const Anchor* anchor : around) {
        a0 += anchor->model / double(around.size());
        b0 += anchor->target / double(around.size());
      }
      Mat3 H = kAsItStands * stands;
      double model = 0, target = 0;
      for (const Anchor* anchor : around) {
        const Vec3 a = anchor->model - a0, b = anchor->target - b0;
        model += a.squaredNorm();
        target += b.squaredNorm();
        if (a.norm() > 1e-3 && b.norm() > 1e-3)
          H += std::min(1.0, std::min(a.norm(), b.norm()) / kSpread) * b.normalized() *
               a.normalized().transpose();
      }
      s.turn = nearest_rotation(H);
      if (around.size() >= 2 && std::sqrt(model) > kSpread)
        s.scale = std::clamp(std::sqrt(target / model), kLeastScale, kMostScale);
    }
    s.shift = b0 - s.scale * (s.turn * a0);
    return s;
  }

  // One rigid motion for the whole model when its centres agree with ours.
  bool same_skeleton(const Candidate& c, Similarity& whole) const {
    std::vector<const Anchor*> all;
    for (const Anchor& a : c.anchors) all.push_back(&a);
    if (all.size() < 8) return false;
    // Both stand upright and face the same way. A few centres may be defined otherwise; they do not
    // pull a median.
    for (int i = 0; i < 3; ++i) {
      std::vector<double> d;
      for (const Anchor* a : all) d.push_back(a->target[i] - a->model[i]);
      std::nth_element(d.begin(), d.begin() + long(d.size() / 2), d.end());
      whole.shift[i] = d[d.size() / 2];
    }
    std::vector<double> distances;
    for (const Anchor* a : all) distances.push_back((a->model + whole.shift - a->target).norm());
    std::nth_element(distances.begin(), distances.begin() + long(distances.size() / 2),
                     distances.end());
    if (distances[distances.size() / 2] > kSameSkeleton) return false;
    return true;
  }

  ModelMatch finish(const Candidate& c) const {
    ModelMatch match;
    match.pose = c.pose;
    match.facing = c.facing;
    match.direction_error = c.error;
    match.centers = c.anchors.size();
    Similarity whole;
    match.same = same_skeleton(c, whole);
    double model = 0, target = 0;  // the size of the whole, for bodies that know nothing better
    for (const Anchor& a : c.anchors)
      for (const Anchor& b : c.anchors)
        if (b.above == a.body) {
          model += (b.model - a.model).norm();
          target += (b.target - a.target).norm();
        }
    const double size = model > 0.1 ? target / model : 1;

    std::vector<Similarity> maps(model_.bodies.size());
    for (size_t b = 0; b < model_.bodies.size(); ++b) {
      const int body = int(b), parent = model_.bodies[b].parent;
      BodyMatch out;
      out.named = !c.joints[b].empty();
      int up = parent;
      while (up >= 0 && c.joints[up].empty()) up = model_.bodies[up].parent;
      if (match.same)
        maps[b] = whole;
      else if (!out.named || is_with(body) ||
               (parent >= 0 && names_[b].rule && names_[b].rule->none) || leader(body, c) != body)
        maps[b] = parent >= 0 ? maps[parent] : Similarity{Mat3::Identity(), size, Vec3::Zero()};
      else
        maps[b] = own_map(body, c, up >= 0 ? &maps[up] : nullptr, size);
      out.joints = out.named ? c.joints[b] : up >= 0 ? match.bodies[up].joints : root_joints(c);
      if (is_with(body)) out.with = sided_joint(skeleton_, names_[b].rule->with, Side::middle);
      const Similarity& s = maps[b];
      out.scale = s.scale;
      Affine to_target = Affine::Identity();
      to_target.linear() = s.scale * s.turn;
      to_target.translation() = s.shift;
      Transform facing = Transform::Identity();
      facing.linear() = c.turn;
      out.X_TB = to_target * Affine((facing * model_.bodies[b].X_WB[c.pose]).matrix());
      match.bodies.push_back(std::move(out));
    }
    measure(c, maps, match);
    list_unknown(match);
    keep_to_own(match);
    return match;
  }

  Similarity own_map(int body, const Candidate& c, const Similarity* parent, double size) const {
    std::vector<const Anchor*> around;
    int below = 0;
    for (const Anchor& a : c.anchors) {
      const bool child = is_below(a, body, c);
      if (a.body == body || child) around.push_back(&a);
      below += child;
    }
    // The end of a limb is turned as what it hangs on.
    const Mat3 stands = below == 0 && parent ? parent->turn : Mat3::Identity();
    const double scale = around.size() < 2 && parent ? parent->scale : size;
    return solve(around, stands, scale, center(c, body), rest_[c.joints[body][0]]);
  }

  // The joints at a body's far end; where that is near (ulna, talus), those of the next body tell
  // where its bone points.
  bool is_below(const Anchor& a, int body, const Candidate& c) const {
    if (a.above < 0) return false;
    int above = leader(a.above, c);
    while (names_[above].rule && names_[above].rule->none && c.above[above] >= 0)
      above = leader(c.above[above], c);  // it goes with its parent
    if (above == body) return true;
    const Anchor* link = nullptr;
    for (const Anchor& other : c.anchors)
      if (other.body == above) link = &other;
    if (!link || link->above < 0 || leader(link->above, c) != body) return false;
    return (link->model - center(c, body)).norm() < kSpread;
  }

  std::vector<int> root_joints(const Candidate& c) const {
    for (const auto& joints : c.joints)
      if (!joints.empty()) return {joints[0]};
    return {0};
  }

  void measure(const Candidate& c, const std::vector<Similarity>& maps, ModelMatch& match) const {
    double sum = 0;
    for (const Anchor& a : c.anchors) {
      const Similarity& s = maps[a.body];
      sum += (s.scale * (s.turn * a.model) + s.shift - a.target).squaredNorm();
    }
    match.center_error = c.anchors.empty() ? 0 : std::sqrt(sum / double(c.anchors.size()));
  }

  void list_unknown(ModelMatch& match) const {
    std::set<int> carrying;
    for (const ModelMuscle& muscle : model_.muscles)
      for (const ModelPoint& point : muscle.points) carrying.insert(point.body);
    for (int b : carrying)
      if (!match.bodies[b].named) match.unknown.push_back(model_.bodies[b].name);
  }

  // A trunk in one piece takes the vertebrae along, but not where the model has bodies for them.
  static void keep_to_own(ModelMatch& match) {
    std::set<int> first;
    for (const BodyMatch& body : match.bodies) first.insert(body.joints[0]);
    for (BodyMatch& body : match.bodies)
      body.joints.erase(std::remove_if(body.joints.begin() + 1, body.joints.end(),
                                       [&](int j) { return first.count(j) > 0; }),
                        body.joints.end());
  }

  const MusculoskeletalModel& model_;
  const Skeleton& skeleton_;
  std::vector<Vec3> rest_;
  std::vector<Named> names_;
};

}  // namespace

std::pair<std::string, Side> split_model_side(const std::string& name) {
  std::string stem = name;
  for (char& c : stem)
    c = c == ' ' || c == '-' || c == '.' ? '_' : char(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  for (const auto& [word, side] : {std::pair{"right", Side::right}, std::pair{"left", Side::left},
                                   std::pair{"r", Side::right}, std::pair{"l", Side::left}}) {
    const std::string w = word;
    if (stem.size() > w.size() + 1 && stem.ends_with("_" + w))
      return {stem.substr(0, stem.size() - w.size() - 1), side};
    if (stem.size() > w.size() + 1 && stem.starts_with(w + "_"))
      return {stem.substr(w.size() + 1), side};
  }
  return {stem, Side::middle};
}

std::vector<BodyRule> read_body_rules(const std::filesystem::path& file) {
  const Table table(file);
  std::vector<BodyRule> rules;
  for (int row = 0; row < table.rows(); ++row) {
    BodyRule rule{table.text(row, "body"),
                  {},
                  table.text(row, "centre") == "first",
                  table.text(row, "centre") == "none",
                  table.text(row, "with")};
    std::istringstream joints(table.text(row, "joints"));
    for (std::string name; joints >> name;) rule.joints.push_back(name);
    if (rule.body.empty() || rule.joints.empty())
      throw InputError(fmt::format("{}: a body and at least one joint expected", table.where(row)));
    if (!rule.first && !rule.none && table.text(row, "centre") != "last")
      throw InputError(fmt::format("{}: centre '{}'; first, last or none expected",
                                   table.where(row), table.text(row, "centre")));
    rules.push_back(std::move(rule));
  }
  return rules;
}

ModelMatch match_model(const MusculoskeletalModel& model, const Skeleton& skeleton,
                       const std::vector<BodyRule>& rules) {
  return Matcher(model, skeleton, rules).match();
}

}  // namespace ecorche::inline v1
